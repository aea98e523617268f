"""The emergency stop (rule E5)."""

from __future__ import annotations

from prima.invariants import check
from prima.language.commands import ABSENCE_MS
from prima.messages import (
    ApplicationLoaded,
    Emergency,
    Ended,
    Group,
    Step,
)
from tests.helpers.generated.plays import perform
from tests.helpers.generated.scripts import Ask, Leave, Script, drive
from tests.helpers.generated.world import World
from tests.helpers.plays import NESTED, play, stepped, told
from tests.helpers.stage import Stage, ask, chain, command, move, say

EVENT = 7


def test_e5_an_emergency_stop_ends_everything_until_released() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(10).mediator.emergency(True, True, 8)
    stage.select()
    assert stage.running == set()
    stage.request("fa", say(), cause=EVENT)
    assert stage.select() == []
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == ["fa#1"]
    stage.at(30).end("fa#1")
    assert stage.select() == ["ea#1"], "what was cut is done again"


def test_e5_a_user_who_is_gone_meanwhile_is_absent_after_the_release() -> None:
    """K1: until then there is nothing to do; the run came to the same instant again and again."""
    stage = Stage()
    stage.request("ea", ask())
    stage.request("fa", move())
    assert stage.select() == ["ea#1"]
    stage.at(10).mediator.emergency(True, True, 8)
    stage.select()
    assert stage.mediator.deadline() is None
    stage.at(2 * ABSENCE_MS).mediator.emergency(False, True, 9)
    assert stage.select() == ["ea#1", "fa#1.1"]
    assert check(stage.records) == []


def test_e5_only_what_returns_is_recorded_as_halted() -> None:
    stage = Stage()
    stage.request("ea", say("One."))
    stage.request("fa", command("move-head", pan=1))
    stage.select()
    stage.at(5).leave("ea")
    stage.at(10).mediator.emergency(True, True, 8)
    stage.select()
    halted = {r["behavior"]: r["outcome"] for r in stage.phases("cancel")}
    assert halted == {"ea#1": "running", "fa#1": "halted"}
    assert [r["serial"] for r in stage.phases("emergency")] == [8]
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == ["fa#1"]


def test_e5_is_recorded_with_what_the_operator_says() -> None:
    stage = Stage()
    stage.mediator.emergency(True, True, 8)
    stage.at(20).mediator.emergency(False, False, 9)
    stage.select()
    names = ("actor", "rule", "outcome", "inbound", "serial", "data")
    assert [[one.get(name) for name in names] for one in stage.phases("emergency")] == [
        ["mediator", "E5", "pressed", True, 8, None],
        ["mediator", "E5", "released", True, 9, {"resume": False}],
    ]


def test_e5_streams_do_not_resume_when_the_operator_says_so() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(10).mediator.emergency(True, True, 8)
    stage.at(20).mediator.emergency(False, False, 9)
    assert stage.select() == []
    assert stage.told("ea") == ["cancel.speak", "cancel.speak"]


def test_a_unit_that_was_left_does_not_come_back_after_an_emergency() -> None:
    # The unit is out of time, what runs in it finishes (U5); the emergency ends that, and
    # with it the unit. Yet the unit is put back among the waiting ones, and starts again.
    body = (
        '<form id="f1"><iu longest="1ms"><block><speak>Hello.</speak></block></iu>'
        '<on event="error"/></form>'
    )
    run = perform(play(body, (2, Emergency(True)), (3, Emergency(False))))
    assert check(run.records) + run.problems == []


def test_a_unit_that_is_left_during_an_emergency_is_concluded() -> None:
    # The application leaves the unit when it gets emergency.stop. The unit then waited for the
    # release, started again and kept its devices for ever.
    body = (
        '<form id="f1"><iu><block><speak>Hello.</speak></block></iu>'
        '<on event="emergency.stop"><goto next="#f2"/></on></form><form id="f2"/>'
    )
    run = perform(play(body, (1, Emergency(True)), (2, Emergency(False))))
    assert check(run.records) + run.problems == []


def test_a_group_that_was_given_up_ends_whole_in_an_emergency() -> None:
    # The group (U4) is unheard since its state was left (O3). Halted, it is taken out of
    # working memory, but not its Commands: its stream stays open, and so does its floor.
    asked = Ask((("speak", "turn"),), ((),))
    events = ((1, ((asked,), ())), (2, ((Leave(),), ())))
    script = Script(((), ()), events, ((3, 1, True),), World())
    run = drive(script)
    assert check(run.records) + run.problems == []


def test_a_unit_of_which_only_what_was_out_of_time_is_left_ends_in_an_emergency() -> None:
    # The emergency gave up the inner unit, which was out of time; with it the outer one ended,
    # and was then put back among the waiting ones.
    session, records = stepped(
        NESTED.format("", " longest='1s'"),
        (0, (ApplicationLoaded("ea"),)),
        (100, (Ended("ea#3"),)),
        (1200, ()),
        (1500, (Emergency(True),)),
        (3000, (Emergency(False),)),
    )
    assert told(records, "ea#4")[-1] == (1500, "cancel")
    assert told(records, "ea#1")[-1] == (1500, "end")
    assert session.idle


def test_e5_what_runs_is_aborted_and_its_unit_waits_with_it() -> None:
    stage = Stage()
    stage.request("ea", Group(chain(say("One."), say("Two."))))
    stage.select()
    stage.at(10).mediator.emergency(True, True, 8)
    stage.select()
    ended = [(one["behavior"], one["rule"], one["outcome"]) for one in stage.phases("cancel")]
    assert ended == [("ea#2", "E5", "halted"), ("ea#1", "E5", "halted")]
    orders = [(one.verb, one.behavior) for one in stage.orders]
    assert orders == [("start", "ea#2"), ("abort", "ea#2")], "devices know nothing of units"
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == ["ea#1", "ea#2"]


def test_e5_what_is_left_of_a_group_is_done_once() -> None:
    stage = Stage()
    nod = Group(chain(command("move-head", pan=1), command("move-head", pan=2)))
    stage.request("ea", Group([Step(say("One.")), Step(nod), Step(say("Two."), (0, 1))]))
    assert stage.select() == ["ea#1", "ea#2", "ea#3", "ea#5"]
    stage.at(5).end("ea#2")
    stage.at(10).mediator.emergency(True, True, 8)
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == ["ea#1", "ea#3", "ea#5"]
    stage.at(30).end("ea#5")
    assert stage.select() == ["ea#6"]
    stage.at(40).end("ea#6")
    assert stage.select() == ["ea#4"]
    stage.at(50).end("ea#4")
    assert stage.select() == [] and stage.mediator.memory.behaviors == {}
    assert stage.told("ea") == ["done"]
    assert check(stage.records) == []


def test_e5_what_is_given_up_goes_from_its_end_and_its_application_hears_of_each_part() -> None:
    stage = Stage()
    stage.request("ea", Group(chain(say("One."), say("Two."))), say("Three."), say("Four."))
    stage.select()
    stage.at(10).mediator.emergency(True, True, 8)
    stage.at(20).mediator.emergency(False, False, 9)
    stage.select()
    given_up = [
        (one["behavior"], one["rule"], one["outcome"])
        for one in stage.phases("cancel")
        if one["time"] == 20
    ]
    assert given_up == [
        ("ea#3", "E5", "linked"),
        ("ea#2", "E5", "linked"),
        ("ea#4", "E5", "waiting"),
        ("ea#5", "E5", "waiting"),
        ("ea#1", "E5", "waiting"),
    ]
    assert stage.told("ea") == ["cancel.speak", "cancel.speak", "cancel.iu"]


def test_e5_a_unit_that_was_closed_ends_with_what_still_ran_in_it() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "neck")
    stage.request("ea", say("One."), unit=1)
    stage.select()
    stage.at(5).close("ea", 1)
    stage.at(10).mediator.emergency(True, True, 8)
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == [] and stage.mediator.memory.behaviors == {}
    ended = [(one["behavior"], one["outcome"]) for one in stage.phases("cancel")]
    assert ended == [("ea#2", "running"), ("ea#1", "running")]


def test_e5_an_open_unit_waits_though_nothing_is_in_it() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.select()
    stage.at(10).mediator.emergency(True, True, 8)
    stage.at(20).mediator.emergency(False, True, 9)
    assert stage.select() == ["ea#1"]


def test_e5_streams_are_not_held_once_they_are_given_up() -> None:
    """X3: neither one that is held already nor one that would have been."""
    stage = Stage("prima+x3")
    stage.request("fa", say(), cause=EVENT, hold=5_000)
    stage.select()
    stage.at(10).end("fa#1")
    stage.request("ea", say(), cause=EVENT + 1, hold=5_000)
    stage.select()
    stage.at(20).mediator.emergency(True, True, 8)
    stage.at(30).mediator.emergency(False, False, 9)
    stage.select()
    held = [(one["app"], one["outcome"]) for one in stage.phases("held")]
    assert held == [("fa", "begun"), ("fa", "left")]
    assert stage.floor == []
