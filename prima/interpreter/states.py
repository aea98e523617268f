"""The states of an application: forms that are entered, called, and left."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any, NamedTuple

from prima.interpreter.acts import Declare, Script
from prima.interpreter.bounds import ElementVisit
from prima.interpreter.content import Executor
from prima.interpreter.elements import Document, Form, all_items
from prima.interpreter.form import Algorithm
from prima.interpreter.frame import Abandoned, Content, Fiber, Frame, GoForm
from prima.interpreter.handling import Handling
from prima.interpreter.owner import FORM_STEPS, Evaluating, Owner
from prima.interpreter.pyengine import PythonEngine, is_python
from prima.interpreter.transfers import GoBack, GoItem, GoOut, Thrown, Transfer, thrown_of
from prima.messages import CloseUnit, Data, LeaveState, Notice, Raise
from prima.script.evaluation import Scope, ScriptError
from prima.script.isolated import Engines


class Timer(NamedTuple):
    """A delayed event."""

    due: int
    """When it is raised (ms)."""
    event: str
    data: Data
    state: int
    """The state that it belongs to."""


class States(Owner):
    """One document with its active form, and the content waiting there.

    Args:
        document: what it runs.
        arguments: the motion arguments of the robot's own Commands.
        engines: makes the evaluator of the document's code, if it needs one.
    """

    execute: Executor
    handling: Handling
    algorithm: Algorithm
    timers: tuple[Timer, ...] = ()
    """Delayed events, in the order in which they were asked for."""

    def __init__(
        self,
        document: Document,
        arguments: Mapping[str, frozenset[str]] | None = None,
        engines: Engines | None = None,
    ) -> None:
        self.document = document
        self.arguments = arguments or {}
        super().__init__(document.id, document.kind, evaluator_of(document, engines or Engines()))
        self.execute = Executor(self)
        self.handling = Handling(self)
        self.algorithm = Algorithm(self)
        self.application = self.engine.named("application")
        self.visits.append(ElementVisit(self.name, 0, "document", document.node, document.file))
        self.waiting: dict[int, Fiber] = {}
        self.reported = {}

    def guard(self, act: Callable[..., object], *given: Any) -> None:
        """Do something for the application, handling its errors."""
        try:
            act(*given)
        except (Thrown, ScriptError, GoOut) as error:
            self._rescue(error)

    def _rescue(self, error: Thrown | ScriptError | GoOut) -> None:
        """Find a handler of an event; an unhandled one ends the application (5.2.5)."""
        try:
            if isinstance(error, GoOut):
                raise error
            self._seek_handler(thrown_of(error))
        except (Thrown, ScriptError) as unhandled:
            self.quit_unhandled(thrown_of(unhandled))
        except GoOut as out:
            self.quit(out.reason, out.failed)

    def _seek_handler(self, thrown: Thrown) -> None:
        """Find a handler of an error outside all content, as in a handler's condition."""
        frame = self.frame
        if thrown.sought or frame is None:
            raise thrown
        self.handling.dispatch(thrown.event, frame, thrown.source)

    def leave_states(self) -> None:
        """O3: leave the form, and those that have called it."""
        while self.frame is not None:
            self.leave(self.frame)
            self.frame = self.frame.caller
        self.note(None, "leave")
        self.keep_timers(())

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
            if not fiber.main:  # the form's own content has looked for items itself
                self.go_on(fiber.frame)
        except Abandoned:
            self._drop(fiber)
            fiber.frame.stalled = fiber.frame.stalled or fiber.main
        except Transfer as transfer:
            self._drop(fiber)
            self.transfer(fiber.frame, transfer)

    def go_on(self, frame: Frame) -> None:
        """Continue after a handler's end: a waiting form looks for items to visit again."""
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
            self.close_units(frame)

    def transfer(self, frame: Frame, transfer: Transfer) -> None:
        """Leave a state for another; chains of gotos loop here instead of nesting."""
        while self.frame is not frame and self.frame is not None:
            self.leave(self.frame)  # a subdialog that the state had called
            self.frame = self.frame.caller
        pending: tuple[Frame, Transfer] | None = (frame, transfer)
        while pending is not None:
            frame, transfer = pending
            if isinstance(transfer, GoBack):
                pending = self._go_back(frame, transfer)
            else:
                pending = self.go_to(frame, transfer)

    def go_to(self, frame: Frame, transfer: Transfer) -> tuple[Frame, Transfer] | None:
        """Go to a form or an item; gives the transfer of control if that ends at once.

        Raises:
            Transfer: it leads out of the application, or back from a subdialog.
        """
        if isinstance(transfer, GoForm):
            self.leave(frame)
            return self.begin(self.frame_for(self.document.forms[transfer.form], frame))
        if isinstance(transfer, GoItem):
            return self._go_item(frame, transfer)
        raise transfer

    def _go_item(self, frame: Frame, transfer: GoItem) -> tuple[Frame, Transfer] | None:
        """Go to another item of the same form; the form's own content restarts there."""
        if any(fiber.main for fiber in frame.fibers):
            # A handler leaves what the state was doing: O3 for the item instead of the form.
            self.leave(frame)
            frame.state, frame.asked = next(self.states), False
        frame.next_item = transfer.item
        frame.silent = ""
        return self.begin(frame, setup=False)

    def _go_back(self, frame: Frame, transfer: GoBack) -> tuple[Frame, Transfer] | None:
        """Return from a subdialog, with values or an event (VoiceXML 2.3.4, 5.3.10)."""
        caller = frame.caller
        if caller is None:
            raise GoOut("return")
        self.leave(frame)
        self.frame = caller
        self.note(None, "leave", caller.form.id)
        if caller.form.watches:
            self.guard(self._look_again, caller.form)
        main = next((one for one in caller.fibers if one.main), None)
        if main is None or main.content is None:
            return None
        notice = Notice("done", 0, data={"result": transfer.values}, event=transfer.event)
        return self._go_along(main, lambda content: content.send(notice))

    def _go_along(
        self, fiber: Fiber, resume: Callable[[Content], object]
    ) -> tuple[Frame, Transfer] | None:
        """Run a state's own content until it waits or ends; gives the transfer that ends it."""
        assert fiber.content is not None
        try:
            resume(fiber.content)
        except (Thrown, ScriptError):
            self._drop(fiber)
            raise
        except (StopIteration, Abandoned):
            self._drop(fiber)
        except Transfer as transfer:
            self._drop(fiber)
            return fiber.frame, transfer
        return None

    def _look_again(self, form: Form) -> None:
        """C6: raise the events whose conditions turned true during a subdialog."""
        self.untold = True
        self.actions += map(Raise, self.handling.check_watches(form.watches))

    def forget(self, fiber: Fiber) -> None:
        """Give up a piece of content, with everything that it waits for."""
        if fiber.waiting is not None:
            self.waiting.pop(fiber.waiting, None)
        self._drop(fiber)
        if fiber.content is not None:
            try:
                fiber.content.close()
            except ValueError:
                pass  # the fiber that is running this

    def leave(self, frame: Frame) -> None:
        """O3: end the state's content, conclude its units, give up its Commands.

        The mediator hears of the state first: a unit that waits belongs to the stream that goes on.
        """
        if frame.asked:  # otherwise the mediator does not know the state
            self.actions.append(LeaveState(frame.state))
        if frame.fibers:
            for fiber in frame.fibers:
                self.forget(fiber)
        if self.timers:
            self.keep_timers(timer for timer in self.timers if timer.state != frame.state)

    def close_units(self, frame: Frame) -> None:
        """U5: conclude the units in which nothing is going on any more."""
        for number, _ in reversed(frame.units):
            if not frame.inside(number):
                frame.units = tuple(one for one in frame.units if one[0] != number)
                self.actions.append(CloseUnit(number))

    def keep_timers(self, timers: Iterable[Timer]) -> None:
        """Set the delayed events, and when the first one is due."""
        self.timers = tuple(timers)
        self.deadline = min((timer.due for timer in self.timers), default=None)

    def enter(self, form: Form) -> None:
        """Enter the first form."""
        pending = self.begin(self.frame_for(form, None))
        if pending is not None:
            self.transfer(*pending)

    def frame_for(self, form: Form, before: Frame | None) -> Frame:
        """A frame for a form entered by goto (keeping the document's scope) or at the start."""
        document = before.document if before else self.engine.named("document")
        frame = Frame(form, next(self.states), document, self.engine.named("dialog"))
        if before is None:
            frame.fresh = True
        elif before.caller is not None:
            frame.caller, frame.called_by = before.caller, before.called_by
            frame.given = before.given
        return frame

    def set_up_document(self, frame: Frame) -> None:
        """Declare the document's variables and run its scripts, which see no dialog."""
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
        """Start a form's own content; gives the transfer of control if it ends at once."""
        self.frame, form = frame, frame.form
        self.note(form.node, "enter", form.id)
        if frame.form.bare and not (frame.fresh or frame.called_by):
            return None  # nothing more can happen until the next event
        self.count_step(form.node, FORM_STEPS)
        frame.stalled = frame.entering = False
        fiber = Fiber(frame, main=True)
        fiber.content = self.algorithm.interpret(frame, fiber, setup)
        frame.fibers += (fiber,)
        return self._go_along(fiber, next)

    def initialise(self, frame: Frame, fiber: Fiber) -> None:
        """Declare the form's variables and items (the algorithm's initialisation)."""
        given = frame.params
        if given:
            self.engine.unset(frame.dialog, *given)
            self.engine.fill(frame.dialog, frame.given)
        setup = [
            act for act in frame.form.setup if not (isinstance(act, Declare) and act.name in given)
        ]
        self._set_up(setup, frame.dialog, fiber)
        for empty, items in groupby(all_items(frame.form.items), lambda one: one.expr is None):
            if empty:
                self.engine.unset(frame.dialog, *(one.name for one in items))
                continue
            for one in items:
                self.execute.declare(Declare(one.name, one.expr, one.node), frame.dialog, fiber)


def evaluator_of(document: Document, engines: Engines) -> Evaluating:
    """The evaluator of a document's code: Python if that is all it needs."""
    return PythonEngine() if is_python(document) else engines.engine(document.id, document.kind)
