"""The conductor: turns orders into drivers' goals, and drivers' reports into inbound values.

It is sans-IO, and the same for simulated and real robots. Its caller passes in orders, reports
and the time; it returns calls for the drivers and values for the session.

A device is free once its driver has confirmed it: an order for a device that is still stopping
is held back, and no device ever gets orders for two things at once.
"""

from __future__ import annotations

from collections.abc import Callable

from prima.devices.ear import Ear
from prima.devices.goals import (
    SAY,
    Accepted,
    Again,
    Back,
    Begin,
    Broke,
    Call,
    Done,
    Lost,
    Progress,
    Report,
    Safe,
    Stand,
    Stopped,
)
from prima.devices.profile import Profile
from prima.devices.senses import Sensors, Sight
from prima.devices.settings import FOREVER, DriverLimits
from prima.devices.speech import SpeechMarks, Utterance
from prima.devices.tasks import SEARCH, Goal, OpenGoals, Task, searches
from prima.messages import Command, Data, Ended, Failed, Inbound, Json, Listening, Order
from prima.messages.times import earliest

NO_RESOURCE = "error.noresource"
"""The outcome of a question whose answer cannot be recorded (VoiceXML 2.0, 5.2.6)."""


class Conductor:
    """Turns orders into goals for drivers, and reports into ends, failures and answers.

    Args:
        profile: the robot.
        pose: returns the robot's current pose, which Commands that move it report.
        limits: how long drivers may take over a goal.
        exclusive: whether a device does one thing at a time. Without a mediator it does not:
            a goal that begins takes it over.
        start: when the run begins or resumes (ms).
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
        self._inbound: list[Inbound] = []
        """Values not yet returned."""
        self._goals = OpenGoals(self._inbound)
        self._looped: dict[str, Task] = {}
        """Feedback Commands whose loop has ended at this instant: another may follow (U2)."""
        self._now = self._collected = start
        """The latest report or order, and the latest call of :meth:`collect`."""

    def drain(self) -> list[Call]:
        """Return the calls for drivers made since the last time, in order.

        Goals that were held back begin here if their devices are free by now.
        """
        return self._goals.drain(self._now)

    # Orders -------------------------------------------------------------------------

    def order(self, now: int, order: Order) -> None:
        """Take an order of the mediator."""
        self._now = now
        if order.verb == "start":
            self._start(order)
        elif order.verb == "stop":
            self.end_loops()
            self._goals.calls.append(Stand())
        elif (task := self.tasks.get(order.behavior)) is not None:
            task.halting = order.verb == "interrupt"
            self.sight.again |= searches([task])
            question = self.ear.questions.get(task.id)
            task.note_share(now, question.until if question else None)
            self._drop(task)
            self._goals.cancel(self._now, task)
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
                self._goals.calls.append(Again(goal.begin.key))
        else:
            self._goals.cancel(self._now, before)
            self._begin(task)

    def _loop(self, command: Command) -> int:
        """How long (ms) a loop of a feedback Command takes."""
        return self.profile.lasts(command.type) or self.profile.loop

    def _begin(self, task: Task) -> None:
        """Make the goals of an AB: its motion, its text, and the answer it listens for."""
        kind, lost = task.command.type, sorted(task.order.devices & self._goals.missing.keys())
        if lost:
            task.failed = lost[0], self._goals.missing[lost[0]]
            return
        if kind == "q-and-a":
            self.ear.ask(task.id, task.command)
            task.asks = True
        if kind == "pause":
            task.ends = self._now + int(task.command.args["time"])
        elif kind in ("speak", "q-and-a") and task.said is None:
            task.ends = self._now + 1
        for part, on in task.parts(self.profile.commands[kind].devices):
            self._goals.add(self._now, task, part, on, self._loop(task.command))

    def _drop(self, task: Task) -> None:
        """Note that an AB is no longer carried out; its goals may still have to stop."""
        del self.tasks[task.id]
        self.ear.drop(task.id)

    def _end_loops_on(self, devices: frozenset[str]) -> None:
        """End a feedback Command on whose devices something else begins: it loops no more."""
        for other in list(self._looped.values()):
            if other.order.devices & devices:
                self._goals.cancel(self._now, self._looped.pop(other.name))

    def end_loops(self) -> None:
        """F5: end the feedback Commands that were not ordered to go on."""
        looped, self._looped = self._looped, {}
        self.sight.again |= searches(looped.values())
        for task in looped.values():
            self._goals.cancel(self._now, task)

    # Reports ------------------------------------------------------------------------

    def report(self, now: int, report: Report) -> None:
        """Take a driver's report; reports on a goal that is over are ignored."""
        self._now = now
        match report:
            case Lost():
                self._lose(report)
            case Back():
                self._goals.bring_back(report.devices)
            case _ if (goal := self._goals.open.get(report.key)) is not None and goal.begun:
                self._hear(goal, report)

    def _hear(self, goal: Goal, report: Accepted | Progress | Done | Stopped | Broke) -> None:
        task = goal.task
        if isinstance(report, Accepted | Progress):
            goal.accepted = True
            goal.since = goal.since if goal.cancelled else self._now
            return
        self._goals.over(goal)
        if goal.cancelled:  # however it has ended
            task.note_end(goal.begin, report)
            if self.tasks.get(task.id) is not task and not task.goals:
                self._tell_halted(task)
            elif task.asks:  # the user has interrupted it: now it listens
                task.ends = self._now + 1
        elif isinstance(report, Done):
            task.data.update(report.data)
        elif isinstance(report, Stopped):
            self._fail(task, goal.begin.device, "it stopped by itself")
        else:
            task.lacks = report.lacks
            self._fail(task, report.device, report.reason)

    def _fail(self, task: Task, device: str, reason: str) -> None:
        """E1: an AB fails as a whole."""
        if self.tasks.get(task.id) is task:
            task.failed = device, reason
            self._goals.cancel(self._now, task)

    def _lose(self, lost: Lost) -> None:
        """Devices are lost: what ran on them fails, what was stopping has stopped."""
        self._goals.lose(lost.devices, lost.reason)
        for goal in list(self._goals.open.values()):
            gone = sorted(goal.begin.devices & lost.devices)
            if gone and goal.begin.key in self._goals.open:
                report = Broke(goal.begin.key, gone[0], lost.reason)
                goal.begun = True
                self._hear(goal, report)

    def _tell_halted(self, task: Task) -> None:
        if task.halting:
            pose = self._pose() if "locomotion" in task.order.devices else {}
            self._inbound.append(task.halted(self._now, pose))

    # Time ---------------------------------------------------------------------------

    def due(self, visible: bool) -> int | None:
        """When the next report is due (ms), if known."""
        now, tasks = self._now, self.tasks.values()
        ends = [task.ends for task in tasks if task.ends and task.ends > self._collected]
        late = [goal.late(self._limits(goal.begin)) for goal in self._goals.open.values()]
        due = earliest(self.sight.due(now, visible), self.ear.due(), *ends, *late)
        if self._inbound or any(task.failed for task in tasks):
            due = earliest(due, now + 1)
        return due

    def collect(self, now: int, visible: bool, where: Data) -> list[Inbound]:
        """The reports for the session at ``now``.

        Args:
            now: the time.
            visible: whether the camera sees the user.
            where: their distance (m) and angle (degrees).
        """
        self._now = self._collected = now
        self.end_loops()
        self.sight.again = False
        self._give_up_late()
        reports = list(self._inbound)
        self._inbound.clear()
        for task in self._in_order():
            reports += self._report(task, where)
        searching = searches([*self.tasks.values(), *self._looped.values()])
        return reports + self.sight.look(now, visible, where, searching)

    def failures(self) -> list[Inbound]:
        """The failures since :meth:`collect`."""
        return [one for task in self._in_order() if task.failed for one in self._report(task, {})]

    def _in_order(self) -> list[Task]:
        """The tasks in reporting order: a motion before one that is composed with it (X5)."""
        tasks, motions = list(self.tasks.values()), self.profile.motions
        return sorted(tasks, key=lambda one: one.command.type in motions) if motions else tasks

    def _report(self, task: Task, where: Data) -> list[Inbound]:
        """Report what has become of an AB."""
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
        """A question listens once it has been asked, and ends if nobody answers it."""
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
        self._goals.cancel(self._now, task)
        self._marks.end(self._now, task.order.app, task.said)

    def _give_up_late(self) -> None:
        """Give up goals whose drivers take too long; a goal that does not stop is unsafe."""
        for goal in list(self._goals.open.values()):
            late = goal.late(self._limits(goal.begin))
            if late is None or late > self._now or goal.begin.key not in self._goals.open:
                continue
            if goal.cancelled:
                reason = "the device does not stop"
                self._goals.calls.append(Safe())
                self._lose(Lost(goal.begin.devices, reason))
            else:
                what = "answer" if goal.accepted else "accept it"
                self._fail(goal.task, goal.begin.device, f"the device does not {what}")

    # What the user says ---------------------------------------------------------------

    def speech_begins(self, now: int) -> None:
        """The user begins to speak: an interruptible question listens."""
        self._now = now
        task = self.tasks.get(self.ear.speech_begins())
        if task is None or not task.asks:
            return
        task.ends = now + 1
        if task.said is not None:
            task.said.ends = now
        for goal in [one for one in task.goals if one.begin.kind == SAY]:
            self._goals.cancel_goal(self._now, goal)

    def longest_answer(self) -> int:
        """How long the user may speak (ms); 0 for no limit (VoiceXML 2.0, 6.3.2)."""
        cues = (cue for task in self.tasks.values() for cue in task.command.cues)
        return next((int(cue.value or 0) for cue in cues if cue.kind == "longest"), 0)

    def marks_passed(self, began: int) -> dict[str, Json]:
        """The last mark passed when the user began to speak, as :class:`prima.messages.Heard` has it."""
        question = self.ear.question
        spoken = (task for task in self.tasks.values() if task.command.type == "speak")
        task = self.tasks[question.id] if question is not None else next(spoken, None)
        return self._marks.heard(began, task.order.app, task.said) if task is not None else {}
