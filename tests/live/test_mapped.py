"""What drivers share that are mapped to a robot's own interface: values, and what messages mean."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from prima.devices.goals import SAY, At, Begin, Sees
from prima.devices.profile import Profile, read_robot
from prima.errors import DocumentError
from prima.live.driver import Refused
from prima.live.mapped import MappedDriver
from prima.live.reports import SenseReports, pose
from prima.messages import Command, Emergency, Heard, Json, Occurred, Sensed
from prima.sim.map import Map

ROBOT = """<robot xmlns="urn:prima:robot:1" version="1.0" id="r" turn-speed="45">
  <device name="locomotion"/><device name="localization"/><device name="speaker"/>
  <device name="neck"/><device name="arm"/><gesture name="nod" duration="800ms"/>
  <driver kind="mapped">{}</driver></robot>"""


def profile(inside: str = "") -> Profile:
    return read_robot("robot.xml", ROBOT.format(inside).encode())


def driver(inside: str = "", at: At | None = None) -> MappedDriver:
    robot = profile(inside)
    made = MappedDriver(robot.drivers[0], robot, Map("m", places={"door": (4.0, 4.0)}))
    made._at = at
    return made


def begin(kind: str, text: str | None = None, **args: Json) -> Begin:
    command = Command("speak" if kind == SAY else kind, args, text, lang="en")
    return Begin("key", kind, command, frozenset({"locomotion"}))


def test_degrees_are_given_in_radians_and_times_in_seconds() -> None:
    values = driver().values(begin("move-head", pan=90, tilt=-30))
    assert values["pan-radians"] == pytest.approx(math.pi / 2)
    assert values["down-radians"] == pytest.approx(math.pi / 6)
    drive = {"speed": 0.1, "turn-speed": 90, "time": 1500}
    values = driver().values(begin("set-speed-and-time", None, **drive))
    assert values["seconds"] == 1.5
    assert values["turn-speed-radians"] == pytest.approx(math.pi / 2)


def test_a_turn_has_the_robots_speed_and_its_own_direction() -> None:
    values = driver().values(begin("turn", angle=-90))
    assert (values["turn"], values["turn-speed"], values["seconds"]) == (-90, -45, 2)


@pytest.mark.parametrize(
    ("args", "turn"), [({"heading": 90}, 60), ({"heading": -160}, 170), ({"toward": "door"}, 15)]
)
def test_a_direction_of_the_map_is_a_turn_from_where_the_robot_looks(
    args: dict[str, Json], turn: float
) -> None:
    values = driver(at=At(0, 0, 30)).values(begin("set-direction", **args))
    assert values["turn"] == pytest.approx(turn)
    assert values["heading"] == pytest.approx(30 + turn)


def test_a_direction_needs_to_know_where_the_robot_is() -> None:
    with pytest.raises(Refused, match="the robot's place is unknown"):
        driver().values(begin("set-direction", heading=90))


def test_a_heading_is_a_quaternion_too() -> None:
    values = driver('<place name="lab" x="1" y="2" heading="90"/>').values(
        begin("topological-move", to="lab")
    )
    assert (values["x"], values["y"]) == (1, 2)
    assert values["heading-z"] == pytest.approx(0.5**0.5)
    assert values["heading-w"] == pytest.approx(0.5**0.5)


def test_slots_may_be_in_a_list() -> None:
    inside = (
        '<does command="move-head" by="a.b"><set name="v" value="[{pan}, -1, {tilt}]"/>'
        '<set name="text" value="to {pan}"/></does>'
    )
    robot = driver(inside)
    goal = begin("move-head", pan=10, tilt=5)
    does = robot.does(goal)
    assert does is not None
    assert does.filled(robot.values(goal)) == {"v": [10, -1, 5], "text": "to 10"}


def told(senses: str, *messages: Json) -> list[Any]:
    robot = profile(f"<senses {senses}/>")
    reports = SenseReports()
    news: list[Any] = []
    for message in messages:
        reports.take(robot.drivers[0].senses[0], message)
        news += reports.drain()
    return news


def test_an_event_with_a_value_is_raised_when_that_comes_to_hold() -> None:
    on, off = {"data": True}, {"data": False}
    senses = 'event="touch" by="/t" field="data" when="true"'
    assert told(senses, off, on, on, off, on) == [Occurred("touch", "user")] * 2
    assert (
        told('event="bumped" by="/t" actor="environment"', {}, {})
        == [Occurred("bumped", "environment")] * 2
    )


def test_a_sensor_is_told_when_it_changes_with_all_its_parts() -> None:
    assert told('sensor="power" by="/b"', {"left": 3, "of": {"cells": 4}}) == [
        Sensed({"power.left": 3, "power.of.cells": 4})
    ]
    assert told('sensor="power" by="/b" field="1"', [1, 2], [0, 2], [0, 3]) == [
        Sensed({"power": 2}),
        Sensed({"power": 3}),
    ]
    assert told('sensor="power" by="/b" field="level"', {"other": 1}) == []


@pytest.mark.parametrize(
    "message",
    [
        {"x": 1, "y": 2, "theta": math.pi / 2},
        [1.0, 2.0, math.pi / 2],
        {"pose": {"position": {"x": 1, "y": 2}, "orientation": {"z": 0.5**0.5, "w": 0.5**0.5}}},
    ],
)
def test_a_pose_is_read_as_robots_write_it(message: Json) -> None:
    at = pose(message)
    assert at is not None
    assert (at.x, at.y, round(at.heading, 6)) == (1, 2, 90)
    assert told('as="pose" by="/p" field="at"', {"at": message}, {"at": message}) == [at]


NO_POSES: list[Json] = [
    "here",
    [1, 2],
    {"x": 1},
    ["a", "b", "c"],
    [1, 2, 10**400],
    {"position": 5},
    {"position": {"x": 1}},
    {"position": {"x": "a", "y": 2}},
    {"position": {"x": 1, "y": 2}, "orientation": [0, 0, 0, 1]},
    {"position": {"x": 1, "y": 2}, "orientation": {"w": None}},
    None,
]


@pytest.mark.parametrize("message", NO_POSES)
def test_what_is_no_pose_is_passed_over(message: Json) -> None:
    assert pose(message) is None


def test_what_is_heard_comes_with_its_confidence() -> None:
    senses = 'as="heard" by="/h" field="text"'
    assert told(senses, {"text": " yes ", "confidence": 0.5}) == [Heard("yes", {"confidence": 0.5})]
    assert told(senses, {"text": " "}, {}) == []
    ranked = told('as="heard" by="/h"', ["yes", 0.5, "guess", 0.25])
    other = {"text": "guess", "confidence": 0.25}
    assert ranked == [Heard("yes", {"confidence": 0.5, "alternatives": [other]})]
    assert told('as="heard" by="/h"', ["", 0.0], []) == []


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ('event="speech"', 'needs the words that they say. Write as="heard" instead.'),
        ('event="speech" actor="environment"', ""),
        ('event="a" sensor="b"', "exactly one of event, sensor, as. Write a <senses> for each."),
        ("", 'exactly one of event, sensor, as. Write event="...", sensor="..." or as="heard".'),
    ],
)
def test_what_a_robot_senses_is_of_one_kind(given: str, told: str) -> None:
    if not told:
        assert profile(f'<senses {given} by="/s"/>').drivers[0].senses
        return
    with pytest.raises(DocumentError) as caught:
        profile(f'<senses {given} by="/s"/>')
    assert told in str(caught.value) and "robot.xml:4" in str(caught.value)


def test_a_human_and_the_emergency_stop() -> None:
    assert told('as="human" by="/p"', [], [1], {"distance": 1.5, "angle": 10.0}) == [
        Sees(False),
        Sees(True),
        Sees(True, 1.5, 10.0),
    ]
    assert told('as="emergency" by="/e" field="data"', {"data": False}, {"data": True}) == [
        Emergency(True)
    ]


def test_a_command_that_is_not_mapped_takes_its_time() -> None:
    assert driver().lasts(begin("gesture", name="nod")) == 0.8
    goal = replace(begin(SAY, "Hello there, you."), kind=SAY)
    assert driver().lasts(goal) == pytest.approx(1.2, abs=0.5)
    assert driver().lasts(begin("face-human")) is None
