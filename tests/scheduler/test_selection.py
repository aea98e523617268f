"""Selection (rules S): which waiting AB starts first.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

import pytest

from prima.invariants import check
from prima.messages import (
    Occurred,
    Step,
)
from tests.helpers.generated.plays import Play, perform
from tests.helpers.generated.world import World
from tests.helpers.plays import HEAD, IN_ORDER, SEARCH, play
from tests.helpers.stage import TRACK, Stage, ask, command, move, say

EVENT = 7


def test_s1_an_ab_waits_for_its_devices() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.at(1).request("fa", say())
    assert stage.select() == ["ea#1"]
    assert stage.holds("fa#1") == ["S1"]


def test_s2a_the_higher_priority_goes_first() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.at(5).request("fa", command("turn", angle=10))
    assert stage.select() == ["fa#1"]
    assert stage.rule("fa#1") == "S2a"


def test_s2b_of_reactions_the_latest_event_goes_first() -> None:
    stage = Stage()
    stage.request("ea", say(), cause=1)
    stage.at(1).request("fa", say(), cause=2)
    assert stage.select() == ["fa#1"]
    assert stage.rule("fa#1") == "S2b"


def test_s2b_of_one_events_reactions_the_active_applications_goes_first() -> None:
    stage = Stage()
    stage.request("ea", command("move-head", pan=1))
    stage.select()
    stage.request("fa", say(), cause=EVENT)
    stage.request("ea", say(), cause=EVENT)
    assert stage.select() == ["ea#2"]


@pytest.mark.parametrize("goes_on", [True, False])
def test_s2b_a_stream_that_has_not_ended_is_active_between_its_abs(goes_on: bool) -> None:
    stage = Stage()
    stage.request("ea", say("One."), *([say("Two.")] if goes_on else []))
    stage.select()
    stage.request("fa", say("F."), cause=EVENT)
    stage.request("ea", say("E."), cause=EVENT)
    stage.at(10).end("ea#1")
    first = ("ea#3", "S2b") if goes_on else ("fa#1", "S2f")
    assert stage.select() == [first[0]]
    assert stage.rule(first[0]) == first[1]


def test_s2b_a_stream_that_has_ended_is_not_active_while_another_runs() -> None:
    stage = Stage(apps={"one": "ea", "two": "ea"})
    stage.request("one", say("Long."))
    stage.select()
    stage.at(5).request("two", command("move-head", pan=1))
    stage.select()
    stage.at(10).end("two#1")
    stage.select()
    stage.at(15).request("two", command("point-by-hand", angle=0), cause=EVENT)
    stage.request("one", command("point-by-hand", angle=9), cause=EVENT)
    assert stage.select() == ["one#2"], "the sentence is what is active"


def test_s2b_a_stream_is_not_active_once_its_last_ab_has_ended() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    active = stage.mediator.memory.active
    assert active is not None and active.name == "ea"
    stage.at(10).end("ea#1")
    assert stage.mediator.memory.active is None, "before the next selection ends it"


def test_s2b_a_stream_that_begins_in_the_same_selection_is_active_for_the_rest_of_it() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.request("fa", move(), cause=EVENT)
    stage.request("ea", move(), cause=EVENT)
    assert stage.select() == ["ea#1", "ea#2.1"]
    assert stage.rule("ea#2.1") == "S2b"


def test_s2b_ranks_anew_only_reactions_though_others_wait_as_well() -> None:
    stage = Stage(apps={"fa": "fa", "ea": "ea", "third": "fa"})
    stage.request("ea", say())
    stage.request("fa", move(), cause=EVENT)
    stage.request("third", say("Later."))
    stage.request("ea", move(), cause=EVENT)
    assert stage.select() == ["ea#1", "ea#2.1"]


def test_s2c_a_parent_that_has_just_ended_goes_before_others() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]
    assert stage.rule("ea#2") == "S2c"


def test_s2d_the_stream_suspended_last_goes_first() -> None:
    apps = {"a": "fa", "b": "ea", "c": "ea"}
    stage = Stage(apps=apps)
    stage.request("a", say("a1"), say("a2"))
    stage.select()
    stage.request("b", say("b1"), say("b2"), cause=1)
    stage.at(10).end("a#1")
    stage.select()
    stage.request("c", say("c1"), cause=2)
    stage.at(20).end("b#1")
    assert stage.select() == ["c#1"]
    stage.at(30).end("c#1")
    assert stage.select() == ["b#2"], "a stack of topics is unwound"
    stage.at(40).end("b#2")
    assert stage.select() == ["a#2"]


def test_s2d_the_stream_suspended_last_goes_first_when_no_floor_is_left() -> None:
    stage = Stage(apps={"a": "fa", "b": "ea", "c": "ea"})
    stage.request("a", say("a1"), say("a2"))
    stage.request("b", command("move-head", pan=1), say("b1"))
    stage.select()
    stage.request("b", say("r"), cause=1)
    stage.at(10).end("a#1")
    assert stage.select() == ["b#3"], "a is suspended"
    stage.request("c", say("c1"), cause=2)
    stage.at(20).end("b#3")
    assert stage.select() == ["c#1"], "and now b's first stream"
    stage.at(25).end("b#1")
    stage.select()
    stage.at(30).end("c#1")
    assert stage.select() == ["b#2"]
    assert stage.rule("b#2") == "S2d"


def test_s2d_streams_suspended_together_rank_alike() -> None:
    stage = Stage(apps={"a": "fa", "b": "ea", "c": "ea"})
    stage.request("a", say("a1"), say("a2"))
    stage.at(1).request("b", command("move-head", pan=1), say("b1"))
    stage.select()
    stage.request("c", say("c1"), cause=EVENT)
    stage.at(10).end("a#1")
    assert stage.select() == ["c#1"]
    stage.at(15).end("b#1")
    stage.select()
    stage.at(20).end("c#1")
    assert stage.select() == ["a#2"]
    assert stage.rule("a#2") == "S2e"


def test_s2d_a_stream_that_has_not_begun_never_goes_before_one_that_was_broken() -> None:
    stage = Stage(apps={"fa": "fa", "one": "ea", "two": "ea"})
    stage.request("one", ask("One?"), ask("Or two?"))
    stage.select()
    stage.at(1).request("two", ask("Three?"))
    stage.request("fa", say(), cause=EVENT)
    stage.at(10).end("one#1")
    assert stage.select() == ["fa#1"]
    assert [r["tree"] for r in stage.phases("suspend")] == ["one:1"]
    stage.at(20).end("fa#1")
    assert stage.select() == ["one#2"]


def test_s2f_goes_by_the_declared_order_whoever_was_loaded_first() -> None:
    stage = Stage(apps={})
    stage.mediator.load("late", "ea", order=1)
    stage.mediator.load("early", "ea", order=0)
    stage.request("late", say())
    stage.request("early", say())
    assert stage.select() == ["early#1"]
    assert stage.rule("early#1") == "S2f"


def test_s2_who_starts_beside_the_winner_has_not_lost() -> None:
    stage = Stage(apps={"fa": "fa", "ea": "ea", "third": "ea"})
    stage.request("fa", say("Hello."))
    stage.request("ea", say("Good day."))
    stage.request("third", command("turn", angle=90))
    assert stage.select() == ["fa#1", "third#1"]
    assert stage.losers("fa#1") == ["ea#1"]
    assert stage.losers("third#1") == []


def test_s2_a_decision_names_as_losers_only_what_could_have_started() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say(), command("face-human"), cause=EVENT)
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]
    assert (stage.rule("fa#1"), stage.losers("fa#1")) == ("S2b", ["ea#2"])
    stage.at(20).end("fa#1")
    assert stage.select() == ["fa#2"]
    assert (stage.rule("fa#2"), stage.losers("fa#2")) == ("S1", []), "F2 holds ea#2"


def test_s2e_and_s2f_the_earlier_request_then_the_declared_order() -> None:
    stage = Stage()
    stage.at(5).request("ea", say())
    stage.at(6).request("fa", say())
    assert stage.select() == ["ea#1"]
    assert stage.rule("ea#1") == "S2e"
    same = Stage()
    same.request("ea", say())
    same.request("fa", say())
    assert same.select() == ["fa#1"]
    assert same.rule("fa#1") == "S2f"


def test_s3_a_waiting_reaction_holds_its_devices_back() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    # The reaction needs speaker and locomotion; only the speaker is taken.
    stage.at(1).request("fa", command("turn-and-speak", "Hey.", angle=90), cause=EVENT)
    stage.request("ea", steps=[Step(command("turn", angle=5))], cause=None)
    stage.at(2).request("fa", command("turn", angle=5), cause=None)
    assert stage.select() == []
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]


def test_s3_holds_a_device_from_another_applications_ab() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    stage.at(1).request("fa", command("turn-and-speak", "Hey.", angle=90), cause=EVENT)
    third = Stage(apps={"a": "fa", "b": "ea", "c": "ea"})
    third.request("b", say())
    third.select()
    third.at(1).request("a", command("turn-and-speak", "Hey.", angle=90), cause=EVENT)
    third.request("c", command("turn", angle=5))
    assert third.select() == []
    assert third.holds("c#1") == ["S3"]


def test_s4_abs_without_a_common_device_run_together() -> None:
    stage = Stage()
    stage.request("ea", move())
    stage.request("fa", say("Hello."))
    assert sorted(stage.select()) == ["ea#1.1", "fa#1"]


def test_of_those_who_have_waited_too_long_the_first_by_rank_starts_first() -> None:
    """E4, S2d: whose stream is suspended goes before one that has just resumed."""
    stage = Stage(apps=dict.fromkeys("abcd", "ea"), bound=1)
    stage.request("c", say("One."), say("Two."))
    stage.request("a", TRACK)
    stage.select()
    stage.at(10).request("b", steps=[Step(say("Three.")), Step(say("Four."))])
    stage.select()
    stage.at(20).request("d", command("gesture", name="nod"), cause=1)
    stage.select()
    for now, name, goal in (
        (30, "c#1", True),
        (40, "a#1.1", False),
        (50, "d#1", True),
        (60, "b#1", True),
    ):
        stage.at(now).end(name, goal)
        stage.select()
    started = [record["behavior"] for record in stage.records if record["phase"] == "start"]
    assert started.index("c#2") == len(started) - 1


def test_a_decision_names_no_loser_that_s3_keeps_back() -> None:
    # Had the turn not started, "Hm." would still hold the speaker back from the search.
    reaction = '<par><turn angle="5"/><speak>Hm.</speak></par>'
    body = f'<form id="f1">{SEARCH}<on event="touch">{reaction}</on></form>'
    run = perform(play(body, (10, Occurred("touch", "user"))))
    assert check(run.records, declared=IN_ORDER) == []


def test_s2c_what_cancels_a_tree_follows_nothing_that_has_ended() -> None:
    # fa has waited for the wheels since 5 ms. What ea wants now cancels its own turn (O2):
    # its parent has not ended, so the earlier request goes first (S2e).
    waits = '<form id="f1"><on event="corner" reactive="false"><turn angle="5"/></on></form>'
    urgent = (
        '<form id="f1"><block><set-direction heading="5"/></block>'
        '<on event="touch" reactive="false"><turn angle="5" order="now"/></on></form>'
    )
    documents = (HEAD.format("fa", waits), HEAD.format("ea", urgent))
    events = ((5, Occurred("corner")), (10, Occurred("touch", "user")))
    run = perform(Play(documents, (0, 0), events, World()))
    assert check(run.records, declared=IN_ORDER) == []
