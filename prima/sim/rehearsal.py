"""The virtual-time loop: it jumps to whatever is next, and steps only what moves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from prima.errors import DocumentError, Problem
from prima.interpreter.bounds import Visit
from prima.interpreter.elements import Document
from prima.interpreter.sensors import sensors_read
from prima.interpreter.surroundings import nearest
from prima.messages import Inbound, Loaded, Order, Record, Unloaded
from prima.scheduler.selection import Policy
from prima.session import AnyDocument, Session
from prima.sim.expected import check_expectations
from prima.sim.person import Person
from prima.sim.robot import Robot
from prima.sim.routes import Routes
from prima.sim.scenario import Area, Map, Point, Profile, Scenario
from prima.sim.services import Services, Web
from prima.sim.telephone import Telephone
from prima.sim.world import STEP_MS, World

THRESHOLD = 0.5
"""How far (m) outside an area the robot has left it."""
MAX_RECORDS = 500_000
"""Records that a run may make."""
MAX_WRITTEN = 50_000_000
"""Characters that the applications of a run may say, log and send."""


NAMING_APPLICATIONS = (
    *(("unload", "application"), ("load", "application")),
    *(("service", "application"), ("message", "to")),
)
"""Elements of scenarios, and their attributes, that name an application."""


@dataclass(slots=True)
class Cast:
    """All that a run needs, read and checked."""

    scenario: Scenario
    documents: list[AnyDocument]
    """Those of the scenario's applications, then those that areas of the world offer."""
    world: Map
    robot: Profile
    offers: list[tuple[Area, str]] = field(default_factory=list)
    """Areas that offer an application, with the application's id."""


def check_names(
    scenario: Scenario,
    world: Map | None,
    robot: Profile | None,
    documents: list[AnyDocument] | None,
) -> list[Problem]:
    """Names in a scenario that its world, robot and applications do not know.

    What could not be read is None: then nothing is said of its names.
    """
    problems: list[Problem] = []
    known: dict[tuple[str, str], tuple[set[str] | None, str]] = {}
    if world is not None:
        points = set(world.places) | set(world.things)
        known["robot", "at"] = set(world.places), "place"
        known["person", "at"] = known["walk", "to"] = points, "place or thing"
        known["look", "at"] = points | {"robot"}, "place or thing"
    if robot is not None:
        known["touch", "sensor"] = set(robot.touch), "touch sensor"
        known["fail", "device"] = known["repair", "device"] = set(robot.devices), "device"
        known["when", "doing"] = known["when", "done"] = set(robot.commands), "Command"
    if documents is not None:
        ids = {document.id for document in documents}
        for tag, name in NAMING_APPLICATIONS:
            known[tag, name] = ids, "application"
    for node in scenario.node.walk():
        for name in node.attributes:
            words, what = known.get((node.tag, name), (None, ""))
            word = node.attributes[name]
            if words is not None and word not in words:
                place = node.attribute_place(name)
                message = f'There is no {what} "{word}".'
                remedy = nearest(word, words)
                problems.append(Problem(place, "error", "no-such-name", message, remedy))
    return problems


def check_cast(cast: Cast) -> list[Problem]:
    """What is wrong with a scenario together with its world, robot and applications."""
    scenario = cast.scenario
    problems = check_names(scenario, cast.world, cast.robot, cast.documents)
    seen: set[str] = set()
    nodes = [node for _, _, node in scenario.applications]
    nodes += {name: area.node for area, name in reversed(cast.offers)}.values()
    for node, document in zip(nodes, cast.documents, strict=True):
        if document.id in seen:
            message = f'Two applications have the id "{document.id}".'
            own = isinstance(document, Document)
            remedy = "Change the id in one of the documents" if own else 'Give one another id="..."'
            remedy += ", or remove this one."
            problems.append(Problem(node.place, "error", "duplicate-id", message, remedy))
        seen.add(document.id)
    return problems + check_expectations(scenario, cast.documents, cast.robot)


class Rehearsal:
    """One run of a scenario. Iterate over :meth:`run` for its records, in order."""

    def __init__(
        self,
        cast: Cast,
        policy: Policy,
        bound: int | None = None,
        web: Web | None = None,
        isolate: str = "ea",
        patience: int | None = None,
    ) -> None:
        self.cast = cast
        problems = check_cast(cast)
        if problems:
            raise DocumentError(problems)
        scenario = cast.scenario
        at = cast.world.places.get(scenario.robot_at) or next(
            iter(cast.world.places.values()), (0.0, 0.0)
        )
        heading = scenario.robot_heading
        if heading is None:
            heading = cast.world.headings.get(scenario.robot_at, 0.0)
        self.world = World(cast.world, cast.robot, at, heading)
        self.world.person = self._person_start(scenario)
        self.robot = Robot(cast.robot, self.world, Routes(cast.world))
        self.person = Person(scenario, self.world, self.robot)
        self.services = Services(scenario.services, web)
        self.telephone = Telephone(scenario.transfers)
        self.session = Session(
            cast.documents,
            policy,
            cast.robot.commands,
            bound,
            scenario.date,
            absence=cast.robot.absence,
            isolate=isolate,
            patience=scenario.patience if patience is None else patience,
        )
        native = [doc for doc in cast.documents if isinstance(doc, Document)]
        self._watching = any(
            doc.watches or any(form.watches for form in doc.forms.values()) for doc in native
        )
        if self._watching:
            read = [sensors_read(doc) for doc in native]
            known = [one for one in read if one is not None]
            self.robot.told_of = frozenset().union(*known) if len(known) == len(read) else None
        self._loads = sorted(
            (start, index, doc.id)
            for index, ((_, start, _), doc) in enumerate(
                zip(scenario.applications, cast.documents, strict=False)
            )
        )
        self._native = {doc.id for doc in native}
        """Applications of PRIMA's own language."""
        self._inside: set[str] = set()
        """Areas that the robot is in."""
        self._crossed: Point | None = None
        """Where the robot was when areas were compared with its place last."""
        self._deadline = self.session.deadline()
        """When the session has to be stepped even if nothing happens: only a step changes it."""
        self._ended = self.session.over
        """Whether every application has ended, likewise."""
        self.outcome = ""
        """Why the run ended: ``over``, ``quiet``, ``until`` or ``limit``."""
        self.visits: list[Visit] = []
        """What applications came to in the latest instant."""
        self.made = 0
        self._full = False
        """Whether the run has made as much as it may."""
        self.now = 0
        """The instant that was carried out last (ms)."""

    def _person_start(self, scenario: Scenario) -> Point | None:
        return scenario.person_point or self.cast.world.point(scenario.person_at)

    def run(self) -> Iterator[list[Record]]:
        """Run to the end, giving the records of each instant as they are made."""
        until = self.cast.scenario.until
        while (records := self.advance(until)) is not None:
            yield records
        yield self.finish(until)

    def advance(self, until: int) -> list[Record] | None:
        """Carry out the next instant up to a time (ms).

        Returns:
            its records, or None if there is no such instant: nothing is due by then, or
            ``outcome`` says why the run has ended.
        """
        if self.over:
            self.outcome = "over"
        due = None if self.outcome else self.due()
        if due is None or due > until:
            return None
        if self._full:
            self.outcome = "limit"
            return None
        return self.step(max(due, self.now))

    def finish(self, until: int) -> list[Record]:
        """End the run at a time (ms) by which nothing is due any more; gives its last records."""
        due = None if self.outcome else self.due()
        if not self.outcome:
            self.outcome = "quiet" if due is None else "until"
        if self.outcome == "until":
            self.now = until
        self.session.recorder.now = self.now
        self.session.recorder.add("over", "mediator", outcome=self.outcome)
        self.visits = self.session.drain_visits()
        self.session.close()
        return self.session.drain()

    @property
    def over(self) -> bool:
        """Whether every application has ended, and none is still to come."""
        return self._ended and not self._loads and not self.person.will_load

    def step(self, now: int) -> list[Record]:
        """One instant. Where a body only moved on, nobody is told and nothing is decided."""
        self.now, self.visits = now, []
        self.world.advance(now)
        inbound, said = self._happened(now)
        if not inbound and (self._deadline is None or now < self._deadline):
            return []
        session = self.session
        for order in session.step(now, inbound):
            self._device(order).order(now, order)
        self._deadline, self._ended = session.deadline(), session.over
        if said:
            self.robot.listen_on()
        records, self.visits = session.drain(), session.drain_visits()
        self.made += len(records)
        self._full = self.made > MAX_RECORDS or session.written > MAX_WRITTEN
        self.person.observe(now, records)
        return records

    def _happened(self, now: int) -> tuple[list[Inbound], bool]:
        """All that happens at ``now``, and whether something of it is the person's doing."""
        inbound: list[Inbound] = []
        while self._loads and self._loads[0][0] <= now:
            inbound.append(self._loaded(self._loads.pop(0)[2]))
        if self.cast.offers:
            inbound += self._cross()
        inbound += self.robot.collect(now)
        said = self.person.collect(now)
        for value in said:
            inbound.append(self._loaded(value.app) if isinstance(value, Loaded) else value)
        inbound += self.services.collect(now)
        inbound += self.telephone.collect(now)
        if self._watching:
            inbound += self.robot.sense(self.person.sensors)
        return inbound, bool(said)

    def _device(self, order: Order) -> Robot | Services | Telephone:
        """Who carries out an order."""
        if order.verb != "send":
            return self.robot
        return self.telephone if "transfer" in order.data else self.services

    def _loaded(self, name: str, place: str = "") -> Loaded:
        """An application starts; one of VoiceXML is told of the user's call."""
        native = name in self._native
        return Loaded(name, place, {} if native else self.cast.scenario.connection)

    def _cross(self) -> list[Inbound]:
        """Load what an area offers that the robot has come into, and unload what it has left."""
        here = self.world.position
        if here is self._crossed:
            return []
        self._crossed = here
        crossed: list[Inbound] = []
        for area, name in self.cast.offers:
            inside = area.id in self._inside
            if not inside and area.holds(here):
                self._inside.add(area.id)
                crossed.append(self._loaded(name, area.title))
            elif inside and not area.holds(here, THRESHOLD):
                self._inside.discard(area.id)
                crossed.append(Unloaded(name, area.title))
        return crossed

    def due(self) -> int | None:
        """When the next instant is (ms), if ever."""
        due: int | None = None
        for time in (
            0 if self._crossed is None and self.cast.offers else None,
            self._loads[0][0] if self._loads else None,
            self.robot.due(),
            self.person.due(),
            self.services.due(),
            self.telephone.due(),
            self._deadline,
            self.world.time + STEP_MS if self.world.moving or self._has_controls() else None,
        ):
            if time is not None and (due is None or time < due):
                due = time
        return due

    def _has_controls(self) -> bool:
        """Whether a motion has been ordered that has not set the wheels going yet."""
        return any(
            task.control is not None and task.ends is None for task in self.robot.tasks.values()
        )
