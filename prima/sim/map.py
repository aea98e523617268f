"""Worlds as values, read from their documents."""

from __future__ import annotations

from dataclasses import dataclass, field

from prima.devices.reading import Reader
from prima.errors import Problem
from prima.markup.tree import Node
from prima.sim.plan import FloorPlan, Point
from prima.sim.vocabulary.world import WORLD

MAX_AREAS = 256
"""Maximum number of areas of a world."""
EPSILON = 1e-6
"""A distance (m) too small to matter."""


@dataclass(slots=True)
class Corner:
    """A point that raises an event when the robot comes near (radius in m)."""

    id: str
    at: Point
    radius: float
    event: str


@dataclass(slots=True)
class Area:
    """An area that offers an application: its corners (m), and the application's document."""

    id: str
    title: str
    low: Point
    high: Point
    src: str
    node: Node

    def beyond(self, point: Point, margin: float = 0.0) -> float:
        """How far (m) a point lies beyond a margin around it; less than 0 within.

        Nobody gets in or out without going at least so far.
        """
        (x, y), (west, south), (east, north) = point, self.low, self.high
        return max(west - margin - x, x - (east + margin), south - margin - y, y - (north + margin))


@dataclass(slots=True)
class Map:
    """A world: places with headings (degrees), ways, walls, things, corners, areas."""

    id: str
    places: dict[str, Point] = field(default_factory=dict)
    headings: dict[str, float] = field(default_factory=dict)
    ways: list[tuple[str, str]] = field(default_factory=list)
    walls: list[tuple[Point, Point]] = field(default_factory=list)
    things: dict[str, Point] = field(default_factory=dict)
    corners: list[Corner] = field(default_factory=list)
    areas: list[Area] = field(default_factory=list)
    warnings: list[Problem] = field(default_factory=list)
    """The warnings about its document."""
    plan: FloorPlan | None = None
    """Its ways and walls with their elements, if the world was read from a document."""

    def point(self, name: str) -> Point | None:
        """Where a place or thing is (m)."""
        return self.places.get(name) or self.things.get(name)


def read_world(file: str, data: bytes) -> Map:
    """Read a world.

    Raises:
        DocumentError: with all its problems.
    """
    reader = Reader(WORLD, file, data)
    world = Map(reader.root.get("id"))
    seen: set[str] = set()
    _read_points(reader, world, seen)
    _read_ways(reader, world)
    for node in reader.root.all("wall"):
        x1, y1, x2, y2 = _ends(reader, node)
        world.walls.append(((x1, y1), (x2, y2)))
        if (x1, y1) == (x2, y2) and {"x2", "y2"} <= node.attributes.keys():
            message = "The wall has no length: it begins where it ends."
            reader.problem(node, "bad-value", message, "x2", "Write its other end.", "warning")
    _read_areas(reader, world, seen)
    world.plan = _plan(reader.root, world)
    errors = {problem.code for problem in reader.problems if problem.severity == "error"}
    if errors <= {"no-such-name"}:  # others may depend on where things are
        reader.problems += world.plan.problems(whole=not errors)
    reader.finish()
    world.warnings = reader.problems
    return world


def _read_points(reader: Reader, world: Map, seen: set[str]) -> None:
    """Places, things and corners."""
    for node in reader.root.all("place", "thing", "corner"):
        name = reader.once(node, seen)
        at = (reader.get(node, "x") or 0.0, reader.get(node, "y") or 0.0)
        if node.tag == "place":
            world.places[name] = at
            world.headings[name] = reader.get(node, "heading") or 0.0
        elif node.tag == "thing":
            world.things[name] = at
        else:
            world.corners.append(
                Corner(name, at, reader.get(node, "radius") or 0.8, node.get("event", "corner"))
            )


def _read_ways(reader: Reader, world: Map) -> None:
    for node in reader.root.all("way"):
        for end in ("from", "to"):
            reader.known(node, end, world.places, "place")
        if node.get("from") == node.get("to") != "":
            message = f'The way goes from "{node.get("from")}" to itself.'
            reader.problem(node, "bad-value", message, "to", "Name another place.")
        world.ways.append((node.get("from"), node.get("to")))


def _ends(reader: Reader, node: Node) -> tuple[float, float, float, float]:
    x1, y1, x2, y2 = (reader.get(node, name) or 0.0 for name in ("x1", "y1", "x2", "y2"))
    return x1, y1, x2, y2


def _read_areas(reader: Reader, world: Map, seen: set[str]) -> None:
    areas = reader.root.all("area")
    for node in areas[MAX_AREAS:][:1]:
        message = f"There are more than {MAX_AREAS} areas."
        reader.problem(node, "too-large", message, "", "Divide the world.")
    for node in areas[:MAX_AREAS]:
        name = reader.once(node, seen)
        x1, y1, x2, y2 = _ends(reader, node)
        low, high = (min(x1, x2), min(y1, y2)), (max(x1, x2), max(y1, y2))
        title, offered = node.get("title", name), node.get("application")
        world.areas.append(Area(name, title, low, high, offered, node))


def _plan(root: Node, world: Map) -> FloorPlan:
    """A world's map with its elements."""
    places = {node.get("id"): node for node in root.all("place")}
    ways = [(node.get("from"), node.get("to"), node) for node in root.all("way")]
    return FloorPlan(
        world.places, places, ways, list(zip(world.walls, root.all("wall"), strict=True))
    )
