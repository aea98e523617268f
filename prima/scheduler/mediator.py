"""The mediator: takes requests and ends in, gives orders and notices out.

It has no clock, devices or documents. Whoever drives it calls, at one instant,
first what has ended, then what has happened, then :meth:`Mediator.select` once
(rule V3), and drains ``orders`` (for the devices), ``notices`` (for the
applications) and the chronicle's records.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from prima.messages import (
    CloseUnit,
    Command,
    Data,
    LeaveState,
    Notice,
    OpenUnit,
    Order,
    Request,
)
from prima.scheduler.behavior import Application, Behavior, Run, State, Stream
from prima.scheduler.chronicle import Chronicle
from prima.scheduler.intake import Maker, Refused, Table, check_steps, link, parent_of
from prima.scheduler.memory import Memory
from prima.scheduler.selection import Policy
from prima.scheduler.selector import Selector

HANG_MS = 120_000
"""How long a Command may run beyond its own stated times before it has failed (E1)."""


@dataclass(slots=True)
class Told:
    """Notices for one application, to be handled in the window of ``stream`` if any (C3)."""

    app: str
    stream: Stream | None
    notices: list[Notice]


class Mediator:
    """Mediates the Commands of any number of applications by the rules of one policy."""

    def __init__(
        self, policy: Policy, table: Table, chronicle: Chronicle, bound: int | None = None
    ) -> None:
        self.chronicle = chronicle
        self.memory = Memory()
        self.told: deque[Told] = deque()
        self._maker = Maker(table)
        self._selector = Selector(self.memory, policy, self._maker, chronicle, bound)
        self._deadlines: dict[str, int] = {}
        self._rolling: Behavior | None = None
        self._touched: dict[str, Stream] = {}
        self.halted = False

    @property
    def orders(self) -> list[Order]:
        """Orders for the devices, not yet drained."""
        return self._selector.orders

    def drain_orders(self) -> list[Order]:
        """Give the orders made since the last time."""
        orders, self._selector.orders = self._selector.orders, []
        return orders

    def _now(self) -> int:
        return self.chronicle.now

    # Applications -----------------------------------------------------------

    def load(self, name: str, kind: str) -> None:
        """An application starts; its place in the declared order is that of this call."""
        self.memory.apps[name] = Application(name, kind, len(self.memory.apps))
        self.chronicle.add("load", "mediator", app=name, data={"kind": kind})

    def unload(self, name: str, reason: str) -> None:
        """E2: an application has ended; what runs finishes, the rest is given back."""
        app = self.memory.apps[name]
        if app.gone:
            return
        app.gone = True
        self._withdraw(list(self.memory.of_app(app)), "E2")
        for number in list(app.units):
            self._close_unit(app, number)
        self.chronicle.add("unload", "mediator", app=name, rule="E2", outcome=reason)

    # Requests ---------------------------------------------------------------

    def request(self, name: str, asked: Request) -> None:
        """Take Commands in as one tree (U3), or refuse them all (E3)."""
        app = self.memory.apps[name]
        try:
            check_steps(asked.steps, app, self._maker.table)
        except Refused as refused:
            self._refuse(app, asked, refused)
            return
        unit = app.units.get(asked.unit) if asked.unit is not None else None
        first = asked.steps[0].what
        if isinstance(first, Command) and first.now:
            self._order_now(app, first, unit)
        reaction = asked.cause if unit is None else None
        stream, parent = self._place(app, reaction, unit)
        run = Run(asked.run, app, len(asked.steps))
        made = self._maker.chain(app, stream, asked.steps, asked, self._now(), run, unit)
        for ab in made:
            if not ab.waits_for:
                self._root(ab, parent, reaction)
            if unit is not None:
                unit.inner[ab.name] = ab
            self.memory.add(ab)
            self.chronicle.request(ab)
        app.latest = made[-1]

    def open_unit(self, name: str, asked: OpenUnit) -> None:
        """U5: a unit that spans questions is requested like an AB of its own."""
        app = self.memory.apps[name]
        stream, parent = self._place(app, asked.cause, None)
        unit = self._maker.spanning(app, stream, asked, self._now())
        app.units[asked.unit] = unit
        self._root(unit, parent, asked.cause)
        self.memory.add(unit)
        self.chronicle.request(unit)
        app.latest = unit

    def close_unit(self, name: str, asked: CloseUnit) -> None:
        """U5: the unit is left; what runs in it finishes, the rest is deleted."""
        self._close_unit(self.memory.apps[name], asked.unit)

    def leave_state(self, name: str, asked: LeaveState) -> None:
        """O3: the state's Commands that have not started are deleted, its loops end."""
        app = self.memory.apps[name]
        state = [ab for ab in self.memory.of_app(app) if ab.document_state == asked.state]
        if not state:
            return
        app.continuing = (state[-1].stream, self._now())
        self._withdraw(state, "O3")

    def _refuse(self, app: Application, asked: Request, refused: Refused) -> None:
        command = refused.command
        self.chronicle.add(
            "fail",
            "mediator",
            app=app.name,
            rule="E3",
            command=command.type if command else None,
            event=refused.event,
            message=refused.message,
            source=command.source if command else None,
        )
        notice = Notice("failed", asked.run, command, event=refused.event, message=refused.message)
        self.told.append(Told(app.name, None, [notice]))

    def _place(
        self, app: Application, reaction: int | None, unit: Behavior | None
    ) -> tuple[Stream, Behavior | None]:
        """O1, O2, O3, C3: the stream a new tree belongs to, and its parent there."""
        if unit is not None:
            return unit.stream, parent_of(app, unit)
        parent = parent_of(app, None) if reaction is None else None
        if parent is not None:
            return parent.stream, parent
        continuing = app.continuing
        if continuing is not None and continuing[1] == self._now():
            stream = continuing[0]
        elif reaction is None and app.window is not None:
            stream = app.window
        else:
            stream = self._maker.stream(app)
        if stream.name not in self.memory.streams:
            self.memory.streams[stream.name] = stream
        self._touched[stream.name] = stream
        return stream, None

    def _root(self, ab: Behavior, parent: Behavior | None, reaction: int | None) -> None:
        """Give a root its parent by O1, its reactive flag by C5, or its place by C3."""
        if parent is not None:
            link(parent, ab)
        elif reaction is not None:
            ab.reaction = reaction
        elif ab.app.window is ab.stream or ab.app.continuing is not None:
            ab.freed = self._now()

    def _order_now(self, app: Application, command: Command, unit: Behavior | None) -> None:
        """O2: cancel this application's trees that want a device of the new Command."""
        devices = self._maker.table[command.type].occupied(command.text)
        if unit is not None:
            clashing = [ab for ab in unit.inner.values() if ab.devices & devices]
            self._cancel(clashing, devices)
            return
        streams = {
            ab.stream.name: ab.stream
            for ab in self.memory.of_app(app)
            if ab.devices & devices and ab.unit is None
        }
        for stream in streams.values():
            app.continuing = (stream, self._now())
            self._cancel(list(stream.members.values()), devices)

    def _cancel(self, behaviors: list[Behavior], devices: frozenset[str]) -> None:
        """O2: delete ABs; one that runs on the devices is cut short, others finish."""
        for ab in reversed(behaviors):
            if ab.state is State.GONE or _in_group(ab):
                continue
            heard = not ab.silent
            if ab.state is State.RUNNING and not ab.devices & devices:
                self._silence(ab)
            else:
                self._delete(ab, "O2")
            if heard:
                self._tell_cancelled(ab)

    def _tell_cancelled(self, ab: Behavior) -> None:
        if ab.run is not None and not ab.app.gone:
            name = ab.command.type if ab.command else "iu"
            notice = Notice("cancelled", ab.run.number, ab.command, event=f"cancel.{name}")
            self.told.append(Told(ab.app.name, None, [notice]))

    def _withdraw(self, behaviors: list[Behavior], rule: str) -> None:
        """O3, E2: what has not started goes; what runs finishes, heard by nobody."""
        for ab in reversed(behaviors):
            if ab.state is State.GONE or _in_group(ab):
                continue
            if ab.state is State.RUNNING:
                self._silence(ab)
                ab.left = True
                if ab.listening:
                    self._delete(ab, rule)
            elif not ab.spans:
                self._delete(ab, rule)

    def _silence(self, ab: Behavior) -> None:
        ab.silent = True
        ab.last_loop = True

    def _delete(self, ab: Behavior, rule: str) -> None:
        """Take an AB out before its end; a running one is aborted."""
        ab.open = True  # a unit that is deleted does not settle as done
        for inner in list(ab.inner.values()):
            self._delete(inner, rule)
        if ab.state is State.RUNNING and ab.command is not None:
            self.orders.append(Order("abort", ab.id, ab.command, app=ab.app.name))
        self.chronicle.behavior("cancel", ab, rule=rule, outcome=ab.state.value)
        self._remove(ab)

    def _remove(self, ab: Behavior) -> None:
        unit = ab.unit
        self.memory.remove(ab)
        self._deadlines.pop(ab.name, None)
        self._touched[ab.stream.name] = ab.stream
        for child in ab.children:
            child.waits_for.discard(ab.name)
            if child.state is State.LINKED and not child.waits_for:
                child.freed = self._now()
                self.memory.wait(child)
        if ab.group is not None:
            ab.app.units = {key: held for key, held in ab.app.units.items() if held is not ab}
        if unit is not None:
            self._settle(unit)

    # Ends --------------------------------------------------------------------

    def running(self, behavior: str) -> Behavior | None:
        """The running AB of that name, if it runs still."""
        ab = self.memory.running.get(behavior.partition(".")[0])
        return ab if ab is not None and ab.id == behavior else None

    def question(self) -> Behavior | None:
        """The question that runs, if any (V1)."""
        ab = self.memory.occupied.get("speech-recognition")
        while ab is not None and ab.group is not None:
            ab = ab.busy.get("speech-recognition")
        return ab

    def listening(self, behavior: str) -> None:
        """A question has been said. One whose state was left ends at once (O3)."""
        ab = self.running(behavior)
        if ab is not None:
            ab.listening = True
            if ab.left:
                self._delete(ab, "O3")

    def ended(self, behavior: str, goal: bool, data: Data, inbound: bool = True) -> bool:
        """An AB ends by itself, or one loop of a feedback Command does (U2)."""
        ab = self.running(behavior)
        if ab is None:
            return False
        ending = goal or ab.last_loop or not ab.feedback
        self.chronicle.behavior(
            "end",
            ab,
            outcome=str(data.get("outcome", "done")) if ending else "again",
            goal=goal if ab.feedback else None,
            data=dict(data) or None,
            inbound=inbound or None,
        )
        if ab.feedback and not goal and "locomotion" in ab.devices:
            self._rolling = ab
        if ending:
            self._finish(ab, data)
        else:
            self.memory.release(ab)
            self._deadlines.pop(ab.name, None)
            ab.freed = self._now()
            self.memory.wait(ab)
        return True

    def _finish(self, ab: Behavior, data: Data) -> None:
        run = ab.run
        self._remove(ab)
        if ab.silent or ab.app.gone or run is None:
            return
        run.left -= 1
        notices = []
        if ab.command is not None:
            notices.append(Notice("ended", run.number, ab.command, data))
        if run.left == 0:
            notices.append(Notice("done", run.number, ab.command, data))
        self.told.append(Told(ab.app.name, ab.stream, notices))

    def _settle(self, unit: Behavior) -> None:
        """End a unit when its Commands have ended, or what was left to run in it has."""
        if unit.state is not State.RUNNING or unit.inner or unit.open:
            return
        self.chronicle.behavior("end", unit, outcome="done")
        self._finish(unit, {})

    def _close_unit(self, app: Application, number: int) -> None:
        unit = app.units.pop(number, None)
        if unit is None or unit.state is State.GONE:
            return
        unit.open = False
        for ab in list(reversed(list(unit.inner.values()))):
            if ab.state is State.RUNNING:
                self._silence(ab)
            elif ab.state is not State.GONE:
                self._delete(ab, "U5")
        if unit.name in self.memory.running:
            self._settle(unit)
        elif unit.name in self.memory.behaviors:
            self._delete(unit, "U5")

    # Failures ------------------------------------------------------------------

    def failed(self, behavior: str, device: str, reason: str) -> None:
        """E1: a device fails; the AB ends as failed and the rest of its tree goes."""
        ab = self.running(behavior)
        if ab is not None:
            self._fail(ab, f"error.device.{device}", reason, inbound=True)

    def _fail(self, ab: Behavior, event: str, reason: str, inbound: bool = False) -> None:
        self.chronicle.behavior(
            "fail",
            ab,
            rule="E1",
            event=event,
            message=reason,
            device=event.rpartition(".")[2],
            inbound=inbound or None,
        )
        if ab.feedback and "locomotion" in ab.devices:
            self._rolling = ab
        told = ab.silent or ab.app.gone
        # Inside a group the unit is the AB that fails (U4); a spanning unit stays its author's.
        while ab.unit is not None and not ab.unit.spans:
            unit = ab.unit
            for inner in list(unit.inner.values()):
                if inner is not ab:
                    self._delete(inner, "E1")
            unit.open = True  # so that it does not settle as done
            self._remove(ab)
            ab = unit
            self.chronicle.behavior("fail", ab, rule="E1", event=event, message=reason)
        stream, run, unit_of = ab.stream, ab.run, ab.unit
        self._remove(ab)
        self._delete_rest(stream.members if unit_of is None else unit_of.inner, run, "E1")
        if run is not None and not told:
            run.left = 0
            notice = Notice("failed", run.number, ab.command, event=event, message=reason)
            self.told.append(Told(ab.app.name, stream, [notice]))

    def _delete_rest(self, tree: dict[str, Behavior], run: Run | None, rule: str) -> None:
        """Delete what has not started of a failed tree; other runs in it are cancelled."""
        for other in list(reversed(list(tree.values()))):
            if other.state in (State.LINKED, State.WAITING) and not _in_group(other):
                self._delete(other, rule)
                if other.run is not run and not other.silent:
                    self._tell_cancelled(other)

    def deadline(self) -> int | None:
        """The next instant at which a unit or a device is too late, if any."""
        return min(self._deadlines.values(), default=None)

    def expire(self) -> None:
        """U5, E1: end what has run longer than it may."""
        late = [name for name, due in self._deadlines.items() if due <= self._now()]
        for name in late:
            self._deadlines.pop(name, None)
            ab = self.memory.running.get(name)
            if ab is not None and ab.group is not None:
                self._unit_timeout(ab)
            elif ab is not None:
                self.orders.append(Order("abort", ab.id, ab.command, app=ab.app.name))
                device = min(ab.devices, default="none")
                self._fail(ab, f"error.device.{device}", "The device did not end in time.")

    def _unit_timeout(self, unit: Behavior) -> None:
        self.chronicle.behavior("fail", unit, rule="U5", event="error.unit.timeout")
        number = next((key for key, ab in unit.app.units.items() if ab is unit), None)
        run = unit.run
        if number is not None:
            self._close_unit(unit.app, number)
        else:
            told = unit.silent or unit.app.gone
            self._silence(unit)
            for ab in list(reversed(list(unit.inner.values()))):
                if ab.state is not State.RUNNING:
                    self._delete(ab, "U5")
            self._delete_rest(unit.stream.members, run, "U5")
            if told:
                return
        notice = Notice(
            "failed" if number is None else "unit-timeout",
            number if number is not None else run.number if run else 0,
            event="error.unit.timeout",
            message="The unit took too long.",
        )
        self.told.append(Told(unit.app.name, unit.stream, [notice]))

    def emergency(self, pressed: bool, resume: bool) -> None:
        """E5: every AB ends at once and nothing starts until the stop is released."""
        self.chronicle.add("emergency", "mediator", rule="E5", outcome="pressed" if pressed else "released", inbound=True, data=None if pressed else {"resume": resume})  # fmt: skip
        if pressed:
            self.halted = True
            running = [ab for ab in self.memory.running.values() if ab.unit is None]
            for ab in running:
                self._halt(ab)
            return
        self.halted = False
        if not resume:
            for ab in reversed(list(self.memory.behaviors.values())):
                if ab.state is not State.GONE and not _in_group(ab):
                    self._delete(ab, "E5")
                    if not ab.silent:
                        self._tell_cancelled(ab)

    def _halt(self, ab: Behavior) -> None:
        given_up = ab.silent or ab.last_loop or (ab.spans and not ab.open)
        ab.open = ab.open or given_up  # it does not settle as done meanwhile
        for inner in list(ab.inner.values()):
            if given_up:
                self._delete(inner, "E5")
            elif inner.state is State.RUNNING:
                self._halt(inner)
        if ab.command is not None:
            self.orders.append(Order("abort", ab.id, ab.command, app=ab.app.name))
        self.chronicle.behavior("cancel", ab, rule="E5", outcome="halted")
        self.memory.release(ab)
        self._deadlines.pop(ab.name, None)
        if given_up:
            self._remove(ab)
        else:
            ab.listening = False
            self.memory.wait(ab)

    # Windows and selection -----------------------------------------------------

    def open_window(self, told: Told) -> None:
        """C3: while an application handles the end of its Command, its stream stays open."""
        stream = told.stream
        self.memory.apps[told.app].window = stream
        if stream is not None:
            stream.windows += 1
            self.chronicle.stream("window", stream, "C3", outcome="open")

    def close_window(self, told: Told) -> None:
        """The application has gone to wait for something else."""
        stream = told.stream
        self.memory.apps[told.app].window = None
        if stream is not None:
            stream.windows -= 1
            self._touched[stream.name] = stream
            self.chronicle.stream("window", stream, "C3", outcome="closed")

    def select(self) -> None:
        """Start everything that may start, then stop what rolls on for nobody (F5)."""
        self._close_streams()
        if not self.halted:
            self._selector.select(self._now())
            self._set_deadlines()
        if self._rolling is not None and "locomotion" not in self.memory.occupied:
            ab = self._rolling
            self.orders.append(Order("stop", ab.id, ab.command, app=ab.app.name))
            self.chronicle.behavior("stop", ab, rule="F5")
        self._rolling = None
        for app in self.memory.apps.values():
            app.continuing = None

    def _close_streams(self) -> None:
        """C1, F3: streams that nothing keeps open end, and hold no floor then."""
        touched, self._touched = self._touched, {}
        for stream in touched.values():
            if stream.open or stream.name not in self.memory.streams:
                continue
            del self.memory.streams[stream.name]
            self.chronicle.stream("stream-end", stream, "C1")
            floor = self.memory.floor
            if stream in floor:
                floor.remove(stream)
                self.chronicle.stream(
                    "floor", stream, "F3", outcome="returned", floor=[held.name for held in floor]
                )

    def _set_deadlines(self) -> None:
        for ab in self._selector.started:
            if ab.command is not None:
                self._deadlines[ab.name] = self._now() + allowance(ab)
            elif ab.longest is not None:
                self._deadlines[ab.name] = self._now() + ab.longest


def _in_group(ab: Behavior) -> bool:
    """Whether an AB is a part of a unit that shares the unit's fate (U4)."""
    return ab.unit is not None and not ab.unit.spans


def allowance(ab: Behavior) -> int:
    """How long an AB may run (ms): the times among its arguments and :data:`HANG_MS`."""
    row, command = ab.type, ab.command
    assert row is not None and command is not None
    stated: Iterable[int] = (
        int(command.args[name])
        for name, argument in row.arguments.items()
        if argument.kind == "duration" and name in command.args
    )
    return HANG_MS + sum(stated)
