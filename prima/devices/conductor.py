"""The conductor: turns the mediator's orders into goals of drivers, and their reports into what comes in.

It is sans-IO, and the same for the simulated robot and for a real one. Whoever drives it gives
it orders, reports and the time; it gives calls for the drivers and values for the session.

A device is free when its driver has confirmed so: what an order begins on a device that is
still stopping is held back, and nothing is ever told to do two things at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from prima.devices.ear import Ear, bounds_of
from prima.devices.goals import (
    LISTEN,
    RECORD,
    SAY,
    Accepted,
    Again,
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
from prima.devices.profile import Profile
from prima.devices.senses import Sensors, Sight
from prima.devices.settings import FOREVER, DriverLimits
from prima.devices.speech import SpeechMarks, Utterance
from prima.messages import (
    Command,
    Data,
    Delayed,
    Ended,
    Failed,
    Halted,
    Inbound,
    Json,
    Listening,
    Order,
    Presence,
)

NO_RESOURCE = "error.noresource"
"""The end of a question whose answer cannot be recorded (VoiceXML 2.0, 5.2.6)."""
SEARCH = "active-sensing-human"
"""The Command that reports by itself whom it finds."""


@dataclass(slots=True, eq=False)
class Goal:
    """Something that a driver does, or has still to begin."""

    begin: Begin
    task: Task
    begun: bool = False
    """Whether the driver has been told."""
    accepted: bool = False
    cancelled: bool = False
    """Whether it was told to stop."""
    since: int = 0
    """When the driver was told something, or reported, last (ms)."""
    held: tuple[int, str] | None = None
    """Since when (ms) it is held back, and by which device that is still stopping."""

    def late(self, limits: DriverLimits) -> int | None:
        """When it will have taken too long (ms), if ever."""
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
    """What it says, as far as that can be told without a report."""
    ends: int | None = None
    """When a loop ends, a pause is over, or a question without a text has been asked."""
    asks: bool = False
    """Whether it is a question that has still to be asked to its end."""
    data: dict[str, Json] = field(default_factory=dict)
    """What the device told at the end."""
    failed: tuple[str, str] | None = None
    """Which device did not do it, and why."""
    lacks: bool = False
    """Whether its devices work, and the robot cannot do just this."""
    halting: bool = False
    """Whether it was interrupted, and its devices have still to say how much was done (X2)."""
    shares: list[float] = field(default_factory=list)
    """How much of its goals had been done then."""
    timed: float | None = None
    """How much of it had been done then by its times, if these tell."""
    heard: int | None = None
    """How many characters had been said of what was left of its text, if the device tells."""

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


class Conductor:
    """Goals for drivers out of orders; ends, failures and answers out of reports.

    Args:
        profile: the robot.
        pose: the robot's pose as it is known now, for what Commands that move it tell.
        limits: how long drivers may take over a goal.
        exclusive: whether a device does one thing at a time. Without a mediator it does not:
            whoever begins takes it.
        start: when the run begins, or goes on (ms).
    """

    def __init__(
        self,
        profile: Profile,
        pose: Callable[[], dict[str, float]],
        limits: Callable[[Begin], DriverLimits] = lambda _: FOREVER,
        exclusive: bool = True,
        start: int = 0,
    ) -> None:
        self.profile = profile
        self.ear = Ear()
        self.sight = Sight()
        self.sensors = Sensors()
        self.tasks: dict[str, Task] = {}
        self._pose = pose
        self._limits = limits
        self._exclusive = exclusive
        self._marks = SpeechMarks()
        self._calls: list[Call] = []
        self._inbound: list[Inbound] = []
        """What has still to be told."""
        self._goals: dict[str, Goal] = {}
        """Those that have not ended, by their keys."""
        self._looped: dict[str, Task] = {}
        """Feedback Commands whose loop has ended at this instant: another may follow (U2)."""
        self._missing: dict[str, str] = {}
        """Devices that are lost, and why."""
        self._serial = 0
        self._now = start

    def drain(self) -> list[Call]:
        """Give the calls for drivers made since the last time, in order.

        What was held back begins here, if its devices are free by now.
        """
        for goal in list(self._goals.values()):
            if not goal.begun:
                self._try(goal)
        calls, self._calls = self._calls, []
        return calls

    # Orders -------------------------------------------------------------------------

    def order(self, now: int, order: Order) -> None:
        """Take an order of the mediator."""
        self._now = now
        if order.verb == "start":
            self._start(order)
        elif order.verb == "stop":
            self.end_loops()
            self._calls.append(Stand())
        elif (task := self.tasks.get(order.behavior)) is not None:
            task.halting = order.verb == "interrupt"
            self._note_share(task)
            self._drop(task)
            self._cancel(task)
            if not task.goals:
                self._tell_halted(task)

    def _start(self, order: Order) -> None:
        command, now = order.command, self._now
        assert command is not None
        task = Task(order, command, now, said=Utterance.of(now, order, self.profile.voices))
        self.tasks[task.id] = task
        before = self._looped.pop(task.name, None)
        if self._exclusive and not order.beside:
            self._end_loops_on(order.devices)
        if self.profile.commands[command.type].feedback:
            task.ends = max(now + self._loop(command), task.said.ends if task.said else 0)
        if before is None:
            self._begin(task)
        elif order.loop > 1 and not order.resumed and before.goals:
            task.goals = before.goals
            for goal in task.goals:
                goal.task = task
                self._calls.append(Again(goal.begin.key))
        else:
            self._cancel(before)
            self._begin(task)

    def _loop(self, command: Command) -> int:
        """How long (ms) a loop of a feedback Command takes."""
        return self.profile.durations.get(command.type, self.profile.loop)

    def _begin(self, task: Task) -> None:
        """Make the goals of an AB: its motion, what it says, and what it listens for."""
        kind, devices = task.command.type, task.order.devices
        lost = sorted(devices & self._missing.keys())
        if lost:
            task.failed = lost[0], self._missing[lost[0]]
            return
        if kind == "q-and-a":
            self.ear.ask(task.id, task.command)
            task.asks = True
        if kind == "pause":
            task.ends = self._now + int(task.command.args["time"])
        elif kind not in ("speak", "q-and-a"):
            self._goal(task, kind, devices - {"speaker"} if task.said is not None else devices)
        if task.said is not None:
            self._goal(task, SAY, devices & {"speaker"})
        elif kind in ("speak", "q-and-a"):
            task.ends = self._now + 1
        if kind == "q-and-a":
            records = task.command.cued("record")
            self._goal(task, RECORD if records else LISTEN, devices - {"speaker"})

    def _goal(self, task: Task, kind: str, devices: frozenset[str]) -> None:
        self._serial += 1
        spoken = task.said.ends if task.said is not None else 0
        says = task.said if kind == SAY else None
        begin = Begin(
            f"{task.name}/{self._serial}",
            kind,
            task.command if says is None else says.left(),
            devices,
            spoken,
            task.ends,
            self._loop(task.command),
            task.order.beside,
            (bounds_of(task.command) if kind == RECORD else None) or RecordingBounds(),
        )
        goal = Goal(begin, task)
        task.goals.append(goal)
        self._goals[begin.key] = goal
        self._try(goal)

    def _try(self, goal: Goal) -> None:
        """Tell the driver, unless one of the devices is still stopping, or lost."""
        devices = goal.begin.devices
        if devices & self._missing.keys():
            return
        stopping = {
            name
            for one in self._goals.values()
            if one.cancelled
            for name in one.begin.devices & devices
        }
        if stopping:
            goal.held = goal.held or (self._now, min(stopping))
            return
        if goal.held is not None and goal.held[0] < self._now:
            since, device = goal.held
            self._inbound.append(Delayed(goal.task.id, device, self._now - since))
        goal.begun, goal.since = True, self._now
        self._calls.append(goal.begin)

    def _cancel(self, task: Task) -> None:
        """Let the goals of an AB end as soon as they can."""
        for goal in list(task.goals):
            self._cancel_goal(goal)

    def _cancel_goal(self, goal: Goal) -> None:
        if not goal.begun:
            if goal.begin.kind == SAY:
                goal.task.heard = 0
            self._over(goal)
        elif not goal.cancelled:
            goal.cancelled, goal.since = True, self._now
            self._calls.append(Cancel(goal.begin.key))

    def _drop(self, task: Task) -> None:
        """An AB is no longer carried out; its goals may still have to stop."""
        del self.tasks[task.id]
        self.ear.drop(task.id)

    def _end_loops_on(self, devices: frozenset[str]) -> None:
        """Something else begins on devices of a feedback Command, which so makes no other loop."""
        for other in list(self._looped.values()):
            if other.order.devices & devices:
                self._cancel(self._looped.pop(other.name))

    def end_loops(self) -> None:
        """F5: feedback Commands that were not ordered to go on are over."""
        looped, self._looped = self._looped, {}
        for task in looped.values():
            self._cancel(task)

    # Reports ------------------------------------------------------------------------

    def report(self, now: int, report: Report) -> None:
        """Take what a driver reports; one of a goal that is over counts for nothing."""
        self._now = now
        match report:
            case Lost():
                self._lose(report)
            case Back():
                for device in sorted(report.devices & self._missing.keys()):
                    del self._missing[device]
                    self._inbound.append(Presence(device, True))
            case _ if (goal := self._goals.get(report.key)) is not None and goal.begun:
                self._hear(goal, report)

    def _hear(self, goal: Goal, report: Accepted | Progress | Done | Stopped | Broke) -> None:
        task = goal.task
        if isinstance(report, Accepted | Progress):
            goal.accepted = True
            goal.since = goal.since if goal.cancelled else self._now
            return
        self._over(goal)
        if goal.cancelled:  # however it has ended
            self._note_end(task, goal.begin, report)
            if self.tasks.get(task.id) is not task and not task.goals:
                self._tell_halted(task)
        elif isinstance(report, Done):
            task.data.update(report.data)
        elif isinstance(report, Stopped):
            self._fail(task, min(goal.begin.devices, default="none"), "it stopped by itself")
        else:
            task.lacks = report.lacks
            self._fail(task, report.device, report.reason)

    def _over(self, goal: Goal) -> None:
        """A goal has ended: its devices are free."""
        del self._goals[goal.begin.key]
        goal.task.goals.remove(goal)

    def _fail(self, task: Task, device: str, reason: str) -> None:
        """E1: an AB fails as a whole."""
        if self.tasks.get(task.id) is task:
            task.failed = device, reason
            self._cancel(task)

    def _lose(self, lost: Lost) -> None:
        """Devices are gone: what ran on them fails, what was stopping has stopped."""
        for device in sorted(lost.devices - self._missing.keys()):
            self._missing[device] = lost.reason
            self._inbound.append(Presence(device, False, lost.reason))
        for goal in list(self._goals.values()):
            gone = sorted(goal.begin.devices & lost.devices)
            if gone and goal.begin.key in self._goals:
                report = Broke(goal.begin.key, gone[0], lost.reason)
                goal.begun = True
                self._hear(goal, report)

    def _note_share(self, task: Task) -> None:
        """X2: how much of an AB had been done, as far as its times tell."""
        question, said = self.ear.questions.get(task.id), task.said
        known = (task.ends, question.until if question else None, said.ends if said else None)
        ends = max((time for time in known if time is not None), default=0)
        began = task.began - (said.skipped if said is not None else 0)
        if ends > task.began:
            task.timed = (self._now - began) / (ends - began)

    @staticmethod
    def _note_end(task: Task, goal: Begin, report: Done | Stopped | Broke) -> None:
        """X2: how much of a goal had been done that was to stop, as its driver tells."""
        if isinstance(report, Stopped) and report.share is not None:
            task.shares.append(report.share)
        if goal.kind == SAY and isinstance(report, Done):
            task.heard = len(goal.command.text or "")
        elif goal.kind == SAY and isinstance(report, Stopped):
            task.heard = report.said

    def _tell_halted(self, task: Task) -> None:
        """X2: say how much had been done of an AB that was interrupted."""
        if not task.halting:
            return
        said = task.said
        timed = task.timed if said is None or task.heard is None else said.share(task.heard)
        shares = [*task.shares, *([] if timed is None else [timed])]
        data: dict[str, Json] = {"done": round(min(max(min(shares, default=0.0), 0.0), 1.0), 3)}
        if said is not None:
            data |= said.heard(self._now, task.heard)
        elif task.command.text:
            data["heard"] = task.command.text.strip()
        self._inbound.append(Halted(task.id, data))

    # Time ---------------------------------------------------------------------------

    def due(self, visible: bool) -> int | None:
        """The next instant at which something is to be reported, if one is known (ms)."""
        now = self._now
        due = [task.ends for task in self.tasks.values() if task.ends and task.ends > now]
        late = (goal.late(self._limits(goal.begin)) for goal in self._goals.values())
        times = (self.sight.due(now, visible), self.ear.due(), *late)
        due += [time for time in times if time is not None]
        if self._inbound or any(task.failed for task in self.tasks.values()):
            due.append(now + 1)
        return min(due, default=None)

    def collect(self, now: int, visible: bool, where: Data) -> list[Inbound]:
        """What has to be told the session at ``now``.

        Args:
            now: the time.
            visible: whether the camera sees the user.
            where: their distance (m) and angle (degrees).
        """
        self._now = now
        self.end_loops()
        self._give_up_late()
        reports, self._inbound = self._inbound, []
        for task in self._in_order():
            reports += self._report(task, where)
        searching = any(one.command.type == SEARCH for one in self.tasks.values())
        return reports + self.sight.look(now, visible, where, searching)

    def failures(self) -> list[Inbound]:
        """What has failed since :meth:`collect`."""
        return [one for task in self._in_order() if task.failed for one in self._report(task, {})]

    def _in_order(self) -> list[Task]:
        """The tasks as they are told: a motion that another composes with before that one (X5)."""
        tasks, motions = list(self.tasks.values()), self.profile.motions
        return sorted(tasks, key=lambda one: one.command.type in motions) if motions else tasks

    def _report(self, task: Task, where: Data) -> list[Inbound]:
        """What has become of an AB."""
        over = task.ends is None or task.ends <= self._now
        if task.failed is not None:
            self._leave(task)
            if task.lacks:
                lacking: Data = {"outcome": NO_RESOURCE, "message": task.failed[1]}
                return [Ended(task.id, True, lacking)]
            return [Failed(task.id, *task.failed)]
        if task.command.type == "q-and-a":
            return self._ask(task, over)
        if not over or task.has(SAY):
            return []
        if self.profile.commands[task.command.type].feedback:
            return self._end_loop(task, where)
        if task.goals:
            return []
        self._leave(task)
        return [Ended(task.id, True, task.data)]

    def _ask(self, task: Task, over: bool) -> list[Inbound]:
        """A question listens when it has been asked, and ends when nobody answers it."""
        if task.asks and over and not task.has(SAY):
            task.asks, task.ends = False, None
            return [Listening(task.id)] if self.ear.listen(self._now, task.id) else []
        unanswered = self.ear.unanswered(self._now, task.id)
        if unanswered:
            self._leave(task)
        return unanswered

    def _end_loop(self, task: Task, where: Data) -> list[Inbound]:
        """U2: a loop of a feedback Command ends; its goal goes on if another loop follows."""
        reached = not task.goals
        self._drop(task)
        self._marks.end(self._now, task.order.app, task.said)
        if not reached:
            self._looped[task.name] = task
        pose = self._pose() if "locomotion" in task.order.devices else {}
        ended = Ended(task.id, reached, {**pose, **task.data})
        if reached and task.command.type == SEARCH:
            return [ended, self.sight.find(where)]
        return [ended]

    def _leave(self, task: Task) -> None:
        """An AB has come to its end."""
        self._drop(task)
        self._cancel(task)
        self._marks.end(self._now, task.order.app, task.said)

    def _give_up_late(self) -> None:
        """Give up goals whose drivers take too long; one that does not stop is not safe."""
        for goal in list(self._goals.values()):
            late = goal.late(self._limits(goal.begin))
            if late is None or late > self._now or goal.begin.key not in self._goals:
                continue
            if goal.cancelled:
                reason = "the device does not stop"
                self._calls.append(Safe(reason))
                self._lose(Lost(goal.begin.devices, reason))
            else:
                what = "answer" if goal.accepted else "accept it"
                reason = f"the device does not {what}"
                self._fail(goal.task, min(goal.begin.devices, default="none"), reason)

    # What the user says ---------------------------------------------------------------

    def speech_begins(self, now: int) -> None:
        """The user begins to speak: a question that may be interrupted listens."""
        self._now = now
        task = self.tasks.get(self.ear.speech_begins())
        if task is None or not task.asks:
            return
        task.ends = now + 1
        if task.said is not None:
            task.said.ends = now
        for goal in [one for one in task.goals if one.begin.kind == SAY]:
            self._cancel_goal(goal)

    def longest_answer(self) -> int:
        """How long the user may speak (ms); 0 without end (VoiceXML 2.0, 6.3.2)."""
        cues = (cue for task in self.tasks.values() for cue in task.command.cues)
        return next((int(cue.value or 0) for cue in cues if cue.kind == "longest"), 0)

    def marks_passed(self, began: int) -> dict[str, Json]:
        """The last mark passed when the user began to speak, as :class:`prima.messages.Heard` has it."""
        question = self.ear.question
        spoken = (task for task in self.tasks.values() if task.command.type == "speak")
        task = self.tasks[question.id] if question is not None else next(spoken, None)
        return self._marks.heard(began, task.order.app, task.said) if task is not None else {}
