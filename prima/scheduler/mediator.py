"""The mediator: takes requests and ends in, gives orders and notices out.

It has no clock, devices or documents. At each instant the caller reports first
what has ended, then what has happened, calls :meth:`Mediator.select` once
(rule V3), and drains the orders (for the devices), ``deliveries`` (for the
applications) and the recorder's records. The rules are functions in the
neighbouring modules, which this module calls.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping

from prima.language.commands import ABSENCE_MS, PATIENCE_MS, CommandType
from prima.messages import CloseUnit, Data, LeaveState, OpenUnit, Order, Request
from prima.scheduler import (
    emergency,
    endings,
    failures,
    freshness,
    interruption,
    requests,
    selection,
    streams,
)
from prima.scheduler.behavior import Application, Behavior, Stream
from prima.scheduler.mediation import Delivery, Mediation
from prima.scheduler.policy import Policy
from prima.scheduler.recorder import Recorder


class Mediator:
    """Mediates the Commands of any number of applications by the rules of one policy.

    The arguments are those of :class:`~prima.scheduler.mediation.Mediation`.
    """

    def __init__(
        self,
        policy: Policy,
        table: Mapping[str, CommandType],
        recorder: Recorder,
        bound: int | None = None,
        absence: int = ABSENCE_MS,
        patience: int = PATIENCE_MS,
    ) -> None:
        recorder.extensions = policy.extensions
        self._all = Mediation(policy, table, recorder, bound, absence, patience)
        self.memory = self._all.memory
        self.recorder = recorder

    # Applications ---------------------------------------------------------------------

    def expect(self, names: Iterable[str]) -> None:
        """Applications will be loaded at this instant: each starts beside the others (E6)."""
        self._all.coming = {*names}

    def load(self, name: str, kind: str, lang: str = "", order: int | None = None) -> None:
        """An application starts; ``lang`` is its language, if known.

        ``order`` is its place among the declared ones (S2f); by default, after all earlier
        ones.
        """
        before = self.memory.apps.get(name)
        if order is None:
            order = before.order if before is not None else len(self.memory.apps)
        self.memory.apps[name] = Application(name, kind, order)
        self._all.coming.discard(name)
        data = {"kind": kind, **({"lang": lang} if lang else {})}
        self.recorder.add("load", "mediator", app=name, data=data)

    def unload(self, name: str, reason: str) -> None:
        """E2: an application has ended."""
        app = self.memory.apps[name]
        if not app.gone:
            self._all.changed = True
            requests.e2(self._all, app, reason)

    def ask(self, name: str, asked: Request | OpenUnit | CloseUnit | LeaveState) -> None:
        """An application requests Commands, begins or leaves a unit, or leaves a state."""
        self._all.changed = True
        app = self.memory.apps[name]
        match asked:
            case Request():
                requests.u3(self._all, app, asked)
            case OpenUnit():
                requests.u5(self._all, app, asked)
            case CloseUnit():
                endings.close_unit(self._all, app, asked.unit)
            case LeaveState():
                requests.o3(self._all, app, asked)

    def open_window(self, delivery: Delivery) -> None:
        """C3: an application begins to handle a notice."""
        streams.open_window(self._all, delivery)

    def close_window(self, delivery: Delivery) -> None:
        """C3: it has handled the notice."""
        streams.close_window(self._all, delivery)

    # Devices and the user ---------------------------------------------------------------

    def ended(self, behavior: str, goal: bool, data: Data, inbound: bool = True) -> bool:
        """U2: an AB, or one loop of it, has ended by itself; False if it is not running."""
        ab = self.running(behavior)
        if ab is not None:
            self._all.changed = True
            endings.u2(self._all, ab, goal, data, inbound)
        return ab is not None

    def listening(self, behavior: str) -> None:
        """A question has been asked. If its state was left, it ends at once (O3)."""
        ab = self.running(behavior)
        if ab is not None:
            self._all.changed = ab.listening = True
            if ab.left:
                endings.delete(self._all, ab, "O3")

    def interrupted(self, behavior: str, data: Data) -> None:
        """X2: a device reports how much it had done of an interrupted AB."""
        self._all.changed = True
        interruption.interrupted(self._all, behavior, data)

    def answered(self, ab: Behavior, data: Data, rule: str, serial: int) -> None:
        """X8, X10: the user's words, the event ``serial``, answer a question before it is asked."""
        self._all.changed = True
        endings.answered(self._all, ab, data, rule, serial)

    def offered(self) -> Behavior | None:
        """X8: the question that is offered what the listening one refuses, if any."""
        return freshness.offered(self._all) if "x8" in self._all.policy.extensions else None

    def coming_question(self, name: str) -> Behavior | None:
        """X10: the question that an application is asking, or asks next."""
        members = self.memory.apps[name].members.values()
        asking = (one for one in members if one.command and one.command.type == "q-and-a")
        return next((one for one in asking if one.run is not None and not one.silent), None)

    def failed(self, behavior: str, device: str, reason: str) -> None:
        """E1: a device fails."""
        ab = self.running(behavior)
        if ab is not None:
            self._all.changed = True
            failures.e1(self._all, ab, f"error.device.{device}", reason, inbound=True)

    def emergency(self, pressed: bool, resume: bool, serial: int) -> None:
        """E5: the emergency stop is pressed or released; ``serial`` is that event's."""
        self._all.changed = True
        emergency.e5(self._all, pressed, resume, serial)

    def sees_user(self, yes: bool) -> None:
        """V4: the camera has found or lost the user (for X4 and K1)."""
        if yes or self.memory.in_view:
            self.senses_user()
        self.memory.in_view = yes

    def senses_user(self) -> None:
        """K1: the user is seen, heard or felt."""
        self.memory.sensed = self._all.now
        self._all.changed = self._all.changed or self.memory.absent

    # Time -------------------------------------------------------------------------------

    def deadline(self) -> int | None:
        """When :meth:`expire` next has something to do (ms), if ever."""
        return failures.deadline(self._all)

    def expire(self) -> bool:
        """U5, E1, X8: end what has taken too long; whether anything had."""
        due = self.deadline()
        if due is None or due > self._all.now:
            return False
        self._all.changed = True
        failures.expire(self._all)
        freshness.x8(self._all)
        return True

    def select(self) -> None:
        """Start everything that may start, then stop the body if it rolls on needlessly (F5)."""
        if not self._all.changed:
            return
        self._all.changed = False
        streams.c1(self._all)
        if not self._all.halted:
            failures.look_for_user(self._all)
            selection.select(self._all)
            failures.set_deadlines(self._all)
        selection.f5(self._all)
        streams.end_continuing(self._all)

    # What comes of it -------------------------------------------------------------------

    @property
    def changed(self) -> bool:
        """Whether there is anything to select from."""
        return self._all.changed

    @property
    def halted(self) -> bool:
        """Whether the emergency stop is pressed (E5)."""
        return self._all.halted

    @property
    def holds(self) -> Mapping[str, int]:
        """Until when streams are held (ms, X3), by name."""
        return self._all.holds

    @property
    def deliveries(self) -> deque[Delivery]:
        """The notices not yet passed to applications."""
        return self._all.deliveries

    @property
    def orders(self) -> list[Order]:
        """Orders for the devices, not yet drained."""
        return self._all.orders

    def drain_orders(self) -> list[Order]:
        """Return the orders made since the last call."""
        orders, self._all.orders = self._all.orders, []
        return orders

    def drain_turns(self) -> list[tuple[str, Stream]]:
        """Return the streams that wait ``suspended`` or have ``resumed`` since the last call."""
        turns, self._all.turns = self._all.turns, []
        return turns

    def running(self, behavior: str) -> Behavior | None:
        """The AB of a Command with that name in the transcript, if it is still running.

        A unit ends with its Commands: devices know nothing of it.
        """
        ab = self.memory.running.get(behavior.partition(".")[0])
        return ab if ab is not None and ab.id == behavior and ab.command is not None else None

    def question(self) -> Behavior | None:
        """The running question, if any (V1)."""
        return self.memory.using("speech-recognition")
