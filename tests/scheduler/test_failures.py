"""When things go wrong (rules E): failures, ends, bad Commands, starvation, emergencies.

Each rule by its number, on the smallest case that shows it.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from prima.invariants import check
from prima.language.commands import TABLE_4_2
from prima.messages import (
    Command,
    Emergency,
    Group,
    Occurred,
    Step,
)
from tests.helpers.generated.plays import perform
from tests.helpers.plays import play
from tests.helpers.stage import TRACK, Stage, chain, command, move, say

EVENT = 7
BRIEF = Command("q-and-a", {"timeout": "500ms"}, "Well?")


def test_e1_a_failing_device_ends_the_ab_and_the_rest_of_its_tree() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.request("fa", say("Me."))
    stage.select()
    stage.at(10).mediator.failed(min(stage.running), "speaker", "broken")
    stage.settle()
    assert "error.device.speaker" in stage.told("fa")
    assert stage.select() == ["ea#1"]


def test_e1_what_was_left_fails_alone() -> None:
    """Nobody hears of it (O3), and what has come in its place goes on."""
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(5).leave("ea")
    stage.request("ea", say("On."), state=2)
    stage.select()
    stage.at(10).mediator.failed("ea#1", "speaker", "broken")
    stage.settle()
    assert stage.told("ea") == []
    assert stage.select() == ["ea#3"]
    assert check(stage.records) == []


def test_e1_what_was_cancelled_fails_alone() -> None:
    """A Command with order="now" has taken its place (O2)."""
    stage = Stage()
    stage.request("ea", steps=[Step(say("Long.")), Step(command("move-head", pan=1))])
    stage.select()
    stage.at(5).request("ea", replace(command("move-head", pan=9), now=True), say("On."))
    assert stage.select() == ["ea#3"]
    stage.at(10).mediator.failed("ea#1", "speaker", "broken")
    stage.at(20).end("ea#3")
    assert stage.select() == ["ea#4"]
    assert "error.device.speaker" not in stage.told("ea")
    assert check(stage.records) == []


def test_e1_what_was_requested_later_in_the_tree_is_cancelled() -> None:
    stage = Stage()
    stage.request("ea", say("One."))
    stage.select()
    stage.request("ea", say("Two."), say("Three."))
    stage.select()
    stage.at(10).mediator.failed("ea#1", "speaker", "broken")
    assert stage.select() == []
    assert [(r["behavior"], r["outcome"]) for r in stage.phases("cancel")] == [
        ("ea#3", "linked"),
        ("ea#2", "waiting"),
    ], "what follows is deleted before it could wait itself"
    assert sorted(stage.told("ea")) == ["cancel.speak", "cancel.speak", "error.device.speaker"]


def test_e1_a_failed_trees_loops_end() -> None:
    """Its feedback Commands' next loops have not started, whether one runs or waits."""
    stage = Stage()
    stage.request("ea", steps=[Step(say("One.")), Step(TRACK)])
    assert stage.select() == ["ea#1", "ea#2.1"]
    stage.at(10).mediator.failed("ea#1", "speaker", "broken")
    assert stage.select() == []
    stage.at(500).end("ea#2.1", goal=False)
    assert stage.select() == []
    assert [stop["behavior"] for stop in stage.phases("stop")] == ["ea#2.1"]
    assert stage.told("ea") == ["error.device.speaker"]
    assert check(stage.records) == []


def test_e1_a_failed_trees_loops_end_though_a_later_branch_runs() -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(say("One.")), Step(TRACK), Step(command("move-head", pan=1))])
    assert stage.select() == ["ea#1", "ea#2.1", "ea#3"]
    stage.at(10).mediator.failed("ea#1", "speaker", "broken")
    stage.at(500).end("ea#2.1", goal=False)
    assert stage.select() == []
    stage.at(600).end("ea#3")
    assert check(stage.records) == []


def test_e1_of_another_requests_loops_that_end_the_application_hears() -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(say("One.")), Step(command("move-head", pan=1))])
    stage.select()
    stage.at(5).end("ea#2", then=lambda: stage.request("ea", replace(TRACK, now=True)))
    assert stage.select() == ["ea#3.1"]
    stage.at(10).mediator.failed("ea#1", "speaker", "broken")
    stage.at(500).end("ea#3.1", goal=False)
    assert stage.select() == []
    assert stage.told("ea") == ["ended", "cancel.tracking-human", "error.device.speaker"]
    assert check(stage.records) == []


def test_e1_of_a_loop_that_was_left_the_application_does_not_hear() -> None:
    """What fails was requested later and continues the stream (O3)."""
    stage = Stage()
    stage.request("ea", TRACK)
    stage.select()
    stage.at(5).leave("ea")
    stage.request("ea", say("Ouch."), cause=EVENT, state=2)
    assert stage.select() == ["ea#2"]
    assert [r["tree"] for r in stage.phases("request")] == ["ea:1", "ea:1"]
    stage.at(10).mediator.failed("ea#2", "speaker", "broken")
    assert stage.select() == []
    assert stage.told("ea") == ["error.device.speaker"]
    stage.at(500).end("ea#1.1", goal=False)
    assert stage.select() == []
    assert check(stage.records) == []


def test_e1_a_unit_that_has_begun_is_finished_whole() -> None:
    stage = Stage()
    unit = Group(chain(say("One."), say("Two.")))
    stage.request("ea", steps=[Step(unit), Step(command("turn", angle=5))])
    assert stage.select() == ["ea#1", "ea#3", "ea#2"]
    stage.at(10).mediator.failed("ea#2", "locomotion", "broken")
    stage.select()
    stage.at(500).end("ea#3")
    assert stage.select() == ["ea#4"]


def test_e1_a_device_that_hangs_past_its_limit_has_failed() -> None:
    stage = Stage()
    stage.request("ea", say())
    stage.select()
    due = stage.mediator.deadline()
    assert due is not None
    stage.at(due).mediator.expire()
    stage.settle()
    assert stage.told("ea") == ["error.device.speaker"]
    assert stage.running == set()


def test_e1_a_failure_is_recorded_with_its_rule_its_device_and_who_noticed_it() -> None:
    reported, hangs = Stage(), Stage()
    for stage in (reported, hangs):
        stage.request("ea", say("One."))
        stage.select()
    reported.at(10).mediator.failed("ea#1", "speaker", "broken")
    reported.select()
    hangs.at(600_000).mediator.expire()
    hangs.select()
    [first], [second] = reported.phases("fail"), hangs.phases("fail")
    assert (first["rule"], first["device"], first["inbound"]) == ("E1", "speaker", True)
    assert (second["rule"], second["device"]) == ("E1", "speaker") and second.get("inbound") is None


def test_e1_what_has_failed_is_not_done_when_its_other_branch_ends() -> None:
    stage = Stage()
    stage.request("ea", steps=[Step(say("One.")), Step(command("turn", angle=5))])
    stage.select()
    stage.at(10).mediator.failed("ea#2", "locomotion", "broken")
    stage.at(500).end("ea#1")
    assert [notice.what for _, notice in stage.notices] == ["failed", "ended"]


def test_e1_a_robot_without_the_command_says_so() -> None:
    table = {name: row for name, row in TABLE_4_2.items() if name != "gesture"}
    stage = Stage(table=table, refuses=True)
    stage.request("ea", command("gesture", name="nod"))
    stage.select()
    assert stage.told("ea") == ["error.unsupported.gesture"]


def test_e2_an_unloaded_application_gives_back_what_it_holds() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.request("fa", say("Me."))
    stage.mediator.unload("ea", "crash")
    assert stage.select() == []
    stage.at(10).end("ea#1")
    assert stage.select() == ["fa#1"]


def test_e6_who_is_kept_from_the_speaker_has_a_turn_at_last() -> None:
    stage = Stage(patience=5000)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(1).request("fa", say("One."), say("Two."))
    stage.select()
    for number in range(1, 20):
        stage.at(1000 * number)
        stage.end(f"ea#{number}", then=lambda: stage.request("ea", say("On.")))
        if (started := stage.select()) != [f"ea#{number + 1}"]:
            break
    assert started == ["fa#1"] and stage.recorder.now == 6000
    assert stage.rule("fa#1") == "E6" and stage.losers("fa#1") == ["ea#7"]
    assert stage.floor == [], "no reaction, so that nobody is suspended"
    assert [(r["time"], r["rule"]) for r in stage.phases("starve")] == [(6000, "E6")]
    stage.at(7000).end("fa#1")
    assert stage.select() == ["fa#2"], "its stream goes on (S2c)"
    stage.at(8000).end("fa#2")
    assert stage.select() == ["ea#7"], "and then the other one"


@pytest.mark.parametrize(("patience", "turns"), [(0, []), (5000, ["fa#1"])])
def test_e6_without_patience_it_waits_for_ever(patience: int, turns: list[str]) -> None:
    stage = Stage(patience=patience)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    found: list[str] = []
    for number in range(1, 9):
        stage.at(1000 * number)
        if f"ea#{number}" in stage.running:
            stage.end(f"ea#{number}", then=lambda: stage.request("ea", say("On.")))
        found += [one for one in stage.select() if one.startswith("fa")]
    assert found == turns


def test_e6_only_the_speaker_counts_and_no_floor() -> None:
    """A reaction's stream has the floor (F2): who waits for that is not kept from the speaker."""
    stage = Stage(patience=5000)
    stage.request("ea", say("Yes?"), say("A"), say("long"), say("story."), cause=EVENT)
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    for number in range(1, 4):
        stage.at(4000 * number).end(f"ea#{number}")
        assert stage.select() == [f"ea#{number + 1}"]
    assert [(r["rule"], r["by"]) for r in stage.phases("starve")] == [("F2", "ea:1")]
    stage.at(16_000).end("ea#4", then=lambda: stage.request("ea", say("Next.")))
    assert stage.select() == ["ea#5"]


def test_e6_a_reaction_goes_first() -> None:
    stage = Stage(patience=1000)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    stage.at(5000).request("ea", say("Ouch."), cause=EVENT)
    stage.end("ea#1")
    assert stage.select() == ["ea#2"]


def answered_late(*branches: Command) -> Stage:
    """The EA's question, beside other Commands, is answered when the FA has waited too long."""
    stage = Stage(patience=1000)
    stage.request("ea", steps=[Step(one) for one in branches])
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    stage.at(5000).mediator.ended("ea#1", True, {"outcome": "filled"}, inbound=False)
    return stage


@pytest.mark.parametrize(
    ("then", "started"),
    [
        (say("Thank you."), ["ea#2"]),
        (BRIEF, ["fa#1"]),
        (command("move-head", pan=1), ["fa#1", "ea#2"]),
    ],
)
def test_e6_after_an_answer_the_asker_has_the_first_word_but_no_question(
    then: Command, started: list[str]
) -> None:
    stage = answered_late(replace(BRIEF))
    stage.settle(lambda: stage.request("ea", replace(then), say("More.")))
    assert stage.select() == started
    if started == ["ea#2"]:
        stage.at(6000).end("ea#2")
        assert stage.select() == ["fa#1"], "before its next sentence"


def test_e6_a_unit_that_asks_behind_its_first_word_counts_as_a_word() -> None:
    stage = answered_late(replace(BRIEF))
    unit = Group(chain(say("Thank you."), replace(BRIEF)))
    stage.settle(lambda: stage.request("ea", unit))
    assert stage.select()[0] == "ea#2"
    assert check(stage.records, "prima", patience=1000) == []


def test_e6_what_has_waited_beside_the_question_is_no_word_to_its_answer() -> None:
    stage = answered_late(replace(BRIEF), say("By the way."))
    assert (stage.select(), stage.rule("fa#1")) == (["fa#1"], "E6")
    assert check(stage.records, "prima", patience=1000) == []


def test_e6_what_comes_beside_the_word_after_an_answer_waits_for_the_turn() -> None:
    """Only that word goes first: the devices of the FA's unit are held back as soon as it starts."""
    stage = Stage(patience=1000)
    stage.request("ea", replace(BRIEF))
    stage.select()
    stage.at(1).request("fa", Group(chain(say("One."), command("turn", angle=1))))
    stage.select()
    stage.at(5000).mediator.ended("ea#1", True, {"outcome": "filled"}, inbound=False)
    beside = [Step(say("Thank you.")), Step(command("turn", angle=2))]
    stage.settle(lambda: stage.request("ea", steps=beside))
    assert stage.select() == ["ea#2"]
    assert stage.holds("ea#3") == ["S3"]
    stage.at(6000).end("ea#2")
    assert stage.select() == ["fa#1", "fa#2"]
    assert check(stage.records, "prima", patience=1000) == []


def test_e6_whoever_may_not_speak_into_a_topic_holds_nothing_back_meanwhile() -> None:
    stage = Stage(apps={"fa": "fa", "ea": "ea", "xa": "ea"}, patience=1000)
    stage.request("xa", command("point-by-hand", angle=1))
    stage.request("ea", say("The answer is"), command("turn", angle=1), say("forty two."))
    stage.select()
    stage.at(1).request("fa", Group(chain(say("One."), command("point-by-hand", angle=2))))
    stage.request("xa", steps=[Step(command("point-by-hand", angle=one)) for one in (3, 4)])
    stage.select()
    stage.at(2000).end("ea#1")
    stage.select()
    stage.at(2500).end("xa#1")
    assert stage.select() == ["xa#2"]
    assert stage.holds("fa#1")[-1] == "F6" and stage.losers("xa#2") == ["xa#3"]
    assert check(stage.records, "prima", patience=1000) == []


def test_e6_holds_other_devices_back_as_well() -> None:
    """Two devices that another application uses in turn are kept for it (S3)."""
    stage = Stage(patience=1000)
    stage.request("ea", Group(chain(say("One."), command("move-head", pan=1))))
    stage.select()
    stage.at(1).request("fa", Group(chain(say("Me."), command("move-head", pan=2))))
    stage.select()
    stage.at(500).end("ea#2")
    stage.select()
    stage.at(2000).end("ea#3")
    assert stage.select() == ["fa#1", "fa#2"]


@pytest.mark.parametrize(("more", "rule"), [([], "K1"), (["speaker"], "F6")])
def test_e6_k1_stands_above_it(more: list[str], rule: str) -> None:
    """What leaves the user waits for the conversation, however long that takes."""
    row = TABLE_4_2["topological-move"]
    going = {row.name: replace(row, devices=row.devices.union(more))}
    stage = Stage(patience=1000, table={**TABLE_4_2, **going})
    stage.request("ea", *(replace(BRIEF) for _ in range(3)))
    stage.select()
    stage.at(1).request("fa", move())
    stage.select()
    for number in range(1, 3):
        stage.at(4000 * number).end(f"ea#{number}")
        assert stage.select() == [f"ea#{number + 1}"]
    assert [r["rule"] for r in stage.phases("starve")] == [rule]


@pytest.mark.parametrize(
    "bad",
    [
        Command("fly"),
        Command("turn", {"angle": 1000}),
        Command("turn", {"speed": 1}),
        Command("turn"),
        Command("speak"),
        Command("speak", text="Hi", extra={"volume": 1}),
        Command("turn", {"angle": float("nan")}),
        Command("turn", {"angle": None}),
    ],
)
def test_e3_a_bad_command_never_enters_memory(bad: Command) -> None:
    stage = Stage(refuses=True)
    stage.request("ea", say(), bad)
    assert stage.select() == []
    assert stage.told("ea") == ["error.semantic"]
    assert stage.phases("fail")[0]["rule"] == "E3"


def test_e4_starving_is_reported_and_can_be_bounded() -> None:
    def loops(bound: int | None) -> int:
        stage = Stage(bound=bound)
        stage.request("fa", Command("tracking-human"))
        stage.select()
        stage.at(1).request("ea", command("turn", angle=3))
        for loop in range(1, 60):
            stage.at(500 * loop).end(f"fa#1.{loop}", goal=False)
            if "ea#1" in stage.select():
                return loop
        assert [r["rule"] for r in stage.phases("starve")] == ["E4"]
        return -1

    assert loops(None) == -1
    assert 0 < loops(30) <= 32


def test_a_play_meets_touches_units_and_emergencies_without_harm() -> None:
    body = (
        '<form id="f1"><iu><block><speak>Hello.</speak></block></iu>'
        '<on event="touch"><turn angle="10"/></on></form>'
    )
    events = ((1, Occurred("touch")), (2, Emergency(True)), (900, Emergency(False)))
    run = perform(play(body, *events))
    assert check(run.records) + run.problems == []


def test_e1_a_unit_in_a_unit_fails_with_it() -> None:
    # What runs in the inner unit is a part of the outer one, which fails as a whole (U4).
    stage = Stage()
    inner = Group([Step(say("In.")), Step(command("turn", angle=90))])
    stage.request("ea", Group([Step(command("move-head")), Step(inner)]))
    stage.select()
    stage.at(100).mediator.failed("ea#2", "neck", "it fails")
    stage.select()
    assert stage.running == set()
    assert check(stage.records, "prima") == []


def test_e1_of_units_in_units_each_fails_for_the_same_reason() -> None:
    stage = Stage()
    innermost = Group([Step(say("In.")), Step(command("turn", angle=90))])
    middle = Group([Step(innermost), Step(command("move-head"))])
    stage.request("ea", Group([Step(middle), Step(command("point-by-hand", angle=1))]))
    stage.select()
    [speaking] = [
        ab.id for ab in stage.mediator.memory.running.values() if "In." in str(ab.command)
    ]
    stage.at(100).mediator.failed(speaking, "speaker", "broken")
    stage.select()
    fails = [(r["command"], r["event"], r["message"]) for r in stage.phases("fail")]
    assert fails == [
        ("speak", "error.device.speaker", "broken"),
        *[("iu", "error.device.speaker", "broken")] * 3,
    ]
    assert stage.running == set()


def test_e1_what_hangs_fails_though_what_hangs_beside_it_has_ended_with_another() -> None:
    stage = Stage()
    stage.request("fa", Group([Step(say("One.")), Step(command("move-head"))]))
    stage.request("ea", command("turn", angle=9))
    stage.select()
    stage.at(900_000).mediator.expire()
    stage.select()
    assert stage.running == set()
    assert stage.told("ea") == ["error.device.locomotion"]
