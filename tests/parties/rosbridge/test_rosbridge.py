"""The driver ``rosbridge`` against a server of its protocol in a second process."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.parties.bench import LOST_AND_BACK, Driven, Process, Visit, in_order

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


def made_robot(port: int, *options: str) -> Process:
    robot = Process("rosbridge", str(HERE / "robot.py"), str(port), *options)
    robot.expect("ready")
    return robot


@pytest.fixture
def robot(port: int) -> Iterator[Process]:
    process = made_robot(port, "threads")
    yield process
    process.kill()


@pytest.fixture
def driver(robot: Process, document: Path) -> Iterator[Driven]:
    patient = document.read_text().replace('open="4s"', 'open="15s"')
    document.write_text(patient)  # many programs begin at once, and its library takes long then
    process = Driven("rosbridge", document)
    try:
        process.expect("open")
        yield process
        assert process.end() == 0, "".join(process.errors)
    finally:
        process.kill()


def test_a_goal_is_done(robot: Process, driver: Driven) -> None:
    key = driver.start("gesture", name="nod")
    driver.expect("Accepted", key=key)
    driver.expect("Done", key=key)
    assert robot.expect("goes")["order"] == 5


def test_a_cancelled_goal_has_really_stopped(robot: Process, driver: Driven) -> None:
    key = driver.start("topological-move", to="door")
    driver.expect("Progress", key=key)
    assert robot.expect("goes")["x"] == 4
    at = driver.cancel(key)
    stopped = driver.expect("Stopped", key=key)
    over = robot.expect("go over")
    assert over["status"] == 5
    assert over["at"] <= stopped["at"] < at + 1


def test_a_goal_is_refused_or_given_up(robot: Process, driver: Driven) -> None:
    key = driver.start("gesture", name="hop")
    assert driver.expect("Broke", key=key)["reason"] == "Action goal was rejected"
    key = driver.start("topological-move", to="nowhere")
    assert driver.expect("Broke", key=key)["reason"] == "there is a wall"


def test_services_and_topics(robot: Process, driver: Driven) -> None:
    driver.expect("Done", key=driver.start("say", "Hello!"))
    robot.expect("says no more", cut=False)
    key = driver.start("say", LONG)
    robot.expect("says")
    at = driver.cancel(key)
    assert robot.expect("says no more", cut=True)["at"] - at < 1
    driver.expect("Stopped", key=key)
    key = driver.start("turn", angle=360)
    assert robot.expect("turns")["speed"] == pytest.approx(1.571, abs=0.001)
    at = driver.cancel(key)
    assert robot.expect("stands")["at"] - at < 1


def test_what_is_sensed_is_told(robot: Process, driver: Driven) -> None:
    where = '{"pose": {"pose": {"position": {"x": 2, "y": 1}, "orientation": {"z": 0, "w": 1}}}}'
    robot.write(f"/odom {where}")
    assert driver.expect("At")["x"] == 2
    robot.write('/touch {"data": true}')
    assert driver.expect("Occurred")["name"] == "touch"
    robot.write('/heard {"text": "two please", "confidence": 0.5}')
    heard = driver.expect("Heard")
    assert (heard["text"], heard["data"]) == ("two please", {"confidence": 0.5})


def test_safe_stops_everything(robot: Process, driver: Driven) -> None:
    keys = {driver.start("topological-move", to="door"), driver.start("say", LONG)}
    robot.expect("says")
    driver.do("safe")
    assert {driver.expect("Stopped")["key"] for _ in keys} == keys
    ends = {
        robot.until(lambda line: "cut" in line or "status" in line, "end")["what"] for _ in keys
    }
    assert ends == {"go over", "says no more"}


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_a_robot_that_is_gone_is_lost_and_found_again(
    robot: Process, driver: Driven, port: int, how: str
) -> None:
    key = driver.start("topological-move", to="door")
    driver.expect("Progress", key=key)
    getattr(robot, how)()
    driver.expect("Lost")
    robot.kill()
    back = made_robot(port, "threads")
    try:
        driver.expect("Back")
        driver.expect("Done", key=driver.start("gesture", name="nod"))
        back.expect("goes")
    finally:
        back.kill()


def test_a_wrong_address_is_told_in_time(document: Path, port: int) -> None:
    driver = Driven("rosbridge", document)
    try:
        closed = driver.expect("closed")
        assert f"nobody answers at ws://127.0.0.1:{port}" in closed["error"]
        assert closed["after"] < 4
    finally:
        driver.kill()


def test_a_server_that_never_answers_is_told_in_time(document: Path, port: int) -> None:
    with socket.create_server(("127.0.0.1", port)):
        driver = Driven("rosbridge", document)
        try:
            closed = driver.expect("closed")
            assert "does not answer as a rosbridge" in closed["error"]
            assert closed["after"] < 4.5
        finally:
            driver.kill()


def test_an_action_that_is_not_there_is_told(robot: Process, document: Path) -> None:
    document.write_text(document.read_text().replace('"/go"', '"/gone"'))
    driver = Driven("rosbridge", document)
    try:
        told = "the action /gone (my_robot/action/Go) is not there"
        assert told in driver.expect("closed")["error"]
    finally:
        driver.kill()


def test_a_bridge_that_cannot_cancel_is_told(port: int, document: Path) -> None:
    robot = made_robot(port)
    driver = Driven("rosbridge", document)
    try:
        driver.expect("open")
        driver.start("topological-move", to="door")
        assert "send_action_goals_in_new_thread:=true" in driver.expect("Lost")["reason"]
    finally:
        driver.kill()
        robot.kill()


@pytest.mark.parametrize(("options", "code"), [(("threads",), 0), ((), 3)])
def test_the_check_before_a_run_tries_to_cancel(
    port: int, document: Path, options: tuple[str, ...], code: int
) -> None:
    text = document.read_text().replace('  <gesture name="hop"/>\n', "")
    start, end = text.index('    <does gesture="hop"'), text.index("    <senses")
    document.write_text(text[:start] + text[end:])
    robot = made_robot(port, *options)
    world = HERE.parent / "world.xml"
    given = ("--robot", str(document), "--world", str(world), "--check")
    check = Process("rosbridge", "-m", "prima", "live", *given)
    try:
        check.process.wait(60)
        told = "".join(check.errors)
        line = next(one for one in check.errors if "topological-move" in one)
        assert line.startswith("FAILS" if code else "ok"), told
        assert ("does not stop" in line) == bool(code), told
    finally:
        check.kill()
        robot.kill()


def test_two_applications_run_to_their_end(robot: Process, document: Path, tmp_path: Path) -> None:
    visit = Visit("rosbridge", document, tmp_path / "visit.jsonl")
    try:
        robot.expect("goes")
        robot.write('/touch {"data": true}')
        robot.expect("go over", status=5)
        robot.expect("turns")
        robot.expect("stands")
        robot.expect("goes")
        robot.expect("go over", status=4)
        rows = visit.rows()
    finally:
        visit.kill()
    parts = ("Topological Move", "touch", "Turn", "ends dodge", "resumes", "ends walk: exit")
    assert in_order(rows, *parts), rows


def test_the_robot_goes_in_the_midst_of_a_run(
    robot: Process, document: Path, port: int, tmp_path: Path
) -> None:
    visit = Visit("rosbridge", document, tmp_path / "visit.jsonl")
    rows = visit.rows_of_lost_robot(
        robot, partial(made_robot, port, "threads"), '/touch {"data": true}'
    )
    assert in_order(rows, *LOST_AND_BACK), rows
