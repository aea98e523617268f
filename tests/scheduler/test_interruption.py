"""X2: an AB that is marked restartable gives way to a reaction and starts again."""

from __future__ import annotations

import pytest

from prima.invariants import check
from prima.language.commands import PATIENCE_MS
from prima.messages import (
    Command,
    Group,
    Step,
)
from prima.scheduler import rules
from tests.helpers.generated.world import TABLE
from tests.helpers.rebinding import rebind
from tests.helpers.stage import TRACK, Stage, ask, chain, command, inserted, move, restartable, say

EVENT = 7


def test_x2_a_restartable_ab_gives_way_to_a_reaction_and_starts_again() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")), say("The end."))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500)
    assert stage.select() == ["fa#1"]
    assert [order.verb for order in stage.orders] == ["start", "interrupt", "start"]
    assert [(r["behavior"], r["by"], r["rule"]) for r in stage.phases("interrupt")] == [
        ("ea#1", "fa#1", "X2")
    ]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1"]
    assert [r.get("resumed") for r in stage.phases("start")] == [None, None, True]
    stage.at(1900).end("ea#1")
    assert stage.select() == ["ea#2"]


@pytest.mark.parametrize("policy", ["prima", "prima+x1+x3+x4+x5+x6", "fifo"])
def test_x2_is_off_unless_it_is_asked_for(policy: str) -> None:
    stage = Stage(policy)
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    assert stage.select() == []


def test_x2_what_is_not_marked_is_not_interrupted() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", say("A long story."))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    assert stage.select() == []
    assert stage.holds("fa#1") == ["S1"]


def test_x2_only_a_reaction_interrupts() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"))
    assert stage.select() == []


def test_x2_nothing_is_interrupted_where_that_would_not_be_enough() -> None:
    stage = Stage("prima+x2")
    story = restartable(say("A story."))
    stage.request("ea", steps=[Step(story), Step(command("turn", angle=90))])
    stage.select()
    stage.request("fa", command("turn-and-speak", "Here!", angle=10), cause=EVENT)
    assert stage.select() == []
    assert stage.phases("interrupt") == []


def test_x2_nothing_is_interrupted_on_a_device_that_is_held_back_for_another() -> None:
    stage = Stage("prima+x2")
    story = restartable(say("A story."))
    stage.request("ea", steps=[Step(story), Step(command("turn", angle=90))])
    stage.select()
    stage.request("fa", command("turn-and-speak", "Here!", angle=10), cause=EVENT + 1)
    stage.request("fa", ask("Yes?"), cause=EVENT)
    assert stage.select() == []
    assert (stage.holds("fa#1"), stage.holds("fa#2")) == (["S1"], ["S1"])
    assert stage.phases("interrupt") == []


def test_x2_the_application_is_told_how_much_was_heard() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500).select()
    stage.at(501)
    stage.mediator.interrupted("ea#1", {"done": 0.4, "heard": "A long"})
    stage.settle()
    [(name, notice)] = [n for n in stage.notices if n[1].what == "interrupted"]
    assert (name, notice.event) == ("ea", "interrupted.speak")
    assert notice.data == {"done": 0.4, "heard": "A long"}


def test_x2_of_a_unit_the_application_is_told_how_much_was_done_in_all() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", Group(chain(say("One."), say("Two three.")), restartable=True))
    stage.select()
    stage.at(300).end("ea#2")
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500).select()
    stage.at(501)
    stage.mediator.interrupted("ea#3", {"done": 0.5, "heard": "Two"})
    stage.settle()
    [(name, notice)] = [n for n in stage.notices if n[1].what == "interrupted"]
    assert (name, notice.event) == ("ea", "interrupted.iu")
    assert notice.data == {"done": 0.75, "heard": "One. Two"}
    deadlines = stage.mediator.deadline()
    stage.at(900).end("fa#1")
    stage.select()
    assert deadlines == 500 + PATIENCE_MS, "nothing of what was broken off is awaited, but its turn"


def test_x2_a_unit_starts_again_whole() -> None:
    stage = Stage("prima+x2")
    unit = Group(chain(say("One."), say("Two.")), restartable=True)
    stage.request("ea", unit)
    assert stage.select() == ["ea#1", "ea#2"]
    stage.at(300).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500)
    assert stage.select() == ["fa#1"]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1", "ea#4"]
    stage.at(1000).end("ea#4")
    assert stage.select() == ["ea#5"]
    stage.at(1100).end("ea#5")
    stage.settle()
    assert stage.told("ea")[-1] == "done"


def test_x2_does_not_interrupt_what_has_just_been_preferred() -> None:
    # Of two reactions to one event the first starts (S2f), and in the same selection the
    # second, which it outranks, interrupts it.
    stage = Stage("prima+x2")
    stage.request("fa", steps=[Step(restartable(say("First."))), Step(say("Second."))], cause=1)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2") == []


def test_x2_an_earlier_reaction_does_not_interrupt_a_later_one_at_its_start() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", say("First."), cause=1)
    stage.request("fa", restartable(say("Second.")), cause=2)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2") == []


def test_x2_what_starts_again_does_not_give_way_to_a_reaction_to_its_own_event() -> None:
    stage = Stage("prima+x2")
    stage.request("fa", restartable(say("A long story.")), cause=EVENT)
    stage.request("ea", ask("Yes?"), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(100).mediator.emergency(True, True, 8)
    stage.select()
    stage.at(200).mediator.emergency(False, True, 9)
    assert stage.select() == ["fa#1"]
    stage.at(300).request("fa", command("point-by-hand", angle=0), cause=EVENT + 3)
    assert stage.select() == ["fa#2"], "from now on the floor reacts to another event (F2)"
    assert stage.holds("ea#1") == ["F2", "S1"] and stage.phases("interrupt") == []


def test_x2_a_reaction_that_leaves_does_not_go_before_what_outranks_it() -> None:
    # Two restartable Commands want the body; a reaction of low priority interrupts the one
    # that runs, and the other, which outranks it by S2a, is passed over.
    stage = Stage("prima+x2")
    turn = restartable(command("turn", angle=90))
    stage.request("ea", steps=[Step(turn), Step(restartable(command("turn", angle=90)))])
    stage.select()
    stage.at(100).request("fa", move(), cause=1)
    stage.select()
    assert check(stage.records, "prima+x2") == []


def test_x2_nothing_is_interrupted_for_a_reaction_that_is_held_back() -> None:
    # The speaker is held back for the reaction that ranks first and waits for the body (S3):
    # the other reaction interrupts the story, and must then wait for the first one (S3).
    stage = Stage("prima+x2")
    stage.request("ea", steps=[Step(restartable(say("A story."))), Step(command("turn", angle=90))])
    stage.select()
    stage.at(100).request("ea", say("Soon."), cause=1)
    stage.request("fa", command("face-human-and-speak", "Here."), cause=2)
    stage.select()
    assert check(stage.records, "prima+x2") == []


def test_x2_a_unit_in_a_unit_is_interrupted_with_it() -> None:
    # The unit inside is taken out, but what runs in it goes on: it is never told to stop.
    stage = Stage("prima+x2")
    inside = Group(chain(say("One."), say("Two.")))
    stage.request("ea", Group([Step(inside)], restartable=True))
    stage.select()
    stage.at(100).request("fa", ask(), cause=1)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2") == []
    orders = [(order.verb, order.behavior) for order in stage.orders]
    assert orders == [("start", "ea#3"), ("interrupt", "ea#3"), ("start", "fa#1")]
    stage.at(900).end("fa#1")
    stage.select()
    assert check(stage.records, "prima+x2") == []


def test_x2_of_a_unit_in_a_unit_the_device_reports_on_its_command() -> None:
    stage = Stage("prima+x2")
    turn = command("turn", angle=90)
    stage.request("ea", Group([Step(Group(chain(turn, turn)))], restartable=True))
    stage.select()
    stage.at(100).request("fa", turn, cause=1)
    assert stage.select() == ["fa#1"]
    stage.mediator.interrupted("ea#3", {"done": 0.5})
    stage.settle()
    ((_, notice),) = stage.notices
    assert (notice.event, notice.data) == ("interrupted.iu", {"done": 0.25})


@pytest.mark.parametrize(
    ("unit", "leave"),
    [(True, "state"), (True, "application"), (False, "state"), (False, "application")],
)
def test_x2_nobody_hears_of_what_has_been_left_meanwhile(unit: bool, leave: str) -> None:
    """O3, E2: the device reports after the state, or the application, has been left."""
    stage = Stage("prima+x2")
    turn = command("turn", angle=90)
    stage.request("ea", Group(chain(turn), restartable=True) if unit else restartable(turn))
    stage.select()
    stage.at(100).request("fa", turn, cause=1)
    assert stage.select() == ["fa#1"]
    if leave == "state":
        stage.leave("ea")
    else:
        stage.mediator.unload("ea", "exit")
    stage.mediator.interrupted("ea#2" if unit else "ea#1", {"done": 0.5})
    stage.settle()
    assert stage.told("ea") == []


def test_x2_a_motion_that_can_be_composed_is_in_nobodys_way() -> None:
    # Of the move and the nod only the nod is in the dance's way (X5), and it is restartable.
    stage = Stage("prima+x2+x5", table=TABLE)
    nod = restartable(command("gesture", name="nod"))
    stage.request("ea", steps=[Step(move()), Step(nod)])
    stage.select()
    stage.at(100).request("fa", Command("dance"), cause=1)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2+x5") == []


def test_x2_nothing_is_interrupted_where_a_composed_motion_stays_in_the_way() -> None:
    # A move and a spin share the body (X5). The spin gives way; the move does not.
    stage = Stage("prima+x2+x5", table=TABLE)
    stage.request("ea", move())
    stage.select()
    stage.at(50).request("ea", restartable(Command("spin")), cause=1)
    stage.select()
    stage.at(100).request("fa", command("turn", angle=90), cause=2)
    stage.select()
    assert check(stage.records, "prima+x2+x5") == []


def test_x2_what_is_linked_behind_what_waits_in_an_interrupted_unit_is_told_as_linked() -> None:
    stage = Stage("prima+x2")
    steps = [Step(say("One.")), Step(say("Two.")), Step(say("Three."), (1,))]
    stage.request("ea", Group(steps, restartable=True))
    stage.select()
    stage.at(100).request("fa", say("Ouch."), cause=1)
    assert stage.select() == ["fa#1"]
    outcomes = [r["outcome"] for r in stage.phases("cancel")]
    assert outcomes == ["running", "waiting", "linked"]
    assert check(stage.records, "prima+x2") == []


def test_x2_only_the_loop_that_was_interrupted_starts_again() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(TRACK))
    stage.select()
    stage.at(100).request("fa", command("turn", angle=3), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1.2"]
    stage.at(1200).end("ea#1.2", goal=False)
    assert stage.select() == ["ea#1.3"]
    resumed = [(r["behavior"], r.get("resumed")) for r in stage.phases("start")]
    assert resumed == [("ea#1.1", None), ("fa#1", None), ("ea#1.2", True), ("ea#1.3", None)]


def test_x2_why_what_was_interrupted_waits_is_told_at_once() -> None:
    """Its application learns at the same time that its stream is suspended (C2)."""
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    branches = [Step(command("pause", time="1s")), Step(say("Oh!"))]
    stage.at(500).request("fa", steps=branches, cause=EVENT)
    assert stage.select() == ["fa#1", "fa#2"]
    assert [(r["time"], r["rule"]) for r in stage.phases("hold")] == [(500, "F2")]
    assert check(stage.records, "prima+x2") == []


def test_x2_with_x1_a_motion_starts_again_from_where_it_began() -> None:
    both = "prima+x1+x2"
    stage = Stage(both)
    turn = restartable(command("turn", angle=60))
    stage.request("ea", command("set-direction", heading=90), say("Look!"), turn)
    stage.select()
    stage.at(100).end("ea#1", x=0.0, y=0.0, heading=90.0)
    stage.select()
    stage.at(200).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.at(500).request("fa", command("face-human"), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(501).mediator.interrupted("ea#3", {"done": 0.5, "x": 0.0, "y": 0.0, "heading": 120.0})
    stage.select()
    stage.at(600).end("fa#1")
    assert stage.select() == ["ea#4"]
    assert inserted(stage) == [("X1", "set-direction")], "it has turned half of its way"
    assert check(stage.records, both) == []


def test_x2_the_check_of_a_run_sees_that_another_reaction_was_to_interrupt() -> None:
    """Two reactions could both interrupt a unit: the one to the later event was to do so (S2b)."""
    stage = Stage("prima+x2", apps={"fa": "fa", "ea": "ea", "third": "fa"})
    unit = Group(chain(say("Hm."), command("turn", angle=9)), restartable=True)
    stage.request("ea", unit)
    assert "ea#1" in stage.select()
    stage.at(100).request("fa", say("Oh!"), cause=7)
    stage.request("third", command("turn", angle=90), cause=8)
    with pytest.MonkeyPatch.context() as patch:
        rebind(patch, rules, "s2b", lambda ab, memory: (0, ab.reaction or 0, 0))
        assert stage.select() == ["fa#1", "third#1"]
    found = check(stage.records, "prima+x2")
    assert "invariant 12 (S2b) at 0.100 s: fa#1 starts before third#1, which outranks it" in found
