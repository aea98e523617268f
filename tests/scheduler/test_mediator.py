"""What the mediator answers to the session that drives it."""

from __future__ import annotations

import pytest

from prima.messages import Group, Step
from prima.scheduler.failures import HANG_MS
from tests.helpers.stage import Stage, ask, chain, command, restartable, say

TOUCH = 7


def test_what_is_loaded_is_recorded_with_its_kind_and_language() -> None:
    stage = Stage(apps={})
    assert not stage.mediator.changed
    stage.mediator.load("guide", "ea", "en-GB")
    stage.mediator.load("pal", "fa")
    assert [(one["app"], one["data"]) for one in stage.recorder.drain()] == [
        ("guide", {"kind": "ea", "lang": "en-GB"}),
        ("pal", {"kind": "fa"}),
    ]


def test_there_is_something_to_select_from_only_after_something_has_happened() -> None:
    stage = Stage("prima+x2")
    mediator = stage.mediator
    stage.request("ea", restartable(say("A long story.")))
    assert mediator.changed
    stage.select()
    assert not mediator.changed
    assert not mediator.expire() and not mediator.changed, "nothing is due"
    mediator.senses_user()
    assert not mediator.changed, "the user was not absent"
    mediator.memory.absent = True
    mediator.senses_user()
    assert mediator.changed
    stage.select()
    stage.at(10 * HANG_MS)
    assert mediator.expire() and mediator.changed


def test_x2_what_an_interrupted_device_reports_leads_to_a_selection() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.at(10).request("fa", say("Oh!"), cause=TOUCH)
    stage.select()
    assert not stage.mediator.changed
    stage.mediator.interrupted("ea#1", {"text": "story."})
    assert stage.mediator.changed


@pytest.mark.parametrize(
    ("before", "now", "sensed"),
    [(False, False, 0), (False, True, 500), (True, True, 500), (True, False, 500)],
)
def test_v4_a_user_who_is_seen_or_goes_out_of_view_is_sensed(
    before: bool, now: bool, sensed: int
) -> None:
    stage = Stage()
    stage.mediator.memory.in_view = before
    stage.at(500).mediator.sees_user(now)
    assert stage.mediator.memory.sensed == sensed
    assert stage.mediator.memory.in_view == now


def test_x10_the_question_that_comes_is_asked_by_its_author_and_still_wanted() -> None:
    stage = Stage()
    assert stage.mediator.coming_question("ea") is None
    stage.request("ea", Group(chain(ask("In a unit?"))), say("Well."), ask("You?"), ask("And you?"))
    stage.select()
    coming = stage.mediator.coming_question("ea")
    assert coming is not None and coming.command is not None and coming.command.text == "You?"
    left = Stage()
    left.request("ea", ask("Left?"))
    left.select()
    left.leave("ea")
    assert left.mediator.coming_question("ea") is None
    unit = Stage()
    unit.request("ea", Group(chain(ask("In a unit?"))))
    unit.select()
    assert unit.mediator.coming_question("ea") is None


def test_o3_what_is_requested_in_a_later_instant_begins_a_stream_of_its_own() -> None:
    stage = Stage()
    stage.request("ea", say("One."))
    stage.select()
    stage.request("ea", say("Oh!"), cause=TOUCH)
    assert stage.select() == []
    stage.at(10).leave("ea")
    stage.select()
    stage.at(20).request("ea", say("Two."), state=2)
    stage.select()
    first, _, last = stage.phases("request")
    assert first["tree"] != last["tree"]


def test_an_order_to_stop_names_the_application() -> None:
    stage = Stage()
    stage.request("ea", say("Long."))
    stage.select()
    stage.mediator.emergency(True, True, 8)
    stage.select()
    assert [(one.verb, one.behavior, one.app) for one in stage.orders] == [
        ("start", "ea#1", "ea"),
        ("abort", "ea#1", "ea"),
    ]


def test_v1_a_question_in_a_unit_in_a_unit_is_the_running_question() -> None:
    stage = Stage()
    inner = Group([Step(ask("Well?")), Step(command("move-head"))])
    stage.request("ea", Group([Step(inner), Step(command("turn", angle=9))]))
    stage.select()
    question = stage.mediator.question()
    assert question is not None and question.command is not None
    assert question.command.text == "Well?"
