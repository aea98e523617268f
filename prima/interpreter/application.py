"""An application as a state machine without I/O or clock.

An :class:`Interpreter` is told what happens (``start``, ``event``, ``notice``,
``sensed``, ``expire``) and appends what its application wants to ``actions``.
Between two calls it waits; a call takes no simulated time. What it does in a form
is :mod:`prima.interpreter.form`; how it finds handlers, :mod:`prima.interpreter.handling`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import count
from typing import TYPE_CHECKING, Any

from prima.grammar.answers import Answers
from prima.interpreter.bounds import Visit
from prima.interpreter.content import Executor
from prima.interpreter.elements import (
    Declare,
    Document,
    Field,
    Form,
    Link,
    Script,
    SendOut,
    Watch,
    all_items,
)
from prima.interpreter.form import Algorithm, confidence_level
from prima.interpreter.frame import Abandoned, Fiber, Frame, GoForm
from prima.interpreter.handling import Handling
from prima.interpreter.owner import FORM_STEPS
from prima.interpreter.places import source
from prima.interpreter.plain import PlainEngine, is_plain
from prima.interpreter.protocol import App
from prima.interpreter.sensors import NOTHING_READ, sensors_read
from prima.interpreter.transfers import (
    GoBack,
    GoItem,
    GoOut,
    Thrown,
    Transfer,
    thrown_of,
)
from prima.markup.tree import Node
from prima.messages import (
    PROMOTED,
    CloseUnit,
    Command,
    Data,
    Event,
    GoOn,
    Hypothesis,
    LeaveState,
    Notice,
    Promote,
    Raise,
    Request,
    Say,
    Step,
    Understood,
)
from prima.script.budget import Budget
from prima.script.evaluation import Scope, ScriptError
from prima.script.isolated import Engines

if TYPE_CHECKING:
    from prima.script.isolated import AnyEngine

MAX_TIMERS = 256


class Interpreter(App["AnyEngine | PlainEngine"]):
    """Runs one document. ``arguments`` are the motion arguments of the robot's own Commands.

    ``engines`` makes what evaluates the document's code, if it needs one.
    """

    def __init__(
        self,
        document: Document,
        arguments: Mapping[str, frozenset[str]] | None = None,
        engines: Engines | None = None,
    ) -> None:
        self.document = document
        self.arguments = arguments or {}
        super().__init__(document.id, document.kind, evaluator_of(document, engines or Engines()))
        self.application = self.engine.named("application")
        self.visits.append(Visit(self.name, 0, "document", document.node, document.file))
        self.execute = Executor(self)
        self.handling = Handling(self)
        self.algorithm = Algorithm(self)
        self.frame: Frame | None = None
        self._waiting: dict[int, Fiber] = {}
        self._timers: list[tuple[int, int, str, Data, int]] = []
        """Delayed events: when, serial number, name, data, and the state they belong to."""
        self._timer_serial = count(1)
        self.untold = False
        """Whether the variable ``sensor`` has old values: it is told the new ones when code runs."""
        self.reports = 0
        """How often sensors have had new values."""
        self.reported: dict[str, int] = {}
        """Which of the reports was the latest, by the first part of a sensor's name."""
        self.cause: int | str | None = None
        self.fresh: tuple[int | str, int] | None = None
        """A cause, and for how long (ms) a reaction to it is worth starting (X8)."""
        """What is requested next reacts to this event: its serial, or the name of an own one (C5)."""
        self._timed = "session" in document.node.source.text
        """Whether the document looks at the clock at all."""

    def start(self, now: int) -> None:
        """Begin with the first form."""
        self._tick(now)
        first = next(iter(self.document.forms.values()))
        self._guard(self._enter, first)

    def takes(self, name: str) -> bool:
        """Whether a handler in scope takes an event."""
        frame = self.frame
        return frame is not None and bool(self.handling.takers(frame, frame.item, name))

    def event(self, now: int, event: Event) -> None:
        """Something happened that every application is told of, or this one alone."""
        if now != self.now:
            if self._timed:
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
        """The mediator tells the fate of Commands."""
        self._tick(now)
        if self.over:
            return
        if notice.what == "unit-timeout":
            self._guard(self.handling.unit_timeout, notice)
        elif notice.what in ("ended", "interrupted", "expired"):
            kind = "end" if notice.what == "ended" else notice.what
            self._guard(self.handling.command_event, notice, kind)
        else:
            fiber = self._waiting.pop(notice.run, None)
            if fiber is not None and fiber.waiting == notice.run:
                self._guard(self.count_wait, fiber.began, self._going_on_at(fiber))
                if self.over:
                    return
                self.cause = notice.cause
                self._guard(self._resume, fiber, notice)
                self.cause = None
            if notice.what == "cancelled":
                self._guard(self.handling.command_event, notice, notice.event.partition(".")[0])

    @staticmethod
    def _going_on_at(fiber: Fiber) -> Node:
        """The element in which a piece of content goes on."""
        frame = fiber.frame
        return frame.item.node if frame.item is not None else frame.form.node

    def sensed(self, now: int, values: Data) -> list[str]:
        """Sensor values changed: gives the events whose conditions turned true (C6)."""
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
            self._guard(self._look, watch, raised)
            if self.over:  # what the watch came to has ended it
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
        budget = self._budget()
        for text, confidence in said:
            for link in (*frame.form.links, *self.document.links):
                tell = partial(self._no_match, link.node)
                if confidence >= least and link.answers.match(text, budget, tell) is not None:
                    return link
                if budget.steps <= 0:
                    self.give_up(link.node, "what it listens for takes too long")
        return None

    def follow(self, now: int, link: Link, event: Event) -> None:
        """The user has said what a link listens for."""
        self._tick(now)
        self.note(link.node)
        if link.event:
            self.event(now, Event(link.event, event.serial, event.data))
            return
        self.cause = event.serial
        frame = self.frame
        if frame is not None:
            self._guard(self.transfer, frame, GoForm(link.form))
        self.cause = None

    def answer(self, run: int, said: Sequence[Hypothesis]) -> Understood | None:
        """What the asking field makes of what the user said, or None if it takes no such.

        The likeliest hypothesis that it takes counts, if the recogniser is sure enough of it.
        """
        asking = self._asking(run)
        if asking is None:
            return None
        form, field = asking
        least = confidence_level(self.document, form, field)
        budget, tell = self._budget(), partial(self._no_match, field.node)
        for text, confidence in said:
            value = field.answers.match(text, budget, tell) if confidence >= least else None
            if budget.steps <= 0:
                self.give_up(field.node, "what it listens for takes too long")
            if value is not None:
                return Understood(value, text, confidence)
        return None

    def _budget(self) -> Budget:
        """What one utterance may take of this application's engine, in which tags run."""
        engine = self.engine
        return Budget(engine.now, host=getattr(engine, "host", None))

    def _no_match(self, node: Node, message: str) -> None:
        """A tag failed, so that its grammar does not take what was said."""
        self.actions.append(Say("log", f"no match: {message}", source(node)))

    def listening(self) -> Sequence[Answers]:
        """What the links of the form and the document take (V1)."""
        if self.frame is None or self.over:
            return ()
        return [link.answers for link in (*self.frame.form.links, *self.document.links)]

    def answers(self, run: int) -> Answers | None:
        """What the asking field takes, if a field asks."""
        asking = self._asking(run)
        return asking[1].answers if asking is not None else None

    def _asking(self, run: int) -> tuple[Form, Field] | None:
        fiber = self._waiting.get(run)
        item = fiber.frame.item if fiber is not None else None
        return (fiber.frame.form, item) if fiber and isinstance(item, Field) else None

    def expire(self, now: int) -> list[tuple[str, Data]]:
        """Give the application's own delayed events that are due."""
        if not self._timers:
            return []
        due = sorted((t for t in self._timers if t[0] <= now), key=lambda t: t[:2])
        self._keep_timers([timer for timer in self._timers if timer[0] > now])
        return [(name, data) for _, _, name, data, _ in due]

    def request(self, steps: list[Step], fiber: Fiber) -> int:
        """Ask the mediator for Commands; the first one after an event is a reaction (C5)."""
        number = next(self.runs)
        frame = fiber.frame
        fresh = self.fresh[1] if self.fresh and self.fresh[0] == self.cause else None
        asked = Request(number, steps, frame.state, self.take_cause(), fiber.unit, fresh=fresh)
        asked.hold = frame.form.hold
        if frame.item is not None and frame.item.hold is not None:
            asked.hold = frame.item.hold
        asked.words = self.words(frame.form)
        frame.asked = True
        asked.connect = self.connects(frame) and any(says(step) for step in steps)
        if asked.connect:
            frame.connected = True
        self.actions.append(asked)
        self._waiting[number] = fiber
        fiber.waiting, fiber.began = number, self.now
        return number

    def words(self, form: Form) -> Command | None:
        """What the robot says first when the state's stream resumes (X9)."""
        if not form.words:
            return None
        place = source(form.node)
        return Command("speak", text=form.words, lang=self.document.lang, source=place)

    def take_cause(self) -> int | None:
        """The serial of the event that a request reacts to, which no further one does (C5)."""
        cause, self.cause = self.cause, None
        if isinstance(cause, str):
            self.actions.append(Promote(cause))
            return PROMOTED
        return cause

    @staticmethod
    def connects(frame: Frame) -> bool:
        """Whether the robot has to face the user before the state's next word (X4)."""
        asks = isinstance(frame.item, Field) and frame.item.connect
        return asks or (frame.form.connect and not frame.connected)

    def delay(self, act: SendOut, data: Data, milliseconds: int, fiber: Fiber) -> None:
        """Raise an event here later, unless the state is left before."""
        if len(self._timers) >= MAX_TIMERS:
            message = f"more than {MAX_TIMERS} delayed events"
            raise Thrown.at(act.node, "error.semantic", message)
        due = self.now + max(milliseconds, 1)
        if milliseconds <= 1:  # who sends himself one after the other loops without ever waiting
            self.hurried = due
        timer = (due, next(self._timer_serial), act.event, data, fiber.frame.state)
        self._keep_timers([*self._timers, timer])

    def _keep_timers(self, timers: list[tuple[int, int, str, Data, int]]) -> None:
        self._timers = timers
        self.deadline = min((timer[0] for timer in timers), default=None)

    def _tick(self, now: int) -> None:
        if now != self.now:
            self.renew(now)
            if self._timed and not self.over:
                self._guard(self.engine.clock, self.application, now / 1000)

    def _guard(self, act: Callable[..., object], *given: Any) -> None:
        """Do something for the application."""
        try:
            act(*given)
        except (Thrown, ScriptError, GoOut) as error:
            self._rescue(error)

    def _rescue(self, error: Thrown | ScriptError | GoOut) -> None:
        """Seek a handler of an event; one that nobody handles ends the application (5.2.5)."""
        try:
            if isinstance(error, GoOut):
                raise error
            self._seek_handler(thrown_of(error))
        except (Thrown, ScriptError) as unhandled:
            self.quit_unhandled(thrown_of(unhandled))
        except GoOut as out:
            self.quit(out.reason, out.failed, out.source)

    def _seek_handler(self, thrown: Thrown) -> None:
        """An error outside all content, as in a condition of a handler, has handlers too."""
        frame = self.frame
        if thrown.sought or frame is None:
            raise thrown
        self.handling.dispatch(thrown.event, frame, thrown.source)

    def leave_states(self) -> None:
        """O3: leave the form, and those that have called it."""
        while self.frame is not None:
            self.leave(self.frame)
            self.frame = self.frame.caller
        self._keep_timers([])

    def _resume(self, fiber: Fiber, notice: Notice) -> None:
        """Go on with content whose Commands have met their fate."""
        fiber.waiting = None
        self.drive(fiber, notice)

    def drive(self, fiber: Fiber, notice: Notice | None) -> None:
        """Run a fiber until it waits or ends, then carry out a transfer of control."""
        assert fiber.content is not None
        try:
            if notice is None:
                next(fiber.content)
            else:
                fiber.content.send(notice)
            return
        except (Thrown, ScriptError):
            self._drop(fiber)
            raise
        except StopIteration:
            self._drop(fiber)
            self.go_on(fiber.frame)
        except Abandoned:
            self._drop(fiber)
            fiber.frame.stalled = fiber.frame.stalled or fiber.main
        except Transfer as transfer:
            self._drop(fiber)
            self.transfer(fiber.frame, transfer)

    def go_on(self, frame: Frame) -> None:
        """A handler has ended: a form that was waiting looks for items to visit again."""
        if (
            not frame.form.items
            or frame is not self.frame
            or frame.stalled
            or any(one.main for one in frame.fibers)
        ):
            return
        pending = self.begin(frame, setup=False)
        if pending is not None:
            self.transfer(*pending)

    def _drop(self, fiber: Fiber) -> None:
        frame = fiber.frame
        if frame.fibers:
            frame.fibers = tuple(one for one in frame.fibers if one is not fiber)

    def transfer(self, frame: Frame, transfer: Transfer) -> None:
        """Leave a state for another; goto chains go round here, not deeper."""
        while self.frame is not frame and self.frame is not None:
            self.leave(self.frame)  # a subdialog that the state had called
            self.frame = self.frame.caller
        pending: tuple[Frame, Transfer] | None = (frame, transfer)
        while pending is not None:
            frame, transfer = pending
            if isinstance(transfer, GoForm):
                self.leave(frame)
                form = self.document.forms[transfer.form]
                pending = self.begin(self.frame_for(form, frame))
            elif isinstance(transfer, GoOut):
                raise transfer
            elif isinstance(transfer, GoItem):
                pending = self.go_item(frame, transfer)
            else:
                assert isinstance(transfer, GoBack)
                pending = self._go_back(frame, transfer)

    def go_item(self, frame: Frame, transfer: GoItem) -> tuple[Frame, Transfer] | None:
        """Go on with another item of the same form; the form's own content starts anew there."""
        if any(fiber.main for fiber in frame.fibers):
            # A handler leaves what the state was doing: O3 for the item instead of the form.
            self.leave(frame)
            frame.state, frame.asked = next(self.states), False
        frame.next_item = transfer.item
        frame.reprompt = True
        return self.begin(frame, setup=False)

    def _go_back(self, frame: Frame, transfer: GoBack) -> tuple[Frame, Transfer] | None:
        """Come back from a subdialog, with values or an event (VoiceXML 2.3.4, 5.3.10)."""
        caller = frame.caller
        if caller is None:
            raise GoOut("return")
        self.leave(frame)
        self.frame = caller
        main = next((one for one in caller.fibers if one.main), None)
        if main is None or main.content is None:
            return None
        notice = Notice("done", 0, data={"result": transfer.values}, event=transfer.event)
        try:
            main.content.send(notice)
        except (Thrown, ScriptError):
            self._drop(main)
            raise
        except (StopIteration, Abandoned):
            self._drop(main)
        except Transfer as further:
            self._drop(main)
            return caller, further
        return None

    def forget(self, fiber: Fiber) -> None:
        """Give up a piece of content; nobody hears any more of what it waited for."""
        if fiber.waiting is not None:
            self._waiting.pop(fiber.waiting, None)
        self._drop(fiber)
        if fiber.content is not None:
            try:
                fiber.content.close()
            except ValueError:
                pass  # it is the fiber that brought us here

    def leave(self, frame: Frame) -> None:
        """O3: the state's content ends, its units are concluded, its Commands are given up."""
        outer = frame.caller.form if frame.caller is not None and not self.over else None
        name = outer.id if outer is not None else ""
        self.visits.append(
            Visit(self.name, self.now, "leave", outer.node if outer is not None else None, name)
        )
        if frame.fibers:
            for fiber in frame.fibers:
                self.forget(fiber)
        if frame.units:
            self.close_units(frame)
        if self._timers:
            self._keep_timers([timer for timer in self._timers if timer[4] != frame.state])
        if frame.asked:  # else the mediator knows nothing of the state
            self.actions.append(LeaveState(frame.state))

    def close_units(self, frame: Frame) -> None:
        """U5: conclude every unit that the state is in."""
        for number, _ in reversed(frame.units):
            self.actions.append(CloseUnit(number))
        frame.units = ()

    def _enter(self, form: Form) -> None:
        pending = self.begin(self.frame_for(form, None))
        if pending is not None:
            self.transfer(*pending)

    def frame_for(self, form: Form, before: Frame | None) -> Frame:
        """A frame for a form entered by goto (keeping the document's scope) or at the start."""
        document = before.document if before else self.new_document()
        frame = Frame(form, next(self.states), document, self.engine.named("dialog"))
        if before is None:
            frame.fresh = True
        elif before.caller is not None:
            frame.caller, frame.called_by = before.caller, before.called_by
        return frame

    def new_document(self) -> object:
        """An empty document scope."""
        return self.engine.named("document")

    def set_up_document(self, frame: Frame) -> None:
        """Declare the document's variables and run its scripts; they see no dialog."""
        frame.fresh = False
        alone = Frame(frame.form, frame.state, frame.document, self.engine.nothing)
        self._set_up(self.document.setup, frame.document, Fiber(alone))

    def _set_up(self, setup: Sequence[Declare | Script], scope: Scope, fiber: Fiber) -> None:
        for act in setup:
            if isinstance(act, Declare):
                self.execute.declare(act, scope, fiber)
            else:
                self.execute.script(act, scope, fiber)

    def begin(self, frame: Frame, setup: bool = True) -> tuple[Frame, Transfer] | None:
        """Start a form's own content; gives a transfer of control that it ends in at once."""
        self.frame, form = frame, frame.form
        self.visits.append(Visit(self.name, self.now, "enter", form.node, form.id))
        self.note(form.node)
        if frame.form.bare and not (frame.fresh or frame.called_by):
            return None  # nothing more can happen until the next event
        self.count_step(form.node, FORM_STEPS)
        frame.stalled = frame.entering = False
        fiber = Fiber(frame, main=True)
        fiber.content = self.algorithm.interpret(frame, fiber, setup)
        frame.fibers += (fiber,)
        try:
            next(fiber.content)
        except (Thrown, ScriptError):
            self._drop(fiber)
            raise
        except (StopIteration, Abandoned):
            self._drop(fiber)
        except Transfer as transfer:
            self._drop(fiber)
            return frame, transfer
        return None

    def arm_watches(self, frame: Frame) -> None:
        """C6: what a form watches for counts from its entry, true already or not.

        Events that are raised so are handled before the form's content begins, which
        :meth:`go_on_entering` lets begin: a handler may leave the form (O3).
        """
        self.handling.forget_watches(frame.form.watches)
        if frame.form.watches and self.sensors:
            self.untold = True
            names = self.handling.check_watches(frame.form.watches)
            if names:
                self.actions += [*map(Raise, names), GoOn(frame.state)]
                frame.entering = True

    def go_on_entering(self, state: int) -> None:
        """Begin a form's content, unless a handler of the events of its entry has left it."""
        frame = self.frame
        while frame is not None and frame.state != state:
            frame = frame.caller
        if frame is None or not frame.entering:
            return
        frame.entering = False
        for fiber in frame.fibers:
            if fiber.main:
                self._guard(self.drive, fiber, Notice("done", 0))

    def initialise(self, frame: Frame, fiber: Fiber) -> None:
        """Declare the form's variables and items (the algorithm's initialisation)."""
        call = frame.called_by
        given: set[str] = set()
        if call is not None and frame.caller is not None:
            outer = Fiber(frame.caller)
            for name, value in self.execute.named(call.params, outer, call.node).items():
                self.engine.set(frame.dialog, name, value)
                given.add(name)
        setup = [
            act for act in frame.form.setup if not (isinstance(act, Declare) and act.name in given)
        ]
        self._set_up(setup, frame.dialog, fiber)
        for item in all_items(frame.form.items):
            self.execute.declare(Declare(item.name, item.expr, item.node), frame.dialog, fiber)


def evaluator_of(document: Document, engines: Engines) -> AnyEngine | PlainEngine:
    """What evaluates a document's code: Python where that is all it needs."""
    return PlainEngine() if is_plain(document) else engines.engine(document.id, document.kind)


def says(step: Step) -> bool:
    """Whether a step of a request says anything."""
    if isinstance(step.what, Command):
        return step.what.text is not None
    return any(says(inner) for inner in step.what.steps)
