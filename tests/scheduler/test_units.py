"""Information Units (rules U): ABs, trees, groups and units that span questions.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from dataclasses import replace

from prima.invariants import check
from prima.language.commands import TABLE_4_2
from prima.messages import (
    Command,
    Group,
    OpenUnit,
    Step,
)
from tests.helpers.generated.scripts import Ask, Go, Open, Script, drive
from tests.helpers.generated.world import World
from tests.helpers.stage import Stage, ask, chain, command, move, say, search

EVENT = 7


def test_u1_a_command_makes_one_ab() -> None:
    stage = Stage()
    stage.request("ea", say())
    assert stage.select() == ["ea#1"]


def test_u2_a_feedback_command_makes_one_ab_a_loop_until_its_goal() -> None:
    stage = Stage()
    stage.request("ea", move(), say())
    assert stage.select() == ["ea#1.1"]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["ea#1.2"]
    stage.at(1000).end("ea#1.2", goal=True)
    assert stage.select() == ["ea#2"]


def test_u2_the_end_of_a_loop_that_is_over_ends_no_other() -> None:
    stage = Stage()
    stage.request("ea", move(), say())
    stage.select()
    stage.at(500).end("ea#1.1", goal=False)
    stage.select()
    assert not stage.mediator.ended("ea#1.1", True, {})
    assert stage.select() == [] and stage.running == {"ea#1.2"}


def test_u2_what_makes_no_loops_ends_though_its_goal_is_not_reached() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(500).end("ea#1", goal=False)
    assert stage.select() == ["ea#2"]


def test_u4_a_unit_ends_with_its_commands_whatever_devices_report() -> None:
    stage = Stage()
    stage.request("ea", Group(chain(say("One."), say("Two."))))
    assert stage.select() == ["ea#1", "ea#2"]
    assert not stage.mediator.ended("ea#1", True, {})
    stage.mediator.failed("ea#1", "speaker", "broken")
    assert stage.select() == [] and stage.running == {"ea#1", "ea#2"}
    stage.at(500).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.at(900).end("ea#3")
    stage.select()
    [end] = [r for r in stage.phases("end") if r["behavior"] == "ea#1"]
    assert end["outcome"] == "done"


def test_u5_a_unit_that_is_left_finishes_what_runs_and_tells_nobody() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.request("ea", say("One."), say("Two."), say("Three."), unit=1)
    stage.select()
    stage.close("ea", 1)
    assert stage.select() == [] and stage.running == {"ea#1", "ea#2"}
    assert [(r["behavior"], r["outcome"]) for r in stage.phases("cancel")] == [
        ("ea#4", "linked"),
        ("ea#3", "linked"),
    ]
    stage.at(500).end("ea#2")
    stage.select()
    assert stage.running == set() and stage.told("ea") == []


def test_u2_a_feedback_command_that_was_interrupted_starts_afresh() -> None:
    stage = Stage()
    stage.request("ea", search("Where are you?"))
    stage.select()
    stage.request("fa", ask(), cause=EVENT)
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == ["fa#1"]
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#1.2"]
    assert [order.resumed for order in stage.orders if order.behavior == "ea#1.2"] == [True]


def test_u3_branches_share_a_parent_and_what_follows_waits_for_all() -> None:
    stage = Stage()
    steps = [
        Step(say()),
        Step(command("move-head", pan=10), (0,)),
        Step(command("point-by-hand", angle=0), (0,)),
        Step(say("Done."), (1, 2)),
    ]
    stage.request("ea", steps=steps)
    assert stage.select() == ["ea#1"]
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2", "ea#3"]
    stage.at(20).end("ea#3")
    assert stage.select() == []
    stage.at(30).end("ea#2")
    assert stage.select() == ["ea#4"]


def test_u3_branches_that_share_a_device_run_in_document_order() -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(say("One.")), Step(say("Two."))])
    assert stage.select() == ["ea#1"]
    stage.at(10).end("ea#1")
    assert stage.select() == ["ea#2"]


def test_u4_a_group_is_one_ab_with_the_devices_of_all_branches() -> None:
    stage = Stage()
    group = Group([Step(say()), Step(command("gesture", name="nod"), (0,))])
    stage.request("ea", group)
    stage.request("fa", command("move-head", pan=5), cause=EVENT)
    # The reaction ranks first, so it has the neck; the group waits for all its devices.
    assert stage.select() == ["fa#1"]
    stage.at(10).end("fa#1")
    assert stage.select() == ["ea#1", "ea#2"]
    stage.request("fa", command("move-head", pan=0), cause=EVENT + 1)
    stage.at(20).end("ea#2")
    assert stage.select() == ["ea#3"], "the neck belongs to the group until its end"
    stage.at(30).end("ea#3")
    assert stage.select() == ["fa#2"]


def test_u4_neither_feedback_nor_leaving_commands_stand_in_a_group() -> None:
    stage = Stage(refuses=True)
    stage.request("ea", Group([Step(say()), Step(move(), (0,))]))
    assert stage.select() == []
    assert stage.told("ea") == ["error.semantic"]


def test_u5_a_unit_spans_requests_and_owns_its_devices_until_it_is_left() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=1)
    assert stage.select() == ["ea#1", "ea#2"]
    stage.request("fa", say(), cause=EVENT)
    stage.at(10).end("ea#2", then=lambda: stage.request("ea", say("Thanks."), unit=1))
    assert stage.select() == ["ea#3"]
    stage.at(20).end("ea#3", then=lambda: stage.close("ea", 1))
    assert stage.select() == ["fa#1"]


def test_u5_what_runs_finishes_when_the_unit_is_left_and_the_rest_is_deleted() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker")
    stage.request("ea", say("One."), say("Two."), unit=1)
    stage.select()
    stage.request("fa", say("Me."), cause=EVENT)
    stage.at(5).close("ea", 1)
    assert stage.select() == []
    stage.at(10).end("ea#2")
    assert stage.select() == ["fa#1"]
    assert [r["behavior"] for r in stage.phases("cancel")] == ["ea#3"]


def test_u5_a_unit_that_takes_too_long_ends_and_its_application_is_told() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", longest=1000)
    stage.request("ea", say(), unit=1)
    stage.select()
    assert stage.mediator.deadline() == 1000
    stage.at(1000).mediator.expire()
    stage.select()
    assert "error.unit.timeout" in stage.told("ea")
    assert stage.running == {"ea#1", "ea#2"}, "the Command that runs finishes"
    stage.at(1500).end("ea#2")
    stage.select()
    assert stage.running == set()


def test_u5_a_unit_that_was_left_has_no_time_to_keep() -> None:
    """What takes its place is not deleted, and nobody hears that it took too long."""
    stage = Stage()
    stage.open("ea", 1, "speaker", longest=2000)
    stage.request("ea", say("Long."), unit=1)
    stage.select()
    stage.at(1500).leave("ea")
    stage.close("ea", 1)
    stage.request("ea", say("On."), state=2)
    assert stage.select() == [] and stage.running == {"ea#1", "ea#2"}
    assert stage.mediator.deadline() != 2000
    stage.at(2000).mediator.expire()
    stage.at(3000).end("ea#2")
    assert stage.select() == ["ea#3"]
    assert stage.phases("fail") == [] and stage.told("ea") == []
    assert check(stage.records) == []


def test_u4_a_group_whose_state_was_left_keeps_its_time() -> None:
    """It ends, as it would else; what takes its place is not deleted, and nobody hears of it."""
    stage = Stage()
    stage.request("ea", Group(chain(say("One."), say("Two."), say("Three.")), longest=2000))
    stage.select()
    stage.at(1500).leave("ea")
    stage.request("ea", say("On."), state=2)
    stage.at(1700).end("ea#2")
    assert stage.select() == ["ea#3"], "a group is not cut by leaving"
    assert stage.mediator.deadline() == 2000
    stage.at(2000).mediator.expire()
    assert stage.select() == [] and stage.mediator.deadline() != 2000
    stage.at(2500).end("ea#3")
    assert stage.select() == ["ea#5"]
    [failed] = stage.phases("fail")
    assert (failed["behavior"], failed["rule"]) == ("ea#1", "U5") and stage.told("ea") == []
    assert check(stage.records) == []


def test_u6_a_running_ab_is_not_interrupted_by_another_application() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    stage.request("fa", say(), cause=EVENT)
    assert stage.select() == []
    assert stage.running == {"ea#1"}


def test_u5_a_command_that_needs_another_device_is_refused_in_a_unit() -> None:
    stage = Stage(refuses=True)
    stage.open("ea", 1, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=1)
    stage.request("ea", command("turn", angle=90), unit=1)
    stage.select()
    assert stage.told("ea") == ["error.semantic"]
    assert "locomotion" in stage.notices[-1][1].message


def test_u5_a_command_that_leaves_or_loops_is_refused_in_a_unit() -> None:
    for what in (command("set-position", x=1, y=1), command("tracking-human")):
        stage = Stage()
        stage.open("ea", 1, "speaker", "locomotion", "localization", "human-detection")
        stage.request("ea", what, unit=1)
        stage.settle()
        assert stage.told("ea") == ["error.semantic"], what


def test_u5_what_is_inside_a_linked_unit_holds_nobody_back() -> None:
    stage = Stage()
    stage.request("ea", command("face-human"), move(), cause=EVENT)
    assert stage.select() == ["ea#1"], "it has the floor, and engages the user"
    stage.open("ea", 1, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=1)
    stage.request("fa", say(), cause=EVENT + 1)
    assert stage.select() == ["fa#1"]
    stage.request("fa", move())
    stage.at(10).end("ea#1")
    stage.select()
    assert stage.mediator.memory.behaviors["ea#3"].state == "linked"
    stage.at(20).end("fa#1")
    assert stage.select() == ["fa#2.1"], "all that contends in the other's stream leaves as well"


def test_a_chain_is_what_a_run_of_commands_becomes() -> None:
    assert [step.after for step in chain(say(), say(), say())] == [(), (0,), (1,)]


def test_u5_a_unit_owns_the_devices_of_what_the_profile_adds() -> None:
    camera = replace(TABLE_4_2["turn"], name="take-picture", devices=frozenset({"camera"}))
    stage = Stage(table={**TABLE_4_2, "take-picture": camera})
    asked = OpenUnit(1, 1, frozenset({"speaker"}), types=("take-picture",))
    stage.mediator.ask("fa", asked)
    stage.select()
    stage.request("ea", Command("take-picture", {"angle": 1}))
    assert stage.select() == []
    stage.request("fa", Command("take-picture", {"angle": 1}), unit=1)
    assert stage.select() == ["fa#2"]


def test_u4_no_feedback_command_of_the_profile_runs_in_a_unit_either() -> None:
    stage = Stage(refuses=True)
    stage.open("fa", 1, "speaker")
    stage.select()
    stage.request("fa", search(), unit=1)
    stage.select()
    assert stage.told("fa") == ["error.semantic"]


def test_a_script_opens_a_unit_and_goes() -> None:
    unit = Open(frozenset({"speaker"}), None)
    asked = Ask(("speak",), ((),))
    run = drive(Script(((), ()), ((1, ((unit, asked, Go()), (asked,))),), (), World()))
    assert check(run.records) + run.problems == []
