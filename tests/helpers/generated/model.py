"""The rules of docs/mediation.md once more, as plainly as they can be written.

It knows only Commands whose lengths are known (:mod:`tests.helpers.generated.timed`), and nothing
of the package. Where it and a run differ, one of them misreads a rule.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import accumulate

from tests.helpers.generated.timed import (
    END,
    KINDS,
    WORDS,
    Do,
    GoTo,
    Happening,
    Log,
    Par,
    Step,
    Timed,
    Unit,
)


@dataclass(eq=False)
class Stream:
    """A topic: an AB tree, with what continues it."""

    app: int
    latest: int = 0
    """When an AB of it was the latest to start, as a serial number of starts."""
    spoken: bool = False
    engages: bool = False
    suspended: int = 0
    """The serial number of its suspension, if it is suspended."""
    events: set[int] = field(default_factory=set)
    """The events to which it reacts."""


@dataclass(eq=False)
class Thread:
    """Content that is carried out."""

    app: int
    left: list[Step]
    waits: set[AB] = field(default_factory=set)
    abandoned: bool = False


@dataclass(eq=False)
class AB:
    """An Atomic Behavior in working memory."""

    command: Do | Unit
    stream: Stream
    thread: Thread
    serial: int
    asked: int
    parents: set[AB]
    event: int = 0
    """The serial number of the event that its reactive flag is for (C5)."""
    children: list[AB] = field(default_factory=list)
    follows: int = -1
    """When the AB before it has ended."""
    running: bool = False
    ends: int = -1
    began: int = 0
    """The serial number of its start."""
    last: bool = False
    """Whether no loop follows (O2, O3)."""
    reports: int = 0
    """The serial number of the request whose end ends it: of a unit, its last part's."""

    @property
    def waiting(self) -> bool:
        return not self.running and not self.parents

    @property
    def devices(self) -> frozenset[str]:
        return devices(self.command)

    @property
    def leaves(self) -> bool:
        return isinstance(self.command, Do) and marked(self.command, "leaves")

    @property
    def endless(self) -> bool:
        return isinstance(self.command, Do) and marked(self.command, "endless")

    @property
    def name(self) -> str:
        return self.command.what if isinstance(self.command, Do) else "iu"


def marked(command: Do, mark: str) -> bool:
    return command.what in KINDS and bool(getattr(KINDS[command.what], mark))


def devices(command: Do | Unit) -> frozenset[str]:
    if isinstance(command, Unit):
        return frozenset().union(*map(devices, command.parts))
    return frozenset({"speaker"}) if command.what in WORDS else KINDS[command.what].devices


def lasts(command: Do | Unit) -> int:
    if isinstance(command, Unit):
        return sum(map(lasts, command.parts))
    return WORDS.get(command.what) or KINDS[command.what].lasts


def parts(ab: AB) -> list[int]:
    """When the parts of a unit that runs begin, but for the first."""
    begins = accumulate(map(lasts, ab.command.parts)) if isinstance(ab.command, Unit) else ()
    return [ab.ends - lasts(ab.command) + time for time in begins][:-1]


@dataclass(frozen=True)
class Cause:
    """Why content goes on: an event (C5), the end of an AB (C3), or a state that was left (O3)."""

    event: int = 0
    window: Stream | None = None
    left: Stream | None = None


class Model:
    """One run."""

    def __init__(self, timed: Timed) -> None:
        self.timed = timed
        self.now = 0
        self.found: list[Happening] = []
        self.memory: list[AB] = []
        self.floor: list[Stream] = []
        self.states = ["f"] * len(timed.apps)
        self.threads: list[Thread] = []
        self.latest: dict[int, AB] = {}
        """What each application has requested last."""
        self.resumed: set[Stream] = set()
        self.starts = self.suspensions = self.requests = self.events = 0

    def run(self) -> list[Happening]:
        for app, states in enumerate(self.timed.apps):
            self.carry_out(Thread(app, list(states["f"].block)), Cause())
        self.select()
        coming = dict(self.timed.events)
        while True:
            running = [ab for ab in self.memory if ab.running]
            times = [*coming, *(time for ab in running for time in (ab.ends, *parts(ab)))]
            self.now = min((time for time in times if time > self.now), default=END)
            if self.now >= END:
                return self.found
            self.end_all([ab for ab in running if ab.ends == self.now])
            self.begin_parts()
            if self.now in coming:
                self.occur(coming.pop(self.now))
            self.select()

    def tell(self, phase: str, app: int, what: str) -> None:
        self.found.append((self.now, phase, app, what))

    # Events -----------------------------------------------------------------------------

    def apps(self) -> list[int]:
        """V3: the application whose stream is active, then the declared order."""
        active = self.active()
        return sorted(range(len(self.states)), key=lambda app: (app != active, app))

    def active(self) -> int:
        """The application with the floor, or of the stream whose AB started last."""
        streams = [self.floor[-1]] if self.floor else [ab.stream for ab in self.memory]
        latest = max(streams, key=lambda one: one.latest, default=None)
        return latest.app if latest is not None and latest.latest else -1

    def end_all(self, ended: list[AB]) -> None:
        order = self.apps()
        for ab in sorted(ended, key=lambda one: (order.index(one.stream.app), one.reports)):
            if ab in self.memory:
                self.end(ab)
        self.floor = [one for one in self.floor if self.is_open(one)]

    def is_open(self, stream: Stream) -> bool:
        return any(ab.stream is stream for ab in self.memory)  # C1

    def occur(self, name: str) -> None:
        """V1: an event goes to every application."""
        self.events += 1
        for app in self.apps():
            handler = self.timed.apps[app][self.states[app]].handlers.get(name)
            if handler is not None:
                cause = Cause(event=self.events) if handler.reactive else Cause()
                self.carry_out(Thread(app, list(handler.content)), cause)
        self.floor = [one for one in self.floor if self.is_open(one)]

    def end(self, ab: AB) -> None:
        ab.running = False
        self.tell("end", ab.stream.app, ab.name)
        if ab.endless and not ab.last:  # U2: another loop
            ab.follows = self.now
            return
        self.memory.remove(ab)
        for child in ab.children:
            child.parents.discard(ab)
            child.follows = self.now
        thread = ab.thread
        thread.waits.discard(ab)
        if not thread.waits and not thread.abandoned:
            self.carry_out(thread, Cause(window=ab.stream))

    def begin_parts(self) -> None:
        """U4: the parts of a unit begin one after the other, which counts for its stream."""
        for ab in self.memory:
            if ab.running and self.now in parts(ab):
                self.starts += 1
                ab.began = ab.stream.latest = self.starts

    # Content ----------------------------------------------------------------------------

    def carry_out(self, thread: Thread, cause: Cause) -> None:
        """O4: up to the next run of Commands, which is requested at once (U3)."""
        self.threads.append(thread)
        while thread.left:
            step = thread.left.pop(0)
            if isinstance(step, Log):
                self.tell("log", thread.app, f"L{step.number}")
            elif isinstance(step, GoTo):
                return self.leave(thread.app, step.form, cause)
            else:
                run = [step]
                while thread.left and not _divides(thread.left[0]):
                    run.append(thread.left.pop(0))  # type: ignore[arg-type]
                return self.request(thread, run, cause)

    def leave(self, app: int, form: str, cause: Cause) -> None:
        """O3: what has not started is deleted; what runs ends unnoticed."""
        own = [ab for ab in self.memory if ab.stream.app == app]
        left = self.continued(own)
        for thread in self.threads:
            thread.abandoned = thread.abandoned or thread.app == app
        for ab in own:
            ab.last = True
            if not ab.running:
                self.delete(ab)
        self.states[app] = form
        block = Thread(app, list(self.timed.apps[app][form].block))
        self.carry_out(block, Cause(cause.event, cause.window, left))

    def delete(self, ab: AB) -> None:
        self.memory.remove(ab)
        ab.thread.abandoned = True
        self.tell("cancel", ab.stream.app, ab.name)

    @staticmethod
    def continued(ended: list[AB]) -> Stream | None:
        """O2, O3: the stream that goes on, of those that end."""
        running = [ab for ab in ended if ab.running]
        if running:
            return max(running, key=lambda ab: ab.began).stream
        begun = [ab.stream for ab in ended if ab.stream.latest]
        if begun:
            return max(begun, key=lambda one: one.latest)
        return max(ended, key=lambda ab: ab.serial).stream if ended else None

    def request(self, thread: Thread, run: Sequence[Do | Unit | Par], cause: Cause) -> None:
        stream, after = self.place(thread.app, run[0], cause)
        begins = True
        for step in run:
            branches = step.branches if isinstance(step, Par) else ((step,),)
            ends = []
            for branch in branches:
                before = after
                for number, command in enumerate(branch):
                    event = cause.event if begins and number == 0 else 0
                    before = [self.add(command, stream, thread, before, event, cause)]
                ends += before
            after, begins = ends, False

    def add(
        self, command: Do | Unit, stream: Stream, thread: Thread, parents: list[AB], event: int,
        cause: Cause,
    ) -> AB:  # fmt: skip
        self.requests += 1
        ab = AB(command, stream, thread, self.requests, self.now, set(parents), event)
        for parent in parents:
            parent.children.append(ab)
        if cause.window is not None and not parents:
            ab.follows = self.now  # C3
        self.memory.append(ab)
        thread.waits.add(ab)
        self.latest[thread.app] = ab
        return ab

    def place(self, app: int, first: Step, cause: Cause) -> tuple[Stream, list[AB]]:
        """O1, O2, O3: the stream of what is requested, and what it follows."""
        if isinstance(first, Do) and first.now:
            return self.cancel(app, first) or cause.window or cause.left or Stream(app), []
        if cause.event:
            return cause.left or Stream(app), []
        latest = self.latest.get(app)
        if cause.window is not None:
            own = [ab for ab in self.memory if ab.stream is cause.window]
            return cause.window, own[-1:]
        if latest in self.memory and latest is not None:
            return latest.stream, [latest]
        return cause.left or Stream(app), []

    def cancel(self, app: int, command: Do) -> Stream | None:
        """O2: the trees of an application that need a device of a Command wanted now."""
        needed = devices(command)
        own = [ab for ab in self.memory if ab.stream.app == app]
        trees = {ab.stream for ab in own if ab.devices & needed}
        ended = [ab for ab in own if ab.stream in trees]
        stream = self.continued(ended)
        for ab in ended:
            ab.last = ab.thread.abandoned = True
            if not ab.running or ab.devices & needed:
                self.delete(ab)
        return stream

    # Selection --------------------------------------------------------------------------

    def select(self) -> None:
        """S4: until none may start; each start may change the ranks of the others."""
        while (ab := self.next()) is not None:
            self.start(ab)
        for stream in self.resumed:
            stream.suspended = 0
        self.resumed = set()

    def next(self) -> AB | None:
        taken = {device for ab in self.memory if ab.running for device in ab.devices}
        active = self.active()
        waiting = [ab for ab in self.memory if ab.waiting]
        for ab in sorted(waiting, key=lambda one: self.rank(one, active)):
            if self.kept(ab):
                continue
            if not ab.devices & taken:
                return ab
            if ab.event:
                taken |= ab.devices  # S3
        return None

    def rank(self, ab: AB, active: int) -> tuple[int, ...]:
        """S2."""
        return (
            ab.leaves,  # a, K2
            not ab.event,  # b
            -ab.event,
            bool(ab.event) and ab.stream.app != active,
            ab.follows != self.now,  # c
            -ab.stream.suspended,  # d
            ab.asked,  # e
            ab.stream.app,  # f
            ab.serial,
        )

    def shown(self, stream: Stream) -> list[AB]:
        """The running and waiting ABs of a stream."""
        return [ab for ab in self.memory if ab.stream is stream and not ab.parents]

    def kept(self, ab: AB) -> bool:
        """Whether something other than a device keeps an AB from starting."""
        return self.f2(ab) or self.f6(ab) or self.k1(ab)

    def f2(self, ab: AB) -> bool:
        if not self.floor or self.floor[-1].app == ab.stream.app:
            return False
        floor = self.floor[-1]
        if ab.event and ab.event not in floor.events:
            return False
        return ab.leaves or not all(other.leaves for other in self.shown(floor))

    def f6(self, ab: AB) -> bool:
        if "speaker" not in ab.devices or ab.event or ab.stream in self.floor[-1:]:
            return False
        return any(
            one.running and one.stream.app != ab.stream.app and one.stream.spoken
            and not one.endless and "speaker" not in one.devices and self.words_behind(one)
            for one in self.memory
        )  # fmt: skip

    def words_behind(self, ab: AB) -> bool:
        behind = [child for child in ab.children if child in self.memory and not child.endless]
        return any("speaker" in one.devices or self.words_behind(one) for one in behind)

    def k1(self, ab: AB) -> bool:
        return ab.leaves and any(
            one.app != ab.stream.app
            and one.engages
            and not all(other.leaves for other in self.shown(one))
            for one in {other.stream for other in self.memory}
        )

    def start(self, ab: AB) -> None:
        stream = ab.stream
        if self.takes_floor(ab):
            self.floor = [*(one for one in self.floor if one is not stream), stream]
            self.suspend_others(stream)
        if ab.event:
            stream.events.add(ab.event)
        self.resumed.add(stream)
        self.starts += 1
        self.requests += len(ab.command.parts) if isinstance(ab.command, Unit) else 0
        ab.reports = self.requests if isinstance(ab.command, Unit) else ab.serial
        ab.running, ab.event, ab.ends = True, 0, self.now + lasts(ab.command)
        ab.began = stream.latest = self.starts
        stream.spoken = stream.spoken or "speaker" in ab.devices
        stream.engages = stream.engages or (
            isinstance(ab.command, Do) and marked(ab.command, "engages")
        )
        self.tell("start", stream.app, ab.name)

    def takes_floor(self, ab: AB) -> bool:
        """F1, F3."""
        floor = self.floor[-1] if self.floor else None
        if ab.event:
            return floor is not ab.stream
        if floor is None or floor.app == ab.stream.app:
            return False
        return any(ab.devices & other.devices for other in self.shown(floor))

    def suspend_others(self, stream: Stream) -> None:
        """F1, C2: streams of other applications of which something has started."""
        self.suspensions += 1
        for other in {ab.stream for ab in self.memory}:
            begun = other.app != stream.app and other.latest
            if begun and (not other.suspended or other in self.resumed):
                other.suspended = self.suspensions
                self.resumed.discard(other)


def _divides(step: Step) -> bool:
    return isinstance(step, Log | GoTo) or (isinstance(step, Do) and step.now)
