"""The mediator: takes requests and ends in, gives orders and notices out.

It has no clock, devices or documents. Whoever drives it calls, at one instant,
first what has ended, then what has happened, then :meth:`Mediator.select` once
(rule V3), and drains ``orders`` (for the devices), ``notices`` (for the
applications) and the recorder's records.
"""

from __future__ import annotations

from prima.messages import (
    NO_DEVICES,
    CloseUnit,
    Command,
    LeaveState,
    Notice,
    OpenUnit,
    Order,
    Request,
    line_of,
)
from prima.scheduler.behavior import GONE, Application, Behavior, Run, Stream
from prima.scheduler.endings import Told
from prima.scheduler.failures import Failures, allowance
from prima.scheduler.intake import Refused, check_steps, link, parent_in, substitute


class Mediator(Failures):
    """Mediates the Commands of any number of applications by the rules of one policy."""

    def load(self, name: str, kind: str, lang: str = "", order: int | None = None) -> None:
        """An application starts, which speaks a language if that is known.

        ``order`` is its place among the declared ones (S2f); by default, behind all that came
        before.
        """
        before = self.memory.apps.get(name)
        if order is None:
            order = before.order if before is not None else len(self.memory.apps)
        self.memory.apps[name] = Application(name, kind, order)
        self.recorder.add(
            "load", "mediator", app=name, data={"kind": kind, **({"lang": lang} if lang else {})}
        )

    def unload(self, name: str, reason: str) -> None:
        """E2: an application has ended; what runs finishes, the rest is given back."""
        app = self.memory.apps[name]
        if app.gone:
            return
        self.changed = app.gone = True
        self._withdraw(list(self.memory.of_app(app)), "E2")
        self._drop_hints(app, None)
        for number in list(app.units):
            self._close_unit(app, number)
        self.recorder.add("unload", "mediator", app=name, rule="E2", outcome=reason)

    def sees_user(self, yes: bool) -> None:
        """V4: the camera has come to see the user, or has lost them (for X4 and K1)."""
        if yes or self.memory.in_view:
            self.senses_user()
        self.memory.in_view = yes

    def senses_user(self) -> None:
        """K1: the user is seen, heard or felt."""
        self.memory.sensed = self._now()
        self.changed = self.changed or self.memory.absent

    def request(self, name: str, asked: Request) -> None:
        """Take Commands in as one tree (U3), or refuse them all (E3)."""
        self.changed = True
        app = self.memory.apps[name]
        if self._selector.policy.has("x6"):
            for command, lacking in substitute(asked.steps, self._maker.table):
                self.recorder.add(
                    "substitute",
                    "mediator",
                    app=name,
                    rule="X6",
                    command=lacking,
                    by=command.type,
                    source=line_of(command.source),
                )
        unit = app.units.get(asked.unit) if asked.unit is not None else None
        try:
            check_steps(asked.steps, app, self._maker.table, unit.devices if unit else None)
        except Refused as refused:
            self._refuse(app, asked, refused)
            return
        first = asked.steps[0].what
        reaction = asked.cause if unit is None else None
        if isinstance(first, Command) and first.now:
            stream, parent = self._order_now(app, first, reaction, unit), None
        else:
            stream, parent = self._place(app, reaction, unit)
        self._hint(stream, asked)
        run = Run(asked.run, app, len(asked.steps))
        made = self._maker.chain(app, stream, asked.steps, asked, self._now(), run, unit)
        for ab in made:
            if not ab.waits_for:
                self._root(ab, parent, reaction)
                ab.connect = asked.connect and unit is None
            if unit is not None:
                unit.inner[ab.name] = ab
            self.memory.add(ab)
            self.recorder.request(ab)
        (app if unit is None else unit).latest = made[-1]

    def open_unit(self, name: str, asked: OpenUnit) -> None:
        """U5: a unit that spans questions is requested like an AB of its own."""
        self.changed = True
        app = self.memory.apps[name]
        stream, parent = self._place(app, asked.cause, None)
        if stream.held_until is not None:
            self._let_go(stream, "joined")
        asked.devices |= self._devices_of(asked.types)
        unit = self._maker.spanning(app, stream, asked, self._now())
        app.units[asked.unit] = unit
        self._root(unit, parent, asked.cause)
        unit.connect = asked.connect
        self.memory.add(unit)
        self.recorder.request(unit)
        app.latest = unit

    def _devices_of(self, types: tuple[str, ...]) -> frozenset[str]:
        """The devices of Commands as this robot does them, substitutes included (X6)."""
        table, devices = self._maker.table, NO_DEVICES
        for name in types:
            row = table.get(name)
            if row is not None and row.substitute and self._selector.policy.has("x6"):
                row = table[row.substitute]
            if row is not None and not row.substitute:
                devices |= row.devices
        return devices

    def close_unit(self, name: str, asked: CloseUnit) -> None:
        """U5: the unit is left; what runs in it finishes, the rest is deleted."""
        self.changed = True
        self._close_unit(self.memory.apps[name], asked.unit)

    def leave_state(self, name: str, asked: LeaveState) -> None:
        """O3: the state's Commands that have not started are deleted, its loops end."""
        self.changed = True
        app = self.memory.apps[name]
        self.recorder.add("leave", "mediator", app=name, rule="O3", state=asked.state)
        self._drop_hints(app, asked.state)
        state = [ab for ab in self.memory.of_app(app) if ab.document_state == asked.state]
        if not state:
            return
        self._continue(app, going_on([ab.stream for ab in state]))
        self._withdraw(state, "O3")

    def _continue(self, app: Application, stream: Stream) -> None:
        """O3: what the application asks for in this instant outside of windows goes on with it."""
        app.continuing = stream
        self._continuing.append(app)

    def _hint(self, stream: Stream, asked: Request) -> None:
        """X3: the latest request of a stream says whether it is held afterwards."""
        if stream.held_until is not None:
            self._let_go(stream, "joined")
        if self._selector.policy.has("x3"):
            stream.hold, stream.hold_state = asked.hold, asked.state

    def _drop_hints(self, app: Application, state: int | None) -> None:
        """X3: a state that is left, or an application that ends, holds nothing any more."""
        if not self._selector.policy.has("x3"):
            return
        for stream in self.memory.streams.values():
            if stream.app is app and stream.hold and state in (None, stream.hold_state):
                stream.hold = None
                if stream.held_until is not None:
                    self._continue(app, stream)
                    self._let_go(stream, "left")

    def _refuse(self, app: Application, asked: Request, refused: Refused) -> None:
        command = refused.command
        self.recorder.add(
            "fail",
            "mediator",
            app=app.name,
            rule="E3",
            command=command.type if command else None,
            event=refused.event,
            message=refused.message,
            source=line_of(command.source) if command else None,
        )
        notice = Notice("failed", asked.run, command, event=refused.event, message=refused.message)
        notice.cause = asked.cause
        self.told.append(Told(app.name, None, [notice]))

    def _place(
        self, app: Application, reaction: int | None, unit: Behavior | None
    ) -> tuple[Stream, Behavior | None]:
        """O1, O3, C3: the stream a new tree belongs to, and its parent there; a reaction has none."""
        if unit is not None:
            return unit.stream, parent_in(unit)
        parent = self._parent(app) if reaction is None else None
        if parent is not None:
            return parent.stream, parent
        return self._opened(self._stream(app, reaction)), None

    def _opened(self, stream: Stream) -> Stream:
        """Let a stream begin, or go on after all."""
        if stream.name not in self.memory.streams:
            self.memory.open(stream)
        self._touched[stream.name] = stream
        return stream

    def _parent(self, app: Application) -> Behavior | None:
        """O1: what a Command follows; in a window that is an AB of the window's stream."""
        if app.window is not None:
            return app.window.latest()
        latest = app.latest
        return latest if latest is not None and latest.state is not GONE else None

    def _stream(self, app: Application, reaction: int | None) -> Stream:
        """The stream that a tree without a parent goes on with, or a new one."""
        if reaction is None and app.window is not None:
            return app.window
        return self._held(app) or app.continuing or self._maker.stream(app)

    def _held(self, app: Application) -> Stream | None:
        """X3: the application's stream that is held, the latest of several."""
        held = (self.memory.streams[name] for name in reversed(self.holds))
        return next((stream for stream in held if stream.app is app), None)

    def _root(self, ab: Behavior, parent: Behavior | None, reaction: int | None) -> None:
        """Give a root its parent by O1, its reactive flag by C5, or its place by C3."""
        if parent is not None:
            link(parent, ab)
        elif reaction is not None:
            ab.reaction = reaction
        elif ab.app.window is not None:
            ab.freed = self._now()

    def _order_now(
        self, app: Application, command: Command, reaction: int | None, unit: Behavior | None
    ) -> Stream:
        """O2: cancel this application's trees that want a device of the new Command.

        Gives the stream that goes on: one of those cancelled, or one that is held (X3). In a
        window no event has come that such a stream waits for.
        """
        devices = self._maker.table[command.type].occupied(command.text)
        if unit is not None:
            self._cancel([ab for ab in unit.inner.values() if ab.devices & devices], devices)
            return unit.stream
        streams = {
            ab.stream.name: ab.stream
            for ab in self.memory.of_app(app)
            if ab.devices & devices and ab.unit is None
        }
        waited_for = reaction is not None or app.window is None
        if streams and not (waited_for and self._held(app)):
            stream = going_on(list(streams.values()))
        else:
            stream = self._stream(app, reaction)
        for one in streams.values():
            self._cancel(list(one.members.values()), devices)
        return self._opened(stream)

    def open_window(self, told: Told) -> None:
        """C3: while an application handles the end of its Command, its stream stays open."""
        self.changed = True
        stream = told.stream
        self.memory.apps[told.app].window = stream
        if stream is not None:
            self.recorder.stream("window", stream, "C3", outcome="open")

    def close_window(self, told: Told) -> None:
        """The application has gone to wait for something else."""
        self.changed = True
        stream = told.stream
        self.memory.apps[told.app].window = None
        if stream is not None:
            self._touched[stream.name] = stream
            self.recorder.stream("window", stream, "C3", outcome="closed")

    def select(self) -> None:
        """Start everything that may start, then stop what rolls on for nobody (F5)."""
        if not self.changed:
            return
        self.changed = False
        self._close_streams()
        if not self.halted:
            self._look_for_user()
            self._selector.select(self._now())
            self._set_deadlines()
        if self._rolling is not None:
            self._stop_rolling(self._rolling)
            self._rolling = None
        if self._continuing:
            for app in self._continuing:
                app.continuing = None
            self._continuing.clear()

    def _stop_rolling(self, ab: Behavior) -> None:
        """F5: stop a body that gets no next loop, unless something else takes the wheels."""
        if "locomotion" not in self.memory.occupied:
            self.orders.append(Order("stop", ab.id, ab.command, app=ab.app.name))
            self.recorder.behavior("stop", ab, rule="F5")

    def _close_streams(self) -> None:
        """C1, F3: streams that nothing keeps open end, and hold no floor then."""
        touched, self._touched = self._touched, {}
        kept: list[Stream] = []
        for stream in touched.values():
            if stream.open or stream.name not in self.memory.streams:
                continue
            if stream.hold and not stream.app.gone:
                kept.append(stream)  # after those that end have given the floor back
                continue
            self.memory.end(stream)
            self.recorder.stream("stream-end", stream, "C1")
            floor = self.memory.floor
            if stream in floor:
                floor.remove(stream)
                self.recorder.stream(
                    "floor", stream, "F3", outcome="returned", floor=[held.name for held in floor]
                )

        for stream in kept:
            self._keep_open(stream)

    def _keep_open(self, stream: Stream) -> None:
        """X3: the stream stays open, with the floor unless another has it, and waits."""
        assert stream.hold is not None
        until = self.holds[stream.name] = stream.held_until = self._now() + stream.hold
        self.recorder.stream("held", stream, "X3", outcome="begun", data={"until": until / 1000})
        if not self.memory.floor:
            self._selector.take_floor(stream, "X3")

    def _set_deadlines(self) -> None:
        now = self._now()
        for ab in self._selector.started:
            if ab.command is not None:
                ab.late = now + allowance(ab)
            elif ab.longest is not None:
                ab.late = now + ab.longest


def going_on(streams: list[Stream]) -> Stream:
    """O2, O3: of streams that are cancelled, the one that goes on.

    That is the one that runs, or of which an AB started last; else the latest.
    """
    return max(reversed(streams), key=lambda one: (one.runs, one.turn))
