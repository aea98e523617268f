"""Streams (rules C): topics that begin, are suspended, resumed and ended.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from tests.helpers.stage import Stage, ask, say

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
