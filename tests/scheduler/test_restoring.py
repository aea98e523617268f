"""X1: the robot's state is restored when a stream resumes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from prima.invariants import check
from prima.language.commands import TABLE_4_2
from prima.messages import (
    Command,
    Group,
    Step,
)
from tests.helpers.generated.scripts import Ask, Script, drive
from tests.helpers.generated.world import World
from tests.helpers.stage import Stage, ask, chain, command, inserted, move, say

EVENT = 7
NOD = command("move-head", pan=0, tilt=20)


def at_a_panel(policy: str, *then: Command) -> Stage:
    """The EA has gone to a panel and explains it, when the FA takes the robot away."""
    stage = Stage(policy)
    stage.request("ea", move(), say("First."), *then)
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    assert stage.select() == ["ea#2"]
    stage.request("fa", command("tracking-human"), cause=EVENT)
    stage.select()
    stage.at(1000).end("ea#2")
    return stage


def test_x1_a_stream_that_resumes_stands_where_it_stood() -> None:
    stage = at_a_panel("prima+x1", say("Second."))
    assert stage.select() == []
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    assert inserted(stage) == []
    assert stage.select() == ["ea#4.1"]
    assert inserted(stage) == [("X1", "set-position")]
    [made] = [r for r in stage.phases("request") if r.get("inserted")]
    assert made["args"] == {"x": 4.0, "y": 1.0} and made["before"] == "ea#3"
    stage.at(2000).end("ea#4.1", x=4.0, y=1.0, heading=10.0)
    assert stage.select() == ["ea#3"]
    assert stage.rule("ea#3") == "S1"


def turned_away(then: Command, x: float, y: float, heading: float) -> Stage:
    """The EA has gone somewhere and turned, when the FA turns the robot, which ends elsewhere."""
    stage = Stage("prima+x1")
    stage.request("ea", move(), command("set-direction", heading=90), say("First."), then)
    stage.select()
    stage.at(500).end("ea#1.1", x=x, y=y, heading=0.0)
    stage.select()
    stage.at(600).end("ea#2", x=x, y=y, heading=heading)
    stage.select()
    stage.request("fa", command("turn", angle=3), cause=EVENT)
    stage.select()
    stage.at(1000).end("ea#3")
    stage.select()
    stage.at(1500).end("fa#1", x=0.0, y=0.0, heading=0.0)
    stage.select()
    return stage


def test_x1_a_way_back_is_written_without_a_negative_zero() -> None:
    stage = turned_away(say("Second."), -0.0001, 4.0, -0.01)
    [made] = [r for r in stage.phases("request") if r.get("inserted")]
    assert str(made["args"]) == "{'x': 0.0, 'y': 4.0, 'heading': 0.0}"


def test_x1_who_waits_for_its_own_way_back_is_kept_waiting_by_nobody_else() -> None:
    stage = at_a_panel("prima+x1", say("Second."))
    assert stage.select() == []
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#4.1"]
    stage.at(90_000).end("ea#4.1", x=4.0, y=1.0, heading=10.0)
    assert stage.select() == ["ea#3"] and stage.phases("starve") == []


@pytest.mark.parametrize(
    ("kind", "text", "args", "way"),
    [
        ("turn", None, {"angle": 30}, "set-position-and-direction"),
        ("turn-and-speak", "There.", {"angle": 30}, "set-position-and-direction"),
        ("set-speed-and-time", None, {"time": "1s"}, "set-position-and-direction"),
        ("turn-and-speak", "There.", {"toward": "room"}, "set-position"),
        ("set-direction", None, {"heading": 30}, "set-position"),
    ],
)
def test_x1_what_moves_from_where_the_robot_stands_relies_on_it(
    kind: str, text: str | None, args: dict[str, Any], way: str
) -> None:
    stage = turned_away(command(kind, text, **args), 4.0, 1.0, 90.0)
    assert inserted(stage) == [("X1", way)]


def test_x1_is_off_unless_it_is_asked_for() -> None:
    stage = at_a_panel("prima", say("Second."))
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#3"]


def test_x1_nothing_is_restored_that_the_next_behaviour_does_itself() -> None:
    stage = at_a_panel("prima+x1", move("hall"))
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#3.1"]


def test_x1_nothing_is_restored_where_the_robot_has_not_moved() -> None:
    stage = at_a_panel("prima+x1", say("Second."))
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=4.1, y=1.0, heading=92.0)
    assert stage.select() == ["ea#3"]


def test_x1_a_stream_that_follows_the_user_relies_on_no_place() -> None:
    stage = Stage("prima+x1")
    follow = command("tracking-human")
    steps = [Step(move()), Step(say("One."), (0,)), Step(say("Two."), (1,)), Step(follow, (0,))]
    stage.request("ea", steps=steps)
    stage.select()
    stage.at(500).end("ea#1.1", x=1.0, y=1.0, heading=0.0)
    assert stage.select() == ["ea#2", "ea#4.1"]
    stage.request("fa", ask(), cause=EVENT)
    stage.at(1000).end("ea#4.1", goal=False, x=5.0, y=5.0, heading=0.0)
    stage.end("ea#2")
    assert stage.select() == ["fa#1"]
    stage.at(1500).end("fa#1")
    assert stage.select() == ["ea#3", "ea#4.2"]
    assert inserted(stage) == []


def test_x1_a_stream_relies_on_no_place_that_it_only_passes() -> None:
    stage = Stage("prima+x1")
    steps = [Step(move()), Step(say("One.")), Step(say("Two."), (1,))]
    stage.request("ea", steps=steps)
    assert set(stage.select()) == {"ea#1.1", "ea#2"}
    stage.request("fa", command("turn", angle=5), cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False, x=1.0, y=1.0, heading=0.0)
    stage.end("ea#2")
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1", x=5.0, y=5.0, heading=0.0)
    assert set(stage.select()) == {"ea#3", "ea#1.2"}
    assert inserted(stage) == []


def test_x1_the_way_back_changes_nothing_on_which_the_stream_relies() -> None:
    stage = at_a_panel("prima+x1", say("Second."), say("Third."))
    stage.select()
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#5.1"]
    stage.at(2000).end("ea#5.1", x=4.4, y=1.0, heading=90.0)
    assert stage.select() == ["ea#3"]
    stage.request("fa", command("turn", angle=5), cause=EVENT + 1)
    assert stage.select() == ["fa#2"]
    stage.at(2500).end("fa#2", x=3.8, y=1.0, heading=90.0)
    stage.end("ea#3")
    assert stage.select() == ["ea#4"], "it is near to where the stream has led it"


def test_x1_direction_and_head_are_restored() -> None:
    stage = Stage("prima+x1")
    stage.request(
        "ea", command("set-direction", heading=90.0), command("move-head", pan=40.0), say(), say()
    )
    stage.select()
    stage.at(100).end("ea#1", x=0.0, y=0.0, heading=90.0)
    stage.select()
    stage.at(200).end("ea#2")
    stage.select()
    stage.request("fa", command("turn", angle=180), command("move-head"), cause=EVENT)
    stage.select()
    stage.at(300).end("fa#1", x=0.0, y=0.0, heading=270.0)
    stage.end("ea#3")
    stage.select()
    stage.at(400).end("fa#2")
    stage.select()
    assert inserted(stage) == [("X1", "set-direction"), ("X1", "move-head")]
    assert stage.running == {"ea#5"}
    stage.at(500).end("ea#5", x=0.0, y=0.0, heading=90.0)
    assert stage.select() == ["ea#6"]
    stage.at(600).end("ea#6")
    assert stage.select() == ["ea#4"]


def test_x1_what_was_turned_to_the_human_turns_to_him_again() -> None:
    stage = Stage("prima+x1")
    stage.request("ea", command("face-human"), say("One."), say("Two."))
    stage.select()
    stage.at(100).end("ea#1", x=0.0, y=0.0, heading=90.0)
    stage.select()
    stage.request("fa", command("turn", angle=180), cause=EVENT)
    stage.select()
    stage.at(300).end("fa#1", x=0.0, y=0.0, heading=270.0)
    stage.end("ea#2")
    stage.select()
    assert inserted(stage) == [("X1", "face-human")]


def test_x1_a_way_back_that_is_blocked_is_done_without() -> None:
    stage = at_a_panel("prima+x1", say("Second."))
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    stage.select()
    stage.at(2000)
    stage.mediator.failed("ea#4.1", "locomotion", "the way is blocked")
    assert stage.select() == ["ea#3"]
    assert stage.told("ea") == ["ended", "ended"], "the way back is not the application's"


def test_x1_the_way_back_waits_while_another_talks_with_the_user() -> None:
    stage = at_a_panel("prima+x1", say("Second."))
    stage.leave("fa")
    stage.request("fa", ask("Are you well?"))
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["fa#2"]


def test_x1_whatever_waits_in_the_stream_waits_for_the_way_back() -> None:
    # The second was to be said once the robot had turned to the user (X4), when the way back came in.
    stage = Stage("prima+x1+x4")
    stage.request("ea", move())
    stage.select()
    branches = [Step(say("First.")), Step(command("turn-and-speak", "Second.", angle=9))]
    stage.at(500).end(
        "ea#1.1",
        x=4.0,
        y=1.0,
        heading=90.0,
        then=lambda: stage.request("ea", steps=branches, connect=True),
    )
    assert stage.select() == ["ea#4"]
    stage.request("fa", command("turn", angle=10), cause=EVENT)
    stage.at(1000).end("ea#4", x=4.0, y=1.0, heading=0.0)
    assert stage.select() == ["fa#1"]
    stage.at(1500).end("fa#1", x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#5"]
    assert inserted(stage)[-2:] == [("X1", "set-position"), ("X1", "face-human")]
    stage.at(2000).end("ea#5", x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#6.1"], "nothing of the stream goes before the way back"
    stage.at(2500).end("ea#6.1", x=4.0, y=1.0, heading=0.0)
    assert stage.select() == ["ea#7"]
    stage.at(3000).end("ea#7", x=4.0, y=1.0, heading=0.0)
    assert stage.select() == ["ea#2"]


def test_x1_the_robot_goes_back_before_it_turns_to_the_user() -> None:
    """X4: the turn waited for the wheels when another drove the robot away."""
    stage = Stage("prima+x1+x4")
    stage.request("ea", move(), say("One."))
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    stage.select()
    stage.at(600).request("fa", command("turn", angle=10))
    stage.select()
    stage.at(700).end("ea#2", then=lambda: stage.request("ea", say("Two."), connect=True))
    assert stage.select() == [] and inserted(stage) == [("X4", "face-human")]
    stage.at(750).request("fa", command("turn", angle=20), cause=EVENT)
    assert stage.select() == []
    stage.at(800).end("fa#1", x=4.0, y=1.0, heading=100.0)
    assert stage.select() == ["fa#2"]
    stage.at(900).end("fa#2", x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#5.1"]
    assert inserted(stage)[1:] == [("X1", "set-position")]
    stage.at(1500).end("ea#5.1", x=4.0, y=1.0, heading=0.0)
    assert stage.select() == ["ea#4"], "the turn to the user, once"
    stage.at(1700).end("ea#4", x=4.0, y=1.0, heading=0.0)
    assert stage.select() == ["ea#3"]
    assert check(stage.records, "prima+x1+x4") == []


def way_back_that_waits(policy: str, *steps: Step) -> Stage:
    """The EA's stream is to resume, but another turns the robot: the way back waits for that."""
    stage = Stage(policy, {"fa": "fa", "ea": "ea", "xa": "ea"})
    stage.request("ea", steps=[Step(move()), Step(say("One."), (0,)), *steps])
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    assert "ea#2" in stage.select()
    stage.at(600).request("fa", command("turn", angle=10), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(700).end("ea#2")
    stage.select()
    stage.request("xa", command("turn", angle=20))
    assert stage.select() == []
    stage.at(900).end("fa#1", x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["xa#1"] and inserted(stage) == [("X1", "set-position")]
    return stage


def test_x1_what_is_wanted_now_waits_for_no_way_back_that_waits_itself() -> None:
    nod = Step(command("gesture", name="nod"), (0,))
    stage = way_back_that_waits("prima+x1", nod, Step(say("Two."), (1,)))
    point = replace(command("point-by-hand", angle=9), now=True)
    stage.at(1000).end("ea#3", then=lambda: stage.request("ea", point))
    assert stage.select() == ["ea#6"]
    stage.at(1100).end("xa#1", x=0.0, y=0.0, heading=20.0)
    assert stage.select() == ["ea#5.1"]
    stage.at(1500).end("ea#5.1", x=4.0, y=1.0, heading=20.0)
    assert stage.select() == ["ea#4"], "the rest of the stream goes on where it stood"
    assert len(inserted(stage)) == 1
    assert check(stage.records, "prima+x1") == []


def test_x1_the_response_to_an_answer_does_not_wait_for_the_way_back() -> None:
    """X7, X10: the question is answered before it is asked once more."""
    stage = way_back_that_waits("prima+x1+x7+x10", Step(ask(), (1,)))
    question = stage.mediator.coming_question("ea")
    assert question is not None
    stage.at(1000).mediator.answered(question, {"outcome": "filled"}, "X10", EVENT + 1)
    stage.settle(lambda: stage.request("ea", say("Thank you.")))
    assert stage.select() == ["ea#5"]


def test_x1_a_way_back_goes_on_when_another_branch_has_failed() -> None:
    """What the application says of the failure relies on it too (E1)."""
    nod = Step(command("gesture", name="nod"), (0,))
    stage = way_back_that_waits("prima+x1", nod, Step(say("Two."), (1,)))
    stage.at(1000).end("xa#1", x=0.0, y=0.0, heading=20.0)
    assert stage.select() == ["ea#5.1"]
    stage.at(1200).mediator.failed("ea#3", "arm", "broken")
    stage.settle(lambda: stage.request("ea", say("Sorry.")))
    assert stage.select() == []
    stage.at(1500).end("ea#5.1", goal=False, x=2.0, y=0.0, heading=20.0)
    assert stage.select() == ["ea#5.2"]
    stage.at(2000).end("ea#5.2", x=4.0, y=1.0, heading=20.0)
    assert stage.select() == ["ea#6"]
    assert check(stage.records, "prima+x1") == []


def test_x1_a_way_back_that_k1_keeps_does_not_keep_the_floor() -> None:
    # fa would wait to drive back until ea no longer engages the user, ea for fa's floor.
    stage = Stage("prima+x1", apps={"fa": "fa", "ea": "ea", "xa": "ea"})
    stage.request("fa", command("set-position", x=2, y=0), say("a"))
    stage.select()
    stage.at(100).end("fa#1.1", x=2.0, y=0.0, heading=0.0)
    stage.request("ea", command("tracking-human"))
    assert stage.select() == ["fa#2", "ea#1.1"]
    stage.at(200).leave("fa")
    stage.request("fa", say("b"), say("c"), state=2, cause=1)
    stage.at(300).end("fa#2")
    assert stage.select() == ["fa#3"]
    stage.request("xa", command("turn", angle=10), cause=2)
    stage.at(500).end("ea#1.1", goal=False, x=2.0, y=0.0, heading=0.0)
    assert stage.select() == ["xa#1"]
    stage.at(600).end("fa#3")
    stage.select()
    stage.at(700).end("xa#1", x=5.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#1.2"]
    assert [r["behavior"] for r in stage.phases("request") if r.get("inserted")] == ["fa#5"]
    assert stage.floor == ["fa:1", "ea:1"], "the way back waits for the wheels that ea takes (F3)"


def ends(stage: Stage, behavior: str, x: float, y: float) -> None:
    """An AB ends with the robot at a place."""
    stage.end(behavior, x=x, y=y, heading=0.0)
    stage.select()


def test_x1_a_unit_that_goes_on_beneath_the_floor_does_not_resume_its_stream() -> None:
    # F1 lets the unit finish. Its second Command counts as if the suspended stream had
    # resumed, so that nothing is restored when it does.
    stage = Stage("prima+x1")
    stage.request("ea", move(), Group(chain(say("One."), say("Two."))), say("Three."))
    stage.select()
    ends(stage.at(500), "ea#1.1", 4.0, 1.0)
    stage.request("fa", command("set-speed-and-time", speed=0.3, time="1s"), cause=1)
    stage.select()
    stage.at(600).end("ea#4")
    stage.select()
    stage.at(700).end("ea#5")
    stage.select()
    ends(stage.at(900), "fa#1", 0.0, 0.0)
    assert check(stage.records, "prima+x1") == []


def test_x1_a_held_stream_that_was_suspended_is_restored_too() -> None:
    # A reaction breaks in while nothing of the held stream is in working memory.
    stage = Stage("prima+x1+x3")
    stage.request("ea", move(), say("One."), hold=5000)
    stage.select()
    ends(stage.at(500), "ea#1.1", 4.0, 1.0)
    stage.at(600).end("ea#2")
    stage.select()
    stage.at(700).request("fa", command("set-speed-and-time", speed=0.3, time="1s"), cause=1)
    stage.select()
    ends(stage.at(900), "fa#1", 0.0, 0.0)
    stage.at(1000).request("ea", say("Two."), cause=2)
    stage.select()
    assert check(stage.records, "prima+x1+x3") == []


def test_x1_branches_go_back_once() -> None:
    # Each branch of the suspended stream is given a way back of its own.
    stage = Stage("prima+x1")
    steps = [
        Step(move()),
        Step(say("One."), (0,)),
        Step(say("Two."), (1,)),
        Step(command("gesture", name="nod"), (1,)),
    ]
    stage.request("ea", steps=steps)
    stage.select()
    ends(stage.at(500), "ea#1.1", 4.0, 1.0)
    stage.request("fa", command("set-speed-and-time", speed=0.3, time="1s"), cause=1)
    stage.select()
    stage.at(700).end("ea#2")
    stage.select()
    ends(stage.at(900), "fa#1", 0.0, 0.0)
    assert check(stage.records, "prima+x1") == []


def test_a_way_back_that_is_put_in_gives_up_neither_channel_nor_conversation() -> None:
    # X1 puts a move, which leaves the user, before a conversation that resumes. K1 then took
    # the stream for one that leaves him anyway, and another application's move went off; and F2
    # took its place for a low one, so that neither went on where K1 kept the other.
    sensing = "active-sensing-human"
    talk = Ask(("q-and-a", "q-and-a", sensing), ((), (), ()))
    reaction = Ask((sensing, sensing, "topological-move"), ((), (), ()))
    asked = (Ask(("set-position",), ((),)), talk, Ask((sensing,), ((),)))
    script = Script(
        ((), ()), ((0, ((), ())), (0, (asked, ())), (4000, ((), (reaction,)))), (), World()
    )
    for policy in ("prima+x1", "prima+all"):
        run = drive(script, policy)
        assert check(run.records, policy) + run.problems == []
        assert run.complete


def test_x1_of_a_way_back_a_robot_does_what_it_can() -> None:
    """It cannot go to a position, but turn its head."""
    table = {name: row for name, row in TABLE_4_2.items() if not name.startswith("set-")}
    stage = Stage("prima+x1", table=table)
    stage.request("ea", move(), command("move-head", pan=30), say("First."), say("Second."))
    stage.select()
    stage.at(500).end("ea#1.1", x=4.0, y=1.0, heading=90.0)
    stage.select()
    stage.at(600).end("ea#2")
    stage.select()
    stage.request("fa", steps=[Step(command("turn", angle=9)), Step(NOD)], cause=EVENT)
    stage.select()
    stage.at(700).end("fa#1", x=0.0, y=0.0, heading=0.0)
    stage.at(800).end("fa#2")
    stage.at(1000).end("ea#3")
    stage.select()
    assert inserted(stage) == [("X1", "move-head")]


def test_x1_a_way_back_that_was_not_undone_is_not_gone_again() -> None:
    stage = turned_away(say("Second."), 4.0, 1.0, 0.0)
    assert inserted(stage) == [("X1", "set-position-and-direction")]
    stage.at(2000).request("fa", say("Oh!"), cause=EVENT + 1)
    stage.select()
    stage.at(2500).end("ea#5.1", goal=False, x=2.0, y=1.0, heading=0.0)
    stage.select()
    stage.at(3000).end("fa#2")
    stage.select()
    assert len(inserted(stage)) == 1
