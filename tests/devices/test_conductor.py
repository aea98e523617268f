"""The conductor between generated applications and drivers that do everything that drivers do.

They accept late or never, refuse, break, report twice, out of order or not at all, stop late,
or end just when they are told to stop. What the driver itself knows to be going on is looked
at: no device is ever given two tasks; and the mediator's records keep the invariants.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator
from itertools import count
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prima.devices.conductor import Conductor
from prima.devices.goals import (
    LISTEN,
    RECORD,
    SAY,
    Accepted,
    Back,
    Begin,
    Broke,
    Call,
    Cancel,
    Done,
    Lost,
    Progress,
    RecordingBounds,
    Report,
    Safe,
    Stand,
    Stopped,
)
from prima.devices.loop import Loop
from prima.devices.profile import Profile
from prima.devices.settings import DriverLimits
from prima.invariants import callers, check
from prima.language.commands import TABLE_4_2
from prima.messages import (
    ApplicationLoaded,
    Command,
    Cue,
    Data,
    Delayed,
    Ended,
    Failed,
    Halted,
    Heard,
    Inbound,
    Listening,
    Order,
    Presence,
    Record,
)
from prima.scheduler.policy import policy_named
from prima.session import Session
from tests.helpers.generated.plays import Play, documents_of, plays
from tests.helpers.generated.world import APPS
from tests.invariants.test_properties import examples

LIMITS = DriverLimits(accept=500, progress=None, cancel=2000)
DEVICES = frozenset(device for row in TABLE_4_2.values() for device in row.devices) | {"speaker"}
LONGEST = 1_000_000


class Adversary:
    """Devices whose driver does whatever it likes, by a seed. It knows what it is really at."""

    awaits = False

    def __init__(self, play: Play, seed: int) -> None:
        profile = Profile("any", commands=dict(play.world.table), devices=DEVICES)
        self.conductor = Conductor(
            profile, lambda: {"x": 0.0, "y": 0.0, "heading": 0.0}, lambda _: LIMITS
        )
        self.dice = Random(seed)
        self.agenda: list[tuple[int, int, Report | Inbound]] = []
        self.at: dict[str, Begin] = {}
        """What it is really at."""
        self.faults: list[str] = []
        self._serial = count()
        self._now = 0
        for number, start in enumerate(play.loads):
            self.plan(start, ApplicationLoaded(APPS[number]))
        for time, value in play.events:
            self.plan(time, value)

    def plan(self, time: int, value: Report | Inbound) -> None:
        heapq.heappush(self.agenda, (time, next(self._serial), value))

    def due(self) -> int | None:
        times = (self.agenda[0][0] if self.agenda else None, self.conductor.due(False))
        return min((time for time in times if time is not None), default=None)

    def collect(self, now: int) -> list[Inbound]:
        self._now = now
        happened: list[Inbound] = []
        while self.agenda and self.agenda[0][0] <= now:
            value = heapq.heappop(self.agenda)[2]
            if isinstance(value, Report):
                self._report(value)
            else:
                happened += self._happen(value)
        found = self.conductor.collect(now, False, {})
        self._carry_out()
        return [*found, *happened]

    def _happen(self, value: Inbound) -> Iterator[Inbound]:
        if isinstance(value, Heard):
            self.conductor.speech_begins(self._now)
            self._carry_out()
            self.conductor.ear.speech_ends()
        yield value

    def order(self, now: int, order: Order) -> None:
        if order.verb != "send":
            self.conductor.order(now, order)
            self._carry_out()

    def observe(self, now: int, records: list[Record]) -> None:
        self.conductor.ear.listen_on(now)
        self.conductor.end_loops()
        self._carry_out()

    # The driver ---------------------------------------------------------------------

    def _report(self, report: Report) -> None:
        if isinstance(report, Done | Stopped | Broke):
            self.at.pop(report.key, None)
        self.conductor.report(self._now, report)
        self._carry_out()

    def _carry_out(self) -> None:
        while calls := self.conductor.drain():
            for call in calls:
                self._take(call)

    def _take(self, call: Call) -> None:
        match call:
            case Begin():
                self._begin(call)
            case Cancel():
                self._cancel(call.key)
            case Safe():
                self.at.clear()
                self.plan(self._now + 3000, Back(DEVICES))

    def _begin(self, begin: Begin) -> None:
        for other in self.at.values():
            if other.devices & begin.devices and not begin.beside:
                self.faults.append(f"{begin.key} begins while {other.key} goes on")
        self.at[begin.key] = begin
        now, chance = self._now, self.dice.random
        if chance() > 0.03:
            self.plan(now + self.dice.randint(0, 40), Accepted(begin.key))
        end = now + self.dice.randint(1, 3000)
        if chance() < 0.05:
            device = min(begin.devices, default="none")
            self.plan(end, Broke(begin.key, device, "it breaks"))
        elif begin.kind != LISTEN and (begin.tick is None or chance() < 0.5) and chance() > 0.03:
            self.plan(end, Done(begin.key))
            if chance() < 0.2:
                self.plan(end + self.dice.randint(0, 200), Done(begin.key))
        if chance() < 0.1:
            self.plan(now + self.dice.randint(0, 4000), Progress(begin.key))

    def _cancel(self, key: str) -> None:
        chance = self.dice.random()
        later = self._now + self.dice.randint(0, 800)
        if chance < 0.1:
            self.plan(later, Done(key))
        elif chance < 0.95:
            self.plan(later, Stopped(key, self.dice.random()))
        if chance < 0.05:
            self.plan(later + 10, Stopped(key))


def conduct(play: Play, seed: int, policy: str) -> tuple[Adversary, list[Record], str]:
    """Run documents on such devices."""
    session = Session(documents_of(play), policy_named(policy), play.world.table)
    devices = Adversary(play, seed)
    loop = Loop(session, devices, LONGEST)
    records: list[Record] = []
    for _ in range(1500):
        made = loop.advance(LONGEST)
        if made is None:
            break
        records += made
    assert not session.defects, session.defects
    session.close()
    return devices, records, loop.outcome


@pytest.mark.parametrize("policy", ["prima", "prima+x2"])
@given(play=plays(), seed=st.integers(0, 2**32))
@examples(20)
def test_no_device_is_given_two_tasks_whatever_the_driver_does(
    policy: str, play: Play, seed: int
) -> None:
    devices, records, _ = conduct(play, seed, policy)
    assert devices.faults == []
    assert check(records, policy, APPS, calling=callers(documents_of(play))) == []


class Desk:
    """A conductor, with what it says."""

    def __init__(self, limits: DriverLimits = LIMITS) -> None:
        profile = Profile("any", commands=dict(TABLE_4_2), devices=DEVICES)
        self.conductor = Conductor(
            profile, lambda: {"x": 1.0, "y": 2.0, "heading": 0.0}, lambda _: limits
        )
        self.now = 0
        self.resumes: Data | None = None
        """From where what is started goes on after an interruption."""

    def order(self, verb: str, name: str, *command: object, loop: int = 0) -> list[Call]:
        made = command[0] if command else None
        assert made is None or isinstance(made, Command)
        row = TABLE_4_2[made.type] if made is not None else None
        devices = row.occupied(made.text) if row is not None and made is not None else frozenset()
        order = Order(verb, name, made, devices, loop, self.resumes is not None)  # type: ignore[arg-type]
        order.data = self.resumes
        self.conductor.order(self.now, order)
        return self.conductor.drain()

    def report(self, report: Report) -> list[Call]:
        self.conductor.report(self.now, report)
        return self.conductor.drain()

    def at(self, now: int) -> list[Inbound]:
        self.now = now
        return self.conductor.collect(now, False, {})


SPEAK = Command("speak", {}, "Hello there.", lang="en")
TURN = Command("turn", {"angle": 90.0})
GOES = Command("topological-move", {"to": "hall"})


def test_a_start_waits_until_what_was_cancelled_has_stopped() -> None:
    desk = Desk()
    (first,) = desk.order("start", "a#1", SPEAK)
    assert desk.order("abort", "a#1") == [Cancel(first.key)]  # type: ignore[union-attr]
    assert desk.order("start", "b#1", SPEAK) == [], "the speaker still speaks"
    (turn,) = desk.order("start", "b#2", TURN)
    assert isinstance(turn, Begin), "other devices are free"
    desk.now = 30
    (second,) = desk.report(Stopped(first.key))  # type: ignore[union-attr]
    assert isinstance(second, Begin)
    assert second.kind == SAY
    assert desk.at(31) == [Delayed("b#1", "speaker", 30)]


@pytest.mark.parametrize(
    ("command", "ends"),
    [
        (Command("q-and-a", {"timeout": 5000}, ""), 1),
        (Command("pause", {"time": 2000}), 2000),
    ],
)
def test_an_end_is_due_though_a_report_comes_after_it(command: Command, ends: int) -> None:
    desk = Desk()
    (turn,) = desk.order("start", "b#1", TURN)
    desk.order("start", "a#1", command)
    desk.at(0)
    desk.now = ends + 3
    desk.report(Accepted(turn.key))  # type: ignore[union-attr]
    assert desk.conductor.due(False) == ends
    assert len(desk.at(ends)) == 1


def test_a_cancelled_start_that_was_held_back_never_begins() -> None:
    desk = Desk()
    (first,) = desk.order("start", "a#1", SPEAK)
    desk.order("abort", "a#1")
    desk.order("start", "b#1", SPEAK)
    assert desk.order("interrupt", "b#1") == []
    assert desk.report(Stopped(first.key)) == []  # type: ignore[union-attr]
    (halted,) = desk.at(1)
    assert isinstance(halted, Halted)
    assert halted.data == {"done": 0.0, "heard": ""}


TOLD = Command(
    "speak",
    {},
    "One two. Three four. Five.",
    lang="en",
    cues=(
        Cue(0, "rate", 0.5),
        Cue(0, "mark", "a"),
        Cue(3, "lasts", 2000),
        Cue(8, "mark", "b"),
        Cue(8, "pause", 700),
        Cue(14, "end"),
        Cue(20, "mark", "c"),
    ),
)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        (0, {"done": 0.0, "heard": "", "passed": 1, "mark": "a"}),
        (11, {"done": 0.423, "heard": "One two.", "passed": 2, "mark": "b"}),
        (26, {"done": 1.0, "heard": "One two. Three four. Five.", "passed": 3, "mark": "c"}),
    ],
)
def test_x2_a_driver_tells_how_much_of_a_text_was_said(said: int, told: dict[str, object]) -> None:
    desk = Desk()
    (first,) = desk.order("start", "a#1", TOLD)
    desk.order("interrupt", "a#1")
    desk.report(Stopped(first.key, said=said))  # type: ignore[union-attr]
    (halted,) = desk.at(400)
    assert isinstance(halted, Halted)
    assert halted.data == told


def test_x2_a_text_goes_on_behind_its_mark_and_is_counted_from_its_beginning() -> None:
    desk = Desk()
    desk.resumes = {"passed": 2, "mark": "b"}
    (again,) = desk.order("start", "a#1", TOLD)
    assert isinstance(again, Begin)
    assert again.command.text == " Three four. Five."
    kept = (Cue(0, "rate", 0.5), Cue(0, "pause", 700), Cue(12, "mark", "c"))
    assert again.command.cues == kept
    desk.order("interrupt", "a#1")
    desk.report(Stopped(again.key, said=7))
    (halted,) = desk.at(400)
    assert isinstance(halted, Halted)
    assert (halted.data["heard"], halted.data["passed"]) == ("One two. Three", 2)


HEARD, POSE = {"done": 1.0, "heard": "Hello there."}, {"x": 1.0, "y": 2.0, "heading": 0.0}


@pytest.mark.parametrize(("what", "told"), [(SPEAK, HEARD), (TURN, {"done": 0.0, **POSE})])
def test_x2_what_is_told_of_what_ended_before_it_could_stop(what: Command, told: Data) -> None:
    desk = Desk()
    (first,) = desk.order("start", "a#1", what)
    desk.order("interrupt", "a#1")
    desk.report(Done(first.key))  # type: ignore[union-attr]
    (halted,) = desk.at(400)
    assert isinstance(halted, Halted)
    assert halted.data == told


RECORDED = (Cue(0, "record", 8000), Cue(0, "finalsilence", 1500))


def test_a_recording_is_a_goal_of_its_own_with_its_bounds() -> None:
    desk = Desk()
    question = Command("q-and-a", {"timeout": 5000}, "Speak.", lang="en", cues=RECORDED)
    _, goal = desk.order("start", "a#1", question)
    assert isinstance(goal, Begin)
    assert (goal.kind, goal.bounds) == (RECORD, RecordingBounds(8000, 1500))


@pytest.mark.parametrize("lacks", [True, False])
def test_what_cannot_be_recorded_ends_the_question(lacks: bool) -> None:
    desk = Desk()
    question = Command("q-and-a", {"timeout": 5000}, "Speak.", lang="en", cues=RECORDED)
    said, recorded = desk.order("start", "a#1", question)
    why = "no driver records"
    report = Broke(recorded.key, "speech-recognition", why, lacks)  # type: ignore[union-attr]
    assert desk.report(report) == [Cancel(said.key)]  # type: ignore[union-attr]
    ended = Ended("a#1", True, {"outcome": "error.noresource", "message": why})
    failed = Failed("a#1", "speech-recognition", why)
    assert desk.at(1) == [ended if lacks else failed]


def test_what_a_driver_says_of_a_goal_that_is_over_counts_for_nothing() -> None:
    desk = Desk()
    (first,) = desk.order("start", "a#1", TURN)
    assert isinstance(first, Begin)
    desk.report(Done(first.key))
    assert desk.at(10) == [Ended("a#1", True, {})]
    assert desk.report(Done(first.key)) == []
    assert desk.report(Broke(first.key, "locomotion", "late")) == []
    assert desk.report(Done("nobody/7")) == []
    assert desk.at(20) == []


def test_loops_are_one_goal_until_no_other_is_ordered() -> None:
    desk = Desk()
    (goal,) = desk.order("start", "a#1.1", GOES, loop=1)
    assert isinstance(goal, Begin)
    assert goal.tick == 500
    desk.report(Accepted(goal.key))
    assert desk.at(500) == [Ended("a#1.1", False, {"x": 1.0, "y": 2.0, "heading": 0.0})]
    assert not any(isinstance(one, Begin) for one in desk.order("start", "a#1.2", GOES, loop=2))
    desk.conductor.end_loops()
    assert desk.conductor.drain() == []
    desk.at(1000)
    desk.conductor.end_loops()
    assert desk.conductor.drain() == [Cancel(goal.key)]


def test_a_stop_ends_loops_before_the_body_stands() -> None:
    desk = Desk()
    (goal,) = desk.order("start", "a#1.1", GOES, loop=1)
    desk.report(Accepted(goal.key))  # type: ignore[union-attr]
    desk.at(500)
    assert desk.order("stop", "a#1.1") == [Cancel(goal.key), Stand()]  # type: ignore[union-attr]


def test_a_driver_that_does_not_accept_has_failed() -> None:
    desk = Desk()
    (goal,) = desk.order("start", "a#1", TURN)
    assert desk.conductor.due(False) == 500
    assert desk.at(500) == [
        Failed("a#1", "localization", "the device does not accept it")
        if "localization" in TABLE_4_2["turn"].devices
        else Failed("a#1", min(TABLE_4_2["turn"].devices), "the device does not accept it")
    ]
    assert desk.conductor.drain() == [Cancel(goal.key)]  # type: ignore[union-attr]


def test_a_driver_that_reports_no_more_has_failed() -> None:
    desk = Desk(DriverLimits(accept=500, progress=1000, cancel=2000))
    (goal,) = desk.order("start", "a#1", TURN)
    desk.report(Accepted(goal.key))  # type: ignore[union-attr]
    desk.now = 900
    desk.report(Progress(goal.key))  # type: ignore[union-attr]
    assert desk.at(1800) == []
    (failed,) = desk.at(1900)
    assert isinstance(failed, Failed)


def test_a_device_that_does_not_stop_is_made_safe_and_given_up() -> None:
    desk = Desk()
    (goal,) = desk.order("start", "a#1", SPEAK)
    desk.report(Accepted(goal.key))  # type: ignore[union-attr]
    desk.order("abort", "a#1")
    desk.order("start", "b#1", SPEAK)
    why = "the device does not stop"
    assert desk.at(2000) == [Presence("speaker", False, why), Failed("b#1", "speaker", why)]
    assert [type(call) for call in desk.conductor.drain()][:1] == [Safe]
    assert desk.order("start", "c#1", SPEAK) == [], "it is missing until it is back"
    assert desk.at(2001) == [Failed("c#1", "speaker", "the device does not stop")]
    desk.report(Back(frozenset({"speaker"})))
    assert desk.at(2002) == [Presence("speaker", True)]
    (again,) = desk.order("start", "c#2", SPEAK)
    assert isinstance(again, Begin)


def test_what_was_held_back_does_not_begin_on_a_device_that_is_lost() -> None:
    desk = Desk()
    (first,) = desk.order("start", "a#1", SPEAK)
    desk.order("abort", "a#1")
    desk.order("start", "b#1", SPEAK)
    assert desk.report(Lost(frozenset({"speaker"}), "the link is down")) == []
    why = "the link is down"
    assert desk.at(1) == [Presence("speaker", False, why), Failed("b#1", "speaker", why)]
    assert desk.report(Stopped(first.key)) == []  # type: ignore[union-attr]


def test_a_prompt_that_was_held_back_is_not_said_when_the_user_speaks_first() -> None:
    desk = Desk()
    (first,) = desk.order("start", "a#1", SPEAK)
    desk.order("abort", "a#1")
    question = Command("q-and-a", {"timeout": 5000}, "Well?", lang="en")
    (listen,) = desk.order("start", "b#1", question)
    assert isinstance(listen, Begin)
    assert listen.kind == LISTEN
    desk.conductor.speech_begins(10)
    assert desk.conductor.drain() == []
    assert desk.at(11) == [Listening("b#1")]
    assert desk.report(Stopped(first.key)) == []  # type: ignore[union-attr]


def test_a_lost_driver_fails_what_runs_on_it_alone() -> None:
    desk = Desk()
    desk.order("start", "a#1", SPEAK)
    desk.order("start", "b#1", TURN)
    desk.report(Lost(frozenset({"speaker"}), "the link is down"))
    why = "the link is down"
    assert desk.at(1) == [Presence("speaker", False, why), Failed("a#1", "speaker", why)]


def test_one_part_that_breaks_takes_the_other_with_it() -> None:
    desk = Desk()
    both = Command("turn-and-speak", {"angle": 30.0}, "Look there.", lang="en")
    motion, speech = desk.order("start", "a#1", both)
    assert isinstance(motion, Begin)
    assert isinstance(speech, Begin)
    assert desk.report(Broke(motion.key, "locomotion", "stuck")) == [Cancel(speech.key)]
    assert desk.at(1) == [Failed("a#1", "locomotion", "stuck")]
    assert desk.report(Stopped(speech.key)) == []
