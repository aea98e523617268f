"""The extensions X1 to X6, each by its number on the smallest case that shows it."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import pytest

from prima.language.commands import PATIENCE_MS, TABLE_4_2, Argument, CommandType
from prima.messages import Command, Group, Step
from tests.stage import Stage, ask, chain, command, move, say, search

EVENT, LATER = 7, 8
ALL = "prima+all"


def restartable(what: Command) -> Command:
    return replace(what, restartable=True)


def inserted(stage: Stage) -> list[tuple[str, str]]:
    return [
        (record["inserted"], record["command"])
        for record in stage.phases("request")
        if record.get("inserted")
    ]


# X1: resume the robot's state ---------------------------------------------------------


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


def test_x1_who_waits_for_its_own_way_back_is_kept_waiting_by_nobody_else() -> None:
    stage = at_a_panel("prima+x1", say("Second."))
    assert stage.select() == []
    stage.leave("fa")
    stage.at(1500).end("fa#1.1", goal=False, x=0.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#4.1"]
    stage.at(90_000).end("ea#4.1", x=4.0, y=1.0, heading=10.0)
    assert stage.select() == ["ea#3"] and stage.phases("starve") == []


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
    # The head was to move once the robot had turned to the user (X4), when the way back came in.
    stage = Stage("prima+x1+x4")
    stage.request("ea", move())
    stage.select()
    branches = [Step(say("First.")), Step(command("move-head", pan=10))]
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
    assert stage.select() == ["ea#2", "ea#3"]


# X2: interrupt and restart an AB --------------------------------------------------------


def test_x2_a_restartable_ab_gives_way_to_a_reaction_and_starts_again() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")), say("The end."))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500)
    assert stage.select() == ["fa#1"]
    assert [order.verb for order in stage.orders] == ["start", "interrupt", "start"]
    assert [(r["behavior"], r["by"], r["rule"]) for r in stage.phases("interrupt")] == [
        ("ea#1", "fa#1", "X2")
    ]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1"]
    assert [r.get("resumed") for r in stage.phases("start")] == [None, None, True]
    stage.at(1900).end("ea#1")
    assert stage.select() == ["ea#2"]


@pytest.mark.parametrize("policy", ["prima", "prima+x1+x3+x4+x5+x6", "fifo"])
def test_x2_is_off_unless_it_is_asked_for(policy: str) -> None:
    stage = Stage(policy)
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    assert stage.select() == []


def test_x2_what_is_not_marked_is_not_interrupted() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", say("A long story."))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    assert stage.select() == []
    assert stage.holds("fa#1") == ["S1"]


def test_x2_only_a_reaction_interrupts() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"))
    assert stage.select() == []


def test_x2_nothing_is_interrupted_where_that_would_not_be_enough() -> None:
    stage = Stage("prima+x2")
    story = restartable(say("A story."))
    stage.request("ea", steps=[Step(story), Step(command("turn", angle=90))])
    stage.select()
    stage.request("fa", command("turn-and-speak", "Here!", angle=10), cause=EVENT)
    assert stage.select() == []
    assert stage.phases("interrupt") == []


def test_x2_the_application_is_told_how_much_was_heard() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500).select()
    stage.at(501)
    stage.mediator.interrupted("ea#1", {"done": 0.4, "heard": "A long"})
    stage.settle()
    [(name, notice)] = [n for n in stage.notices if n[1].what == "interrupted"]
    assert (name, notice.event) == ("ea", "interrupted.speak")
    assert notice.data == {"done": 0.4, "heard": "A long"}


def test_x2_of_a_unit_the_application_is_told_how_much_was_done_in_all() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", Group(chain(say("One."), say("Two three.")), restartable=True))
    stage.select()
    stage.at(300).end("ea#2")
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500).select()
    stage.at(501)
    stage.mediator.interrupted("ea#3", {"done": 0.5, "heard": "Two"})
    stage.settle()
    [(name, notice)] = [n for n in stage.notices if n[1].what == "interrupted"]
    assert (name, notice.event) == ("ea", "interrupted.iu")
    assert notice.data == {"done": 0.75, "heard": "One. Two"}
    deadlines = stage.mediator.deadline()
    stage.at(900).end("fa#1")
    stage.select()
    assert deadlines == 500 + PATIENCE_MS, "nothing of what was broken off is awaited, but its turn"


def test_x2_a_unit_starts_again_whole() -> None:
    stage = Stage("prima+x2")
    unit = Group(chain(say("One."), say("Two.")), restartable=True)
    stage.request("ea", unit)
    assert stage.select() == ["ea#1", "ea#2"]
    stage.at(300).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.request("fa", ask("Yes?"), cause=EVENT)
    stage.at(500)
    assert stage.select() == ["fa#1"]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1", "ea#4"]
    stage.at(1000).end("ea#4")
    assert stage.select() == ["ea#5"]
    stage.at(1100).end("ea#5")
    stage.settle()
    assert stage.told("ea")[-1] == "done"


# X3: stream hints -------------------------------------------------------------------------


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


def test_x3_it_ends_when_its_state_is_left() -> None:
    stage = held("prima+x3")
    stage.select()
    stage.at(2000).leave("fa")
    assert stage.select() == ["ea#2"]


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


# X4: connect the channel ------------------------------------------------------------------


def test_x4_the_robot_faces_the_user_before_the_first_word() -> None:
    stage = Stage("prima+x4")
    stage.request("fa", ask("What is it?"), cause=EVENT, connect=True)
    assert stage.select() == ["fa#2"]
    assert inserted(stage) == [("X4", "face-human")]
    [asked] = [r for r in stage.phases("request") if r.get("inserted")]
    assert asked["reactive"] and asked["cause"] == EVENT, "it is the reaction's first AB now"
    assert stage.floor == ["fa:1"]
    stage.at(700).end("fa#2")
    assert stage.select() == ["fa#1"]


def test_x4_nothing_is_put_in_where_the_camera_sees_the_user() -> None:
    stage = Stage("prima+x4")
    stage.mediator.sees_user(True)
    stage.request("fa", ask("What is it?"), cause=EVENT, connect=True)
    assert stage.select() == ["fa#1"]


@pytest.mark.parametrize(("policy", "connect"), [("prima", True), ("prima+x4", False)])
def test_x4_is_off_unless_run_and_document_ask_for_it(policy: str, connect: bool) -> None:
    stage = Stage(policy)
    stage.request("fa", ask("What is it?"), cause=EVENT, connect=connect)
    assert stage.select() == ["fa#1"]


def test_x4_a_robot_that_cannot_turn_to_the_user_speaks_without() -> None:
    table = {name: row for name, row in TABLE_4_2.items() if name != "face-human"}
    stage = Stage("prima+x4", table=table)
    stage.request("fa", ask("What is it?"), connect=True)
    assert stage.select() == ["fa#1"]


def test_x4_with_x2_the_first_word_waits_for_the_turn_and_the_story_for_both() -> None:
    stage = Stage("prima+x2+x4")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT, connect=True)
    assert stage.select() == ["fa#2"]
    assert stage.running == {"fa#2"}


def test_x4_what_is_put_in_ranks_where_that_ranks_which_it_was_put_in_for() -> None:
    stage = Stage("prima+x4")
    stage.request("fa", command("turn", angle=5))
    stage.select()
    branches = [Step(move()), Step(command("turn", angle=10))]
    stage.request("fa", steps=branches, cause=EVENT, connect=True)
    assert stage.select() == []
    # The second branch has the higher priority, so that the robot turns for it first.
    assert [r["before"] for r in stage.phases("request") if r.get("inserted")] == ["fa#3", "fa#2"]
    stage.at(500).end("fa#1")
    assert stage.select() == ["fa#5"]
    assert stage.rule("fa#5") == "S2f", "the first branch was requested first"


# X5: compose motions ------------------------------------------------------------------------


DANCE = CommandType(
    "dance", "Dance", "", frozenset({"locomotion", "neck", "arm"}), motion="faithful"
)
DANCING = {**TABLE_4_2, "dance": DANCE}


def dancing(policy: str) -> Stage:
    stage = Stage(policy, table=DANCING)
    stage.request("ea", move(), say("Here we are."))
    stage.select()
    stage.request("fa", Command("dance"), cause=EVENT)
    return stage


def test_x5_a_dance_goes_on_together_with_a_move() -> None:
    stage = dancing("prima+x5")
    assert stage.select() == ["fa#1"]
    assert stage.running == {"ea#1.1", "fa#1"}
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"]
    assert stage.rule("ea#1.2") == "X5"
    stage.at(900).end("fa#1")
    stage.select()
    stage.request("fa", command("turn", angle=90), cause=LATER)
    assert stage.select() == [], "the move has the locomotion for itself again"
    stage.at(1000).end("ea#1.2", goal=False)
    assert stage.select() == ["fa#2"]


def test_x5_is_off_unless_it_is_asked_for() -> None:
    stage = dancing("prima")
    assert stage.select() == []
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1"]


def test_x5_what_is_no_move_waits_for_the_dance() -> None:
    stage = dancing("prima+x5")
    stage.select()
    stage.at(500).end("ea#1.1", goal=True)
    assert stage.select() == [], "the arrival's words belong to a suspended stream"
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#2"]


def test_x5_a_dancer_who_talks_with_the_user_is_not_carried_away() -> None:
    stage = Stage("prima+x5", table=DANCING)
    stage.request("ea", move())
    stage.select()
    stage.request("fa", command("face-human"), Command("dance"), cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False)
    stage.select()
    stage.at(900).end("fa#1")
    assert stage.select() == ["fa#2"]
    assert stage.holds("ea#1.1")[-1] == "K1"


# X6: fewer restrictions -------------------------------------------------------------------


def laser_table() -> dict[str, CommandType]:
    arguments = {
        "angle": Argument("number", ""),
        "toward": Argument("id", ""),
    }
    laser = CommandType(
        "point-by-laser", "Laser", "", frozenset({"laser"}), arguments=MappingProxyType(arguments)
    )
    table = {**TABLE_4_2, laser.name: laser}
    table["point-by-hand"] = replace(table["point-by-hand"], substitute=laser.name)
    return table


def test_x6_a_substitute_takes_the_place_of_what_the_robot_lacks() -> None:
    stage = Stage("prima+x6", table=laser_table())
    stage.request("ea", command("point-by-hand", toward="panel"))
    assert stage.select() == ["ea#1"]
    [record] = stage.phases("start")
    assert (record["command"], record["devices"]) == ("point-by-laser", ["laser"])
    [record] = stage.phases("substitute")
    assert (record["command"], record["by"], record["rule"]) == (
        "point-by-hand",
        "point-by-laser",
        "X6",
    )


def test_x6_without_it_the_application_is_told() -> None:
    stage = Stage("prima", table=laser_table())
    stage.request("ea", command("point-by-hand", toward="panel"))
    assert stage.select() == []
    assert stage.told("ea") == ["error.unsupported.point-by-hand"]


def test_x6_three_applications_are_mediated_by_the_same_rules() -> None:
    stage = Stage("prima", apps={"fa": "fa", "museum": "ea", "shop": "ea"})
    stage.request("museum", say("A panel."), say("Another."))
    stage.select()
    stage.request("shop", say("A sale!"), cause=EVENT)
    stage.request("fa", ask("Yes?"), cause=LATER)
    stage.at(100).end("museum#1")
    assert stage.select() == ["fa#1"]
    assert stage.floor == ["fa:1"]
    stage.at(200).end("fa#1")
    assert stage.select() == ["shop#1"]
    stage.at(300).end("shop#1")
    assert stage.select() == ["museum#2"]


def test_all_extensions_together_leave_a_plain_run_as_it_is() -> None:
    runs = []
    for policy in ("prima", ALL):
        stage = Stage(policy)
        stage.request("ea", say("Welcome."), move(), say("Here."))
        stage.select()
        stage.request("fa", ask("Yes?"), search(), cause=EVENT)
        stage.at(100).end("ea#1")
        stage.select()
        stage.at(200).end("fa#1")
        stage.select()
        rests_on = {"restartable", "hold", "connect", "motion"}
        runs.append([{k: v for k, v in r.items() if k not in rests_on} for r in stage.records])
    assert runs[0] == runs[1]


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
