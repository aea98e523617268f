"""ABs that devices carry out, and the drivers' goals that make them up."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from prima.devices.ear import bounds_of
from prima.devices.goals import (
    LISTEN,
    RECORD,
    SAY,
    Begin,
    Broke,
    Call,
    Cancel,
    Done,
    RecordingBounds,
    Stopped,
)
from prima.devices.settings import DriverLimits
from prima.devices.speech import Utterance
from prima.messages import Command, Delayed, Halted, Inbound, Json, Order, Presence

SEARCH = "active-sensing-human"
"""The Command that itself reports whom it finds."""


@dataclass(slots=True, eq=False)
class Goal:
    """Something that a driver does or has yet to begin."""

    begin: Begin
    task: Task
    begun: bool = False
    """Whether the driver has been ordered to begin it."""
    accepted: bool = False
    cancelled: bool = False
    """Whether the driver was ordered to stop it."""
    since: int = 0
    """When the driver last received a call or reported (ms)."""
    held: tuple[int, str] | None = None
    """Since when (ms) it has been held back, and by which device that is still stopping."""

    def late(self, limits: DriverLimits) -> int | None:
        """When it will be overdue (ms), if ever."""
        limit = limits.cancel if self.cancelled else limits.progress
        if not self.cancelled and not self.accepted:
            limit = limits.accept
        return None if limit is None or not self.begun else self.since + limit


@dataclass(slots=True, eq=False)
class Task:
    """An AB that the devices carry out. Times are ms."""

    order: Order
    command: Command
    began: int
    goals: list[Goal] = field(default_factory=list)
    """Those that have not ended."""
    said: Utterance | None = None
    """Its text, as far as known without a report."""
    ends: int | None = None
    """When a loop ends, a pause is over, or a question without a text has been asked."""
    asks: bool = False
    """Whether it is a question that has not been fully asked yet."""
    data: dict[str, Json] = field(default_factory=dict)
    """The data that the device reported at the end."""
    failed: tuple[str, str] | None = None
    """The device that failed to do it, and why."""
    lacks: bool = False
    """Whether the robot is unable to do this though its devices work."""
    halting: bool = False
    """Whether it was interrupted and its devices have yet to report how much was done (X2)."""
    shares: list[float] = field(default_factory=list)
    """How much of its goals had been done then."""
    timed: float | None = None
    """How much of it had been done then by its times, if they are known."""
    heard: int | None = None
    """How many characters of the rest of its text had been said, if the device reports it."""

    @property
    def id(self) -> str:
        """The AB's name."""
        return self.order.behavior

    @property
    def name(self) -> str:
        """The same without the number of its loop."""
        return self.id.partition(".")[0]

    def has(self, *kinds: str) -> bool:
        """Whether a goal of one of these kinds is under way."""
        return any(goal.begin.kind in kinds for goal in self.goals)

    def parts(self, needs: frozenset[str]) -> Iterator[tuple[str, frozenset[str]]]:
        """The goals that make it up, by kind, and their devices.

        ``needs`` are those of its Command: the AB may keep others for what follows it (X4).
        """
        kind, devices = self.command.type, self.order.devices
        if kind not in ("pause", "speak", "q-and-a"):
            moved = devices & needs
            yield kind, moved - {"speaker"} if self.said is not None else moved
        if self.said is not None:
            yield SAY, devices & {"speaker"}
        if kind == "q-and-a":
            yield RECORD if self.command.cued("record") else LISTEN, devices - {"speaker"}

    def note_share(self, now: int, until: int | None) -> None:
        """X2: how much of it had been done by its times; ``until``: the times of its answer."""
        said = self.said
        known = (self.ends, until, said.ends if said else None)
        ends = max((time for time in known if time is not None), default=0)
        began = self.began - (said.skipped if said is not None else 0)
        if ends > self.began:
            self.timed = (now - began) / (ends - began)

    def note_end(self, goal: Begin, report: Done | Stopped | Broke) -> None:
        """X2: note how much of a cancelled goal had been done, as its driver reports."""
        if isinstance(report, Stopped) and report.share is not None:
            self.shares.append(report.share)
        if goal.kind == SAY and isinstance(report, Done):
            self.heard = len(goal.command.text or "")
        elif goal.kind == SAY and isinstance(report, Stopped):
            self.heard = report.said

    def halted(self, now: int, pose: Mapping[str, Json]) -> Halted:
        """X2: how much of it had been done when it was interrupted, and where the robot is."""
        said = self.said
        timed = self.timed if said is None or self.heard is None else said.share(self.heard)
        shares = [*self.shares, *([] if timed is None else [timed])]
        data: dict[str, Json] = {"done": round(min(max(min(shares, default=0.0), 0.0), 1.0), 3)}
        if said is not None:
            data |= said.heard(now, self.heard)
        elif self.command.text:
            data["heard"] = self.command.text.strip()
        return Halted(self.id, {**data, **pose})


def searches(tasks: Iterable[Task]) -> bool:
    """Whether any of these ABs itself reports whom it finds."""
    return any(task.command.type == SEARCH for task in tasks)


class OpenGoals:
    """The goals that have not ended: begins them once their devices are free, and cancels them.

    Args:
        inbound: collects what has to be reported to the session about them.
    """

    def __init__(self, inbound: list[Inbound]) -> None:
        self.open: dict[str, Goal] = {}
        """By their keys."""
        self.missing: dict[str, str] = {}
        """Devices that are lost, and why."""
        self.calls: list[Call] = []
        """Calls for drivers, in order."""
        self._inbound = inbound
        self._serial = 0

    def drain(self, now: int) -> list[Call]:
        """Return the calls made since the last time; goals held back begin if they can."""
        for goal in list(self.open.values()):
            if not goal.begun:
                self.attempt(now, goal)
        calls, self.calls = self.calls, []
        return calls

    def add(self, now: int, task: Task, kind: str, devices: frozenset[str], loop: int) -> None:
        """Make a goal of an AB, and begin it if its devices are free; ``loop`` in ms."""
        self._serial += 1
        says = task.said if kind == SAY else None
        begin = Begin(
            f"{task.name}/{self._serial}",
            kind,
            task.command if says is None else says.left(),
            devices,
            task.said.ends if task.said is not None else 0,
            task.ends,
            loop,
            task.order.beside,
            (bounds_of(task.command) if kind == RECORD else None) or RecordingBounds(),
        )
        goal = Goal(begin, task)
        task.goals.append(goal)
        self.open[begin.key] = goal
        self.attempt(now, goal)

    def attempt(self, now: int, goal: Goal) -> None:
        """Tell the driver, unless one of the devices is still stopping, or lost."""
        devices = goal.begin.devices
        if devices & self.missing.keys():
            return
        stopping = {
            name
            for one in self.open.values()
            if one.cancelled
            for name in one.begin.devices & devices
        }
        if stopping:
            goal.held = goal.held or (now, min(stopping))
            return
        if goal.held is not None and goal.held[0] < now:
            since, device = goal.held
            self._inbound.append(Delayed(goal.task.id, device, now - since))
        goal.begun, goal.since = True, now
        self.calls.append(goal.begin)

    def cancel(self, now: int, task: Task) -> None:
        """Let the goals of an AB end as soon as they can."""
        for goal in list(task.goals):
            self.cancel_goal(now, goal)

    def cancel_goal(self, now: int, goal: Goal) -> None:
        """Let a goal end as soon as it can."""
        if not goal.begun:
            if goal.begin.kind == SAY:
                goal.task.heard = 0
            self.over(goal)
        elif not goal.cancelled:
            goal.cancelled, goal.since = True, now
            self.calls.append(Cancel(goal.begin.key))

    def over(self, goal: Goal) -> None:
        """A goal has ended: its devices are free."""
        del self.open[goal.begin.key]
        goal.task.goals.remove(goal)

    def lose(self, devices: frozenset[str], reason: str) -> None:
        """Devices are gone."""
        for device in sorted(devices - self.missing.keys()):
            self.missing[device] = reason
            self._inbound.append(Presence(device, False, reason))

    def bring_back(self, devices: frozenset[str]) -> None:
        """Note that devices are available again."""
        for device in sorted(devices & self.missing.keys()):
            del self.missing[device]
            self._inbound.append(Presence(device, True))
