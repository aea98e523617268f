"""Connects the applications and the mediator of a session."""

from __future__ import annotations

from collections import deque

from prima.interpreter.transfers import GoOut
from prima.messages import (
    PROMOTED,
    Action,
    CloseUnit,
    Data,
    Event,
    GoOn,
    Json,
    LeaveState,
    OpenUnit,
    Order,
    Promote,
    Quit,
    Raise,
    Request,
    Say,
    Send,
    line_of,
)
from prima.scheduler.behavior import Stream
from prima.scheduler.mediation import Delivery
from prima.scheduler.mediator import Mediator
from prima.scheduler.recorder import Recorder
from prima.session.applications import AnyApp, Applications


class Wiring:
    """Passes applications' requests to the mediator, and their outcomes back."""

    def __init__(self, apps: Applications, mediator: Mediator, recorder: Recorder) -> None:
        self.apps = apps
        self.mediator = mediator
        self.recorder = recorder
        self.serial = 0
        """The serial number of the latest event."""
        self.failures: list[str] = []
        """Applications that ended with an error, as ``NAME: what``."""
        self.due: dict[str, int] = {}
        """When applications want to be called, by name."""
        self.sends: list[Order] = []
        """Messages to services, until they are collected."""
        self.turns: list[tuple[str, Stream]] = []
        """Streams that wait ``suspended`` or have ``resumed`` since the latest selection, and whose
        applications handle that event."""
        self._promoted = 0
        """The serial number of the latest promoted event."""

    def in_order(self) -> list[AnyApp]:
        """V3: the applications in declared order, after the one whose stream is active."""
        living = self.apps.living()
        if len(living) == 1:
            return living
        active = self.mediator.memory.active
        if active is None:
            return living
        first = self.apps.named[active.name]
        if first.over or first is living[0]:
            return living
        return [first, *(app for app in living if app is not first)]

    # To applications ------------------------------------------------------------

    def settle(self) -> None:
        """Notify applications of what became of their Commands, until no notices are left."""
        deliveries = self.mediator.deliveries
        while deliveries:
            delivery = deliveries.popleft()
            self._tell(delivery)

    def _tell(self, delivery: Delivery) -> None:
        app = self.apps.named[delivery.app]
        if app.over:
            return
        self.mediator.open_window(delivery)
        for notice in delivery.notices:
            self.apps.guard(app, app.notice, self.recorder.now, notice)
            self.act(app)
        self.mediator.close_window(delivery)

    def note_turns(self) -> None:
        """Keep the streams that wait suspended or have resumed and whose application handles it."""
        for name, stream in self.mediator.drain_turns():
            app = self.apps.named[stream.app.name]
            if self.apps.guard(app, app.takes, name):
                self.turns.append((name, stream))
            if app.over and app.actions:
                self.act(app)

    def tell_turns(self) -> None:
        """Notify applications that their streams wait suspended or have resumed (C2).

        What they request then belongs to the stream and does not count as a reaction.
        """
        turns, self.turns = self.turns, []
        for name, stream in turns:
            app = self.apps.named[stream.app.name]
            delivery = Delivery(app.name, stream if stream.open else None, [])
            self.mediator.open_window(delivery)
            event = Event(name, 0, {}, reactive=False, shared=True)
            self.apps.guard(app, app.event, self.recorder.now, event)
            self.act(app)
            self.mediator.close_window(delivery)

    def own_event(self, app: AnyApp, name: str, data: dict[str, Json], reactive: bool) -> None:
        """Handle an event that one application alone has defined, and the actions it causes."""
        self.handle_own(app, name, data, reactive)
        self.act(app)

    def handle_own(self, app: AnyApp, name: str, data: dict[str, Json], reactive: bool) -> None:
        """Let the application handle its own event; its actions are left to the caller."""
        serial = self.record_own(app, name, data, "environment")
        event = Event(name, serial, data, reactive)
        self.apps.guard(app, app.event, self.recorder.now, event)

    def record_own(self, app: AnyApp, name: str, data: Data, actor: str) -> int:
        """Record an event defined by one application alone; returns its serial number."""
        self.serial += 1
        self.recorder.add(
            "event", actor, app=app.name, event=name, data=dict(data) or None, serial=self.serial
        )
        return self.serial

    # From applications ---------------------------------------------------------

    def act(self, app: AnyApp) -> None:
        """Carry out an application's actions, and note when it wants to be called."""
        if app.actions:
            self._carry_out(app)
        due = app.deadline
        if due is not None:
            self.due[app.name] = due
        elif self.due:
            self.due.pop(app.name, None)

    def _carry_out(self, app: AnyApp) -> None:
        """Carry out an application's actions in order, and then its own events with all they cause.

        What it had requested before comes first: the handler of an event may leave the state (O3).
        """
        left: deque[Action] = deque()
        own: deque[Action] = deque()
        while app.actions or left or own:
            for action in reversed(app.actions):
                (own if isinstance(action, Raise | GoOn) else left).appendleft(action)
            app.actions.clear()
            try:
                app.count_action()
            except GoOut as error:
                app.fail(error)
            self._do(app, (left or own).popleft())

    def _do(self, app: AnyApp, action: Action) -> None:
        """Carry out one action of an application."""
        match action:
            case Request() | OpenUnit() | CloseUnit() | LeaveState():
                self._ask(app, action)
            case Send():
                self._send(app, action)
            case Say():
                self._log(app, action)
            case Raise():
                self.handle_own(app, action.event, {}, reactive=True)
            case Promote():
                self._promoted = self.record_own(app, action.event, {}, "robot")
            case GoOn():
                self.apps.guard(app, app.go_on_entering, action.state)
            case Quit():
                self._quit(app, action)

    def _ask(self, app: AnyApp, action: Request | OpenUnit | CloseUnit | LeaveState) -> None:
        """Request Commands, a unit or an end from the mediator."""
        if isinstance(action, (Request, OpenUnit)) and action.cause == PROMOTED:
            action.cause = self._promoted
        self.mediator.ask(app.name, action)

    def _send(self, app: AnyApp, action: Send) -> None:
        data = {"to": action.service, **action.data}
        self.recorder.add(
            "send",
            "robot",
            app=app.name,
            data=data,
            serial=action.serial,
            source=line_of(action.source),
        )
        order = Order("send", f"{app.name}!{action.serial}", app=app.name)
        order.data = data
        self.sends.append(order)

    def _log(self, app: AnyApp, action: Say) -> None:
        self.recorder.add(
            "log" if action.level == "log" else "error",
            "robot",
            app=app.name,
            message=action.text,
            source=line_of(action.source),
        )

    def _quit(self, app: AnyApp, action: Quit) -> None:
        self.apps.alive = None
        if action.failed:
            self.failures.append(f"{app.name}: {action.reason}")
        self.mediator.unload(app.name, action.reason)
