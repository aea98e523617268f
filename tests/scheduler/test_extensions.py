"""Extensions X4 to X6, and all together: the channel connected, motions composed, fewer restrictions."""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

import pytest

from prima.invariants import check
from prima.language.commands import TABLE_4_2, Argument, CommandType
from prima.messages import (
    Command,
    Step,
)
from tests.helpers.generated.scripts import Ask, Leave, Script, drive
from tests.helpers.generated.world import TABLE, World
from tests.helpers.stage import Stage, ask, command, inserted, move, restartable, say, search

EVENT, LATER = 7, 8
ALL = "prima+all"


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


def test_x4_the_robot_turns_if_the_user_goes_while_the_first_word_waits() -> None:
    stage = Stage("prima+x4")
    stage.mediator.sees_user(True)
    stage.request("ea", say("A long story."))
    stage.select()
    stage.request("fa", ask("What is it?"), connect=True)
    assert stage.select() == [] and inserted(stage) == [], "the user is there, the speaker is not"
    stage.mediator.sees_user(False)
    stage.at(900).end("ea#1")
    assert stage.select() == ["fa#2"]
    assert inserted(stage) == [("X4", "face-human")]


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


def test_x4_a_robot_with_something_else_for_the_turn_speaks_without_it_too() -> None:
    table = dict(TABLE_4_2)
    table["face-human"] = replace(table["face-human"], substitute="stop-moving")
    stage = Stage("prima+x4", table=table)
    stage.request("fa", say(), connect=True)
    assert stage.select() == ["fa#1"] and inserted(stage) == []


def test_x4_with_x2_the_first_word_waits_for_the_turn_and_the_story_for_both() -> None:
    stage = Stage("prima+x2+x4")
    stage.request("ea", restartable(say("A long story.")))
    stage.select()
    stage.request("fa", ask("Yes?"), cause=EVENT, connect=True)
    assert stage.select() == ["fa#2"]
    assert stage.running == {"fa#2"}


def test_x4_what_the_same_stream_keeps_after_the_turn_is_held_anew() -> None:
    stage = Stage("prima+x4", {"fa": "fa", "ea": "ea", "third": "ea"})
    stage.request("third", command("point-by-hand", angle=0), cause=EVENT)
    stage.select()
    stage.request("ea", ask("Yes?"), connect=True)
    stage.select()
    assert stage.holds("ea#1") == ["F2"]
    stage.request("ea", command("move-head", pan=9), cause=EVENT + 1)
    assert stage.select() == ["ea#2", "ea#3"], "it has the floor, and turns for the question"
    stage.at(500).end("ea#2")
    stage.select()
    stage.at(900).end("ea#3")
    assert stage.select() == [] and stage.floor == ["third:1"]
    assert stage.holds("ea#1") == ["F2", "F2"]


def test_x4_what_is_put_in_ranks_where_that_ranks_which_it_was_put_in_for() -> None:
    lead = CommandType("lead", "Lead", "", frozenset({"locomotion"}), leaves=True, text="required")
    stage = Stage("prima+x4", table={**TABLE_4_2, "lead": lead})
    stage.request("fa", command("turn", angle=5))
    stage.select()
    stage.request("fa", command("lead", "This way."), cause=EVENT, connect=True)
    stage.request("fa", command("turn-and-speak", "Here.", angle=9), cause=EVENT, connect=True)
    assert stage.select() == []
    # The second reaction has the higher priority, so that the robot turns for it first.
    assert [r["before"] for r in stage.phases("request") if r.get("inserted")] == ["fa#3", "fa#2"]
    stage.at(500).end("fa#1")
    assert stage.select() == ["fa#5"]
    assert stage.rule("fa#5") == "S2f", "the first reaction was requested first"


def test_x4_the_robot_turns_to_the_user_once_before_the_first_word() -> None:
    """It turned before what comes before that word, and before a branch without words, too."""
    stage = Stage("prima+x4")
    stage.request("fa", command("turn", angle=150), say("One."), say("Two."), connect=True)
    assert stage.select() == ["fa#1"]
    stage.at(500).end("fa#1")
    assert stage.select() == ["fa#4"] and inserted(stage) == [("X4", "face-human")]
    stage.at(900).end("fa#4")
    assert stage.select() == ["fa#2"]
    stage.at(1500).end("fa#2")
    assert stage.select() == ["fa#3"]
    branches = [Step(say("First.")), Step(command("gesture", name="bow"))]
    stage.at(2000).end("fa#3")
    stage.request("fa", steps=branches, connect=True)
    assert stage.select() == ["fa#7", "fa#6"], "the gesture says nothing"
    stage.at(2500).end("fa#7")
    assert stage.select() == ["fa#5"]
    assert len(inserted(stage)) == 2 and check(stage.records, "prima+x4") == []


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
    assert [order.beside for order in stage.orders] == [False, True]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"]
    assert stage.rule("ea#1.2") == "X5"
    stage.at(900).end("fa#1")
    stage.select()
    stage.request("fa", command("turn", angle=90), cause=LATER)
    assert stage.select() == [], "the move has the locomotion for itself again"
    stage.at(1000).end("ea#1.2", goal=False)
    assert stage.select() == ["fa#2"]


def test_x5_is_the_rule_of_a_composed_start_without_a_floor() -> None:
    stage = Stage("prima+x5", table=DANCING)
    stage.request("ea", move())
    stage.select()
    stage.request("fa", Command("dance"))
    assert stage.select() == ["fa#1"] and stage.floor == []
    assert stage.rule("fa#1") == "X5", "S4 concerns ABs without a common device"


def test_x5_who_has_the_floor_is_active_though_a_loop_of_the_move_started_later() -> None:
    stage = dancing("prima+x5")
    stage.select()
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"]
    active = stage.mediator.memory.active
    assert active is not None and active.name == "fa"


def test_x5_when_the_dance_ends_the_move_keeps_the_wheels() -> None:
    stage = dancing("prima+x5")
    assert stage.select() == ["fa#1"]
    stage.at(400).end("fa#1")
    stage.select()
    stage.request("fa", command("turn", angle=90), cause=LATER)
    assert stage.select() == [] and stage.running == {"ea#1.1"}


def test_x5_is_off_unless_it_is_asked_for() -> None:
    stage = dancing("prima")
    assert stage.select() == []
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1"]
    assert stage.holds("ea#1.1") == ["F2"]


def test_x5_a_move_is_composed_with_no_stream_that_is_held() -> None:
    stage = Stage("prima+x3+x5", table=DANCING)
    stage.request("fa", say("Yes?"), cause=EVENT, hold=5000)
    stage.select()
    stage.at(1000).end("fa#1")
    stage.request("ea", move())
    assert stage.select() == []
    assert stage.holds("ea#1") == ["F2"]


def test_x5_a_move_is_composed_with_no_dance_that_waits() -> None:
    stage = Stage("prima+x5", {"fa": "fa", "ea": "ea", "third": "ea"}, DANCING)
    stage.request("third", command("point-by-hand", angle=9))
    stage.select()
    stage.request("fa", steps=[Step(say("Look!")), Step(Command("dance"))], cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    stage.request("ea", move())
    assert stage.select() == []
    assert (stage.holds("fa#2"), stage.holds("ea#1")) == (["S1"], ["F2"])


def test_x5_lets_a_move_start_also_beside_a_dance_on_the_spot() -> None:
    sway = replace(DANCE, name="sway", devices=frozenset({"neck", "arm"}))
    stage = Stage("prima+x5", table={**TABLE_4_2, "sway": sway})
    stage.request("fa", Command("sway"), cause=EVENT)
    stage.select()
    stage.request("ea", move())
    assert stage.select() == ["ea#1.1"] and stage.floor == ["fa:1"]
    assert stage.rule("ea#1.1") == "X5", "F2 would have kept it"
    assert check(stage.records, "prima+x5") == []


def test_x5_what_is_no_move_waits_for_the_dance() -> None:
    stage = dancing("prima+x5")
    stage.select()
    stage.at(500).end("ea#1.1", goal=True)
    assert stage.select() == [], "the arrival's words belong to a suspended stream"
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#2"]


def test_x5_a_dance_that_tells_something_as_well_carries_nobody() -> None:
    stage = Stage("prima+x5", table=DANCING)
    stage.request("ea", move())
    stage.select()
    stage.request("fa", steps=[Step(Command("dance")), Step(say("La."))], cause=EVENT)
    assert stage.select() == ["fa#1", "fa#2"]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == []
    assert stage.holds("ea#1.1")[-1] == "F2"


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
    stage = Stage("prima", table=laser_table(), refuses=True)
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
        rests_on = {"restartable", "hold", "connect", "motion", "spans"}
        runs.append([{k: v for k, v in r.items() if k not in rests_on} for r in stage.records])
    assert runs[0] == runs[1]


def test_x5_two_dances_are_not_composed_with_one_move() -> None:
    # The move that has started last hides the first dance from the second.
    stage = Stage("prima+x5", table=TABLE)
    stage.request("ea", Command("dance"))
    stage.select()
    stage.at(50).request("ea", move(), cause=1)
    stage.select()
    stage.at(100).request("fa", Command("spin"), cause=2)
    stage.select()
    assert check(stage.records, "prima+x5") == []


def test_x5_two_moves_are_not_composed_with_one_dance() -> None:
    stage = Stage("prima+x5", table=TABLE)
    stage.request("ea", move())
    stage.select()
    stage.at(50).request("fa", Command("waltz"), cause=1)
    stage.select()
    stage.at(100).request("ea", command("set-position", x=1, y=1), cause=2)
    stage.select()
    assert check(stage.records, "prima+x5") == []


def test_a_word_waits_for_the_user_also_while_the_way_back_is_gone() -> None:
    # X4 was left out while something that X1 had put in for another branch was there.
    sensing = Ask(("active-sensing-human",), ((),))
    first = Ask(("face-human", "active-sensing-human"), ((), ()))
    asked = (
        Ask((("face-human",), "q-and-a"), ((), ()), connect=True),
        Ask(("q-and-a",), ((),), connect=True),
    )
    script = Script(
        ((), (), ()),
        ((0, ((first,), (), (sensing,))), (0, ((sensing, sensing), (), asked))),
        (),
        World(),
    )
    for policy in ("prima+x1+x4", "prima+all"):
        run = drive(script, policy)
        assert check(run.records, policy) + run.problems == []


def test_x2_a_question_that_is_asked_again_is_said_to_its_end() -> None:
    """It listened when it was broken off, and speaks when its state is left."""
    question = Ask(("q-and-a",), ((),))
    asks = (Ask(("move-head",), ((),)), replace(question, restartable=True))
    script = Script(
        ((), ()),
        ((0, (asks, ())), (5000, ((), (question,))), (9000, ((Leave(),), ()))),
        (),
        World(),
    )
    run = drive(script, "prima+x2")
    assert check(run.records, "prima+x2") == []
    phases = [one["phase"] for one in run.records if one.get("behavior") == "fa#2"]
    assert phases.index("listening") < phases.index("interrupt")
    assert phases[-3:] == ["start", "listening", "cancel"], "as the state was left meanwhile"


def test_x4_a_third_turn_that_was_broken_off_is_begun_already() -> None:
    """X7 lets it go before the turn to the user; X2 breaks it off, and it goes on without."""
    stage = Stage("prima+x2+x4+x7")
    stage.request("ea", ask())
    stage.select()
    stage.at(1000).mediator.ended("ea#1", True, {"outcome": "filled"}, inbound=False)
    word = restartable(say("Thank you."))
    stage.settle(lambda: stage.request("ea", word, connect=True))
    assert stage.select() == ["ea#2"]
    stage.at(1100).request("fa", say("Ouch."), cause=EVENT)
    assert stage.select() == ["fa#1"] and len(stage.phases("interrupt")) == 1
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#2"]
    assert inserted(stage) == []
