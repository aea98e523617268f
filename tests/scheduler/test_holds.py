"""X3: a stream is held for an event, with the floor."""

from __future__ import annotations

from dataclasses import replace

import pytest

from prima.invariants import check
from tests.helpers.stage import Stage, ask, command, move, say

EVENT, LATER = 7, 8


def held(policy: str, hold: int | None = 5000) -> Stage:
    """The FA has asked for something and waits for the answer; the EA would go on."""
    stage = Stage(policy)
    stage.request("ea", say("Welcome."), say("This way."))
    stage.select()
    stage.request("fa", say("Connecting."), cause=EVENT, hold=hold)
    stage.at(100).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    return stage


def test_x3_a_held_stream_keeps_the_floor_while_its_application_waits() -> None:
    stage = held("prima+x3")
    assert stage.select() == []
    assert stage.floor == ["fa:1"]
    stage.at(2000).request("fa", say("Done."), cause=LATER, state=1)
    assert stage.select() == ["fa#2"]
    assert [r["tree"] for r in stage.phases("start") if r["app"] == "fa"] == ["fa:1", "fa:1"]


@pytest.mark.parametrize(("policy", "hold"), [("prima", 5000), ("prima+x3", None)])
def test_x3_is_off_unless_run_and_document_ask_for_it(policy: str, hold: int | None) -> None:
    assert held(policy, hold).select() == ["ea#2"]


def test_x3_a_reaction_may_break_in() -> None:
    stage = held("prima+x3")
    stage.select()
    stage.at(1500).request("ea", say("A message!"), cause=LATER)
    assert stage.select() == ["ea#3"]
    assert stage.floor == ["fa:1", "ea:2"]


def test_x3_a_higher_priority_alone_does_not_break_in() -> None:
    stage = Stage("prima+x3")
    stage.request("fa", move(), hold=5000)
    stage.select()
    stage.at(500).end("fa#1.1")
    stage.request("ea", say("Hello."))
    assert stage.select() == []
    assert stage.holds("ea#1") == ["F2"]


def test_x3_it_ends_after_its_longest_time_which_runs_on_while_suspended() -> None:
    stage = held("prima+x3")
    stage.select()
    assert stage.mediator.deadline() == 6000
    stage.at(5500).request("ea", say("A message!"), cause=LATER)
    stage.select()
    stage.at(6000).mediator.expire()
    stage.select()
    assert stage.floor == ["ea:2"]
    outcomes = [r["outcome"] for r in stage.phases("held")]
    assert outcomes == ["begun", "over"]


def test_x3_a_stream_of_which_nothing_has_started_is_not_held() -> None:
    stage = Stage("prima+x3+x8")
    stage.request("ea", say("Welcome."), say("This way."))
    stage.select()
    stage.request("fa", say("Oh!"), cause=EVENT, hold=5000, fresh=500)
    stage.select()
    stage.at(500).mediator.expire()
    assert stage.select() == []
    assert [r["rule"] for r in stage.phases("cancel")] == ["X8"]
    stage.at(1000).end("ea#1")
    assert stage.select() == ["ea#2"]
    assert stage.phases("held") == []
    assert check(stage.records, "prima+x3+x8") == []


def test_x3_it_ends_when_its_state_is_left() -> None:
    stage = held("prima+x3")
    stage.select()
    stage.at(2000).leave("fa")
    assert stage.select() == ["ea#2"]
    assert [r["outcome"] for r in stage.phases("held")] == ["begun", "left"]


def test_x3_it_does_not_end_when_another_state_is_left() -> None:
    stage = held("prima+x3")
    stage.select()
    stage.at(2000).leave("fa", 2)
    assert stage.select() == []


def test_x3_it_does_not_end_with_another_application() -> None:
    stage = held("prima+x3")
    stage.select()
    stage.at(2000).mediator.unload("ea", "exit")
    stage.select()
    assert stage.floor == ["fa:1"]
    assert list(stage.mediator.holds) == ["fa:1"]


def test_x3_of_several_streams_that_are_held_the_latest_goes_on() -> None:
    stage = Stage("prima+x3")
    stage.request("ea", command("turn", angle=10), cause=EVENT, hold=5000)
    stage.request("ea", command("move-head", pan=10), cause=LATER, hold=5000)
    stage.select()
    stage.at(100).end("ea#1")
    stage.select()
    stage.at(200).end("ea#2")
    stage.select()
    assert list(stage.mediator.holds) == ["ea:1", "ea:2"]
    stage.at(300).request("ea", say("Done."), cause=LATER + 1)
    stage.select()
    assert stage.phases("start")[-1]["tree"] == "ea:2"


def test_x3_what_is_asked_for_on_leaving_joins_it() -> None:
    stage = held("prima+x3")
    stage.select()
    stage.at(2000).leave("fa")
    stage.request("fa", say("Done."), cause=LATER, state=2)
    assert stage.select() == ["fa#2"]
    assert stage.phases("start")[-1]["tree"] == "fa:1"
    stage.at(3000).end("fa#2")
    assert stage.select() == ["ea#2"]


def test_x3_an_application_that_ends_holds_nothing() -> None:
    stage = held("prima+x3")
    stage.select()
    stage.mediator.unload("fa", "exit")
    assert stage.select() == ["ea#2"]


def test_x3_a_held_conversation_keeps_the_channel() -> None:
    stage = Stage("prima+x3")
    stage.request("fa", ask("Well?"), hold=5000)
    stage.select()
    stage.at(100).end("fa#1")
    stage.request("ea", move())
    assert stage.select() == []
    stage.at(5100).mediator.expire()
    assert stage.select() == ["ea#1.1"]


def test_x3_in_a_window_what_is_wanted_now_continues_what_it_cancels() -> None:
    # O2: no event has come for which the first stream is held.
    stage = Stage("prima+x3")
    stage.request("ea", say("Connecting."), hold=5000)
    stage.request("ea", command("turn", angle=10), cause=EVENT)
    stage.request("ea", command("move-head", pan=10), cause=LATER)
    assert stage.select() == ["ea#3", "ea#2", "ea#1"]
    stage.at(100).end("ea#1")
    stage.select()
    urgent = replace(command("turn", angle=5), now=True)
    stage.at(200).end("ea#3", then=lambda: stage.request("ea", urgent))
    assert stage.select() == ["ea#4"]
    assert stage.phases("start")[-1]["tree"] == "ea:2"


def test_x3_a_unit_joins_the_stream_that_is_held() -> None:
    # Its stream stays held while the unit is of it, and its time runs out then.
    stage = Stage("prima+x3")
    stage.request("fa", say(), hold=5000)
    stage.select()
    stage.at(100).end("fa#1")
    stage.select()
    stage.at(200).open("fa", 1, "speaker")
    stage.select()
    stage.at(300).request("ea", command("turn", angle=90))
    stage.select()
    assert check(stage.records, "prima+x3") == []


def to_be_held_under_a_reaction() -> Stage:
    """A stream that is to be held has just come to its end; a reaction has the floor and speaks."""
    stage = Stage("prima+x3")
    stage.request("ea", command("turn", angle=90), hold=5000)
    stage.select()
    stage.request("fa", say(), cause=1)
    stage.select()
    stage.at(100).end("ea#1")
    return stage


def test_x3_the_floor_that_an_ending_stream_gives_back_is_taken() -> None:
    # Both streams end in one instant; the one to be held comes first and finds the floor
    # taken by the other, which ends then: nobody has it.
    stage = to_be_held_under_a_reaction()
    stage.end("fa#1")
    stage.select()
    stage.at(200).request("fa", command("turn", angle=90))
    assert stage.select() == []
    assert check(stage.records, "prima+x3") == []


def test_x3_who_is_held_has_the_floor_once_those_who_had_it_have_ended() -> None:
    stage = to_be_held_under_a_reaction()
    stage.select()
    assert stage.floor == ["fa:1"]
    stage.at(200).end("fa#1")
    stage.select()
    assert stage.floor == ["ea:1"]
    stage.at(300).request("fa", command("turn", angle=90))
    assert stage.select() == []
    stage.at(5100).mediator.expire()
    assert stage.select() == ["fa#2"]
    assert check(stage.records, "prima+x3") == []


def test_x3_of_several_held_streams_the_latest_has_the_floor_that_another_gives_back() -> None:
    stage = Stage("prima+x3", {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.request("ea", command("turn", angle=10), hold=9000)
    stage.request("eb", command("move-head", pan=10), hold=5000)
    stage.select()
    stage.request("fa", say(), cause=EVENT)
    stage.select()
    stage.at(100).end("eb#1")
    stage.select()
    stage.at(200).end("ea#1")
    stage.select()
    stage.at(300).end("fa#1")
    stage.select()
    assert stage.floor == ["ea:1"]
    stage.at(400).leave("ea")
    stage.select()
    assert stage.floor == ["eb:1"]
    assert check(stage.records, "prima+x3") == []


def test_x3_of_streams_held_in_one_instant_the_latest_has_the_floor() -> None:
    stage = Stage("prima+x3")
    stage.request("fa", say(), hold=5000)
    stage.request("ea", command("move-head", pan=30), hold=5000)
    assert stage.select() == ["fa#1", "ea#1"]
    stage.at(1000).end("fa#1")
    stage.end("ea#1")
    assert stage.select() == []
    held = [record["tree"] for record in stage.phases("held")]
    assert len(held) == 2 and stage.floor == held[1:]
    assert check(stage.records, "prima+x3") == []


@pytest.mark.parametrize(
    ("in_window", "cause", "tree"),
    [(False, None, "fa:1"), (False, 9, "fa:1"), (True, 9, "fa:1"), (True, None, "fa:2")],
)
def test_o2_what_is_wanted_now_continues_the_stream_that_is_held(
    in_window: bool, cause: int | None, tree: str
) -> None:
    """But in a window, where nothing that it waits for has come, the one that it cancels (X3)."""
    stage = Stage("prima+x3")
    stage.request("fa", say("Connecting."), cause=EVENT, hold=5000)
    stage.request("fa", command("turn", angle=90), cause=LATER)
    stage.request("fa", command("gesture", name="nod"), cause=LATER)
    stage.select()
    stage.at(10).end("fa#1")
    stage.select()
    assert [one["outcome"] for one in stage.phases("held")] == ["begun"]

    def stop() -> None:
        stage.request("fa", command("stop-moving"), cause=cause)

    if in_window:
        stage.at(20).end("fa#3", then=stop)
    else:
        stop()
    stage.select()
    assert stage.phases("request")[-1]["tree"] == tree
