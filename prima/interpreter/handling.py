"""Events: which handler takes one, and how it runs alongside its state's content."""

from __future__ import annotations

from collections.abc import Iterable

from prima.interpreter.acts import Handler
from prima.interpreter.elements import Item, Watch
from prima.interpreter.frame import Content, Fiber, Frame
from prima.interpreter.owner import Owner
from prima.interpreter.selection import Candidate, prefixes, select_handler, taking
from prima.interpreter.sensors import hides_sensors, sensors_of
from prima.interpreter.transfers import MAX_DEPTH, Thrown, thrown_of
from prima.messages import Event, Json, Notice
from prima.script.evaluation import Scope, ScriptError

MAX_FIBERS = 64
"""Maximum number of handlers running at once in a state."""
REPROMPTED = frozenset({"noinput", "nomatch", "help"})
"""Events after which a field asks again if unhandled (VoiceXML 5.2.5)."""


Taking = list[Candidate[Handler]]


def name_of(item: Item | None) -> str:
    """Where events are counted: at the visited item, or at the form itself."""
    return item.name if item is not None else ""


def offers(handlers: Iterable[Handler], event: str) -> Taking:
    """Those of some handlers that take an event."""
    return taking((Candidate(one, one.events, one.count) for one in handlers), event)


class Handling:
    """Finds and runs the handlers of one application's events."""

    def __init__(self, owner: Owner) -> None:
        self.owner = owner
        self._armed: dict[int, WatchState] = {}
        self._hidden: bool | None = None
        """Whether the document redeclares names that conditions use; None until computed."""

    def handle_thrown(
        self, frame: Frame, fiber: Fiber, item: Item | None, thrown: Thrown, depth: int
    ) -> Content:
        """Run the handler of an event thrown in content, in the same piece of content."""
        event = thrown.event
        self.count_event(frame, item, event.name)
        inside = offers(fiber.commands, event.name) if fiber.commands else []
        candidates = inside + self.takers(frame, item, event.name)
        fiber.commands = ()
        fiber.local = None  # what the failed content has declared may have filled the memory
        if candidates:
            fiber.local = self.event_scope(event)
        handler = None
        try:
            handler = self._select(frame, fiber, item, candidates)
            if handler is not None:
                if handler.reactive is not None:  # otherwise a throw keeps its own (C5)
                    self.allow_reaction(handler, event)
                yield from self._handler_content(fiber, handler)
        except (Thrown, ScriptError) as error:
            at = frame.form.node if handler is None else handler.node
            self.owner.count_step(at)
            if depth > MAX_DEPTH:
                self.owner.give_up(at, "its handlers throw without end")
            again = thrown_of(error)
        else:
            if handler is None:
                self._unhandled(frame, thrown)
            return
        yield from self.handle_thrown(frame, fiber, item, again, depth + 1)

    @staticmethod
    def _unhandled(frame: Frame, thrown: Thrown) -> None:
        """An event without a handler ends the application, or lets a field ask again (5.2.5)."""
        if thrown.name not in REPROMPTED:
            thrown.sought = True
            raise thrown
        frame.silent = ""

    def dispatch(self, event: Event, frame: Frame, place: str = "") -> None:
        """Handle an event from outside alongside the state's content (O4)."""
        taken = self._take(event, frame, self.takers(frame, frame.item, event.name))
        if not taken and event.name.startswith("error."):
            unhandled = Thrown(event.name, str(event.data.get("message", "")), place)
            unhandled.sought = True
            raise unhandled

    def _take(self, event: Event, frame: Frame, candidates: Taking) -> bool:
        """Let one of some handlers take an event, if it may."""
        item = frame.item
        self.count_event(frame, item, event.name)
        if not candidates:
            return False
        fiber = Fiber(frame, local=self.event_scope(event))
        handler = self._select(frame, fiber, item, candidates)
        if handler is None:
            return False
        self.allow_reaction(handler, event)
        self._launch(fiber, handler)
        return True

    def _launch(self, fiber: Fiber, handler: Handler) -> None:
        frame = fiber.frame
        if not handler.waits:
            self._run_at_once(fiber, handler)
            return
        self._bound_fibers(frame, handler)
        self._enter_unit(fiber, handler)
        self._go_along(fiber, self._recovering(fiber, handler))

    def _bound_fibers(self, frame: Frame, handler: Handler) -> None:
        if len(frame.fibers) >= MAX_FIBERS:
            self.owner.give_up(handler.node, "too many handlers under way")

    @staticmethod
    def _enter_unit(fiber: Fiber, handler: Handler) -> None:
        """U5: requests of a handler inside a unit belong to the unit."""
        for number, unit in fiber.frame.units:
            if handler in unit.handlers or any(handler in one.handlers for one in unit.items):
                fiber.unit = number

    def _go_along(self, fiber: Fiber, content: Content) -> None:
        """Let content run alongside the state's own."""
        fiber.content = content
        fiber.frame.fibers += (fiber,)
        self.owner.drive(fiber, None)

    def _run_at_once(self, fiber: Fiber, handler: Handler) -> None:
        """Run a handler that never waits: it needs no coroutine."""
        frame, owner = fiber.frame, self.owner
        owner.note(handler.node)
        try:
            transfer = owner.execute.run_at_once(handler.content, fiber)
        except (Thrown, ScriptError) as error:
            self.recover(frame, handler, error)
            return
        if transfer is not None:
            owner.transfer(frame, transfer)
        elif frame.form.items:
            owner.go_on(frame)

    def recover(self, frame: Frame, handler: Handler, error: Thrown | ScriptError) -> None:
        """Handle a failure in a handler that never waits."""
        fiber = Fiber(frame)
        self._enter_unit(fiber, handler)
        self._bound_fibers(frame, handler)
        thrown = thrown_of(error)
        self._go_along(fiber, self.handle_thrown(frame, fiber, frame.item, thrown, 0))

    def _handler_content(self, fiber: Fiber, handler: Handler) -> Content:
        self.owner.note(handler.node)
        yield from self.owner.execute.run(handler.content, fiber)

    def _recovering(self, fiber: Fiber, handler: Handler) -> Content:
        """A handler's content; an event thrown in it is handled in the same fiber."""
        frame = fiber.frame
        try:
            yield from self._handler_content(fiber, handler)
            return
        except (Thrown, ScriptError) as error:
            thrown = thrown_of(error)
        yield from self.handle_thrown(frame, fiber, frame.item, thrown, 0)

    def command_event(self, notice: Notice, kind: str, asker: Frame | None) -> None:
        """Handle the end or cancellation of a Command, by handlers in it or in scope.

        Those in it run in the state that asked for it, which may have called the active one. A
        unit around Commands has no Command of its own; its fate has the name ``iu``.
        """
        frame, command = self.owner.frame, notice.command
        if frame is None:
            return
        name = f"{kind}.{command.asked if command is not None else 'iu'}"
        event = Event(name, 0, dict(notice.data), reactive=False)
        inside = offers(command.hook, name) if command is not None and command.hook else []
        outside = self.takers(frame, frame.item, name)
        if asker is None or asker is frame:
            self._take(event, frame, inside + outside)
        elif not (inside and self._take(event, asker, inside)):
            self._take(event, frame, outside)
        self.owner.cause = None

    def unit_timeout(self, notice: Notice) -> None:
        """End a unit that took too long: error.unit.timeout is thrown in it (U5)."""
        frame = self.owner.frame
        units = dict(frame.units) if frame is not None else {}
        if frame is None or notice.run not in units:
            return
        unit = units[notice.run]
        for fiber in [fiber for fiber in frame.fibers if fiber.main or fiber.unit == notice.run]:
            self.owner.forget(fiber)
        frame.item = unit
        thrown = Thrown.at(unit.node, notice.event, notice.message)
        fiber = Fiber(frame, main=True, local=self.event_scope(thrown.event))
        self._go_along(fiber, self.owner.algorithm.after_timeout(frame, fiber, unit, thrown))

    def allow_reaction(self, handler: Handler, event: Event) -> None:
        """C5: make the first request caused by an event a reaction, or not."""
        owner = self.owner
        if not (event.reactive if handler.reactive is None else handler.reactive):
            owner.cause = None
        elif event.serial or owner.cause is None:
            owner.cause = event.serial or event.name
            owner.fresh = (owner.cause, handler.fresh) if handler.fresh else None

    def event_scope(self, event: Event) -> Scope:
        """The scope of an event's handler, if any code of the document may read the event."""
        if not self.owner.document.curious:
            return None
        data = event.data
        message = str(data.get("message", "")) if data else ""
        return self.owner.engine.event(event.name, message, dict(data) if data else None)

    def count_event(self, frame: Frame, item: Item | None, name: str) -> None:
        """Count an occurrence for the item being visited, under all the event's prefixes."""
        if not self.owner.document.counting:
            return
        frame.counters = frame.counters.came(name_of(item), prefixes(name))

    def _in_scope(self, frame: Frame, item: Item | None, event: str) -> Taking:
        """Handlers that take an event, from the item, its unit, the form and the document."""
        found: list[Handler] = []
        if item is not None:
            units = [unit for _, unit in reversed(frame.units) if unit is not item]
            found += [one for scope in (item, *units) for one in scope.handlers]
        found += [*frame.form.handlers, *self.owner.document.handlers]
        self.owner.count_looked_at(frame.form.node, found)
        return offers(found, event)

    def takers(self, frame: Frame, item: Item | None, event: str) -> Taking:
        """The handlers in scope whose names take an event, kept in the form."""
        key = (event, name_of(item), len(frame.units))
        takers = frame.form.takers
        found = takers.get(key)
        if found is None:
            found = self._in_scope(frame, item, event)
            takers.keep(key, found)
        return found

    def _select(
        self, frame: Frame, fiber: Fiber, item: Item | None, candidates: Taking
    ) -> Handler | None:
        """The handler that takes an event here (VoiceXML 5.2.4)."""
        if len(candidates) == 1:
            first = candidates[0].handler
            if first.cond is None and first.count <= 1:
                return first
        self.owner.count_looked_at(frame.form.node, candidates)
        return select_handler(
            candidates,
            lambda name: frame.counters.seen(name_of(item), name),
            lambda one: one.cond is None or self.owner.execute.condition(one.cond, fiber),
        )

    def watches(self) -> list[Watch]:
        """The watches of the active form and of the document."""
        frame = self.owner.frame
        return [*(frame.form.watches if frame else []), *self.owner.document.watches]

    def tell_sensors(self) -> None:
        """Set the application's variable ``sensor`` to the known values."""
        self.owner.untold = False
        tree: dict[str, Json] = {}
        for name, value in self.owner.sensors.items():
            *path, last = name.split(".")
            held = tree
            for part in path:
                inner = held.get(part)
                if not isinstance(inner, dict):
                    inner = held[part] = {}
                held = inner
            held[last] = value
        self.owner.engine.set(self.owner.application, "sensor", tree)

    def forget_watches(self, watches: Iterable[Watch]) -> None:
        """C6: arm the watches anew, whether their conditions hold already or not."""
        for watch in watches:
            self._armed.pop(id(watch), None)

    def check_watches(self, watches: Iterable[Watch]) -> list[str]:
        """C6: raise a watch's event when its condition turns true; rearm it when it turns false.

        A condition on sensors alone is unchanged while none of them has new values.
        """
        raised = []
        frame = self.owner.frame
        assert frame is not None
        fiber = Fiber(frame)
        for watch in watches:
            state = self._armed.setdefault(id(watch), WatchState())
            looked_at = self._sensors_of(watch) if state.report >= 0 else None
            if looked_at is not None and all(
                self.owner.reported.get(name, 0) <= state.report for name in looked_at
            ):
                continue
            state.report = self.owner.reports  # even if it fails
            true = self.owner.execute.condition(watch.when, fiber)
            if true and not state.true:
                raised.append(watch.name)
            state.true = true
        return raised

    def _sensors_of(self, watch: Watch) -> frozenset[str] | None:
        """The only sensors that a watch reads; None if the document declares such a name itself."""
        if self._hidden is None:
            self._hidden = hides_sensors(self.owner.document)
        return None if self._hidden else sensors_of(watch.when.code)


class WatchState:
    """The last value of a watch's condition."""

    true = False
    report = -1
    """The number of sensor reports by then."""
