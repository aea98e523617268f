"""X2: the records of an interruption, and how much of a unit its application is told was done."""

from __future__ import annotations

import pytest

from prima.messages import Command, Data, Group, Step
from tests.helpers.stage import Stage, ask, chain, command, move, restartable, say

EVENT = 7


def interrupted(what: Command | Group, *ends: str) -> Stage:
    """The EA asks for something; after these ends a touch interrupts it."""
    stage = Stage("prima+x2")
    stage.request("ea", what)
    stage.select()
    for time, behavior in enumerate(ends, 100):
        stage.at(time).end(behavior)
        stage.select()
    stage.at(500).request("fa", ask("Yes?"), cause=EVENT)
    stage.select()
    assert stage.phases("interrupt")
    return stage


def told(stage: Stage, behavior: str, data: Data) -> list[Data]:
    """Let a device report how much it has done; give what the application then gets."""
    stage.at(501).mediator.interrupted(behavior, data)
    stage.select()
    return [notice.data for _, notice in stage.notices if notice.what == "interrupted"]


def unit(*steps: Command | Group) -> Group:
    """A restartable unit, one step after another."""
    return Group(chain(*steps), restartable=True)


@pytest.mark.parametrize(
    ("what", "behavior"), [(restartable(say("A story.")), "ea#1"), (unit(say("A story.")), "ea#2")]
)
def test_x2_what_the_device_tells_is_recorded(what: Command | Group, behavior: str) -> None:
    stage = interrupted(what)
    told(stage, behavior, {"done": 0.5, "heard": "A"})
    [record] = stage.phases("halted")
    assert record["data"] == {"done": 0.5, "heard": "A"}
    names = ("time", "actor", "app", "behavior", "inbound")
    assert tuple(record[name] for name in names) == (501, "robot", "ea", behavior, True)


def test_x2_what_a_device_tells_of_something_unknown_is_recorded_all_the_same() -> None:
    stage = interrupted(restartable(say("A story.")))
    assert told(stage, "ea#9", {}) == []
    [record] = stage.phases("halted")
    assert (record["app"], record["behavior"]) == (None, "ea#9")
    assert record.get("data") is None


@pytest.mark.parametrize(
    ("data", "since"),
    [
        ({"done": 0.5, "mark": "half", "passed": 400}, {"mark": "half", "passed": 400}),
        ({"done": 0.5, "heard": "A"}, None),
    ],
)
def test_x2_what_starts_again_starts_from_the_mark_it_has_passed(
    data: Data, since: Data | None
) -> None:
    stage = interrupted(restartable(say("A story.")))
    told(stage, "ea#1", data)
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1"]
    assert stage.orders[-1].data == since


def test_x2_a_reaction_of_lower_priority_interrupts_nothing() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(command("turn", angle=90)))
    stage.select()
    stage.at(100).request("fa", move(), cause=EVENT)
    assert stage.select() == [] and stage.phases("interrupt") == []


def test_x2_an_application_that_has_ended_is_told_nothing() -> None:
    stage = interrupted(unit(say("A story.")))
    stage.mediator.unload("ea", "exit")
    assert told(stage, "ea#2", {"done": 0.5}) == []


def test_x2_of_what_runs_in_parallel_what_speaks_tells_how_much_was_done() -> None:
    steps = [Step(command("gesture", name="nod")), Step(say("One two."))]
    stage = interrupted(Group(steps, restartable=True))
    assert told(stage, "ea#2", {"done": 0.9}) == [], "the nod counts as a whole, or not at all"
    assert told(stage, "ea#3", {"done": 0.5, "heard": "One"}) == [{"done": 0.25, "heard": "One"}]


def test_x2_where_nothing_speaks_the_first_tells_how_much_was_done() -> None:
    steps = [
        Step(say("One.")),
        Step(command("move-head", pan=30)),
        Step(command("turn", angle=90)),
    ]
    stage = interrupted(Group(steps, restartable=True), "ea#2")
    assert told(stage, "ea#4", {"done": 0.5}) == []
    assert told(stage, "ea#3", {"done": 0.5}) == [{"done": 0.5, "heard": "One."}]


NESTED = unit(say("One."), Group(chain(say("Two."), say("Three."))), say("Four."))


@pytest.mark.parametrize(
    ("ends", "behavior", "done", "heard"),
    [
        ((), "ea#2", 0.125, "O"),
        (("ea#2",), "ea#5", 0.375, "One. O"),
        (("ea#2", "ea#5"), "ea#6", 0.625, "One. Two. O"),
        (("ea#2", "ea#5", "ea#6"), "ea#4", 0.875, "One. Two. Three. O"),
    ],
)
def test_x2_of_units_in_units_each_command_counts_once(
    ends: tuple[str, ...], behavior: str, done: float, heard: str
) -> None:
    stage = interrupted(NESTED, *ends)
    assert told(stage, behavior, {"done": 0.5, "heard": "O"}) == [{"done": done, "heard": heard}]


def test_x2_what_says_nothing_counts_and_is_not_heard() -> None:
    stage = interrupted(unit(command("gesture", name="nod"), say("Two three.")), "ea#2")
    assert told(stage, "ea#3", {"done": 0.5, "heard": "Two"}) == [{"done": 0.75, "heard": "Two"}]


@pytest.mark.parametrize(("data", "done"), [({"done": 0.12345}, 0.123), ({}, 0.0)])
def test_x2_nothing_heard_is_not_told(data: Data, done: float) -> None:
    assert told(interrupted(unit(say("A story."))), "ea#2", data) == [{"done": done}]


def test_x2_what_was_said_is_told_though_nothing_of_the_rest_was_heard() -> None:
    stage = interrupted(unit(say("One."), say("Two.")), "ea#2")
    assert told(stage, "ea#3", {"done": 0.0}) == [{"done": 0.5, "heard": "One."}]


def test_x2_what_a_unit_has_just_begun_tells_how_much_was_done() -> None:
    """The next Command of a unit starts before a reaction of the same instant is looked at."""
    stage = Stage("prima+x2")
    stage.request("ea", unit(say("One."), say("Two.")))
    stage.select()
    stage.at(500).end("ea#2")
    stage.request("fa", ask("Yes?"), cause=EVENT)
    assert stage.select() == ["ea#3", "fa#1"]
    [interrupt] = stage.phases("interrupt")
    assert interrupt["behavior"] == "ea#1"
    assert told(stage, "ea#3", {"done": 0.0}) == [{"done": 0.5, "heard": "One."}]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1", "ea#4"], "it starts from its beginning"
