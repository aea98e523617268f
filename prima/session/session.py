"""A session: inbound values in, orders out.

:meth:`Session.step` takes what happens at one instant and processes it by rule V3: ends of
ABs, then events, then timeouts, until nothing more happens; then selection, once.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict

from prima.grammar.answers import Answers
from prima.interpreter.bounds import ElementVisit
from prima.language.commands import ABSENCE_MS, PATIENCE_MS, CommandType
from prima.messages import (
    ApplicationLoaded,
    ApplicationUnloaded,
    Data,
    Delayed,
    Emergency,
    Ended,
    Event,
    Failed,
    Fetched,
    Halted,
    Heard,
    Inbound,
    Json,
    Listening,
    Narrated,
    Occurred,
    Order,
    Presence,
    Record,
    Sensed,
    Transferred,
)
from prima.messages.times import earliest
from prima.scheduler.mediator import Mediator
from prima.scheduler.policy import Policy
from prima.scheduler.recorder import Recorder
from prima.script.sandbox import START
from prima.session.applications import AnyApp, AnyDocument, Applications
from prima.session.hearing import Hearing
from prima.session.wiring import Wiring

SEEING = frozenset(["human.found", "human.lost"])
"""Events by which the camera reports whether it sees the user (V4)."""


class Session:
    """One robot's applications under one policy.

    ``isolate`` says whose code runs in a process of its own
    (:data:`~prima.script.isolated.ISOLATIONS`); :meth:`close` ends these processes.
    """

    def __init__(
        self,
        documents: Iterable[AnyDocument],
        policy: Policy,
        commands: Mapping[str, CommandType],
        bound: int | None = None,
        date: str = START,
        absence: int = ABSENCE_MS,
        isolate: str = "ea",
        patience: int = PATIENCE_MS,
    ) -> None:
        self._apps = Applications(documents, commands, date, isolate)
        self.recorder = Recorder()
        self.mediator = Mediator(policy, commands, self.recorder, bound, absence, patience)
        self._wiring = Wiring(self._apps, self.mediator, self.recorder)
        self.hearing = Hearing(self._wiring, "x10" in policy.extensions)
        self._sensors: dict[str, Json] = {}

    @property
    def apps(self) -> Mapping[str, AnyApp]:
        """The applications by their names, in declared order."""
        return self._apps.named

    @property
    def failures(self) -> list[str]:
        """Applications that ended with an error, as ``NAME: what``."""
        return self._wiring.failures

    @property
    def defects(self) -> list[Exception]:
        """Errors in the interpreters themselves: each has ended its application."""
        return self._apps.defects

    def drain_visits(self) -> list[ElementVisit]:
        """The elements reached since the last call, one application after the other."""
        return self._apps.drain_visits()

    # Driving ------------------------------------------------------------------

    def step(self, now: int, inbound: Collection[Inbound]) -> list[Order]:
        """Process what happens at ``now`` (ms, never less than before) and return the orders.

        Orders are for the devices, in the order in which they were made; ``send``
        orders are for services.
        """
        self.recorder.now = now
        if self._wiring.turns:
            self._wiring.tell_turns()
        for value in self._in_order(inbound) if len(inbound) > 1 else inbound:
            self._take(value)
        mediator = self.mediator
        if self._wiring.due or mediator.memory.behaviors or mediator.holds:
            self._time_out(now)
        if mediator.deliveries:
            self._wiring.settle()
        orders: list[Order] = []
        if mediator.changed:  # otherwise it has not given any orders either
            mediator.select()
            self._wiring.note_turns()
            orders = mediator.drain_orders()
        if self._wiring.sends:
            orders += self._wiring.sends
            self._wiring.sends = []
        return orders

    def deadline(self) -> int | None:
        """When :meth:`step` next has to be called, if anything is due."""
        if self._wiring.turns:
            return self.recorder.now + 1
        return earliest(self.mediator.deadline(), *self._wiring.due.values())

    def close(self) -> None:
        """End the processes in which code was evaluated: the session is over."""
        self._apps.close()

    @property
    def written(self) -> int:
        """The number of characters that the applications have said, logged and sent."""
        return sum(app.written for app in self._apps.named.values())

    def drain(self) -> list[Record]:
        """Return the records made since the last call."""
        return self.recorder.drain()

    @property
    def over(self) -> bool:
        """Whether every loaded application, and what it left running (E2), has ended."""
        return bool(self._apps.loaded) and not self._apps.living() and self.idle

    @property
    def idle(self) -> bool:
        """Whether nothing runs or waits in working memory."""
        return not self.mediator.memory.behaviors

    def _in_order(self, inbound: Collection[Inbound]) -> list[Inbound]:
        """V3: what happens at an instant, in order; applications loaded then start together (E6)."""
        loads = (one.app for one in inbound if isinstance(one, ApplicationLoaded))
        self.mediator.expect(name for name in loads if self._apps.there(name) is None)
        return sorted(inbound, key=self._class)

    def _class(self, value: Inbound) -> tuple[int, int, int]:
        """V3: sort by class, and ends by application, the active stream's first, and by number."""
        if isinstance(value, Ended | Listening | Halted | Failed):
            ab = self.mediator.running(value.behavior)
            rank = self._rank(value.behavior.partition("#")[0])
            return 0, rank, ab.serial if ab is not None else 0
        return 1, 0, 0

    def _rank(self, name: str) -> int:
        active = self.mediator.memory.active
        return -1 if active is not None and active.name == name else self._apps.order.get(name, 0)

    def _take(self, value: Inbound) -> None:
        match value:
            case Occurred():
                self._occurred(value)
            case Ended():
                self.hearing.lapse(value)
                self.mediator.ended(value.behavior, value.goal, value.data)
                self._wiring.settle()
            case Listening():
                self._record("listening", "robot", behavior=value.behavior)
                self.mediator.listening(value.behavior)
            case Halted():
                self.mediator.interrupted(value.behavior, value.data)
                self._wiring.settle()
            case Failed():
                self.mediator.failed(value.behavior, value.device, value.reason)
                self._wiring.settle()
            case Heard():
                self.hearing.hear(value)
            case Fetched() | Transferred():
                self._answered(value)
            case Sensed():
                self._sensed(value)
            case Emergency():
                self._emergency(value)
            case ApplicationLoaded():
                self._load(value)
            case ApplicationUnloaded():
                self._unload(value)
            case _:
                self._note(value)

    def _note(self, value: Delayed | Presence | Narrated) -> None:
        """Record something that concerns no application."""
        match value:
            case Delayed():
                waited: dict[str, Json] = {"waited": value.waited / 1000}
                ab, device = value.behavior, value.device
                self._record("delayed", "robot", behavior=ab, device=device, data=waited)
            case Presence():
                outcome, why = "back" if value.there else "missing", value.reason or None
                device = value.device
                self._record("device", "environment", device=device, outcome=outcome, message=why)
            case Narrated():
                self._record("note", value.actor, text=value.text)

    def _emergency(self, value: Emergency) -> None:
        """E5: applications are notified by an event; the record has its serial number."""
        self._wiring.serial += 1
        self.mediator.emergency(value.pressed, value.resume, self._wiring.serial)
        name = "emergency.stop" if value.pressed else "emergency.release"
        event = Event(name, self._wiring.serial, {}, reactive=True, shared=True)
        for app in self._wiring.in_order():
            self._apps.guard(app, app.event, self.recorder.now, event)
            self._wiring.act(app)
        self._wiring.settle()

    def _record(self, phase: str, actor: str, **fields: Json) -> None:
        self.recorder.add(phase, actor, inbound=True, **fields)

    def _load(self, value: ApplicationLoaded) -> None:
        name = value.app
        self._record("load", "environment", app=name, data=place_data(value))
        app = self._apps.load(name)
        if app is None:
            return
        app.sensors.update(self._sensors)
        app.connection = value.connection
        self.mediator.load(name, app.kind, self._apps.documents[name].lang, self._apps.order[name])
        self._apps.guard(app, app.start, self.recorder.now)
        self._wiring.act(app)
        if self._sensors:  # a condition that it watches may already be true
            self._look(app, {})
        self._wiring.settle()

    def _unload(self, value: ApplicationUnloaded) -> None:
        self._record("unload", "environment", app=value.app, data=place_data(value))
        app = self._apps.there(value.app)
        if app is not None:
            self._apps.guard(app, app.stop)
            self._wiring.act(app)

    def _occurred(self, value: Occurred) -> None:
        name, app, data = value.name, value.app, value.data
        self._wiring.serial = serial = self._wiring.serial + 1
        self.recorder.add(
            "event",
            value.actor,
            app=app,
            event=name,
            data=dict(data) or None,
            serial=serial,
            inbound=True,
        )
        if name in SEEING:
            self.mediator.sees_user(name == "human.found")
        elif value.actor == "user":
            self.mediator.senses_user()
        event = Event(name, serial, data, True, shared=app is None)
        for one in self._wiring.in_order() if app is None else self._apps.alone(app):
            self._apps.guard(one, one.event, self.recorder.now, event)
            self._wiring.act(one)

    def listening(self) -> list[Answers]:
        """The utterances possible now: answers to a listening or interruptible question, links (V1)."""
        return self.hearing.listening()

    def _answered(self, value: Fetched | Transferred) -> None:
        """Pass an answer to the application that asked."""
        if isinstance(value, Fetched):
            answer = {key: one for key, one in asdict(value).items() if one and key != "app"}
            self._record("fetched", "environment", app=value.app, data=answer)
        else:
            self._record(
                "transferred",
                "environment",
                app=value.app,
                serial=value.serial,
                outcome=value.outcome,
                data={"uri": value.uri},
            )
        app = self._apps.there(value.app)
        if app is not None:
            self._apps.guard(app, app.replied, self.recorder.now, value)
            self._wiring.act(app)
            self._wiring.settle()

    def _sensed(self, value: Sensed) -> None:
        self._record("sensed", "environment", data=dict(value.values))
        self._sensors.update(value.values)
        for app in self._wiring.in_order():
            self._look(app, value.values)

    def _look(self, app: AnyApp, values: Data) -> None:
        """C6: give an application sensor values; raise the events of conditions that turn true."""
        for name in self._apps.guard(app, app.sensed, self.recorder.now, values) or []:
            self._wiring.own_event(app, name, {}, reactive=True)
        self._wiring.act(app)

    def _time_out(self, now: int) -> None:
        """V3: timeouts come last."""
        if self.mediator.expire():
            self._wiring.settle()
        if not self._wiring.due or min(self._wiring.due.values()) > now:
            return
        for app in self._wiring.in_order():
            # One event at a time: its handler may leave the state of others.
            while due := self._apps.guard(app, app.expire, now):
                self._wiring.own_event(app, due[0], dict(due[1]), reactive=False)
            self._wiring.act(app)


def place_data(value: ApplicationLoaded | ApplicationUnloaded) -> dict[str, Json] | None:
    """A record's data on an application that a place loads or unloads, or that has a caller."""
    data: dict[str, Json] = {"place": value.place} if value.place else {}
    if isinstance(value, ApplicationLoaded) and value.connection:
        data["connection"] = dict(value.connection)
    return data or None
