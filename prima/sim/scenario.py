"""Scenarios as values, read from their documents."""

from __future__ import annotations

from dataclasses import dataclass

from prima.devices.reading import RENAME, Reader
from prima.errors import DocumentError, Problem
from prima.language.commands import PATIENCE_MS
from prima.markup.tree import Node
from prima.messages import Json
from prima.script.prelude import START
from prima.sim.expectations import Expectation, read_expectations
from prima.sim.happenings import (
    Service,
    Transfer,
    When,
    check_where,
    read_answer,
    read_connection,
    read_services,
    read_transfer,
    read_when,
)
from prima.sim.map import Point
from prima.sim.vocabulary import SCENARIO

UNTIL_MS = 600_000
"""When a run ends whose scenario does not say."""


@dataclass(slots=True)
class Scenario:
    """A run's script. Paths are as written, relative to the scenario's file."""

    id: str
    title: str
    world: str
    robot: str
    until: int
    date: str
    """When the run begins by its own calendar, as ``2005-03-01T10:00:00`` (UTC)."""
    policy: str
    patience: int
    """How long (ms) an application may keep others from the speaker (E6); 0 for ever."""
    entrances: bool
    robot_at: str
    robot_heading: float | None
    person_at: str
    person_point: Point | None
    person_speed: float
    applications: list[tuple[str, int, Node]]
    whens: list[When]
    services: list[Service]
    connection: dict[str, Json]
    """What is known of the user's call, as ``session.connection`` has it."""
    transfers: list[Transfer]
    expectations: list[Expectation]
    """What ``prima test`` checks, in document order."""
    node: Node


def read_scenario(file: str, data: bytes) -> Scenario:
    """Read a scenario; names of the world are checked when the run is put together.

    Raises:
        DocumentError: with all its problems.
    """
    scenario, problems = look_at_scenario(file, data)
    if any(problem.severity == "error" for problem in problems):
        raise DocumentError(problems)
    return scenario


def look_at_scenario(file: str, data: bytes) -> tuple[Scenario, list[Problem]]:
    """A scenario and its problems; what is wrong in it has no value.

    Raises:
        DocumentError: it is no XML document, or beyond a limit.
    """
    reader = Reader(SCENARIO, file, data)
    root = reader.root
    robot, person = _only(reader, "robot"), _only(reader, "person")
    connection = _only(reader, "connection")
    applications = [
        (node.get("src"), reader.get(node, "start") or 0, node) for node in root.all("application")
    ]
    if not applications and root.get("entrances") != "open":
        message = "The scenario runs no <application>."
        remedy = 'Name one, or write entrances="open" to take up what the world offers.'
        reader.problem(root, "missing-element", message, "", remedy)
    if person is not None:
        check_where(reader, person, "at", "a place to be at", needed=False)
    _check_ids(reader)
    until, patience = reader.get(root, "until"), reader.get(root, "patience")
    scenario = Scenario(
        id=root.get("id"),
        title=root.get("title"),
        world=root.get("world"),
        robot=root.get("robot"),
        until=UNTIL_MS if until is None else until,
        date=reader.get(root, "date") or START,
        policy=root.get("policy", "prima"),
        patience=PATIENCE_MS if patience is None else patience,
        entrances=root.get("entrances") == "open",
        robot_at=robot.get("at") if robot is not None else "",
        robot_heading=reader.given(robot, "heading"),
        person_at=person.get("at") if person is not None else "",
        person_point=_point(reader, person),
        person_speed=reader.given(person, "speed") or 1.0,
        applications=applications,
        whens=[read_when(reader, node) for node in root.all("when")]
        + [read_answer(reader, node) for node in root.all("answer")],
        services=read_services(reader),
        connection=read_connection(connection) if connection is not None else {},
        transfers=[read_transfer(reader, node) for node in root.all("transfer")],
        expectations=read_expectations(reader, root),
        node=root,
    )
    return scenario, reader.problems


def _check_ids(reader: Reader) -> None:
    """Note names of happenings and answers that are there twice."""
    seen: set[str] = set()
    for node in reader.root.all("when", "answer"):
        name = node.get("id")
        if name and name in seen:
            message = f'The id "{name}" is there twice.'
            reader.problem(node, "duplicate-id", message, "id", RENAME)
        seen.add(name)


def _only(reader: Reader, tag: str) -> Node | None:
    """The element of a tag that there may be once; a second one is a problem."""
    found = reader.root.all(tag)
    for extra in found[1:]:
        reader.problem(extra, "duplicate-element", f"There is a second <{tag}>.", "", "Keep one.")
    return found[0] if found else None


def _point(reader: Reader, person: Node | None) -> Point | None:
    """Where the user begins, if that is given by coordinates (m)."""
    if person is None or "x" not in person.attributes:
        return None
    return reader.get(person, "x") or 0.0, reader.get(person, "y") or 0.0
