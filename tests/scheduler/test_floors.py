"""Floors (rules F): who may start while a reaction has taken the floor, and who speaks.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import pytest

from prima.invariants import check
from prima.language.commands import TABLE_4_2
from prima.messages import (
    Command,
    Group,
    Occurred,
    Step,
)
from tests.helpers.generated.plays import perform
from tests.helpers.plays import IN_ORDER, SEARCH, play
from tests.helpers.stage import Stage, ask, chain, command, inserted, move, say, search

EVENT = 7


def test_f1_a_reaction_suspends_the_others_whatever_devices_they_need() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == [], "nothing of the EA moves while the FA talks"
    assert stage.holds("ea#1.1") == ["F2"]
    assert [(r["tree"], r["by"]) for r in stage.phases("suspend")] == [("ea:1", "fa:1")]


def test_f1_what_outranks_the_new_holder_starts_in_the_same_instant() -> None:
    stage = Stage(apps={"fa": "fa", "ea": "ea", "other": "ea"})
    stage.request("fa", command("gesture", name="bow"), cause=1)
    stage.select()
    stage.at(5).request("other", say())
    assert stage.select() == []
    assert stage.holds("other#1") == ["F2"], "it does not outrank the gesture"
    stage.at(10).request("ea", move(), cause=2)
    assert stage.select() == ["ea#1.1", "other#1"], "but the move, which has taken the floor"
    assert stage.floor == ["fa:1", "ea:1"]


def test_f2_a_reaction_to_another_event_may_break_in_and_one_to_the_same_may_not() -> None:
    stage = Stage()
    stage.request("fa", say(), cause=1)
    stage.select()
    stage.request("ea", command("move-head", pan=1), cause=1)
    assert stage.select() == []
    stage.request("ea", command("point-by-hand", angle=1), cause=2)
    assert "ea#2" in stage.select()


def test_f2_a_higher_priority_than_all_of_the_floors_stream_may_start() -> None:
    stage = Stage()
    stage.request("fa", search())
    stage.select()
    stage.request("ea", say(), move(), cause=1)
    stage.at(500).end("fa#1.1", goal=False)
    assert stage.select() == ["ea#1"]
    stage.at(900).end("ea#1")
    assert stage.select() == ["fa#1.2"], "the search outranks the move (Figure 5.3, rows 15-16)"
    assert stage.rule("fa#1.2") == "F2"
    assert stage.floor == ["ea:1", "fa:1"]


def test_f2_a_higher_priority_than_some_of_the_floors_stream_is_not_enough() -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(move()), Step(say())], cause=1)
    assert stage.select() == ["ea#2", "ea#1.1"]
    stage.at(5).request("fa", command("gesture", name="bow"))
    assert stage.select() == [], "it outranks the move, not the words"
    assert stage.holds("fa#1") == ["F2"]
    stage.at(10).end("ea#2")
    assert stage.select() == ["fa#1"]


def test_f2_words_of_resumption_have_the_highest_priority_of_what_follows_them() -> None:
    stage = Stage("prima+x9")
    steps = [Step(say("One.")), Step(say("Two."), (0,)), Step(move(), (0,))]
    stage.request("ea", steps=steps, words=say("As I said."))
    stage.select()
    stage.at(100).request("fa", say("Oh!"), move(), cause=EVENT)
    stage.select()
    stage.at(500).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    assert stage.select() == ["ea#4", "fa#2.1"]
    assert inserted(stage) == [("X9", "speak")]


def test_f3_the_floor_falls_back_when_its_holder_ends() -> None:
    stage = Stage()
    stage.request("fa", ask("1"), ask("2"), cause=1)
    stage.select()
    stage.request("ea", say(), cause=2)
    stage.at(10).end("fa#1")
    stage.select()
    assert stage.floor == ["fa:1", "ea:1"]
    stage.at(20).end("ea#1")
    assert stage.select() == ["fa#2"]
    assert stage.floor == ["fa:1"]


def test_f3_what_outranks_the_floor_takes_it_only_if_it_needs_its_devices() -> None:
    for what, floor in ((command("turn", angle=10), "fa:1"), (say(), "ea:1")):
        stage = Stage()
        stage.request("ea", move(), cause=EVENT)
        stage.select()
        stage.at(5).request("fa", what)
        stage.at(500).end("ea#1.1", goal=False)
        stage.select()
        assert stage.floor[-1] == floor, what
        assert ("fa#1" in stage.running) and ("ea#1.2" in stage.running) is (floor == "ea:1")


def test_f3_what_needs_a_device_of_what_follows_words_of_resumption_takes_the_floor() -> None:
    stage = Stage("prima+x9")
    stage.request("ea", say("One."), move(), cause=EVENT, words=say("As I said."))
    stage.select()
    stage.at(100).request("fa", say("Oh!"), cause=EVENT + 1)
    stage.at(500).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == [("X9", "speak")]
    assert stage.floor == ["ea:1"]
    stage.at(1100).request("fa", command("turn", angle=9))
    assert stage.select() == ["fa#2"]
    assert stage.floor == ["ea:1", "fa:2"], "the move that follows the words needs the base"


def test_f3_a_robot_that_guides_does_not_stop_for_every_sentence() -> None:
    stage = Stage()
    stage.request("ea", move(), cause=EVENT)
    stage.select()
    stage.at(5).request("fa", say("Once upon a time"), say("there was a robot."))
    assert stage.select() == ["fa#1"]
    assert stage.phases("suspend") == []
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"]


def test_f2_leaves_open_who_reacts_to_what_the_floors_stream_reacted_to_before() -> None:
    # The EA's stream goes on from event 2 to event 3, so F2 is open for what reacts to 2 (O2).
    stage = Stage(apps={"other": "ea", "fa": "fa", "ea": "ea"})
    bow = Command("gesture", {"name": "bow"}, now=True)
    stage.request("other", say())
    stage.select()
    for event in (1, 2, 3):
        stage.at(10 * event).recorder.add(
            "event", "user", event="touch", serial=event, inbound=True
        )
        stage.request("fa", steps=[Step(say("One.")), Step(say("Two."))], cause=event)
        if event > 1:
            stage.request("ea", bow, cause=event)
        stage.select()
    for time, pressed in ((50, True), (60, False)):
        stage.at(time).mediator.emergency(pressed, not pressed, time)
        stage.select()
    assert (stage.rule("fa#1"), stage.losers("fa#1")) == ("S2f", ["fa#2", "ea#2"])
    assert check(stage.records, declared=("other", "fa", "ea")) == []


def test_f6_a_topic_is_not_spoken_into() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("move-head", pan=30), say("forty two."))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    assert stage.holds("fa#1")[-1] == "F6"
    stage.at(20).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.at(30).end("ea#3")
    assert stage.select() == ["fa#1"]


def test_f6_a_topic_goes_on_through_all_that_is_silent() -> None:
    stage = Stage()
    bow = command("gesture", name="bow")
    stage.request("ea", say("The answer is"), command("turn", angle=30), bow, say("forty two."))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    assert stage.holds("fa#1")[-1] == "F6"


def test_f6_a_pause_in_a_topic_goes_before_those_who_would_have_spoken() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("pause", time="1s"), say("forty two."))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    assert (stage.rule("ea#2"), stage.losers("ea#2")) == ("S2c", ["fa#1"])


def test_f6_a_topic_whose_end_was_deleted_may_be_spoken_into() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("move-head", pan=30), say("forty two."))
    stage.select()
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    stage.leave("ea")
    stage.at(12).request("fa", say("I like trains."))
    assert stage.select() == ["fa#1"] and "ea#2" in stage.running


def test_f6_a_reaction_may_break_in() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("move-head", pan=30), say("forty two."))
    stage.select()
    stage.at(5).request("fa", say("Ouch."), cause=EVENT)
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1", "ea#2"] or "fa#1" in stage.running


@pytest.mark.parametrize(
    "between",
    [
        [command("move-head", pan=30), search(), say("forty two.")],  # it works in loops
        [command("move-head", pan=30)],  # nothing is said behind it
        [command("move-head", pan=30), command("gesture", name="bow")],  # nor further behind
    ],
)
def test_f6_holds_only_between_two_utterances(between: list[Command]) -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), *deepcopy(between))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    stage.at(10).end("ea#1")
    assert "fa#1" in stage.select()


def test_f6_a_question_that_only_listens_is_no_utterance() -> None:
    stage = Stage()
    stage.request("ea", say("Ask me."), command("move-head", pan=30), Command("q-and-a"))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    stage.select()
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2", "fa#1"]
    assert check(stage.records) == []


def test_f6_a_stream_that_has_not_spoken_is_no_topic_yet() -> None:
    stage = Stage()
    stage.request("ea", command("move-head", pan=30), say("Forty two."))
    stage.at(1).request("fa", say("I like trains."))
    assert stage.select() == ["ea#1", "fa#1"]


def test_f6_a_unit_in_which_nothing_was_said_makes_no_topic() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "arm", "neck")
    stage.request("ea", command("gesture", name="nod"), unit=1)
    stage.select()
    stage.close("ea", 1)
    stage.request("ea", command("gesture", name="nod"), say())
    stage.at(10).end("ea#2")
    stage.request("fa", say())
    assert stage.select() == ["ea#3", "fa#1"]
    assert len(stage.mediator.memory.streams) == 2, "the unit and what follows are one stream"


def test_f6_who_holds_the_floor_may_speak_into_a_topic() -> None:
    stage = Stage()
    stage.request("ea", say("The answer is"), command("gesture", name="bow"), say("forty two."))
    stage.select()
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    stage.at(12).request("fa", command("face-human"), say("Ouch there."), cause=EVENT)
    assert stage.select() == ["fa#1"], "the reaction takes the floor without a word"
    stage.at(20).end("fa#1")
    assert stage.select() == ["fa#2"], "what follows it is not a reaction, but has the floor"


def test_f6_a_topic_that_works_in_loops_may_be_spoken_into() -> None:
    stage = Stage()
    stage.request("ea", say("Follow me."), move(), say("Here we are."))
    stage.select()
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2.1"]
    stage.at(20).request("fa", say("I like trains."))
    assert stage.select() == ["fa#1"]


def test_f6_a_unit_keeps_its_own_speaker() -> None:
    """Between two utterances in a unit it is the unit that others wait for, by S1."""
    stage = Stage()
    bow = command("gesture", name="bow")
    stage.request("ea", Group(chain(say("The answer is"), bow, say("forty two."))))
    stage.select()
    stage.at(5).request("fa", say("I like trains."))
    for part in ("ea#2", "ea#3", "ea#4"):
        assert stage.select() == ([] if part == "ea#2" else [part])
        stage.end(part)
    assert stage.select() == ["fa#1"]
    assert [(r["rule"], r["by"]) for r in stage.phases("hold")] == [("S1", "ea#1")]


def test_f6_who_waits_too_long_for_a_unit_holds_its_devices_back() -> None:
    """It waits by S1, so S3 and E6 apply: nobody whom it outranks takes the wheels from it."""
    stage = Stage(patience=1000, apps={"fa": "fa", "ea": "ea", "guide": "ea"})
    bow = command("gesture", name="bow")
    stage.request("ea", Group(chain(say("The answer is"), bow, say("forty two."))))
    stage.select()
    stage.at(5).request("fa", Group(chain(say("Look."), command("turn", angle=10))))
    stage.select()
    stage.at(2000).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.at(2010).request("guide", command("turn", angle=20))
    assert stage.select() == []
    assert stage.holds("guide#1") == ["S3"]


def test_f4_without_a_floor_only_devices_and_the_channel_count() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.request("fa", command("turn", angle=5))
    assert sorted(stage.select()) == ["ea#1", "fa#1"]
    assert stage.floor == []


def test_f5_a_motion_that_gets_no_next_loop_is_stopped_for_certain() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    stage.select()
    stage.at(500).end("ea#1.1", goal=False)
    stage.select()
    assert [order.verb for order in stage.orders][-1] == "stop"
    assert [r["rule"] for r in stage.phases("stop")] == ["F5"]


def test_f5_no_stop_where_something_else_takes_the_wheels_or_the_goal_is_met() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", command("turn", angle=9), cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1"]
    assert stage.phases("stop") == []
    done = Stage()
    done.request("ea", move())
    done.select()
    done.at(500).end("ea#1.1", goal=True)
    done.select()
    assert done.phases("stop") == []


def test_f5_stops_nothing_that_has_no_wheels() -> None:
    wave = replace(TABLE_4_2["tracking-human"], name="wave", devices=frozenset({"arm"}))
    stage = Stage(table={**TABLE_4_2, "wave": wave})
    stage.request("ea", Command("wave"))
    stage.select()
    stage.request("fa", command("point-by-hand", angle=9), cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1"]
    assert stage.phases("stop") == []


@pytest.mark.parametrize(
    ("turns_first", "nested", "stops"),
    [
        (False, False, ["ea#1.1"]),
        (False, True, ["ea#1.1"]),
        (True, False, []),
        (True, True, []),
    ],
)
def test_f5_a_unit_takes_the_wheels_when_a_command_in_it_does(
    turns_first: bool, nested: bool, stops: list[str]
) -> None:
    pair = (say(), command("turn", angle=9))
    unit = Group(chain(*(reversed(pair) if turns_first else pair)))
    stage = Stage()
    stage.request("ea", move())
    stage.select()
    stage.request("fa", Group(chain(unit)) if nested else unit, cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1", "fa#2", "fa#3"][: 2 + nested]
    assert [r["behavior"] for r in stage.phases("stop")] == stops


def test_f5_stops_a_search_that_now_cuts_short_without_moving_the_robot() -> None:
    # The search turns the robot. What is wanted now says something, and moves nothing.
    body = f'<form id="f1">{SEARCH}<on event="touch"><speak order="now">Wait.</speak></on></form>'
    run = perform(play(body, (10, Occurred("touch", "user"))))
    assert check(run.records, declared=IN_ORDER) == []


def test_f2_whom_the_floor_lets_in_when_it_changes_hands_goes_before_those_that_rank_below() -> (
    None
):
    stage = Stage(apps={"fa": "fa", "ea": "ea", "xa": "ea"})
    stage.request("fa", say("Hello."), cause=EVENT + 2)
    stage.select()
    nod = command("gesture", name="nod")
    stage.request("ea", nod, cause=EVENT + 2)
    stage.request("fa", command("turn", angle=3), cause=EVENT + 1)
    stage.request("xa", nod, cause=EVENT)
    assert stage.select() == ["fa#2", "ea#1"]
    assert check(stage.records) == []
