"""The driver ``naoqi`` against a service directory and services of qi in a second process."""

from __future__ import annotations

import re
import socket
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.parties.bench import LOST_AND_BACK, Driven, Process, Visit, in_order
from tests.parties.checked import checked

HERE = Path(__file__).parent
LONG = "This takes much longer than anybody wants to wait for it."


@pytest.fixture
def port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


@pytest.fixture
def document(tmp_path: Path, port: int) -> Path:
    path = tmp_path / "robot.xml"
    path.write_text((HERE / "robot.xml").read_text().replace("PORT", str(port)))
    return path


def made_robot(port: int) -> Process:
    robot = Process("naoqi", str(HERE / "robot.py"), str(port))
    robot.expect("ready")
    return robot


@pytest.fixture
def robot(port: int) -> Iterator[Process]:
    process = made_robot(port)
    yield process
    process.kill()


@pytest.fixture
def driver(robot: Process, document: Path) -> Iterator[Driven]:
    process = Driven("naoqi", document)
    try:
        process.expect("open")
        yield process
        assert process.end() == 0, "".join(process.errors)
    finally:
        process.kill()


def test_a_goal_is_done(robot: Process, driver: Driven) -> None:
    key = driver.start("say", "Hello!")
    driver.expect("Accepted", key=key)
    driver.expect("Done", key=key)
    told = robot.expect("says")
    assert (told["text"], told["language"]) == ("Hello!", "English")
    robot.expect("says no more", cut=False)


def test_arguments_are_in_their_order_and_radians(robot: Process, driver: Driven) -> None:
    driver.expect("Done", key=driver.start("turn", angle=90))
    assert robot.expect("goes")["theta"] == pytest.approx(1.5708, abs=1e-3)
    driver.expect("Done", key=driver.start("move-head", pan=18, tilt=-9))
    head = robot.expect("head")
    assert head["names"] == ["HeadYaw", "HeadPitch"]
    assert head["angles"] == pytest.approx([0.31416, -0.15708], abs=1e-3)


@pytest.mark.parametrize(
    ("kind", "given", "begins", "ends"),
    [
        ("say", {"text": LONG}, "says", "says no more"),
        ("topological-move", {"to": "door"}, "goes", "go over"),
    ],
)
def test_a_cancelled_goal_has_really_stopped(
    robot: Process, driver: Driven, kind: str, given: dict[str, str], begins: str, ends: str
) -> None:
    key = driver.start(kind, **given)
    robot.expect(begins)
    at = driver.cancel(key)
    stopped = driver.expect("Stopped", key=key)
    assert robot.expect(ends, cut=True)["at"] <= stopped["at"]
    assert stopped["at"] - at < 1


def test_a_speed_lasts_its_time(robot: Process, driver: Driven) -> None:
    speed = {"speed": 0.2, "turn-speed": 0, "time": 500}
    key = driver.start("set-speed-and-time", None, **speed)
    driver.expect("Done", key=key)
    began, ended = robot.expect("drives")["at"], robot.expect("stop")["at"]
    assert 0.4 < ended - began < 0.9
    key = driver.start("set-speed-and-time", None, **{**speed, "time": 5000})
    robot.expect("drives")
    at = driver.cancel(key)
    assert robot.expect("stop")["at"] - at < 1
    driver.expect("Stopped", key=key)


def test_a_goal_that_the_robot_refuses_breaks(robot: Process, driver: Driven) -> None:
    key = driver.start("topological-move", to="wall")
    assert driver.expect("Broke", key=key)["reason"] == "ALMotion::moveTo there is a wall behind me"
    key = driver.start("point-by-hand", angle=10)
    assert '<does command="point-by-hand">' in driver.expect("Broke", key=key)["reason"]


def test_what_is_in_the_memory_is_told(robot: Process, driver: Driven) -> None:
    robot.write("FrontTactilTouched 1.0")
    assert driver.expect("Occurred")["name"] == "touch"
    robot.write("FrontTactilTouched 0.0")
    driver.nothing("Occurred", 0.3)
    robot.write("FrontTactilTouched 1.0")
    driver.expect("Occurred")
    robot.write("BatteryChargeChanged 80")
    assert driver.expect("Sensed")["values"] == {"battery": 80}
    robot.write('WordRecognized ["two please", 0.75, "too cheese", 0.25]')
    heard = driver.expect("Heard")
    assert heard["text"] == "two please"
    assert heard["data"]["confidence"] == 0.75
    assert heard["data"]["alternatives"] == [{"text": "too cheese", "confidence": 0.25}]
    robot.write("Pose [1.0, 2.0, 0.0]")
    assert driver.expect("At")["y"] == 2


def test_safe_stops_everything(robot: Process, driver: Driven) -> None:
    keys = {driver.start("topological-move", to="door"), driver.start("say", LONG)}
    robot.expect("says")
    driver.do("safe")
    assert {driver.expect("Stopped")["key"] for _ in keys} == keys
    ended = {robot.until(lambda line: "cut" in line, "end")["cut"] for _ in keys}
    assert ended == {True}


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_a_robot_that_is_gone_is_lost_and_found_again(
    robot: Process, driver: Driven, port: int, how: str
) -> None:
    key = driver.start("topological-move", to="door")
    robot.expect("goes")
    driver.expect("Accepted", key=key)
    getattr(robot, how)()
    driver.expect("Lost")
    robot.kill()
    back = made_robot(port)
    try:
        driver.expect("Back")
        driver.expect("Done", key=driver.start("say", "Hi!"))
        robot = back
        robot.expect("says")
    finally:
        back.kill()


def test_a_wrong_address_is_told_in_time(document: Path, port: int) -> None:
    driver = Driven("naoqi", document)
    try:
        closed = driver.expect("closed")
        assert "cannot be reached: Connect error: 111: Connection refused." in closed["error"]
        assert closed["after"] < 4
    finally:
        driver.kill()


def test_a_robot_that_never_answers_is_told_in_time(document: Path, port: int) -> None:
    with socket.create_server(("127.0.0.1", port)):
        driver = Driven("naoqi", document)
        try:
            closed = driver.expect("closed")
            assert f"tcp://127.0.0.1:{port} does not answer" in closed["error"]
            assert closed["after"] < 4
        finally:
            driver.kill()


@pytest.mark.parametrize(
    ("right", "wrong", "told"),
    [
        ("ALMotion.stopMove", "ALMotion.stopMoving", "ALMotion has no method stopMoving"),
        ("ALTextToSpeech.", "ALTextToSpeach.", "the robot has no service ALTextToSpeach"),
        ("ALTextToSpeech.say", "say", '"say" is not a service and its method'),
    ],
)
def test_a_document_that_does_not_fit_is_told(
    robot: Process, document: Path, right: str, wrong: str, told: str
) -> None:
    document.write_text(document.read_text().replace(right, wrong))
    driver = Driven("naoqi", document)
    try:
        assert told in driver.expect("closed")["error"]
    finally:
        driver.kill()


def test_two_applications_run_to_their_end(robot: Process, document: Path, tmp_path: Path) -> None:
    visit = Visit("naoqi", document, tmp_path / "visit.jsonl")
    try:
        robot.expect("goes", x=4)
        robot.write("FrontTactilTouched 1.0")
        robot.expect("go over", cut=True)
        robot.expect("goes", x=0)
        robot.expect("goes", x=4)
        robot.expect("go over", cut=False)
        rows = visit.rows()
    finally:
        visit.kill()
    parts = ("Topological Move", "touch", "Turn", "ends dodge", "resumes", "ends walk: exit")
    assert in_order(rows, *parts), rows


def test_the_robot_goes_in_the_midst_of_a_run(
    robot: Process, document: Path, port: int, tmp_path: Path
) -> None:
    visit = Visit("naoqi", document, tmp_path / "visit.jsonl")
    rows = visit.rows_of_lost_robot(robot, partial(made_robot, port), "FrontTactilTouched 1.0", x=4)
    assert in_order(rows, *LOST_AND_BACK), rows


def test_the_check_before_a_run_tries_to_cancel(robot: Process, document: Path) -> None:
    code, lines = checked("naoqi", document)
    for what in ("topological-move", "turn", "set-speed-and-time", "say", "listen"):
        assert re.match(r"ok .* \d+ ms +\d+ ms$", lines[what]), lines
    lacking = {what for what, line in lines.items() if line.startswith("FAILS")}
    assert all("no driver carries it out" in lines[what] for what in lacking), lines
    assert code == (3 if lacking else 0)
