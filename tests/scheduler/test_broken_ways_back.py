"""X1: what comes in while a stream's way back is on its way, or before it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from prima.invariants import check
from prima.messages import Command, Step
from tests.helpers.stage import Stage, ask, chain, command, inserted, move, restartable, say

EVENT = 7
NOD = command("move-head", pan=0, tilt=20)


def on_the_way_back() -> Stage:
    """The EA has gone somewhere and turned the head; the FA has changed both, and it goes back."""
    stage = Stage("prima+x1")
    stage.request("ea", move(), command("move-head", pan=40), say("First."), say("Second."))
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    stage.select()
    stage.at(600).end("ea#2")
    stage.select()
    stage.request("fa", command("turn", angle=3), command("move-head"), cause=EVENT)
    stage.select()
    stage.at(1000).end("fa#1", x=0.0, y=0.0, heading=0.0)
    stage.select()
    stage.at(1100).end("ea#3")
    stage.end("fa#2")
    assert stage.select() == ["ea#5.1"]
    return stage


def test_x1_a_way_back_that_was_broken_itself_is_gone_again() -> None:
    """After the way, and before the head has turned back, the robot is taken away once more."""
    stage = on_the_way_back()
    assert inserted(stage) == [("X1", "set-position"), ("X1", "move-head")]
    stage.at(1500).request("fa", command("turn", angle=3), cause=EVENT + 1)
    stage.select()
    stage.at(2000).end("ea#5.1", x=4.0, y=1.0, heading=0.0)
    assert stage.select() == ["fa#3"]
    stage.at(3000).end("fa#3", x=1.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#7.1"]
    assert inserted(stage)[2:] == [("X1", "set-position")], "the head has still to turn"
    stage.at(4000).end("ea#7.1", x=4.0, y=1.0, heading=0.0)
    assert stage.select() == ["ea#6"]
    stage.at(4500).end("ea#6")
    assert stage.select() == ["ea#4"]
    assert check(stage.records, "prima+x1") == []


def test_x1_what_waits_for_its_way_back_is_told_as_linked_when_it_is_left() -> None:
    stage = on_the_way_back()
    stage.at(1200).leave("ea")
    stage.select()
    cancelled = [(r["behavior"], r["outcome"]) for r in stage.phases("cancel")]
    assert cancelled == [("ea#4", "linked"), ("ea#6", "linked")]
    assert check(stage.records, "prima+x1") == []


def test_x1_what_is_cancelled_at_once_has_not_waited_for_the_way_back() -> None:
    stage = on_the_way_back()
    now = [replace(say(text), now=True) for text in ("Stop.", "Wait.")]
    stage.at(1500).request("ea", steps=[Step(now[0]), Step(NOD)])
    stage.request("ea", now[1])
    stage.select()
    cancelled = [(r["behavior"], r["outcome"]) for r in stage.phases("cancel")]
    assert cancelled[-2:] == [("ea#8", "waiting"), ("ea#7", "waiting")]
    assert check(stage.records, "prima+x1") == []


def test_x1_what_was_interrupted_without_a_pose_leaves_the_robot_where_it_is() -> None:
    """X2: a device that only speaks says nothing of it."""
    stage = Stage("prima+x1+x2")
    stage.request("ea", move(), restartable(say("First.")))
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    stage.select()
    stage.request("fa", command("turn", angle=3), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(800).end("fa#1", x=0.0, y=0.0, heading=0.0)
    stage.select()
    stage.request("fa", say("Oh!"), cause=EVENT + 1)
    assert stage.select() == ["fa#2"]
    stage.mediator.interrupted("ea#2", {"done": 0.5, "heard": "Fir"})
    stage.at(1500).end("fa#2")
    assert stage.select() == ["ea#3.1"] and inserted(stage) == [("X1", "set-position")]
    assert check(stage.records, "prima+x1+x2") == []


def two_conversations(
    nods: bool = False,
    own: tuple[Command, ...] = (),
    then: Callable[[Stage], object] = lambda _: None,
) -> Stage:
    """Both engage the user, and the robot stands where neither goes on.

    Args:
        nods: whether the EA nods all the time.
        own: what the FA does instead of asking.
        then: what happens when the EA's first question is answered.
    """
    stage = Stage("prima+x1")
    nod = [Step(command("gesture", name="nod"), (0,))] if nods else []
    stage.request("ea", steps=[*chain(move(), ask("One?"), ask("Two?")), *nod])
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    assert stage.select() == ["ea#2", "ea#4"][: 1 + nods]
    drive = command("set-speed-and-time", speed=0.5, time="1s")
    stage.request("fa", drive, *(own or (ask("A?"), ask("B?"))), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(1500).end("fa#1", x=0.0, y=0.0, heading=0.0)
    stage.end("ea#2", then=lambda: then(stage))
    assert stage.select() == ["fa#2"]
    stage.request("ea", command("turn", angle=3), cause=EVENT + 1)
    (turn,) = stage.select()
    stage.at(2500).end(turn, x=2.0, y=0.0, heading=0.0)
    stage.end("fa#2")
    return stage


def test_x1_two_conversations_do_not_wait_for_each_others_way_back() -> None:
    stage = two_conversations()
    assert stage.select() == ["fa#4.1"], "the one with the floor"
    assert stage.holds("ea#5") == ["F2"]
    stage.at(4000).end("fa#4.1", x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["fa#3"]
    stage.at(5000).end("fa#3")
    assert stage.select() == ["ea#5.1"]
    stage.at(7000).end("ea#5.1", x=4.0, y=1.0, heading=90.0)
    assert stage.select() == ["ea#3"]
    stage.at(8000).end("ea#3")
    stage.select()
    assert check(stage.records, "prima+x1") == []


def test_x1_a_way_back_waits_for_a_conversation_that_does_more_than_go_back() -> None:
    """K1, though its stream has the floor; the other's way back does not wait for it (F2)."""
    stage = two_conversations(nods=True)
    assert stage.select() == ["ea#6.1"] and stage.holds("fa#4") == ["K1", "F2"]
    stage.at(3000).end("ea#4")
    assert stage.select() == []
    stage.at(4000).end("ea#6.1", x=4.0, y=1.0, heading=90.0)
    assert stage.select() == ["ea#3"]
    stage.at(5000).end("ea#3")
    assert stage.select() == ["fa#4.1"]
    assert check(stage.records, "prima+x1") == []


def test_x1_a_way_back_waits_for_no_other_that_only_waits_to_leave_the_user() -> None:
    """K1: the EA wants to drive besides, and waits for the FA with that, too."""
    drive = Command("topological-move", {"to": "hall"}, now=True)
    stage = two_conversations(then=lambda one: one.request("ea", drive))
    assert stage.select() == ["fa#4.1"] and "K1" in stage.holds("ea#4")
    assert check(stage.records, "prima+x1") == []


def test_x1_a_way_back_to_no_conversation_waits_for_one() -> None:
    stage = two_conversations(own=(command("point-by-hand", angle=9), NOD))
    assert stage.select() == ["ea#5.1"] and stage.holds("fa#4")[0] == "K1"
    assert check(stage.records, "prima+x1") == []


def test_x1_a_way_back_waits_for_a_conversation_that_is_held() -> None:
    """X3, K1: nothing of that one waits to go back."""
    stage = Stage("prima+x1+x3", apps={"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.request("ea", move(), ask("One?"), hold=60_000)
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    stage.select()
    drive = command("set-speed-and-time", speed=0.5, time="1s")
    stage.request("fa", drive, ask("A?"), ask("B?"), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(1500).end("fa#1", x=0.0, y=0.0, heading=0.0)
    stage.end("ea#2")
    assert stage.select() == ["fa#2"]
    stage.request("eb", command("turn", angle=3), cause=EVENT + 1)
    assert stage.select() == ["eb#1"]
    stage.at(2500).end("eb#1", x=2.0, y=0.0, heading=0.0)
    stage.end("fa#2")
    assert stage.select() == [] and stage.holds("fa#4") == ["K1"]
    assert check(stage.records, "prima+x1+x3") == []


def test_k1_who_drives_away_waits_for_a_conversation_that_only_waits_to_go_back() -> None:
    """X1: the drive of the FA, which engages the user by a gesture, is no way back."""
    stage = Stage("prima+x1", apps={"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.request("ea", move(), ask("One?"), ask("Two?"))
    told = [command("face-human"), command("gesture", name="nod"), move("hall")]
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    stage.request("fa", steps=[Step(one, (0,) if at else ()) for at, one in enumerate(told)])
    assert stage.select() == ["ea#2", "fa#1"]
    stage.at(600).end("fa#1", x=4.0, y=1.0, heading=90.0)
    assert stage.select() == ["fa#2"] and stage.holds("fa#3") == ["K1"]
    stage.request("eb", command("turn", angle=3), cause=EVENT)
    assert stage.select() == ["eb#1"]
    stage.at(1500).end("eb#1", x=0.0, y=0.0, heading=0.0)
    stage.end("ea#2")
    assert stage.select() == [] and inserted(stage) == [("X1", "set-position")]
    stage.at(2000).end("fa#2")
    assert stage.select() == ["ea#4.1"], "now all that the FA does is to leave the user"
    assert check(stage.records, "prima+x1") == []
