"""The robot's state that a stream relies on (rule X1), from what its Commands report."""

from __future__ import annotations

import math

import pytest

from prima.language.commands import TABLE_4_2
from prima.messages import Command, Data
from prima.scheduler.robot_state import Effects, RobotState, difference, head_of, pose_of
from tests.helpers.stage import command

PLACE, DIRECTION = TABLE_4_2["topological-move"], TABLE_4_2["set-direction"]
HUMAN, HEAD = TABLE_4_2["face-human"], TABLE_4_2["move-head"]
NONE: frozenset[str] = frozenset()


def pose(x: float, y: float, heading: float) -> Data:
    return {"x": x, "y": y, "heading": heading}


def restored(
    effects: Effects, now: Data, own: frozenset[str] = NONE, head: tuple[float, float] = (0.0, 0.0)
) -> list[tuple[str, Data]]:
    """The Commands that restore what is missing, with their arguments."""
    body = RobotState(pose_of(now), head)
    return [(one.type, one.args) for one in effects.missing(own, body)]


def test_x1_the_robot_goes_back_only_from_farther_than_half_a_metre() -> None:
    effects = Effects()
    effects.add(PLACE, command("topological-move"), pose(1.23456, 2.34567, 90), RobotState())
    assert restored(effects, pose(1.23456, 2.84567, 0)) == []
    back = {"x": 1.235, "y": 2.346}
    assert restored(effects, pose(1.23456, 2.85, 90)) == [("set-position", back)]
    assert restored(effects, {}) == [], "nobody knows where it is"


def test_x1_it_turns_back_only_if_it_looks_elsewhere_by_more_than_fifteen_degrees() -> None:
    effects = Effects()
    effects.add(DIRECTION, command("set-direction"), pose(0, 0, 90.26), RobotState())
    assert restored(effects, pose(9, 9, 105.26)) == [], "it has not set a place"
    turn = ("set-direction", {"heading": 90.3})
    assert restored(effects, pose(0, 0, 105.5)) == [turn]
    assert restored(effects, pose(0, 0, 75)) == [turn]
    for own in ("direction", "human"):
        assert restored(effects, pose(0, 0, 0), frozenset({own})) == []
    assert restored(effects, {}) == []
    straight = Effects(heading=0.0)
    assert restored(straight, pose(0, 0, 90)) == [("set-direction", {"heading": 0.0})]


def test_x1_place_and_direction_are_one_way_back() -> None:
    effects = Effects(position=(1.0, 2.0), heading=44.96)
    both = {"x": 1.0, "y": 2.0, "heading": 45.0}
    assert restored(effects, pose(5, 5, 0)) == [("set-position-and-direction", both)]
    only = [("set-position", {"x": 1.0, "y": 2.0})]
    assert restored(effects, pose(5, 5, 0), frozenset({"direction"})) == only
    for own in ("position", "follow"):
        assert restored(effects, pose(5, 5, 0), frozenset({own})) == []


@pytest.mark.parametrize(
    ("now", "turns"),
    [
        (pose(1, 1, 90), False),
        (pose(1.4, 1, 90), False),
        (pose(1.6, 1, 90), True),
        (pose(1, 1, 104), False),
        (pose(1, 1, 106), True),
        (pose(1, 1, 74), True),
        ({}, False),
    ],
)
def test_x1_what_was_turned_to_the_human_turns_again_once_the_robot_has_moved(
    now: Data, turns: bool
) -> None:
    effects = Effects()
    effects.add(HUMAN, command("face-human"), {}, RobotState((1.0, 1.0, 90.0)))
    assert restored(effects, now) == ([("face-human", {})] if turns else [])
    unknown = Effects()
    unknown.add(HUMAN, command("face-human"), {}, RobotState())
    assert restored(unknown, now) == [], "nobody knows where it was"


def test_x1_the_head_turns_back_if_pan_or_tilt_is_elsewhere() -> None:
    effects = Effects()
    effects.add(HEAD, command("move-head", pan=20, tilt=-10), {}, RobotState())
    back = [("move-head", {"pan": 20.0, "tilt": -10.0})]
    assert restored(effects, {}, head=(35, -25)) == []
    assert restored(effects, {}, head=(35.5, -10)) == back
    assert restored(effects, {}, head=(20, 5.5)) == back
    assert restored(effects, {}, head=(-20, -10)) == back
    assert restored(effects, {}, frozenset({"head"}), head=(-20, -10)) == []


def test_x1_before_a_move_only_the_head_turns_back() -> None:
    effects = Effects(position=(1.0, 2.0), heading=30.0, head=(20.0, 0.0))
    back = [("move-head", {"pan": 20.0, "tilt": 0.0})]
    for own in ("position", "follow"):
        assert restored(effects, pose(9, 9, 90), frozenset({own}), head=(-60, 0)) == back
        assert restored(effects, pose(9, 9, 90), frozenset({own}), head=(20, 0)) == []


@pytest.mark.parametrize(
    ("angle", "other", "between"),
    [(10, 350, 20), (350, 10, -20), (90, 0, 90), (0, 90, -90), (180, 0, -180), (5, 5, 0)],
)
def test_a_difference_of_angles_is_the_shorter_way_round(
    angle: float, other: float, between: float
) -> None:
    assert difference(angle, other) == between


@pytest.mark.parametrize(
    "data",
    [
        {},
        {"x": 1, "y": 2},
        {"x": 1, "y": 2, "heading": None},
        {"x": 1, "y": "2", "heading": 0},
        {"x": math.nan, "y": 2, "heading": 0},
        {"x": 1, "y": 2, "heading": math.inf},
    ],
)
def test_a_pose_that_is_not_whole_is_none(data: Data) -> None:
    assert pose_of(data) is None
    assert pose_of({"x": 1, "y": 2, "heading": 3}) == (1.0, 2.0, 3.0)


def test_the_head_is_straight_where_a_command_says_nothing_of_it() -> None:
    assert head_of(command("move-head", pan=5)) == (5.0, 0.0)
    assert head_of(command("move-head", tilt=5)) == (0.0, 5.0)
    assert head_of(Command("look", {"pan": "left", "tilt": None})) == (0.0, 0.0)


def test_x1_the_state_is_what_was_reported_last() -> None:
    body = RobotState()
    body.moved(DIRECTION, command("set-direction", pan=9), pose(1, 2, 90))
    assert (body.pose, body.head) == ((1.0, 2.0, 90.0), (0.0, 0.0))
    body.moved(HEAD, command("move-head", pan=20, tilt=-10), {})
    assert (body.pose, body.head) == ((1.0, 2.0, 90.0), (20.0, -10.0))


def test_x1_what_reports_no_place_changes_no_place_and_no_direction() -> None:
    effects = Effects(position=(1.0, 2.0), heading=30.0)
    effects.add(PLACE, command("topological-move"), {}, RobotState())
    effects.add(DIRECTION, command("set-direction"), {}, RobotState())
    assert (effects.position, effects.heading) == ((1.0, 2.0), 30.0)


def test_x1_a_turn_of_its_own_ends_what_was_turned_to_the_human() -> None:
    effects = Effects()
    effects.add(HUMAN, command("face-human"), {}, RobotState((1.0, 1.0, 90.0)))
    effects.add(DIRECTION, command("set-direction"), pose(1, 1, 30), RobotState())
    assert restored(effects, pose(1, 1, 90)) == [("set-direction", {"heading": 30.0})]


def test_x1_after_a_way_back_it_turns_to_the_human_again() -> None:
    """Wherever it came from, unless what follows turns by itself."""
    effects = Effects(position=(1.0, 1.0), human=True, body=RobotState((5.0, 5.0, 0.0)))
    back = ("set-position", {"x": 1.0, "y": 1.0})
    assert restored(effects, pose(5, 5, 0)) == [back, ("face-human", {})]
    assert restored(effects, pose(5, 5, 0), frozenset({"direction"})) == [back]
    turned = Effects(heading=45.0, human=True, body=RobotState((1.0, 1.0, 0.0)))
    assert restored(turned, pose(1, 1, 0)) == [("set-direction", {"heading": 45.0})]
