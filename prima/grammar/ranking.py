"""The best parse in a chart, and its content in order.

Parses that leave fewer words to GARBAGE come first, then those with lower costs of weights and
repeat probabilities; among equal ones, the alternative written first and the longer repeat win.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from heapq import heappop, heappush
from typing import TYPE_CHECKING, NamedTuple

from prima.digraphs import rings
from prima.grammar.chart import Cell, ChartWay
from prima.grammar.model import BuiltIn, Reference, Rule, Tag, Words
from prima.grammar.text import MatchedUtterance

if TYPE_CHECKING:
    from prima.messages import Json

MOST_CELLS = 200_000
"""Maximum size of an analysis; a few short rules can make one of any size out of nothing."""

MOST_KNOWN = 100_000
"""Maximum number of analyses of all cells together; at least the best of each is kept."""


class RankedParse(NamedTuple):
    """One parse of a cell: its rank, and the analyses of its parts."""

    lost: int
    """The number of words that GARBAGE takes."""
    cost: float
    cell: Cell
    left: RankedParse | None
    right: RankedParse | None
    size: int
    """The number of cells on its way, repeated ones included."""


@dataclass(slots=True)
class RuleFrame:
    """A matched rule with its words, tags and references in order."""

    rule: Rule
    name: str
    events: list[Words | Tag | RuleFrame | Value] = field(default_factory=list)


class Value(NamedTuple):
    """The value that a built-in type read, and its text."""

    value: Json
    text: str


def best(top: Cell, most: int) -> list[RankedParse]:
    """The best analyses of a cell, at most so many."""
    groups = list(rings([top], _below))  # parts first; cells that contain each other are one group
    most = max(1, min(most, MOST_KNOWN // sum(map(len, groups))))
    known: dict[int, list[RankedParse]] = {}
    for group in groups:
        for cell in _settled(group, known):
            # In a group, what is made of cells settled later contains itself.
            ways = [way for way in cell.ways if all(one.number in known for one in _parts(way))]
            known[cell.number] = _best(cell, ways, known, most)
    return known.get(top.number, [])


Candidate = tuple[int, float, int, int, int, int, int, RankedParse]
"""Words lost, cost, rank of the way and where its last part begins; which analyses of its parts; which
way; the analysis."""


def _best(
    cell: Cell, ways: list[ChartWay], known: dict[int, list[RankedParse]], most: int
) -> list[RankedParse]:
    """The best analyses of a cell from those of its parts, each built only when it is next.

    The successor of a candidate, with the next analysis of one part, is never better.
    """
    parts = [(_known(known, way.left), _known(known, way.right)) for way in ways]
    waiting: list[Candidate] = []
    seen: set[tuple[int, int, int]] = set()

    def add(number: int, i: int, j: int) -> None:
        lefts, rights = parts[number]
        if i >= len(lefts) or j >= len(rights) or (number, i, j) in seen:
            return
        seen.add((number, i, j))
        way = ways[number]
        made = _joined(cell, way, lefts[i], rights[j])
        begin = way.left.end if way.left else 0
        heappush(waiting, (made.lost, round(made.cost, 9), way.rank, -begin, i, j, number, made))

    for number in range(len(ways)):
        add(number, 0, 0)
    found: list[RankedParse] = []
    while waiting and len(found) < most:
        *_, i, j, number, made = heappop(waiting)
        if made.size <= MOST_CELLS:
            found.append(made)
        if most > 1:
            add(number, i + 1, j)
            add(number, i, j + 1)
    return found


def _joined(
    cell: Cell, way: ChartWay, left: RankedParse | None, right: RankedParse | None
) -> RankedParse:
    """An analysis of a cell by a way and the analyses of its parts."""
    lost, cost, size = way.lost, way.cost, 1
    for part in (left, right):
        if part is not None:
            lost, cost, size = lost + part.lost, cost + part.cost, size + part.size
    return RankedParse(lost, cost, cell, left, right, size)


def _known(known: dict[int, list[RankedParse]], cell: Cell | None) -> Sequence[RankedParse | None]:
    return (None,) if cell is None else known[cell.number]


def _parts(way: ChartWay) -> Iterator[Cell]:
    if way.left is not None:
        yield way.left
    if way.right is not None:
        yield way.right


def _below(cell: Cell) -> Iterator[Cell]:
    return (part for way in cell.ways for part in _parts(way))


def _settled(group: list[Cell], known: dict[int, list[RankedParse]]) -> list[Cell]:
    """The cells of a group in an order in which the best analysis of each is made of earlier ones.

    No analysis is better than its parts, so that Knuth's generalisation of Dijkstra's algorithm
    finds the best ones, the very best first.
    """
    if len(group) == 1:
        return group
    order: list[Cell] = []
    prices: dict[int, tuple[int, float]] = {}
    waiting: list[tuple[int, float, int]] = []
    users: dict[int, list[tuple[int, ChartWay]]] = {cell.number: [] for cell in group}
    every = [(place, way) for place, cell in enumerate(group) for way in cell.ways]

    def offer(place: int, way: ChartWay) -> None:
        """Add a cell with the price of a way, if all parts of that have one."""
        lost, cost = way.lost, way.cost
        for part in _parts(way):
            before = known.get(part.number)
            paid = (before[0].lost, before[0].cost) if before else prices.get(part.number)
            if paid is None:
                return
            lost, cost = lost + paid[0], cost + paid[1]
        heappush(waiting, (lost, round(cost, 9), -place))  # what is inside comes first

    for place, way in every:
        offer(place, way)
        for part in _parts(way):
            if part.number in users:
                users[part.number].append((place, way))
    while waiting:
        lost, cost, place = heappop(waiting)
        cell = group[-place]
        if cell.number not in prices:
            prices[cell.number] = lost, cost
            order.append(cell)
            for user in users[cell.number]:
                offer(*user)
    return order


def frames(analysis: RankedParse, said: MatchedUtterance) -> RuleFrame:
    """The content of an analysis, rule by rule."""
    top: RuleFrame | None = None
    open_frames: list[RuleFrame] = []
    todo: list[RankedParse | None] = [analysis]  # None ends a frame
    while todo:
        one = todo.pop()
        if one is None:
            open_frames.pop()
            continue
        part = one.cell.part
        if isinstance(part, Reference) and part.rule is not None:
            frame = RuleFrame(part.rule, part.rule.name)
            top = top or frame
            if open_frames:
                open_frames[-1].events.append(frame)
            open_frames.append(frame)
            todo.append(None)
        elif isinstance(part, Words | Tag):
            open_frames[-1].events.append(part)
        elif isinstance(part, BuiltIn):
            text = said.said[one.cell.start : one.cell.end].strip()
            open_frames[-1].events.append(Value(one.cell.value, text))
        todo.extend(child for child in (one.right, one.left) if child is not None)
    assert top is not None
    return top
