"""The driver ``ros2`` against actions, services and topics of rclpy in a second process."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.parties.bench import ROS_HOME, Driven, Process
from tests.parties.ros2.nodes import ROBOT, made_again


@pytest.fixture
def driver(robot: Process) -> Iterator[Driven]:
    process = Driven("ros2", ROBOT, **ROS_HOME)
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
    assert robot.expect("counts")["to"] == 5


def test_values_reach_the_fields_of_messages_and_feedback_comes_back(
    robot: Process, driver: Driven
) -> None:
    key = driver.start("topological-move", to="door")
    driver.expect("Accepted", key=key)
    driver.expect("Progress", key=key)
    driver.expect("Progress", key=key)
    driver.expect("Done", key=key)
    told = robot.expect("goes")
    assert (told["x"], told["y"]) == (4, 1)


def test_a_cancelled_goal_is_really_canceled(robot: Process, driver: Driven) -> None:
    key = driver.start("topological-move", to="door")
    driver.expect("Progress", key=key)
    at = driver.cancel(key)
    stopped = driver.expect("Stopped", key=key)
    assert robot.expect("go canceled")["at"] <= stopped["at"], "it was stopped before it was told"
    assert stopped["at"] - at < 1


def test_a_robot_that_does_not_cancel_has_not_stopped(robot: Process, driver: Driven) -> None:
    robot.write("stubborn")
    key = driver.start("topological-move", to="door")
    driver.expect("Accepted", key=key)
    driver.cancel(key)
    stopped = driver.expect("Stopped", key=key)
    assert robot.expect("go over")["at"] <= stopped["at"]


def test_a_goal_is_refused_or_given_up(robot: Process, driver: Driven) -> None:
    key = driver.start("gesture", name="hop")
    assert (
        "the action /count (test_msgs/action/Fibonacci) refuses"
        in driver.expect("Broke", key=key)["reason"]
    )
    key = driver.start("set-position", x=-1, y=0)
    assert "has given it up" in driver.expect("Broke", key=key)["reason"]
    key = driver.start("move-head", pan=10, tilt=0)
    assert '<does command="move-head">' in driver.expect("Broke", key=key)["reason"]


def test_a_text_is_said_by_a_service_and_cut_off_by_another(robot: Process, driver: Driven) -> None:
    key = driver.start("say", "Hello!")
    driver.expect("Done", key=key)
    assert robot.expect("says")["text"] == "Hello!"
    robot.expect("says no more", cut=False)
    key = driver.start("say", "This takes much longer than anybody wants to wait for it. " * 9)
    robot.expect("says")
    at = driver.cancel(key)
    assert robot.expect("says no more", cut=True)["at"] - at < 1
    driver.expect("Stopped", key=key)


def test_a_topic_moves_the_body_and_stops_it(robot: Process, driver: Driven) -> None:
    key = driver.start("turn", angle=-45)
    assert robot.expect("turns")["speed"] == pytest.approx(-1.571, abs=0.001)
    driver.expect("Done", key=key)
    robot.expect("stands")
    began, ended = (line["at"] for line in robot.lines[-2:])
    assert 0.4 < ended - began < 0.9, "45 degrees at 90 degrees a second"
    key = driver.start("turn", angle=360)
    robot.expect("turns")
    at = driver.cancel(key)
    assert robot.expect("stands")["at"] - at < 1
    driver.expect("Stopped", key=key)


def test_what_is_sensed_is_told(robot: Process, driver: Driven) -> None:
    robot.write("odom 2.5")
    at = driver.expect("At")
    assert (at["x"], at["y"]) == (2.5, 0)
    assert at["heading"] == pytest.approx(90)
    robot.write("battery 0.5")
    assert driver.expect("Sensed")["values"] == {"battery": 0.5}
    robot.write("heard two please")
    assert driver.expect("Heard")["text"] == "two please"
    robot.write("touch on")
    assert driver.expect("Occurred")["name"] == "touch"
    robot.write("touch on")
    driver.nothing("Occurred", 0.5)
    robot.write("emergency on")
    assert driver.expect("Emergency")["pressed"] is True


def test_safe_stops_everything(robot: Process, driver: Driven) -> None:
    go = driver.start("topological-move", to="door")
    say = driver.start("say", "This takes much longer than anybody wants to wait for it. " * 9)
    robot.expect("says")
    driver.expect("Progress", key=go)
    driver.do("safe")
    ended = {
        robot.until(lambda line: "c" in line["what"] or "cut" in line, "end")["what"]
        for _ in range(2)
    }
    assert ended == {"go canceled", "says no more"}
    told = {driver.expect("Stopped")["key"] for _ in range(2)}
    assert told == {go, say}


@pytest.mark.parametrize("how", ["kill", "freeze"])
def test_a_robot_that_is_gone_is_lost_and_found_again(
    robot: Process, driver: Driven, how: str
) -> None:
    key = driver.start("topological-move", to="door")
    driver.expect("Progress", key=key)
    getattr(robot, how)()
    lost = driver.expect("Lost")
    assert "does not answer any more" in lost["reason"]
    robot.kill()
    robot.process = (back := made_again()).process
    driver.expect("Back")
    key = driver.start("gesture", name="nod")
    driver.expect("Done", key=key)
    back.expect("counts")


@pytest.mark.parametrize(
    ("address", "told"),
    [
        ("7", "in the domain 7, the action /go (test_msgs/action/NestedMessage)"),
        ("robot.local", '"robot.local" is not the number of a ROS domain'),
    ],
)
def test_a_wrong_address_is_told_in_time(tmp_path: Path, address: str, told: str) -> None:
    wrong = tmp_path / "robot.xml"
    text = ROBOT.read_text().replace('kind="ros2"', f'kind="ros2" address="{address}"')
    wrong.write_text(text.replace('open="8s"', 'open="2s"'))
    driver = Driven("ros2", wrong, **ROS_HOME)
    try:
        closed = driver.expect("closed")
        assert told in closed["error"]
        assert closed["after"] < 3
    finally:
        driver.kill()


@pytest.mark.parametrize(
    ("right", "wrong", "told"),
    [
        ("float64_value", "float65_value", 'has no field "float65_value"; it has bool_value'),
        (
            "action/Fibonacci",
            "action/Fibbonaci",
            "the type test_msgs/action/Fibbonaci is not there",
        ),
    ],
)
def test_a_document_that_does_not_fit_is_told(
    tmp_path: Path, right: str, wrong: str, told: str
) -> None:
    document = tmp_path / "robot.xml"
    document.write_text(ROBOT.read_text().replace(right, wrong))
    driver = Driven("ros2", document, **ROS_HOME)
    try:
        assert told in driver.expect("closed")["error"]
    finally:
        driver.kill()
