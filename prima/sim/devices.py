"""The simulation around a session: robot, user, services, telephone, and the world's areas."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from prima.devices.profile import Profile
from prima.interpreter.elements import Document
from prima.interpreter.sensors import sensors_read
from prima.messages import ApplicationLoaded, Inbound, Order, Record
from prima.messages.times import earliest
from prima.session import AnyDocument
from prima.sim.entrances import Crossing, Entrances
from prima.sim.happenings import Doing
from prima.sim.map import Area, Map
from prima.sim.people import People
from prima.sim.robot import Robot
from prima.sim.routes import Routes
from prima.sim.scenario import Scenario
from prima.sim.services import Services, Web
from prima.sim.telephone import Telephone
from prima.sim.world import STEP_MS, World


@dataclass(slots=True)
class Cast:
    """Everything that a run needs, read and checked."""

    scenario: Scenario
    documents: list[AnyDocument]
    """The documents of the scenario's applications, then of those that the world's areas offer."""
    world: Map
    robot: Profile
    offers: list[tuple[Area, str]] = field(default_factory=list)
    """The areas that offer an application, with the application's id."""


class SimulatedDevices:
    """The :class:`~prima.devices.loop.Devices` of a scenario."""

    def __init__(self, cast: Cast, web: Web | None = None, exclusive: bool = True) -> None:
        scenario = cast.scenario
        self.cast = cast
        self.world = _world(cast)
        self.robot = Robot(cast.robot, self.world, Routes(cast.world), exclusive)
        self.people = People(scenario, self.world, self.robot)
        self.services = Services(scenario.services, web, scenario.seed)
        self.telephone = Telephone(scenario.transfers, scenario.seed)
        self._native = {doc.id for doc in cast.documents if isinstance(doc, Document)}
        """Applications in PRIMA's own language; the others are given the user's call."""
        self._watched = watches(cast.documents)
        if self._watched:
            self.robot.body.sensors.told_of = sensors_watched(cast.documents)
        self._loads = sorted(
            (start.ms(scenario.seed), index, doc.id)
            for index, ((_, start, _), doc) in enumerate(
                zip(scenario.applications, cast.documents, strict=False)
            )
        )
        self.watcher: Callable[[], None] | None = None
        """Called at each instant, if anybody wants to know where everybody is."""
        self._entrances = Entrances(cast.offers)
        self._said = False
        """Whether any of the latest inbound values came from the user."""
        self._stirred = True
        """Whether anything but positions may have changed since the due time was computed."""
        self._standing: int | None = None
        """When something is due even if nothing moves, as computed by :meth:`due`."""

    @property
    def awaits(self) -> bool:
        """Whether an application is yet to be loaded."""
        return bool(self._loads) or self.people.will_load

    def due(self) -> int | None:
        """When there is next something to collect (ms), if ever."""
        if self._stirred:
            self._stirred, self._standing = False, self._due_standing()
        if self.world.moves() or self.robot.body.moves_on:
            step = self.world.time + STEP_MS
            return step if self._standing is None or step < self._standing else self._standing
        return self._standing

    def _due_standing(self) -> int | None:
        """The same, ignoring motion."""
        return earliest(
            0 if self._entrances.unseen else None,
            self._loads[0][0] if self._loads else None,
            self.robot.due(),
            self.people.due(),
            self.services.due(),
            self.telephone.due(),
        )

    def collect(self, now: int) -> list[Inbound]:
        """Everything that happens by ``now``, in order; :meth:`due` must have been called.

        Most instants only move the bodies.
        """
        self._said = False
        self.world.advance(now)
        crossed = self._entrances.cross(self.world.position)
        moved = self.robot.get_on(now)
        standing = self._standing is not None and self._standing <= now
        inbound = self._happened(now, crossed) if moved or crossed or standing else []
        self.people.follow()
        if self._watched:
            inbound += self.robot.sense(self.people.sensors)
        if self.watcher is not None:
            self.watcher()
        return inbound

    def _happened(self, now: int, crossed: list[Crossing]) -> list[Inbound]:
        """Everything that happens at ``now`` other than motion, in order."""
        self._stirred = True
        inbound: list[Inbound] = []
        while self._loads and self._loads[0][0] <= now:
            inbound.append(ApplicationLoaded(self._loads.pop(0)[2]))
        inbound += [*crossed, *self.robot.collect(now)]
        said = self.people.collect(now)
        self._said = bool(said)
        inbound += [*said, *self.services.collect(now), *self.telephone.collect(now)]
        for value in inbound:
            if isinstance(value, ApplicationLoaded) and value.app not in self._native:
                value.connection = self.cast.scenario.connection
        return inbound

    def order(self, now: int, order: Order) -> None:
        """Pass an order to its recipient."""
        if order.verb != "send":
            self.robot.order(now, order)
        elif "transfer" in order.data:
            self.telephone.order(now, order)
        else:
            self.services.order(now, order)

    def observe(self, now: int, records: list[Record]) -> None:
        """Let the user see what has happened; the robot keeps listening."""
        self._stirred = True
        self.robot.settle(now)
        if self._said:
            self.robot.ear.listen_on(now)
        self.people.observe(now, records)

    def play(self, time: int, doings: list[Doing]) -> Callable[[], bool]:
        """Let the first person do something: see :meth:`People.play`."""
        self._stirred = True
        return self.people.play(time, doings)


def _world(cast: Cast) -> World:
    """The world, with robot and user in their initial places."""
    scenario, plan = cast.scenario, cast.world
    place = scenario.robot_at or next(iter(plan.places), "")
    heading = scenario.robot_heading
    if heading is None:
        heading = plan.headings.get(place, 0.0)
    world = World(plan, cast.robot, plan.places.get(place, (0.0, 0.0)), heading)
    for person in scenario.persons:
        world.put(person.name, person.point or plan.point(person.at))
    return world


def watches(documents: Iterable[AnyDocument]) -> bool:
    """Whether an application watches sensors."""
    native = (doc for doc in documents if isinstance(doc, Document))
    return any(doc.watches or any(form.watches for form in doc.forms.values()) for doc in native)


def sensors_watched(documents: Iterable[AnyDocument]) -> frozenset[str] | None:
    """The sensors that applications read, by the first part of their names.

    None if that cannot be determined: then all may matter.
    """
    read = [sensors_read(doc) for doc in documents if isinstance(doc, Document)]
    known = [one for one in read if one is not None]
    return frozenset().union(*known) if len(known) == len(read) else None
