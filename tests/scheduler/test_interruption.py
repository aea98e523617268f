"""X2: an AB that is marked restartable gives way to a reaction and starts again."""

from __future__ import annotations

from dataclasses import replace

import pytest

from prima.language.commands import PATIENCE_MS
from prima.messages import Command, Group, Step
from tests.helpers.stage import Stage, ask, chain, command, say

EVENT = 7


def restartable(what: Command) -> Command:
    return replace(what, restartable=True)


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
