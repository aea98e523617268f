"""The Form Interpretation Algorithm (VoiceXML 2.0, 2.1.6 and appendix C) without I/O or clock.

An :class:`Interpreter` is told what happens (``start``, ``event``, ``notice``,
``sensed``, ``expire``) and appends what its application wants to ``actions``.
Between two calls it waits; a call takes no simulated time.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import count

from prima.interpreter.content import Executor, source
from prima.interpreter.elements import (
    Block,
    Declare,
    Document,
    Expression,
    Field,
    Filled,
    Form,
    Handler,
    Item,
    Link,
    Subdialog,
    Unit,
    Watch,
    all_items,
)
from prima.interpreter.expressions import Engine, ScriptError
from prima.interpreter.frame import (
    Abandoned,
    Content,
    Fiber,
    Frame,
    GoBack,
    GoForm,
    GoItem,
    GoOut,
    Thrown,
    Transfer,
)
from prima.interpreter.selection import prefixes, select_handler
from prima.markup.tree import Node
from prima.messages import (
    Action,
    CloseUnit,
    Command,
    Data,
    Event,
    Json,
    LeaveState,
    Notice,
    OpenUnit,
    Quit,
    Request,
    Say,
    Send,
    Step,
)

MAX_STEPS = 20_000
"""Pieces of content that an application may go through in one instant."""
MAX_FIBERS = 64
"""Handlers that may be under way at once in a state."""
MAX_DEPTH = 32
"""Subdialogs inside subdialogs, and events thrown while one is handled."""
MAX_TIMERS = 256
REPROMPTED = frozenset({"noinput", "nomatch", "help"})


class Interpreter:
    """Runs one document. ``arguments`` are the motion arguments of the robot's own Commands."""

    def __init__(
        self, document: Document, arguments: Mapping[str, frozenset[str]] | None = None
    ) -> None:
        self.document = document
        self.name = document.id
        self.kind = document.kind
        self.arguments = arguments or {}
        self.engine = Engine()
        self.actions: list[Action] = []
        self.now = 0
        self.over = False
        self.application = self.engine.scope()
        self._execute = Executor(self)
        self._frame: Frame | None = None
        self._waiting: dict[int, Fiber] = {}
        self._runs = count(1)
        self._states = count(1)
        self._units = count(1)
        self._sends = count(1)
        self._timers: list[tuple[int, int, str, Data, int]] = []
        """Delayed events: when, serial number, name, data, and the state they belong to."""
        self._timer_serial = count(1)
        self._armed: dict[int, bool] = {}
        self._sensors: dict[str, Json] = {}
        self._cause: int | None = None
        self._serial = 0
        self._steps = 0
        self._instant = -1

    # What happens ---------------------------------------------------------------

    def start(self, now: int) -> None:
        """Begin with the first form."""
        self._tick(now)
        first = next(iter(self.document.forms.values()))
        self._guard(lambda: self._enter(first, None))

    def event(self, now: int, event: Event) -> None:
        """Something happened that every application is told of, or this one alone."""
        self._tick(now)
        self._serial = event.serial
        if self._frame is not None:
            frame = self._frame
            self._guard(lambda: self._dispatch(event, frame))
        self._cause = None

    def notice(self, now: int, notice: Notice) -> None:
        """The mediator tells the fate of Commands."""
        self._tick(now)
        if self.over:
            return
        if notice.what == "unit-timeout":
            self._guard(lambda: self._unit_timeout(notice))
        elif notice.what == "ended":
            self._guard(lambda: self._command_event(notice, "end"))
        else:
            fiber = self._waiting.pop(notice.run, None)
            if fiber is not None and fiber.waiting == notice.run:
                self._guard(lambda: self._resume(fiber, notice))
            if notice.what == "cancelled":
                self._guard(lambda: self._command_event(notice, "cancel"))

    def sensed(self, now: int, values: Data) -> list[str]:
        """Sensor values changed: gives the events whose conditions turned true (C6)."""
        self._tick(now)
        self._sensors.update(values)
        if self.over:
            return []
        raised: list[str] = []
        watches = self._watches()
        if watches:
            self._guard(lambda: raised.extend(self._check_watches(watches)))
        return raised

    def listens_to(self, text: str) -> Link | None:
        """The link that takes what the user said, innermost scope first (V1)."""
        frame = self._frame
        if frame is None:
            return None
        for link in (*frame.form.links, *self.document.links):
            if link.grammar.match(text) is not None:
                return link
        return None

    def follow(self, now: int, link: Link, event: Event) -> None:
        """The user has said what a link listens for."""
        self._tick(now)
        if link.event:
            self.event(now, Event(link.event, event.serial, event.data))
            return
        self._serial = self._cause = event.serial
        frame = self._frame
        if frame is not None:
            self._guard(lambda: self._transfer(frame, GoForm(link.form)))
        self._cause = None

    def answer(self, run: int, text: str) -> Json:
        """The value of the asking field for what the user said, or None if it takes no such."""
        fiber = self._waiting.get(run)
        item = fiber.frame.item if fiber is not None else None
        return item.answers.match(text) if isinstance(item, Field) else None

    @property
    def deadline(self) -> int | None:
        """When :meth:`expire` wants to be called, if ever."""
        return None if self.over else min((timer[0] for timer in self._timers), default=None)

    def expire(self, now: int) -> list[tuple[str, Data]]:
        """Give the application's own delayed events that are due."""
        due = sorted((t for t in self._timers if t[0] <= now), key=lambda t: t[:2])
        self._timers = [timer for timer in self._timers if timer[0] > now]
        return [(name, data) for _, _, name, data, _ in due]

    def stop(self) -> None:
        """The application is taken out of the robot."""
        self._quit("unloaded")

    # For the executor -------------------------------------------------------------

    def internal(self, name: str, message: str, command: Command | None = None) -> Event:
        """An event of the application's own."""
        data: dict[str, Json] = {"message": message}
        if command is not None:
            data["command"] = command.type
        return Event(name, self._serial, data, reactive=False)

    def count_step(self, node: Node) -> None:
        """Bound what an application does in one instant; a document may loop for ever."""
        self._steps += 1
        if self._steps > MAX_STEPS:
            place = source(node)
            raise GoOut(f"{place}: error.semantic: it loops without ever waiting", True, place)

    def request(self, steps: list[Step], fiber: Fiber) -> int:
        """Ask the mediator for Commands; the first one after an event is a reaction (C5)."""
        number = next(self._runs)
        cause, self._cause = self._cause, None
        self.actions.append(Request(number, steps, fiber.frame.state, cause, fiber.unit))
        self._waiting[number] = fiber
        fiber.waiting = number
        return number

    def send(self, service: str, data: Json, place: str) -> None:
        """Ask a service something."""
        self.actions.append(Send(service, data, next(self._sends), place))

    def delay(self, name: str, data: Data, milliseconds: int, fiber: Fiber) -> None:
        """Raise an event here later, unless the state is left before."""
        if len(self._timers) >= MAX_TIMERS:
            raise Thrown(self.internal("error.semantic", f"more than {MAX_TIMERS} delayed events"))
        due = self.now + max(milliseconds, 1)
        self._timers.append((due, next(self._timer_serial), name, data, fiber.frame.state))

    # Driving fibers ---------------------------------------------------------------

    def _tick(self, now: int) -> None:
        if now != self._instant:
            self._instant = self.now = now
            self._steps = 0
            if not self.over:
                self.engine.set(self.application, "session", {"time": now / 1000})

    def _guard(self, act: object) -> None:
        """Do something for the application; an event nobody handles ends it (VoiceXML 5.2.5)."""
        try:
            act()  # type: ignore[operator]
        except Thrown as thrown:
            self._unhandled(thrown)
        except GoOut as out:
            self._quit(out.reason, out.failed, out.source)
        except ScriptError as error:
            self._quit(f"error.semantic: {error}", failed=True)

    def _unhandled(self, thrown: Thrown) -> None:
        event = thrown.event
        message = str(event.data.get("message", ""))
        self.actions.append(Say("error", f"{event.name}: {message}", thrown.source))
        self._quit(f"{event.name}: {message}", failed=True, place=thrown.source)

    def _quit(self, reason: str, failed: bool = False, place: str = "") -> None:
        if self.over:
            return
        self.over = True
        while self._frame is not None:
            self._leave(self._frame)
            self._frame = self._frame.caller
        self._timers.clear()
        self.actions.append(Quit(reason, failed, place))

    def _resume(self, fiber: Fiber, notice: Notice) -> None:
        """Go on with content whose Commands have met their fate."""
        fiber.waiting = None
        self._drive(fiber, notice)

    def _drive(self, fiber: Fiber, notice: Notice | None) -> None:
        """Run a fiber until it waits or ends, then carry out a transfer of control."""
        assert fiber.content is not None
        try:
            if notice is None:
                next(fiber.content)
            else:
                fiber.content.send(notice)
            return
        except StopIteration:
            self._drop(fiber)
            self._go_on(fiber.frame)
        except Abandoned:
            self._drop(fiber)
            fiber.frame.stalled = fiber.frame.stalled or fiber.main
        except Transfer as transfer:
            self._drop(fiber)
            self._transfer(fiber.frame, transfer)

    def _go_on(self, frame: Frame) -> None:
        """A handler has ended: a form that was waiting looks for items to visit again."""
        if frame is not self._frame or frame.stalled or any(one.main for one in frame.fibers):
            return
        pending = self._begin(frame, setup=False)
        if pending is not None:
            self._transfer(*pending)

    def _drop(self, fiber: Fiber) -> None:
        if fiber in fiber.frame.fibers:
            fiber.frame.fibers.remove(fiber)

    def _transfer(self, frame: Frame, transfer: Transfer) -> None:
        """Leave a state for another; goto chains go round here, not deeper."""
        while self._frame is not None and self._frame is not frame:
            self._leave(self._frame)  # a subdialog that the state had called
            self._frame = self._frame.caller
        pending: tuple[Frame, Transfer] | None = (frame, transfer)
        while pending is not None:
            frame, transfer = pending
            if isinstance(transfer, GoOut):
                raise transfer
            if isinstance(transfer, GoItem):
                pending = self._go_item(frame, transfer)
            elif isinstance(transfer, GoForm):
                self._leave(frame)
                form = self.document.forms[transfer.form]
                self.count_step(form.node)
                pending = self._begin(self._frame_for(form, frame))
            else:
                assert isinstance(transfer, GoBack)
                pending = self._go_back(frame, transfer)

    def _go_item(self, frame: Frame, transfer: GoItem) -> tuple[Frame, Transfer] | None:
        """Go on with another item of the same form; the form's own content starts anew there."""
        if any(fiber.main for fiber in frame.fibers):
            # A handler leaves what the state was doing: O3 for the item instead of the form.
            self._leave(frame)
            frame.state = next(self._states)
        frame.next_item = transfer.item
        frame.reprompt = True
        return self._begin(frame, setup=False)

    def _go_back(self, frame: Frame, transfer: GoBack) -> tuple[Frame, Transfer] | None:
        """Come back from a subdialog, with values or an event (VoiceXML 2.3.4, 5.3.10)."""
        caller = frame.caller
        if caller is None:
            raise GoOut("return")
        fiber = Fiber(frame, local=self.engine.scope())
        result = {}
        scopes = self._execute.scopes(fiber)
        for name in transfer.names:
            result[name] = self.engine.value(name, scopes)
        self._leave(frame)
        self._frame = caller
        main = next((one for one in caller.fibers if one.main), None)
        if main is None or main.content is None:
            return None
        data = {"result": result}
        notice = Notice("done", 0, data=data, event=transfer.event)
        try:
            main.content.send(notice)
        except (StopIteration, Abandoned):
            self._drop(main)
        except Transfer as further:
            self._drop(main)
            return caller, further
        return None

    def _forget(self, fiber: Fiber) -> None:
        if fiber.waiting is not None:
            self._waiting.pop(fiber.waiting, None)
        self._drop(fiber)
        if fiber.content is not None:
            try:
                fiber.content.close()
            except ValueError:
                pass  # it is the fiber that brought us here

    def _leave(self, frame: Frame) -> None:
        """O3: the state's content ends, its units are concluded, its Commands are given up."""
        for fiber in list(frame.fibers):
            self._forget(fiber)
        self._close_units(frame)
        self._timers = [timer for timer in self._timers if timer[4] != frame.state]
        self.actions.append(LeaveState(frame.state))

    def _close_units(self, frame: Frame) -> None:
        for number, _ in reversed(frame.units):
            self.actions.append(CloseUnit(number))
        frame.units.clear()

    # Entering forms ---------------------------------------------------------------

    def _enter(self, form: Form, caller: Frame | None) -> None:
        frame = self._frame_for(form, None)
        pending = self._begin(frame)
        if pending is not None:
            self._transfer(*pending)

    def _frame_for(self, form: Form, before: Frame | None) -> Frame:
        """A frame for a form entered by goto (keeping the document's scope) or at the start."""
        document = before.document if before else self._new_document()
        frame = Frame(form, next(self._states), document, self.engine.scope())
        if before is not None:
            frame.caller, frame.called_by = before.caller, before.called_by
        return frame

    def _new_document(self) -> object:
        """A document scope with the document's variables and scripts (VoiceXML 5.1.2)."""
        scope = self.engine.scope()
        self.engine.put(scope, "document", scope)
        self.engine.put(self.application, "application", self.application)
        frame = Frame(next(iter(self.document.forms.values())), 0, scope, self.engine.scope())
        fiber = Fiber(frame, local=self.engine.scope())
        self._set_up(self.document.setup, scope, fiber)
        return scope

    def _set_up(self, setup: list, scope: object, fiber: Fiber) -> None:  # type: ignore[type-arg]
        for act in setup:
            if isinstance(act, Declare):
                self._execute.declare(act, scope, fiber)
            else:
                self._execute.script(act, scope, fiber)

    def _begin(self, frame: Frame, setup: bool = True) -> tuple[Frame, Transfer] | None:
        """Start a form's own content; gives a transfer of control that it ends in at once."""
        self._frame = frame
        frame.stalled = False
        fiber = Fiber(frame, main=True, local=self.engine.scope())
        fiber.content = self._interpret(frame, fiber, setup)
        frame.fibers.append(fiber)
        try:
            next(fiber.content)
        except (StopIteration, Abandoned):
            self._drop(fiber)
        except Transfer as transfer:
            self._drop(fiber)
            return frame, transfer
        return None

    def _initialise(self, frame: Frame, fiber: Fiber) -> None:
        """Declare the form's variables and items (the algorithm's initialisation)."""
        self.engine.put(frame.dialog, "dialog", frame.dialog)
        call = frame.called_by
        given: set[str] = set()
        if call is not None and frame.caller is not None:
            outer = Fiber(frame.caller, local=self.engine.scope())
            for name, value in self._execute.named(call.params, outer).items():
                self.engine.set(frame.dialog, name, value)
                given.add(name)
        setup = [
            act for act in frame.form.setup if not (isinstance(act, Declare) and act.name in given)
        ]
        self._set_up(setup, frame.dialog, fiber)
        for item in all_items(frame.form.items):
            self._execute.declare(Declare(item.name, item.expr, item.node), frame.dialog, fiber)

    # The algorithm ------------------------------------------------------------------

    def _interpret(self, frame: Frame, fiber: Fiber, setup: bool) -> Content:
        """Select, visit, process, until no item is left; then the form waits for events."""
        if setup:
            yield from self._catching(frame, fiber, None, self._setup_content(frame, fiber))
        yield from self._visit_all(frame, fiber, frame.form.items, None)

    def _setup_content(self, frame: Frame, fiber: Fiber) -> Content:
        self._initialise(frame, fiber)
        return
        yield 0

    def _visit_all(
        self, frame: Frame, fiber: Fiber, items: list[Item], unit: Unit | None
    ) -> Content:
        while True:
            item = self._select(frame, fiber, items)
            if item is None:
                return
            self.count_step(item.node)
            frame.item = item
            yield from self._catching(frame, fiber, item, self._visit(frame, fiber, item))
            frame.item = unit

    def _select(self, frame: Frame, fiber: Fiber, items: list[Item]) -> Item | None:
        """The item that a goto names, else the first undefined one whose condition holds."""
        wanted, target = frame.next_item, None
        if wanted:
            for item in items:
                if item.name == wanted or (
                    isinstance(item, Unit) and wanted in {one.name for one in item.items}
                ):
                    target = item
            if target is not None and target.name == wanted:
                frame.next_item = ""
            return target
        for item in items:
            if not self.engine.defined(frame.dialog, item.name) and (
                item.cond is None or self._execute.condition(item.cond, fiber)
            ):
                return item
        return None

    def _visit(self, frame: Frame, fiber: Fiber, item: Item) -> Content:
        match item:
            case Block():
                self.engine.set(frame.dialog, item.name, True)
                fiber.local = self.engine.scope()
                yield from self._execute.run(item.content, fiber)
            case Field():
                yield from self._collect(frame, fiber, item)
            case Subdialog():
                yield from self._call(frame, fiber, item)
            case Unit():
                yield from self._span(frame, fiber, item)

    def _catching(self, frame: Frame, fiber: Fiber, item: Item | None, content: Content) -> Content:
        """Run content; an event thrown in it is handled in the same fiber."""
        try:
            yield from content
        except Thrown as thrown:
            frame.reprompt = False
            yield from self._handle_thrown(frame, fiber, item, thrown, 0)

    def _handle_thrown(
        self, frame: Frame, fiber: Fiber, item: Item | None, thrown: Thrown, depth: int
    ) -> Content:
        event = thrown.event
        self._count(frame, item, event.name)
        handler = self._find(frame, fiber, item, event)
        if handler is None:
            if event.name in REPROMPTED:
                frame.reprompt = True
                return
            if event.name.startswith(("cancel.", "end.")):
                return
            raise thrown
        fiber.local = self._event_scope(event)
        fiber.commands = []
        if handler.reactive is not None:  # else a throw keeps what it has (C5)
            self._allow_reaction(handler, event)
        try:
            yield from self._execute.run(handler.content, fiber)
        except Thrown as again:
            self.count_step(handler.node)
            if depth > MAX_DEPTH:
                place = source(handler.node)
                raise GoOut(
                    f"{place}: error.semantic: its handlers throw without end", True, place
                ) from None
            yield from self._handle_thrown(frame, fiber, item, again, depth + 1)

    def _collect(self, frame: Frame, fiber: Fiber, field: Field) -> Content:
        """Ask, and take the answer: the Command Q&A (C4)."""
        settings = {**self.document.properties, **frame.form.properties, **field.properties}
        said: list[str] = []
        if frame.reprompt:
            seen = frame.prompts[field.name] = frame.prompts.get(field.name, 0) + 1
            fitting = [
                prompt
                for prompt in field.prompts
                if prompt.count <= seen
                and (prompt.cond is None or self._execute.condition(prompt.cond, fiber))
            ]
            highest = max((prompt.count for prompt in fitting), default=0)
            for prompt in fitting:
                if prompt.count == highest:
                    said.append(self._execute.text(prompt.text, fiber))
                    if prompt.timeout is not None:
                        settings["timeout"] = prompt.timeout
                    if prompt.bargein is not None:
                        settings["bargein"] = prompt.bargein
        frame.reprompt = True
        args = {key: f"{value}ms" if key == "timeout" else value for key, value in settings.items()}
        command = Command(
            "q-and-a", args, " ".join(said) or None, lang=field.lang, source=source(field.node)
        )
        number = self.request([Step(command)], fiber)
        notice = yield number
        self._execute.check(notice, fiber)
        outcome = str(notice.data.get("outcome", "noinput"))
        if outcome != "filled":
            raise Thrown(self.internal(outcome, "", command), command.source)
        self.engine.set(frame.dialog, field.name, notice.data["value"])
        self.engine.set(frame.dialog, f"{field.name}$", {"utterance": notice.data.get("utterance")})
        yield from self._process(frame, fiber, field, field.filled)

    def _process(self, frame: Frame, fiber: Fiber, item: Item, own: list[Filled]) -> Content:
        """Run the filled elements that an answer has satisfied (VoiceXML 2.4)."""
        for filled in own:
            fiber.local = self.engine.scope()
            yield from self._execute.run(filled.content, fiber)
        inputs = [
            one.name for one in all_items(frame.form.items) if isinstance(one, Field | Subdialog)
        ]
        for filled in frame.form.filled:
            names = filled.names or inputs
            if item.name not in names:
                continue
            if filled.mode == "any" or all(
                self.engine.defined(frame.dialog, name) for name in names
            ):
                fiber.local = self.engine.scope()
                yield from self._execute.run(filled.content, fiber)

    def _call(self, frame: Frame, fiber: Fiber, item: Subdialog) -> Content:
        """Call another form in a context of its own and take its result."""
        depth, outer = 0, frame.caller
        while outer is not None:
            depth, outer = depth + 1, outer.caller
        if depth >= MAX_DEPTH:
            message = f"{source(item.node)}: more than {MAX_DEPTH} subdialogs inside each other"
            raise Thrown(self.internal("error.semantic", message), source(item.node))
        form = self.document.forms[item.form]
        inner = Frame(
            form, next(self._states), self._new_document(), self.engine.scope(), frame, item
        )
        result: Notice | None = None
        pending = self._begin(inner)
        if pending is not None and isinstance(pending[1], GoBack) and pending[0] is inner:
            result = self._returned(inner, pending[1])
        elif pending is not None:
            # The called form goes on elsewhere at once; this content is in the middle of
            # being driven, so the rest happens when the driver is free again.
            result = self._chase(frame, *pending)
        if result is None:
            result = yield 0
        if result.event:
            raise Thrown(self.internal(result.event, "", None), source(item.node))
        self.engine.set(frame.dialog, item.name, result.data["result"])
        yield from self._process(frame, fiber, item, item.filled)

    def _returned(self, frame: Frame, back: GoBack) -> Notice:
        """What a subdialog gives that returned without ever waiting."""
        scopes = self._execute.scopes(Fiber(frame, local=self.engine.scope()))
        result = {name: self.engine.value(name, scopes) for name in back.names}
        self._leave(frame)
        self._frame = frame.caller
        return Notice("done", 0, data={"result": result}, event=back.event)

    def _chase(self, caller: Frame, frame: Frame, transfer: Transfer) -> Notice | None:
        """Follow a subdialog's first transfers of control until it waits or returns."""
        pending: tuple[Frame, Transfer] | None = (frame, transfer)
        while pending is not None:
            frame, transfer = pending
            if isinstance(transfer, GoBack) and frame.caller is caller:
                return self._returned(frame, transfer)
            if isinstance(transfer, GoForm):
                self._leave(frame)
                form = self.document.forms[transfer.form]
                self.count_step(form.node)
                pending = self._begin(self._frame_for(form, frame))
            elif isinstance(transfer, GoItem):
                pending = self._go_item(frame, transfer)
            else:
                raise transfer
        return None

    def _span(self, frame: Frame, fiber: Fiber, unit: Unit) -> Content:
        """A unit around form items: opened here, concluded by whatever way it is left (U5)."""
        number = next(self._units)
        cause, self._cause = self._cause, None
        self.actions.append(
            OpenUnit(number, frame.state, unit.devices, unit.longest, cause, source(unit.node))
        )
        frame.units.append((number, unit))
        outer, fiber.unit = fiber.unit, number
        self.engine.set(frame.dialog, unit.name, True)
        try:
            yield from self._visit_unit(frame, fiber, unit)
        finally:
            fiber.unit = outer
            for other in [one for one in frame.fibers if one.unit == number and one is not fiber]:
                self._forget(other)
            if (number, unit) in frame.units:
                frame.units.remove((number, unit))
                self.actions.append(CloseUnit(number))

    def _visit_unit(self, frame: Frame, fiber: Fiber, unit: Unit) -> Content:
        """The items of a unit; a goto from one of them to another does not leave it."""
        while True:
            try:
                yield from self._visit_all(frame, fiber, unit.items, unit)
                return
            except GoItem as go:
                if go.item not in {item.name for item in unit.items}:
                    raise
                frame.next_item, frame.reprompt = go.item, True

    # Events -------------------------------------------------------------------------

    def _dispatch(self, event: Event, frame: Frame) -> None:
        """An event from outside: the handler runs beside what the state is doing (O4)."""
        item = frame.item
        self._count(frame, item, event.name)
        fiber = Fiber(frame, local=self._event_scope(event))
        handler = self._find(frame, fiber, item, event)
        if handler is None:
            if event.name.startswith("error."):
                raise Thrown(event)
            return
        self._allow_reaction(handler, event)
        self._launch(fiber, handler)

    def _launch(self, fiber: Fiber, handler: Handler) -> None:
        frame = fiber.frame
        if len(frame.fibers) >= MAX_FIBERS:
            place = source(handler.node)
            raise GoOut(f"{place}: error.semantic: too many handlers under way", True, place)
        for number, unit in frame.units:
            if handler in unit.handlers or any(handler in one.handlers for one in unit.items):
                fiber.unit = number
        fiber.content = self._handler_content(fiber, handler)
        frame.fibers.append(fiber)
        self._drive(fiber, None)

    def _handler_content(self, fiber: Fiber, handler: Handler) -> Content:
        frame = fiber.frame
        try:
            yield from self._execute.run(handler.content, fiber)
        except Thrown as thrown:
            yield from self._handle_thrown(frame, fiber, frame.item, thrown, 0)

    def _command_event(self, notice: Notice, kind: str) -> None:
        """The end or cancellation of a Command, for handlers in it or in scope."""
        frame, command = self._frame, notice.command
        if frame is None or command is None:
            return
        name = f"{kind}.{command.type}"
        event = Event(name, self._serial, dict(notice.data), reactive=False)
        fiber = Fiber(frame, commands=command.hook or [])
        handlers = [*fiber.commands, *self._in_scope(frame, frame.item)]
        if not any(name.startswith(word) for one in handlers for word in one.events):
            return
        fiber.local = self._event_scope(event)
        self._count(frame, frame.item, name)
        handler = self._find(frame, fiber, frame.item, event)
        if handler is not None:
            self._allow_reaction(handler, event)
            self._launch(fiber, handler)
        self._cause = None

    def _unit_timeout(self, notice: Notice) -> None:
        """The unit took too long: error.unit.timeout is thrown in it, and it ends (U5)."""
        frame, unit = self._frame, None
        while frame is not None:
            unit = next((unit for number, unit in frame.units if number == notice.run), None)
            if unit is not None:
                break
            frame = frame.caller
        if frame is None or unit is None:
            return
        for fiber in [fiber for fiber in frame.fibers if fiber.main or fiber.unit == notice.run]:
            self._forget(fiber)
        self._close_units(frame)
        frame.item = unit
        event = self.internal(notice.event, f"{source(unit.node)}: {notice.message}")
        fiber = Fiber(frame, main=True, local=self._event_scope(event))
        fiber.content = self._after_timeout(frame, fiber, unit, event)
        frame.fibers.append(fiber)
        self._drive(fiber, None)

    def _after_timeout(self, frame: Frame, fiber: Fiber, unit: Unit, event: Event) -> Content:
        thrown = Thrown(event, source(unit.node))
        yield from self._handle_thrown(frame, fiber, unit, thrown, 0)
        frame.item = None
        yield from self._visit_all(frame, fiber, frame.form.items, None)

    def _allow_reaction(self, handler: Handler, event: Event) -> None:
        """C5: what is requested first because of the event is a reaction, or not."""
        reactive = event.reactive if handler.reactive is None else handler.reactive
        self._cause = event.serial if reactive else None

    def _event_scope(self, event: Event) -> object:
        data = dict(event.data)
        message = str(data.get("message", ""))
        value = {"name": event.name, "data": data, "message": message}
        return self.engine.scope(event=value, _event=event.name, _message=message)

    def _count(self, frame: Frame, item: Item | None, name: str) -> None:
        where = item.name if item is not None else ""
        for prefix in prefixes(name):
            key = (where, prefix)
            frame.counters[key] = frame.counters.get(key, 0) + 1

    def _in_scope(self, frame: Frame, item: Item | None) -> list[Handler]:
        """Handlers of the item, its unit, the form and the document, in this order."""
        found = list(item.handlers) if item is not None else []
        for _, unit in reversed(frame.units):
            if unit is not item:
                found += unit.handlers
        return [*found, *frame.form.handlers, *self.document.handlers]

    def _find(self, frame: Frame, fiber: Fiber, item: Item | None, event: Event) -> Handler | None:
        where = item.name if item is not None else ""

        def holds(cond: Expression) -> bool:
            return self._execute.condition(cond, fiber)

        return select_handler(
            [fiber.commands, self._in_scope(frame, item)],
            event.name,
            lambda name: frame.counters.get((where, name), 0),
            holds,
        )

    # Watches ------------------------------------------------------------------------

    def _watches(self) -> list[Watch]:
        frame = self._frame
        return [*(frame.form.watches if frame else []), *self.document.watches]

    def _check_watches(self, watches: list[Watch]) -> list[str]:
        """C6: raised when the condition turns true, armed again when it turns false."""
        tree: dict[str, Json] = {}
        for name, value in self._sensors.items():
            *path, last = name.split(".")
            held = tree
            for part in path:
                held = held.setdefault(part, {})
            held[last] = value
        self.engine.set(self.application, "sensor", tree)
        raised = []
        frame = self._frame
        assert frame is not None
        fiber = Fiber(frame, local=self.engine.scope())
        for watch in watches:
            true = self._execute.condition(watch.when, fiber)
            if true and not self._armed.get(id(watch), False):
                raised.append(watch.name)
            self._armed[id(watch)] = true
        return raised
