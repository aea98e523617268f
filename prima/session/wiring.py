"""What carries a session: the applications, the mediator, and what goes to and fro between them."""

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
from prima.scheduler.mediation import Told
from prima.scheduler.mediator import Mediator
from prima.scheduler.recorder import Recorder
from prima.session.applications import AnyApp, Applications


class Wiring:
    """Carries what applications want to the mediator, and what becomes of it back to them."""

    def __init__(self, apps: Applications, mediator: Mediator, recorder: Recorder) -> None:
        self.apps = apps
        self.mediator = mediator
        self.recorder = recorder
        self.serial = 0
        """The serial number of the latest event."""
        self.failures: list[str] = []
        """Applications that ended by an error, as ``NAME: what``."""
        self.due: dict[str, int] = {}
        """When applications want to be called, by name."""
        self.sends: list[Order] = []
        """What goes to services, until it is taken."""
        self.turns: list[tuple[str, Stream]] = []
        """Streams that wait ``suspended`` or have ``resumed`` by the latest selection, with which:
        their applications want to hear of it."""
        self._promoted = 0
        """The serial number of the event that was promoted last."""

    def in_order(self) -> list[AnyApp]:
        """V3: the applications in declared order, the one whose stream is active first."""
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

    # Told to applications -------------------------------------------------------

    def settle(self) -> None:
        """Tell applications what became of their Commands, until nobody has more to say."""
        told_queue = self.mediator.told
        while told_queue:
            told = told_queue.popleft()
            self._tell(told)

    def _tell(self, told: Told) -> None:
        app = self.apps.named[told.app]
        if app.over:
            return
        self.mediator.open_window(told)
        for notice in told.notices:
            with self.apps.contained(app):
                app.notice(self.recorder.now, notice)
            self.act(app)
        self.mediator.close_window(told)

    def note_turns(self) -> None:
        """Keep the streams that wait suspended or have resumed of which an application will hear."""
        for name, stream in self.mediator.drain_turns():
            app = self.apps.named[stream.app.name]
            with self.apps.contained(app):
                if app.takes(name):
                    self.turns.append((name, stream))
            if app.over and app.actions:
                self.act(app)

    def tell_turns(self) -> None:
        """Tell applications that their streams wait suspended or have resumed (C2).

        What they ask for then belongs to the stream and is no reaction.
        """
        turns, self.turns = self.turns, []
        for name, stream in turns:
            app = self.apps.named[stream.app.name]
            told = Told(app.name, stream if stream.open else None, [])
            self.mediator.open_window(told)
            with self.apps.contained(app):
                app.event(self.recorder.now, Event(name, 0, {}, reactive=False, shared=True))
            self.act(app)
            self.mediator.close_window(told)

    def own_event(self, app: AnyApp, name: str, data: dict[str, Json], reactive: bool) -> None:
        """An event that one application alone has defined."""
        self.handle_own(app, name, data, reactive)
        self.act(app)

    def handle_own(self, app: AnyApp, name: str, data: dict[str, Json], reactive: bool) -> None:
        """Let the application handle its own event; what it wants then is still to be done."""
        serial = self.record_own(app, name, data, "environment")
        with self.apps.contained(app):
            app.event(self.recorder.now, Event(name, serial, data, reactive))

    def record_own(self, app: AnyApp, name: str, data: Data, actor: str) -> int:
        """Record an event that one application alone has defined; gives its serial number."""
        self.serial += 1
        self.recorder.add(
            "event", actor, app=app.name, event=name, data=dict(data) or None, serial=self.serial
        )
        return self.serial

    # Wanted by applications ----------------------------------------------------

    def act(self, app: AnyApp) -> None:
        """Carry out what an application wants, and note when it wants to be called."""
        if app.actions:
            self._carry_out(app)
        due = app.deadline
        if due is not None:
            self.due[app.name] = due
        elif self.due:
            self.due.pop(app.name, None)

    def _carry_out(self, app: AnyApp) -> None:
        """Do what an application wants, in order; what comes of its own events first."""
        left: deque[Action] = deque()
        while app.actions or left:
            left.extendleft(reversed(app.actions))
            app.actions.clear()
            try:
                app.count_action()
            except GoOut as error:
                app.fail(error)
            self._do(app, left.popleft())

    def _do(self, app: AnyApp, action: Action) -> None:
        """Do one thing that an application wants."""
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
                with self.apps.contained(app):
                    app.go_on_entering(action.state)
            case Quit():
                self._quit(app, action)

    def _ask(self, app: AnyApp, action: Request | OpenUnit | CloseUnit | LeaveState) -> None:
        """Ask the mediator for Commands, a unit or an end."""
        if isinstance(action, (Request, OpenUnit)) and action.cause == PROMOTED:
            action.cause = self._promoted
        match action:
            case Request():
                self.mediator.request(app.name, action)
            case OpenUnit():
                self.mediator.open_unit(app.name, action)
            case CloseUnit():
                self.mediator.close_unit(app.name, action)
            case LeaveState():
                self.mediator.leave_state(app.name, action)

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
