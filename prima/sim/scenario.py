"""Scenarios as values, read from their documents."""

from __future__ import annotations

from dataclasses import dataclass, field

from prima.devices.reading import Reader
from prima.errors import DocumentError, Problem, has_errors
from prima.language.commands import PATIENCE_MS
from prima.markup.tree import Node
from prima.messages import Json
from prima.script.sandbox import START
from prima.sim.chance import Amount, Draws
from prima.sim.expectations import Expectation, read_expectations
from prima.sim.happenings import (
    CallTransfer,
    Service,
    When,
    check_where,
    read_answer,
    read_connection,
    read_services,
    read_transfer,
    read_when,
)
from prima.sim.plan import Point
from prima.sim.user import User
from prima.sim.vocabulary.scenario import SCENARIO

UNTIL_MS = 600_000
"""When a run ends if the scenario does not say."""
WALKING = Amount(1.0)
"""How fast a person walks by default."""


@dataclass(slots=True)
class Person:
    """A person of a scenario."""

    name: str
    at: str = ""
    """The place or thing where they start."""
    point: Point | None = None
    speed: Amount = WALKING
    """Metres a second."""
    user: str = ""
    """The document that says how they behave, as a path."""
    node: Node | None = None


@dataclass(slots=True)
class Scenario:
    """A run's script. Paths are as written, relative to the scenario's file."""

    id: str
    world: str
    robot: str
    until: int
    date: str
    """When the run begins by its own calendar, as ``2005-03-01T10:00:00`` (UTC)."""
    policy: str
    patience: int
    """How long (ms) an application may keep others from the speaker (E6); 0 for no limit."""
    entrances: bool
    seed: int
    """The seed of the random values of the scenario and its users."""
    robot_at: str
    robot_heading: float | None
    persons: list[Person]
    applications: list[tuple[str, Amount, Node]]
    """Their documents, and when they are loaded (ms)."""
    whens: list[When]
    services: list[Service]
    connection: dict[str, Json]
    """The user's call, as in ``session.connection``."""
    transfers: list[CallTransfer]
    expectations: list[Expectation]
    """The expectations that ``prima test`` checks, in document order."""
    draws: Draws
    node: Node
    users: dict[str, User] = field(default_factory=dict)
    """The behaviour of persons with a document of their own, by name."""

    @property
    def drawn(self) -> bool:
        """Whether anything in it is random."""
        return self.draws.any or any(user.draws.any for user in self.users.values())

    def take(self, name: str, user: User) -> None:
        """Let a person be a user of a kind; the scenario's own settings take precedence."""
        self.users[name] = user
        for person in self.persons:
            if person.name == name and person.node is not None:
                person.speed = person.speed if "speed" in person.node.attributes else user.speed
        first = self.persons[0].name
        for when in self.whens:
            if (
                when.node is not None
                and when.node.tag == "answer"
                and (when.person or first) == name
            ):
                user.answer(when, self.draws.name(when.node))
        self.whens += user.whens


def read_scenario(file: str, data: bytes) -> Scenario:
    """Read a scenario; names of the world are checked when the run is put together.

    Raises:
        DocumentError: with all its problems.
    """
    scenario, problems = look_at_scenario(file, data)
    if has_errors(problems):
        raise DocumentError(problems)
    return scenario


def look_at_scenario(file: str, data: bytes) -> tuple[Scenario, list[Problem]]:
    """A scenario and its problems; invalid parts have no value.

    Raises:
        DocumentError: it is not an XML document, or exceeds a limit.
    """
    reader = Reader(SCENARIO, file, data)
    root = reader.root
    draws = Draws(reader)
    robot, connection = reader.only("robot"), reader.only("connection")
    applications = _applications(draws)
    persons = _persons(draws)
    seen: set[str] = set()
    for node in root.all("when", "answer"):
        reader.once(node, seen, "The id ")
    until, patience = reader.get(root, "until"), reader.get(root, "patience")
    seed = reader.get(root, "seed")
    scenario = Scenario(
        id=root.get("id"),
        world=root.get("world"),
        robot=root.get("robot"),
        until=UNTIL_MS if until is None else until,
        date=reader.get(root, "date") or START,
        policy=root.get("policy", "prima"),
        patience=PATIENCE_MS if patience is None else patience,
        entrances=root.get("entrances") == "open",
        seed=1 if seed is None else seed,
        robot_at=robot.get("at") if robot is not None else "",
        robot_heading=reader.given(robot, "heading"),
        persons=persons,
        applications=applications,
        whens=[read_when(draws, node) for node in root.all("when")]
        + [read_answer(draws, node) for node in root.all("answer")],
        services=read_services(draws),
        connection=read_connection(connection) if connection is not None else {},
        transfers=[read_transfer(draws, node) for node in root.all("transfer")],
        expectations=read_expectations(reader, root),
        draws=draws,
        node=root,
    )
    return scenario, reader.problems


def _applications(draws: Draws) -> list[tuple[str, Amount, Node]]:
    """The applications: path, when they start, element."""
    root = draws.reader.root
    named = root.all("application")
    if not named and root.get("entrances") != "open":
        message = "The scenario runs no <application>."
        remedy = 'Name one, or write entrances="open" to take up what the world offers.'
        draws.reader.problem(root, "missing-element", message, "", remedy)
    return [(node.get("src"), draws.amount(node, "start"), node) for node in named]


def _persons(draws: Draws) -> list[Person]:
    """The people present; one without a place if the scenario names nobody."""
    reader = draws.reader
    nodes, seen = reader.root.all("person"), set[str]()
    for node in nodes:
        check_where(reader, node, "at", "a place to be at", needed=False)
        if not reader.once(node, seen, "The id ") and len(nodes) > 1:
            message = "Of several persons each needs an id."
            reader.problem(node, "missing-attribute", message, "", 'Write id="...".')
    persons = [
        Person(
            node.get("id") or "user",
            node.get("at"),
            _point(reader, node),
            draws.amount(node, "speed", 1.0),
            node.get("user"),
            node,
        )
        for node in nodes
    ]
    persons = persons or [Person("user")]
    names = {one.name for one in persons}
    for node in reader.root.all("when", "answer"):
        reader.known(node, "person", names, "person")
    return persons


def _point(reader: Reader, person: Node) -> Point | None:
    """Where a person starts, if given by coordinates (m)."""
    if "x" not in person.attributes:
        return None
    return reader.get(person, "x") or 0.0, reader.get(person, "y") or 0.0
