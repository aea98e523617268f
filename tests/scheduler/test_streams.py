"""Streams (rules C): topics that begin, are suspended, resumed and ended.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from dataclasses import replace

from prima.language.commands import TABLE_4_2
from prima.messages import Group, Step
from tests.helpers.stage import Stage, ask, chain, command, say

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


def test_c1_a_stream_is_open_while_it_has_an_ab_or_is_held() -> None:
    stage = Stage("prima+x3")
    stage.request("fa", say(), cause=EVENT, hold=5000)
    stage.select()
    [stream] = stage.mediator.memory.streams.values()
    assert stream.open and stream.runs
    stage.at(10).end("fa#1")
    stage.select()
    assert stream.open and not stream.runs, "it is held (X3)"
    stage.at(5010).mediator.expire()
    stage.select()
    assert not stream.open


def test_o1_the_latest_of_a_stream_is_what_its_application_has_asked_for_last() -> None:
    """Neither what is inside a unit nor what the mediator has put in."""
    stage = Stage("prima+x4")
    assert not stage.mediator.memory.streams
    unit = Group(chain(say("One."), say("Two.")))
    steps = [Step(command("move-head", pan=1)), Step(unit)]
    stage.request("fa", steps=steps, cause=EVENT, connect=True)
    stage.select()
    [stream] = stage.mediator.memory.streams.values()
    assert [ab.id for ab in stream.members.values()] != ["fa#1", "fa#2"]
    latest = stream.latest()
    assert latest is not None and latest.id == "fa#2" and stream.runs


def test_x5_what_moves_inside_a_unit_is_not_composed() -> None:
    dance = replace(TABLE_4_2["turn"], name="dance", motion="faithful")
    stage = Stage("prima+x5", table={**TABLE_4_2, "dance": dance})
    stage.request("fa", command("dance", angle=5))
    stage.request("ea", Group(chain(command("dance", angle=5))))
    stage.select()
    stage.at(10).end("fa#1")
    stage.select()
    motions = {ab.id: ab.motion for ab in stage.mediator.memory.running.values()}
    assert motions == {"ea#1": "", "ea#2": ""}
    assert stage.phases("request")[0]["motion"] == "faithful"


def test_s2c_only_what_was_freed_in_this_very_instant_goes_first() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.at(1).end("ea#1")
    assert stage.select() == ["ea#2"] and stage.rule("ea#2") == "S2c"


def test_f2_what_a_running_unit_holds_contends_and_what_a_linked_one_holds_does_not() -> None:
    stage = Stage()
    inner = Group(chain(say("Three.")))
    stage.request("fa", Group(chain(say("One."), inner)), Group(chain(say("Four."))), cause=EVENT)
    stage.select()
    [stream] = stage.mediator.memory.streams.values()
    assert [ab.id for ab in stream.contending()] == ["fa#1", "fa#3"]
    assert [ab.id for ab in stream.present()] == ["fa#1", "fa#3"]
    states = {ab.id: str(ab.state) for ab in stream.members.values()}
    assert states == {"fa#1": "running", "fa#2": "linked", "fa#3": "running", "fa#4": "linked"}


def test_x4_what_was_put_in_counts_for_itself_once_the_rest_is_gone() -> None:
    stage = Stage("prima+x4")
    stage.request("fa", say("Hello."), cause=EVENT, connect=True)
    assert stage.select() == ["fa#2"]
    [stream] = stage.mediator.memory.streams.values()
    assert [ab.id for ab in stream.contending()] == ["fa#1"]
    stage.at(10).leave("fa")
    stage.select()
    assert [ab.id for ab in stream.contending()] == ["fa#2"]


def test_x2_what_was_left_does_not_start_again() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", replace(say("A long story."), restartable=True))
    stage.select()
    stage.at(10).leave("ea")
    stage.request("fa", say("Oh!"), cause=EVENT)
    assert stage.select() == [] and stage.running == {"ea#1"}


def test_the_end_of_a_unit_is_recorded_as_the_mediators_own() -> None:
    stage = Stage()
    stage.request("fa", Group(chain(say("One."))))
    stage.select()
    stage.at(10).end("fa#2")
    stage.select()
    command, unit = stage.phases("end")
    assert (command["behavior"], command["inbound"]) == ("fa#2", True)
    assert (unit["behavior"], unit["outcome"]) == ("fa#1", "done")
    assert not {"inbound", "goal", "data"} & set(unit)
