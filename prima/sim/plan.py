"""Warnings about a world's map: ways through walls, places to which nothing leads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import dist

from prima.errors import Problem
from prima.errors.diagnoses.structure import DUPLICATE_ELEMENT
from prima.markup.tree import Node

Point = tuple[float, float]
"""Metres east and north."""
Segment = tuple[Point, Point]
MOST = 300_000
"""The maximum number of pairs of lines to compare; larger maps are not checked."""

SAME_POINT = DUPLICATE_ELEMENT.says(
    'The place "{name}" is exactly where "{other}" is.',
    "Give it x and y of its own, or remove it.",
    "warning",
)
SAME_WAY = DUPLICATE_ELEMENT.says(
    'The way between "{begin}" and "{end}" is there already, in line {line}.',
    "Remove it: a way is used in both directions.",
    "warning",
)


def crosses(one: Segment, two: Segment) -> bool:
    """Whether two segments have a point in common."""
    (a, b), (c, d) = one, two
    sides = _side(a, b, c), _side(a, b, d), _side(c, d, a), _side(c, d, b)
    if sides[0] * sides[1] < 0 and sides[2] * sides[3] < 0:
        return True
    ends = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    return any(side == 0 and _between(*end) for side, end in zip(sides, ends, strict=True))


def _side(a: Point, b: Point, p: Point) -> float:
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def _between(a: Point, b: Point, p: Point) -> bool:
    return min(a[0], b[0]) <= p[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= p[1] <= max(a[1], b[1])


def off_line(point: Point, start: Point, end: Point) -> float:
    """Metres from a point to the nearest point of a straight line between two others."""
    length = dist(start, end)
    if length == 0.0:
        return dist(point, start)
    (x, y), (x1, y1), (x2, y2) = point, start, end
    share = ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / length**2
    share = min(max(share, 0.0), 1.0)
    return dist(point, (x1 + share * (x2 - x1), y1 + share * (y2 - y1)))


def apart(one: Segment, two: Segment) -> float:
    """Metres between two segments that do not cross."""
    return min(*(off_line(end, *two) for end in one), *(off_line(end, *one) for end in two))


class FloorPlan:
    """A map's places (m) by name, with its ways and walls; each with its element."""

    def __init__(
        self,
        places: Mapping[str, Point],
        nodes: Mapping[str, Node],
        ways: Sequence[tuple[str, str, Node]],
        walls: Sequence[tuple[Segment, Node]],
    ) -> None:
        self._places = places
        self._nodes = nodes
        self._ways = [way for way in ways if way[0] in places and way[1] in places]
        self._walls = walls

    def problems(self, whole: bool = True) -> Iterator[Problem]:
        """Warnings about the map; ``whole`` says whether all its ways are known."""
        yield from self._twice()
        if len(self._ways) * len(self._walls) <= MOST:
            yield from self._blocked()
        if whole and self._ways and len(self._places) ** 2 * max(len(self._walls), 1) <= MOST:
            yield from self._unreachable()

    def _twice(self) -> Iterator[Problem]:
        """Places that are where another one is, turned alike, and ways that are there already."""
        at: dict[tuple[Point, float], str] = {}
        for name, node in self._nodes.items():
            where = self._places[name], float(node.get("heading", "0"))
            if where in at:
                yield SAME_POINT.at(node.attribute_place("x"), name=name, other=at[where])
            at.setdefault(where, name)
        lines: dict[frozenset[str], int] = {}
        for begin, end, node in self._ways:
            ends, line = frozenset((begin, end)), node.place.line
            if ends in lines and begin != end:
                yield SAME_WAY.at(node.place, begin=begin, end=end, line=lines[ends])
            lines.setdefault(ends, line)

    def _blocked(self) -> Iterator[Problem]:
        for begin, end, node in self._ways:
            line = self._places[begin], self._places[end]
            wall = next((wall for segment, wall in self._walls if crosses(line, segment)), None)
            if wall is not None and begin != end:
                message = (
                    f'The way from "{begin}" to "{end}" goes through the wall'
                    f" in line {wall.place.line}."
                )
                remedy = "Lead it round the wall, by a <place> beside it."
                yield Problem(node.place, "warning", "blocked-way", message, remedy)

    def narrow(self, room: float, radius: float) -> Iterator[Problem]:
        """Warnings about ways and places that are too close (m) to a wall for a robot.

        Along a way it needs some room beside it, and at a place that of its body.
        """
        if (len(self._ways) + len(self._places)) * len(self._walls) > MOST:
            return
        told: set[str] = set()
        for begin, end, node in self._ways:
            line = self._places[begin], self._places[end]
            if any(crosses(line, segment) for segment, _ in self._walls):
                told |= {begin, end}  # already reported
                continue
            near = [(apart(line, segment), wall) for segment, wall in self._walls]
            metres, wall = min(near, key=lambda one: one[0], default=(room, node))
            if metres < room:
                told |= {begin, end}
                message = (
                    f'The way from "{begin}" to "{end}" is too narrow for the robot:'
                    f" the wall in line {wall.place.line} is {metres:.2f} m beside it."
                )
                remedy = f"Lead it {room:.2f} m or more away from walls."
                yield Problem(node.place, "warning", "blocked-way", message, remedy)
        for name in [one for one in self._nodes if one not in told]:
            yield from self._tight(name, radius)

    def _tight(self, name: str, radius: float) -> Iterator[Problem]:
        """A warning if a wall is closer (m) to a place than the robot's body allows."""
        near = [(off_line(self._places[name], *segment), wall) for segment, wall in self._walls]
        node = self._nodes[name]
        metres, wall = min(near, key=lambda one: one[0], default=(radius, node))
        if metres < radius:
            message = (
                f'The place "{name}" is too close to the wall in line {wall.place.line}:'
                f" {metres:.2f} m. The robot may not reach it."
            )
            remedy = f"Put it {radius:.2f} m or more away from walls."
            yield Problem(node.attribute_place("x"), "warning", "blocked-way", message, remedy)

    def _unreachable(self) -> Iterator[Problem]:
        """Places to which no way leads and that some place does not see.

        The robot can begin a route at any place that it sees.
        """
        groups = self._groups()
        for group in groups[1:]:
            blind = next((one for one in groups[0] if not self._sees(one, group)), None)
            if blind is not None:
                name = group[0]
                message = f'Nothing leads to the place "{name}" from "{blind}".'
                remedy = f'Write <way from="..." to="{name}"/>.'
                place = self._nodes[name].attribute_place("id")
                yield Problem(place, "warning", "unreachable", message, remedy)

    def _groups(self) -> list[list[str]]:
        """Places connected by ways, in the order of the document."""
        leads: dict[str, set[str]] = {name: set() for name in self._places}
        for begin, end, _ in self._ways:
            leads[begin].add(end)
            leads[end].add(begin)
        groups: list[list[str]] = []
        seen: set[str] = set()
        for name in self._places:
            group: list[str] = []
            waiting = [name]
            while waiting:
                one = waiting.pop()
                if one not in seen:
                    seen.add(one)
                    group.append(one)
                    waiting += sorted(leads[one])
            groups += [group] if group else []
        return groups

    def _sees(self, name: str, group: Sequence[str]) -> bool:
        """Whether no wall is between a place and one of some others."""
        lines = ((self._places[name], self._places[other]) for other in group)
        return any(not any(crosses(line, wall) for wall, _ in self._walls) for line in lines)
