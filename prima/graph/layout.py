"""Where boxes go: layers by distance from the start, few crossings, lines nearly straight.

The method is that of Sugiyama, Tagawa and Toda (1981), with layers by breadth-first
search, orders by barycenters, and places by isotonic regression. It knows two
directions: *along*, from layer to layer, and *aside*, within a layer; whether along
means across the page or down it is the drawing's matter.
"""

from __future__ import annotations

from bisect import bisect, insort
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

SWEEPS = 12
"""Number of passes that improve orders and places."""
THREAD = 9.0
"""Room that a line takes in a layer it passes through."""


@dataclass(slots=True)
class LayoutEdge:
    """A line between two boxes, from that of the lower layer to that of the higher one.

    ``low_at`` and ``high_at`` are how far aside from a box's beginning the line meets it.
    """

    low: int
    high: int
    low_at: float = 0.0
    high_at: float = 0.0
    chain: list[int] = field(default_factory=list)
    """The indices of :attr:`Layout.aside` through which it passes, including its ends."""


@dataclass(slots=True)
class Layout:
    """The position of each box within its layer, followed by those that lines pass through."""

    aside: list[float]
    links: list[LayoutEdge]
    extent: float


def distances(count: int, starts: Sequence[int], follows: Sequence[Sequence[int]]) -> list[int]:
    """The distance of each box from the start; unreachable ones start again, one layer on.

    Args:
        count: the number of boxes.
        starts: those to begin with.
        follows: for each box, the boxes to which its arrows lead.
    """
    found = [-1] * count
    for number, begin in enumerate([*starts, *range(count)]):
        if found[begin] >= 0:
            continue
        found[begin] = 0 if number < len(starts) or not starts else 1
        queue = [begin]
        for one in queue:
            new = [to for to in dict.fromkeys(follows[one]) if found[to] < 0]
            for to in new:
                found[to] = found[one] + 1
            queue += new
    return found


def depths(count: int, edges: Sequence[tuple[int, int]]) -> list[int]:
    """The layers of an acyclic graph: each box comes after those that lead to it.

    ``edges`` lead from earlier boxes to later ones; others count for nothing.
    """
    found = [0] * count
    for low, high in sorted(edges, key=lambda edge: edge[1]):
        if low < high:
            found[high] = max(found[high], found[low] + 1)
    return found


def arrange(
    sizes: Sequence[float], layers: Sequence[int], links: Sequence[LayoutEdge], gap: float
) -> Layout:
    """Find a place for each box.

    Args:
        sizes: how much room aside each takes.
        layers: each one's layer.
        links: lines between boxes of different layers.
        gap: the least room between two boxes of a layer.
    """
    if not sizes:
        return Layout([], [], 0.0)
    work = _Work(list(sizes), list(layers), list(links), gap)
    work.order()
    work.place()
    extent = max(a + size for a, size in zip(work.aside, work.sizes, strict=True))
    return Layout(work.aside, work.links, extent)


@dataclass(slots=True)
class _Work:
    sizes: list[float]
    layers: list[int]
    links: list[LayoutEdge]
    gap: float
    boxes: int = 0
    rows: list[list[int]] = field(default_factory=list)
    """The boxes and passing lines of each layer, in their order."""
    before: list[list[tuple[int, float, float]]] = field(default_factory=list)
    """For each one those of the layer before, with where the line meets both."""
    after: list[list[tuple[int, float, float]]] = field(default_factory=list)
    aside: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.boxes = len(self.sizes)
        for link in self.links:
            middle = range(self.layers[link.low] + 1, self.layers[link.high])
            places = [self._thread(layer) for layer in middle]
            link.chain = [link.low, *places, link.high]
        self.rows = [[] for _ in range(max(self.layers) + 1)]
        for one, layer in enumerate(self.layers):
            self.rows[layer].append(one)
        self.before = [[] for _ in self.sizes]
        self.after = [[] for _ in self.sizes]
        for link in self.links:
            for one, two in zip(link.chain, link.chain[1:], strict=False):
                one_at = link.low_at if one == link.low else THREAD / 2
                two_at = link.high_at if two == link.high else THREAD / 2
                self.after[one].append((two, one_at, two_at))
                self.before[two].append((one, two_at, one_at))

    def _thread(self, layer: int) -> int:
        self.sizes.append(THREAD)
        self.layers.append(layer)
        return len(self.sizes) - 1

    # Order ----------------------------------------------------------------------------------

    def order(self) -> None:
        """Order each layer so that few lines cross."""
        best, fewest = [list(row) for row in self.rows], self._crossings()
        for sweep in range(SWEEPS):
            down = sweep % 2 == 0
            for row in self.rows if down else reversed(self.rows):
                self._sort(row, self.before if down else self.after)
            crossings = self._crossings()
            if crossings < fewest:
                best, fewest = [list(row) for row in self.rows], crossings
        self.rows = best

    def _ranks(self) -> list[float]:
        ranks = [0.0] * len(self.sizes)
        for row in self.rows:
            for number, one in enumerate(row):
                ranks[one] = float(number)
        return ranks

    def _sort(self, row: list[int], near: list[list[tuple[int, float, float]]]) -> None:
        ranks = self._ranks()
        wanted = {}
        for one in row:
            seen = [ranks[two] + at / (self.sizes[two] + 1) for two, _, at in near[one]]
            wanted[one] = sum(seen) / len(seen) if seen else ranks[one]
        row.sort(key=lambda one: (wanted[one], ranks[one]))

    def _crossings(self) -> int:
        ranks = self._ranks()
        found = 0
        for row in self.rows:
            lines = [
                (ranks[one] + own / (self.sizes[one] + 1), ranks[two] + at / (self.sizes[two] + 1))
                for one in row
                for two, own, at in self.after[one]
            ]
            seen: list[float] = []
            for _, to in sorted(lines):
                found += len(seen) - bisect(seen, to)
                insort(seen, to)
        return found

    # Place ----------------------------------------------------------------------------------

    def place(self) -> None:
        """Move boxes toward those they are linked with, as far as their order lets them."""
        self.aside = [0.0] * len(self.sizes)
        for row in self.rows:
            self._settle(row, lambda one: (0.0, 1.0))
        for sweep in range(SWEEPS):
            rows = self.rows if sweep % 2 == 0 else self.rows[::-1]
            both = sweep >= SWEEPS - 2
            near = self.before if sweep % 2 == 0 else self.after
            for row in rows:
                self._settle(row, partial(self._wish, near=near, both=both))
        least = min(self.aside)
        self.aside = [round(a - least, 1) for a in self.aside]

    def _wish(
        self, one: int, near: list[list[tuple[int, float, float]]], both: bool
    ) -> tuple[float, float]:
        """The best position of a box, and its weight."""
        every = self.before[one] + self.after[one]
        lines = every if both else near[one]
        if not lines:
            return self.aside[one], 0.1 if every else 0.0
        total = weights = 0.0
        for two, own, at in lines:
            threads = (one >= self.boxes) + (two >= self.boxes)
            weight = 4.0 if threads == 2 else 1.0
            # Boxes lie level with boxes, so that a chain is level too; lines go where they go.
            meets = at - own if threads else 0.0
            total += weight * (self.aside[two] + meets)
            weights += weight
        return total / weights, weights

    def _settle(self, row: list[int], wish: Callable[[int], tuple[float, float]]) -> None:
        """Give a layer's boxes their places: near the wishes, in order, without touching.

        Least squares under the order: pool neighbours that would overlap, and let
        each pool lie where its members together wish. What wishes nothing stays beside
        the one before it.
        """
        pools: list[tuple[float, float, int]] = []  # sum of wishes, of weights, members
        offset, offsets = 0.0, []
        for number, one in enumerate(row):
            if number:
                offset += self.sizes[row[number - 1]] + self._gap(row[number - 1], one)
            offsets.append(offset)
            want, weight = wish(one)
            pools.append(((want - offset) * weight, weight, 1))
            while len(pools) > 1 and _touch(pools[-2], pools[-1]):
                last, held = pools.pop(), pools.pop()
                pools.append((held[0] + last[0], held[1] + last[1], held[2] + last[2]))
        place = iter(zip(row, offsets, strict=True))
        for total, weight, members in pools:
            for _ in range(members):
                one, own = next(place)
                self.aside[one] = (total / weight if weight else 0.0) + own

    def _gap(self, one: int, two: int) -> float:
        lines = (one >= self.boxes) + (two >= self.boxes)
        return (self.gap, self.gap * 0.6, 2.0)[lines]


def _touch(one: tuple[float, float, int], two: tuple[float, float, int]) -> bool:
    """Whether two pools of boxes would overlap, or one of them does not care."""
    return not (one[1] and two[1]) or one[0] / one[1] > two[0] / two[1]
