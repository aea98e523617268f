"""An application as a state machine without I/O or clock.

An :class:`Interpreter` is notified of what happens (``start``, ``event``, ``notice``,
``sensed``, ``expire``) and appends what its application wants to ``actions``.
Between two calls it waits; a call takes no simulated time. What it does in a form
is :mod:`prima.interpreter.form`; how it finds handlers, :mod:`prima.interpreter.handling`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from prima.grammar.answers import Answers
from prima.interpreter.acts import SendOut
from prima.interpreter.elements import Field, Form, Link, Unit, Watch
from prima.interpreter.form import confidence_level
from prima.interpreter.frame import Fiber, Frame, GoForm
from prima.interpreter.places import source
from prima.interpreter.sensors import NOTHING_READ, sensors_read
from prima.interpreter.states import States, Timer
from prima.interpreter.transfers import GoOut, Thrown
from prima.markup.tree import Node
from prima.messages import (
    PROMOTED,
    Command,
    Data,
    Event,
    GoOn,
    Hypothesis,
    Notice,
    Promote,
    Raise,
    Request,
    Say,
    Step,
    Understood,
)
from prima.script.evaluation import ScriptError

MAX_TIMERS = 256


class Interpreter(States):
    """Runs one document."""

    def start(self, now: int) -> None:
        """Begin with the first form."""
        self._tick(now)
        first = next(iter(self.document.forms.values()))
        self.guard(self.enter, first)

    def takes(self, name: str) -> bool:
        """Whether a handler in scope takes an event."""
        frame = self.frame
        return frame is not None and bool(self.handling.takers(frame, frame.item, name))

    def event(self, now: int, event: Event) -> None:
        """Deliver an event for every application, or for this one alone."""
        if now != self.now:
            if self.document.timed:
                self._tick(now)
            else:
                self.renew(now)
        frame = self.frame
        if frame is not None:
            try:
                self.handling.dispatch(event, frame)
            except (Thrown, ScriptError, GoOut) as error:
                self._rescue(error)
        self.cause = None

    def notice(self, now: int, notice: Notice) -> None:
        """The mediator reports what became of Commands."""
        self._tick(now)
        if self.over:
            return
        fiber = self.waiting.get(notice.run)
        asker = fiber.frame if fiber is not None else None
        if notice.what == "unit-timeout":
            self.guard(self.handling.unit_timeout, notice)
        elif notice.what in ("ended", "interrupted", "expired"):
            kind = "end" if notice.what == "ended" else notice.what
            self.guard(self.handling.command_event, notice, kind, asker)
        else:
            self.waiting.pop(notice.run, None)
            if fiber is not None and fiber.waiting == notice.run:
                at = fiber.frame.item or fiber.frame.form
                self.guard(self.count_wait, fiber.began, at.node)
                if self.over:
                    return
                self.cause = notice.cause
                self.guard(self._resume, fiber, notice)
                self.cause = None
            if notice.what == "cancelled":
                name = notice.event.partition(".")[0]
                self.guard(self.handling.command_event, notice, name, asker)

    def sensed(self, now: int, values: Data) -> list[str]:
        """Note new sensor values; gives the events whose conditions turned true (C6)."""
        self._tick(now)
        self.sensors.update(values)
        self.reports += 1
        for name in values:
            self.reported[name.partition(".")[0]] = self.reports
        if self.over:
            return []
        watches = self.handling.watches()
        self.untold = self.untold or bool(watches) or sensors_read(self.document) != NOTHING_READ
        if not watches:
            return []
        raised: list[str] = []
        for watch in watches:
            self.guard(self._look, watch, raised)
            if self.over:  # evaluating the watch has ended it
                return []
        return raised

    def _look(self, watch: Watch, raised: list[str]) -> None:
        raised += self.handling.check_watches([watch])

    def listens_to(self, said: Sequence[Hypothesis]) -> Link | None:
        """The link that takes what the user said, innermost scope first (V1)."""
        frame = self.frame
        if frame is None:
            return None
        least = confidence_level(self.document, frame.form)
        budget = self.utterance()
        for text, confidence in said:
            for link in (*frame.form.links, *self.document.links):
                tell = partial(self._no_match, link.node)
                if confidence >= least and link.answers.match(text, budget, tell) is not None:
                    return link
                if budget.steps <= 0:
                    self.give_up(link.node, "what it listens for takes too long")
        return None

    def follow(self, now: int, link: Link, event: Event) -> None:
        """Follow a link whose words the user has said."""
        self._tick(now)
        self.note(link.node)
        if link.event:
            self.event(now, Event(link.event, event.serial, event.data))
            return
        self.cause = event.serial
        frame = self.frame
        if frame is not None:
            self.guard(self.transfer, frame, GoForm(link.form))
        self.cause = None

    def answer(self, run: int, said: Sequence[Hypothesis]) -> Understood | None:
        """How the asking field interprets what the user said; None if it does not take it.

        The most likely hypothesis that it takes counts, if its confidence is high enough.
        """
        asking = self._asking(run)
        if asking is None:
            return None
        form, field = asking
        least = confidence_level(self.document, form, field)
        budget, tell = self.utterance(), partial(self._no_match, field.node)
        for text, confidence in said:
            value = field.answers.match(text, budget, tell) if confidence >= least else None
            if budget.steps <= 0:
                self.give_up(field.node, "what it listens for takes too long")
            if value is not None:
                return Understood(value, text, confidence)
        return None

    def _no_match(self, node: Node, message: str) -> None:
        """A tag failed, so its grammar does not take the utterance."""
        self.actions.append(Say("log", f"no match: {message}", source(node)))

    def listening(self) -> Sequence[Answers]:
        """The answers that the links of the form and the document take (V1)."""
        if self.frame is None or self.over:
            return ()
        return [link.answers for link in (*self.frame.form.links, *self.document.links)]

    def answers(self, run: int) -> Answers | None:
        """The answers that the asking field takes, if a field asks."""
        asking = self._asking(run)
        return asking[1].answers if asking is not None else None

    def _asking(self, run: int) -> tuple[Form, Field] | None:
        fiber = self.waiting.get(run)
        item = fiber.frame.item if fiber is not None else None
        return (fiber.frame.form, item) if fiber and isinstance(item, Field) else None

    def expire(self, now: int) -> tuple[str, Data] | None:
        """Take the first of the application's own delayed events that are due."""
        first = min(self.timers, key=lambda timer: timer.due, default=None)
        if first is None or first.due > now:
            return None
        self.keep_timers(timer for timer in self.timers if timer is not first)
        return first.event, first.data

    def request(self, steps: list[Step], fiber: Fiber) -> int:
        """Ask the mediator for Commands; the first one after an event is a reaction (C5)."""
        number = next(self.runs)
        frame = fiber.frame
        fresh, cause = self.fresh_for(), self.take_cause()
        asked = Request(number, steps, frame.state, cause, fiber.unit, fresh=fresh)
        asked.hold = frame.form.hold
        if frame.item is not None and frame.item.hold is not None:
            asked.hold = frame.item.hold
        asked.words = self.words(frame.form)
        frame.asked = True
        asked.connect = self.connects(frame) and any(says(step) for step in steps)
        if asked.connect:
            frame.connected = True
        self.actions.append(asked)
        self.waiting[number] = fiber
        fiber.waiting, fiber.began = number, self.now
        return number

    def words(self, form: Form) -> Command | None:
        """The words with which the state's stream resumes (X9)."""
        if not form.words:
            return None
        place = source(form.node)
        return Command("speak", text=form.words, lang=self.document.lang, source=place)

    def take_cause(self) -> int | None:
        """Take the serial of the event that a request reacts to; no later request does (C5)."""
        cause, self.cause = self.cause, None
        if isinstance(cause, str):
            self.actions.append(Promote(cause))
            return PROMOTED
        return cause

    @staticmethod
    def connects(frame: Frame) -> bool:
        """Whether the robot has to face the user before the state's next word (X4)."""
        item = frame.item.items[0] if isinstance(frame.item, Unit) else frame.item
        asks = isinstance(item, Field) and item.connect
        return asks or (frame.form.connect and not frame.connected)

    def delay(self, act: SendOut, data: Data, milliseconds: int, fiber: Fiber) -> None:
        """Raise an event here later, unless the state is left before."""
        if len(self.timers) >= MAX_TIMERS:
            message = f"more than {MAX_TIMERS} delayed events"
            raise Thrown.at(act.node, "error.semantic", message)
        due = self.now + max(milliseconds, 1)
        if milliseconds <= 1:  # sending itself one after another, it loops without ever waiting
            self.hurried = due
        self.keep_timers([*self.timers, Timer(due, act.event, data, fiber.frame.state)])

    def _tick(self, now: int) -> None:
        if now != self.now:
            self.renew(now)
            if self.document.timed and not self.over:
                self.guard(self.engine.clock, self.application, now / 1000)

    def _resume(self, fiber: Fiber, notice: Notice) -> None:
        """Resume content whose Commands have ended or been cancelled."""
        fiber.waiting = None
        self.drive(fiber, notice)

    def arm_watches(self, frame: Frame) -> None:
        """C6: arm a form's watches at its entry, whether their conditions hold already or not.

        Events raised this way are handled before :meth:`go_on_entering` begins the form's
        content: a handler may leave the form (O3).
        """
        self.handling.forget_watches(frame.form.watches)
        if frame.form.watches and self.sensors:
            self.untold = True
            names = self.handling.check_watches(frame.form.watches)
            if names:
                self.actions += [*map(Raise, names), GoOn(frame.state)]
                frame.entering = True
                frame.caused = self.cause, self.fresh

    def go_on_entering(self, state: int) -> None:
        """Begin a form's content, unless a handler of the events of its entry has left it."""
        frame = self.frame
        while frame is not None and frame.state != state:
            frame = frame.caller
        if frame is None or not frame.entering:
            return
        frame.entering = False
        self.cause, self.fresh = frame.caused  # these events keep the reactive flag (C5)
        for fiber in frame.fibers:
            if fiber.main:
                self.guard(self.drive, fiber, Notice("done", 0))
        self.cause = None


def says(step: Step) -> bool:
    """Whether a step of a request speaks."""
    if isinstance(step.what, Command):
        return step.what.text is not None
    return any(says(inner) for inner in step.what.steps)
