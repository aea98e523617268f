"""Streams (rules C): topics that begin, are suspended, resumed and ended.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from prima.messages import Step
from tests.helpers.stage import Stage, ask, command, say

EVENT = 7


def test_c1_a_stream_ends_with_its_last_ab_and_holds_no_floor_then() -> None:
    stage = Stage()
    stage.request("fa", say(), cause=EVENT)
    stage.select()
    assert stage.floor == ["fa:1"]
    stage.at(10).end("fa#1")
    stage.select()
    assert stage.floor == []
    assert [r["tree"] for r in stage.phases("stream-end")] == ["fa:1"]


def test_c2_a_suspended_stream_resumes_where_it_was() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."), say("Three."))
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]
    assert [r["tree"] for r in stage.phases("suspend")] == ["ea:1"]
    stage.at(20).end("fa#1")
    assert stage.select() == ["ea#2"]
    assert [r["tree"] for r in stage.phases("resume")] == ["ea:1"]


def test_c3_what_is_requested_in_the_window_belongs_to_the_stream() -> None:
    stage = Stage()
    stage.request("ea", say("One."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.at(10).end("ea#1", then=lambda: stage.request("ea", say("Two.")))
    assert stage.select() == ["ea#2"]
    assert stage.phases("request")[-1]["tree"] == "ea:1"


def test_c4_an_answer_opens_the_window_too() -> None:
    stage = Stage()
    stage.request("ea", ask())
    stage.select()
    stage.request("fa", say("Me."))
    stage.at(10).end("ea#1", then=lambda: stage.request("ea", say("I see.")))
    assert stage.select() == ["ea#2"]


def test_c2_a_stream_that_has_resumed_ranks_as_before_from_the_next_instant_on() -> None:
    """S2d is for suspended streams: then the earlier request goes first (S2e)."""
    stage = Stage(apps={"fa": "fa", "ea": "ea", "third": "ea"})
    turn = command("move-head", pan=30)
    stage.request("fa", turn)
    stage.select()
    stage.at(1).request("third", turn)
    stage.at(2).request("ea", steps=[Step(say()), Step(turn, (0,)), Step(turn, (0,))])
    assert stage.select() == ["ea#1"]
    stage.at(10).request("fa", say("Me."), cause=EVENT)
    stage.end("ea#1")
    assert stage.select() == ["fa#2"]
    stage.at(20).end("fa#2")
    stage.end("fa#1")
    assert stage.select() == ["ea#2"], "its stream is suspended (S2d)"
    stage.at(30).end("ea#2")
    assert (stage.select(), stage.rule("third#1")) == (["third#1"], "S2e")


def test_c2_only_a_stream_that_is_suspended_waits_so() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.select()
    assert (stage.holds("fa#1"), stage.mediator.drain_turns()) == (["F6"], [])
    stage.at(5).request("fa", say("Oh!"), cause=EVENT)
    stage.at(10).end("ea#1")
    stage.select()
    assert [(what, stream.name) for what, stream in stage.mediator.drain_turns()] == [
        ("suspended", "ea:1")
    ]
    stage.at(12).request("fa", say("Listen."))
    stage.select()
    assert stage.mediator.drain_turns() == [], "once is enough"
