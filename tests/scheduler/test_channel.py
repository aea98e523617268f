"""The Communication Channel (rules K): nobody leaves a user whom another application engages.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from prima.invariants import check
from prima.language.commands import ABSENCE_MS, TABLE_4_2
from prima.messages import (
    Command,
    Step,
)
from prima.scheduler import rules
from tests.helpers.generated.plays import Play, perform
from tests.helpers.generated.world import World
from tests.helpers.plays import HEAD, told
from tests.helpers.stage import Stage, ask, command, move, say, search

EVENT = 7


def test_k1_a_leaving_ab_waits_while_another_application_engages_the_user() -> None:
    stage = Stage()
    stage.request("fa", ask("Shall we?"))
    stage.select()
    stage.request("ea", move())
    assert stage.select() == [], "not even though the wheels are free"
    assert stage.holds("ea#1") == ["K1"]
    stage.at(10).end("fa#1")
    assert stage.select() == ["ea#1.1"]


def test_k1_a_stream_that_leaves_itself_engages_nobody() -> None:
    table = {
        **TABLE_4_2,
        "glide": replace(TABLE_4_2["set-position"], name="glide", devices=frozenset({"arm"})),
    }
    stage = Stage(table=table)
    stage.request("fa", ask(), Command("glide", {"x": 1, "y": 1}))
    stage.select()
    stage.at(10).end("fa#1")
    assert stage.select() == ["fa#2.1"]
    stage.request("ea", move())
    assert stage.select() == ["ea#1.1"]


def test_k1_a_stream_of_which_only_a_part_leaves_engages_still() -> None:
    table = {
        **TABLE_4_2,
        "glide": replace(TABLE_4_2["set-position"], name="glide", devices=frozenset({"arm"})),
    }
    stage = Stage(table=table)
    steps = [Step(ask()), Step(move(), (0,)), Step(say("This way."), (0,))]
    stage.request("fa", steps=steps)
    stage.select()
    stage.at(10).end("fa#1")
    assert set(stage.select()) == {"fa#2.1", "fa#3"}
    stage.request("ea", Command("glide", {"x": 1, "y": 1}))
    assert stage.select() == []
    assert stage.holds("ea#1") == ["K1"]
    stage.at(20).end("fa#3")
    assert stage.select() == ["ea#1.1"]


def test_k1_a_stream_that_is_held_and_does_nothing_engages_still() -> None:
    stage = Stage("prima+x3")
    stage.request("fa", ask(), hold=5000)
    stage.select()
    stage.at(10).end("fa#1")
    stage.select()
    stage.at(20).request("ea", move(), cause=EVENT)
    assert stage.select() == [], "a reaction may break in (F2), but not leave the user"
    assert stage.holds("ea#1") == ["K1"]
    stage.at(5010).mediator.expire()
    assert stage.select() == ["ea#1.1"]


def test_k1_nobody_engages_a_user_who_has_gone() -> None:
    stage = Stage()
    stage.mediator.sees_user(True)
    stage.request("ea", ask("Still there?"))
    stage.select()
    stage.at(1000).mediator.sees_user(False)
    stage.request("fa", move())
    assert stage.select() == []
    assert stage.holds("fa#1") == ["K1"]
    assert stage.mediator.deadline() == 21_000
    stage.at(21_000).mediator.expire()
    assert stage.select() == ["fa#1.1"]
    stage.at(21_500).mediator.senses_user()
    stage.end("fa#1.1", goal=False)
    assert stage.select() == [], "the user is back"


@pytest.mark.parametrize(("kind", "engages"), [("active-sensing-human", True), ("q-and-a", False)])
def test_k1_a_stream_that_searches_engages_whom_it_looks_for(kind: str, engages: bool) -> None:
    stage = Stage()
    stage.request("ea", command(kind, "Hello?"))
    stage.select()
    memory = stage.mediator.memory
    memory.absent = True
    assert rules.engages(memory.streams["ea:1"], memory) is engages


def test_k1_a_user_who_was_never_sensed_is_absent_that_long_after_the_beginning() -> None:
    stage = Stage()
    stage.request("ea", ask("Hello?"))
    stage.at(10).request("fa", move())
    stage.select()
    assert stage.mediator.deadline() == ABSENCE_MS


@pytest.mark.parametrize("searches", [True, False])
def test_k1_one_part_that_searches_is_enough(searches: bool) -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(ask("Hello?")), Step(search() if searches else move())])
    assert stage.select() == ["ea#1", "ea#2.1"]
    memory = stage.mediator.memory
    memory.absent = True
    assert rules.engages(memory.streams["ea:1"], memory) is searches


def test_k2_leaving_commands_have_low_priority() -> None:
    low = {name for name, row in TABLE_4_2.items() if row.priority == 0}
    assert low == {"topological-move", "set-position", "set-position-and-direction"}


def test_a_question_in_a_unit_keeps_the_robot_from_leaving() -> None:
    # Without the <iu> the question goes first, having the higher priority (S2a), and K1 holds
    # the move. In a unit it starts after the selection: the robot drives off for one loop.
    asks = '<field name="q" type="boolean"><prompt>Well?</prompt></field>'
    moves = '<block><topological-move to="room"/></block>'
    documents = (
        HEAD.format("fa", f'<form id="f1"><iu>{asks}</iu></form>'),
        HEAD.format("ea", f'<form id="f1">{moves}</form>'),
    )
    run = perform(Play(documents, (0, 0), (), World()))
    assert check(run.records) == []


def test_the_same_question_without_a_unit_keeps_the_robot_from_leaving() -> None:
    asks = '<field name="q" type="boolean"><prompt>Well?</prompt></field>'
    moves = '<block><topological-move to="room"/></block>'
    documents = (
        HEAD.format("fa", f'<form id="f1">{asks}</form>'),
        HEAD.format("ea", f'<form id="f1">{moves}</form>'),
    )
    run = perform(Play(documents, (0, 0), (), World()))
    assert check(run.records) == []
    question = told(run.records, "fa#1")
    move = told(run.records, "ea#1.1")
    assert move[0][0] >= question[-1][0] > 0
