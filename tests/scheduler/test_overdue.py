"""Devices and units that take too long (rules E1, U5), and users who are gone (K1)."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import pytest

from prima.invariants import check
from prima.language.commands import ABSENCE_MS, TABLE_4_2
from prima.messages import Command, Cue, Group, OpenUnit, Step
from prima.scheduler.failures import HANG_MS
from tests.helpers.stage import Stage, ask, chain, command, move, say, search

SPOKEN = [Cue(0, "pause", 300), Cue(0, "mark", "here"), Cue(2, "pause", 700)]


@pytest.mark.parametrize(
    ("what", "longer"),
    [
        (command("gesture", name="nod"), 0),
        (say("Hello"), 2_500),
        (replace(say("Hello"), cues=tuple(SPOKEN)), 3_500),
        (replace(say("Hello"), cues=(Cue(0, "rate", 0.5), Cue(2, "rate", 2.0))), 5_000),
        (replace(say("Hello"), cues=(Cue(0, "rate", 2.0),)), 2_500),
        (command("set-speed-and-time", speed=2, time="4s"), 4_000),
        (command("q-and-a", "Well?", timeout="9s"), 11_500),
        (command("point-by-hand", toward="door"), 1_000),
    ],
)
def test_e1_a_command_may_run_for_its_own_times_and_two_minutes(what: Command, longer: int) -> None:
    stage = Stage()
    stage.at(50).request("fa", copy(what))
    stage.select()
    assert stage.mediator.deadline() == 50 + HANG_MS + longer


def test_e1_a_device_that_hangs_is_made_to_stop_and_the_application_is_told_why() -> None:
    stage = Stage()
    stage.request("ea", search("Where are you?"))
    stage.select()
    stage.at(10 * HANG_MS).mediator.expire()
    stage.select()
    orders = [(order.verb, order.behavior) for order in stage.orders]
    assert orders[1:] == [("abort", "ea#1.1"), ("stop", "ea#1.1")]
    [failed], [(_, notice)] = stage.phases("fail"), stage.notices
    assert failed["message"] == notice.message == "The device did not end in time."
    assert failed["event"] == notice.event == "error.device.human-detection", "the first by name"


def test_e1_a_command_without_devices_hangs_as_well() -> None:
    table = {**TABLE_4_2, "think": replace(TABLE_4_2["turn"], name="think", devices=frozenset())}
    stage = Stage(table=table)
    stage.request("fa", command("think", angle=1))
    stage.select()
    stage.at(10 * HANG_MS).mediator.expire()
    stage.settle()
    assert stage.told("fa") == ["error.device.none"]


def test_e1_two_devices_that_hang_in_one_unit_fail_once() -> None:
    stage = Stage()
    both = [Step(command("turn", angle=5)), Step(command("gesture", name="nod"))]
    stage.request("ea", Group(both))
    stage.select()
    stage.at(10 * HANG_MS).mediator.expire()
    stage.select()
    failed = [(record["behavior"], record["rule"]) for record in stage.phases("fail")]
    assert failed == [("ea#2", "E1"), ("ea#1", "E1")], "the Command, and its unit"
    assert stage.told("ea") == ["error.device.locomotion"]
    assert stage.notices[0][1].command is both[0].what, "whose place and handlers count"
    assert stage.running == set() and check(stage.records) == []


def test_e1_a_unit_of_several_requests_goes_on_after_a_failure_in_it() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "neck")
    stage.request("ea", say("One."), say("Two."), unit=1)
    stage.select()
    stage.at(10).mediator.failed("ea#2", "speaker", "broken")
    stage.request("ea", command("move-head", pan=1), unit=1)
    assert stage.select() == ["ea#4"] and stage.running == {"ea#1", "ea#4"}
    assert [(one["behavior"], one["rule"]) for one in stage.phases("cancel")] == [("ea#3", "E1")]


def test_v3_what_takes_too_long_in_one_instant_ends_in_the_order_of_applications() -> None:
    """The one whose stream is active comes first, then the declared order, then the number."""
    units = {"fa": (1, "speaker"), "ea": (2, "neck"), "xa": (3, "arm")}
    for started, told in (("xa ea fa", [1, 2, 3]), ("xa fa ea", [2, 1, 3])):
        stage = Stage(apps={"fa": "fa", "ea": "ea", "xa": "ea"})
        for app in started.split():
            number, device = units[app]
            stage.open(app, number, device, longest=1_000)
            stage.select()
        stage.at(1_000).mediator.expire()
        stage.settle()
        assert [notice.run for _, notice in stage.notices] == told


def takes_too_long(stage: Stage) -> tuple[str, int]:
    """A unit of one second fails once, however long it goes on: the notice and its number."""
    for now in (1_000, 2_000):
        stage.at(now).mediator.expire()
        stage.select()
    [failed], [(_, notice)] = stage.phases("fail"), stage.notices
    assert (failed["rule"], failed["event"]) == ("U5", "error.unit.timeout")
    assert (notice.event, notice.message) == ("error.unit.timeout", "The unit took too long.")
    return notice.what, notice.run


def test_u5_a_unit_of_several_requests_is_told_by_its_number_and_fails_once() -> None:
    stage = Stage()
    for number, device, longest in ((3, "speaker", 9_000), (7, "neck", 1_000)):
        opened = OpenUnit(number, 1, frozenset({device}), longest, cause=number)
        stage.mediator.ask("ea", opened)
    stage.request("ea", command("move-head", pan=1), unit=7)
    stage.select()
    assert takes_too_long(stage) == ("unit-timeout", 7)


def test_u5_a_unit_of_one_request_that_takes_too_long_finishes_what_runs_and_fails_once() -> None:
    stage = Stage()
    late = Group(chain(say("One."), say("Two."), say("Three.")), longest=1_000)
    number = stage.request("ea", late, say("After."))
    stage.select()
    assert takes_too_long(stage) == ("failed", number)
    left = [(record["behavior"], record["rule"]) for record in stage.phases("cancel")]
    assert left == [("ea#5", "U5"), ("ea#4", "U5"), ("ea#2", "U5")], "what follows goes first"
    stage.at(3_000).end("ea#3")
    assert stage.select() == [] and stage.running == set()
    assert len(stage.notices) == 1 and check(stage.records) == []


def test_u5_a_unit_inside_another_that_takes_too_long_belongs_to_no_request() -> None:
    stage = Stage()
    inner = Group(chain(say()), longest=1_000)
    stage.request("ea", Group([Step(inner), Step(command("turn", angle=5))]))
    stage.select()
    stage.at(1_000).mediator.expire()
    stage.settle()
    assert [(notice.what, notice.run) for _, notice in stage.notices] == [("failed", 0)]


def test_u5_a_unit_of_one_request_that_takes_too_long_in_a_unit_leaves_the_rest_outside() -> None:
    """As a device that fails in a unit does (E1)."""
    stage = Stage()
    stage.open("ea", 1, "speaker", "neck")
    stage.request("ea", say("After."))
    inner = Group(chain(say("One."), say("Two.")), longest=1_000)
    number = stage.request("ea", inner, command("move-head", pan=1), unit=1)
    stage.select()
    assert takes_too_long(stage) == ("failed", number)
    assert [one["behavior"] for one in stage.phases("cancel")] == ["ea#6", "ea#4"]
    stage.at(3_000).end("ea#5")
    stage.close("ea", 1)
    assert stage.select() == ["ea#2"], "what follows the unit"
    assert check(stage.records) == []


def test_u5_however_deep_a_unit_is_that_takes_too_long_the_rest_outside_is_left() -> None:
    stage = Stage()
    stage.open("ea", 1, "speaker", "neck")
    stage.request("ea", say("After."))
    deep = Group([Step(Group([Step(Group(chain(say("One.")), longest=1_000))]))])
    stage.request("ea", deep, command("move-head", pan=1), unit=1)
    stage.select()
    stage.at(1_000).mediator.expire()
    stage.select()
    cancelled = [one["command"] for one in stage.phases("cancel")]
    assert cancelled == ["move-head"], "not what follows the unit around all of them"


@pytest.mark.parametrize(
    ("unit", "due"), [(Group(chain(say())), None), (Group(chain(say()), 900), 900)]
)
def test_u5_a_unit_has_a_time_limit_only_if_its_author_gives_one(
    unit: Group, due: int | None
) -> None:
    stage = Stage()
    stage.request("ea", unit)
    stage.select()
    assert stage.mediator.memory.behaviors["ea#1"].late == due


def test_e6_a_unit_on_the_speaker_ends_in_time_for_another_application_to_have_its_turn() -> None:
    """Only a unit that keeps the speaker from another application is limited so."""
    limits = []
    for apps in ({"ea": "ea"}, {"fa": "fa", "ea": "ea"}):
        for what in (say(), command("move-head", pan=1)):
            stage = Stage(apps=apps, patience=7_000)
            stage.request("ea", Group(chain(what), longest=3_600_000))
            stage.select()
            limits.append(stage.mediator.memory.behaviors["ea#1"].late)
    assert limits == [3_600_000, 3_600_000, 7_000, 3_600_000]


def test_k1_the_absence_of_a_user_who_is_not_engaged_is_not_waited_for() -> None:
    stage = Stage(patience=0)
    stage.request("ea", command("turn", angle=5))
    stage.select()
    stage.request("fa", move())
    stage.select()
    assert stage.mediator.deadline() == HANG_MS, "of the Command that runs"
    stage.request("ea", ask(), cause=1)
    stage.select()
    assert stage.mediator.deadline() == ABSENCE_MS


def test_k1_who_is_absent_already_is_not_waited_for_again() -> None:
    stage = Stage(patience=0)
    stage.request("ea", ask(), cause=1)
    stage.select()
    stage.request("fa", move())
    stage.select()
    stage.at(ABSENCE_MS).mediator.expire()
    stage.select()
    assert stage.mediator.memory.absent
    due = stage.mediator.deadline()
    assert due is not None and due > ABSENCE_MS


def test_k1_who_is_in_view_is_not_absent_however_quiet_they_are() -> None:
    stage = Stage(patience=0)
    stage.mediator.sees_user(True)
    stage.request("ea", ask(), cause=1)
    stage.select()
    stage.request("fa", move())
    stage.at(2 * ABSENCE_MS).mediator.expire()
    stage.select()
    assert not stage.mediator.memory.absent


def test_x3_only_streams_whose_time_is_up_are_let_go() -> None:
    stage = Stage("prima+x3")
    for app, cause, hold in (("fa", 7, 5_000), ("ea", 8, 9_000)):
        stage.request(app, say(), cause=cause, hold=hold)
        stage.select()
        stage.at(stage.recorder.now + 1_000).end(f"{app}#1")
    stage.select()
    stage.at(6_000).mediator.expire()
    stage.select()
    outcomes = [(one["app"], one["outcome"]) for one in stage.phases("held")]
    assert outcomes == [("fa", "begun"), ("ea", "begun"), ("fa", "over")]
