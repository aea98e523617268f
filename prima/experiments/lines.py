"""Searches over runs: along one moved time, and for the smallest shift.

A search is a generator: it yields the points that it needs, and is sent the result of
each. A point has the time (ms) of each moved event, in order.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Generator, Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypeVar

from prima.experiments.examine import Seen

MOST_EFFECTS = 4
"""Maximum number of effects of one event that are moved to the instants of a run."""
MOST_ROUNDS = 100
"""Maximum number of batches of runs that one search requests."""

Point = tuple[int, ...]
Results = Mapping[Point, Seen]
Found = TypeVar("Found")
Search = Generator[list[Point], Results, Found]


class LinePiece(NamedTuple):
    """Times of one event, from first to last (ms), that lead to the same order."""

    first: int
    last: int
    order: str

    def nearest(self, time: int) -> int:
        """The time in it that is nearest to another."""
        return min(max(time, self.first), self.last)


@dataclass(frozen=True)
class EventLine:
    """All times of one event, with the others fixed."""

    origin: Point
    which: int
    low: int
    high: int
    step: int = 0
    """The step of a grid (ms) that is also tried; 0 for none."""
    exact: bool = True
    """Whether boundaries are located to 1 ms."""

    def at(self, time: int) -> Point:
        """The point with this time."""
        return moved(self.origin, self.which, time)

    def search(self) -> Search[list[LinePiece]]:
        """Try the times that may matter, and find the pieces.

        An order can change only where the event comes just before, at or just after an instant
        of the run; the instants of runs with other orders are also tried.
        """
        here = self.origin[self.which]
        beside = here + 1 if here < self.high else here - 1
        first = yield [self.at(here), self.at(beside)]
        shows = moments(first[self.at(here)], first[self.at(beside)], here, beside)
        known = {here: first[self.at(here)], beside: first[self.at(beside)]}
        orders: set[str] = set()
        wanted = {self.low, self.high}
        if self.step:
            wanted |= set(range(here, self.high, self.step)) | set(
                range(here, self.low, -self.step)
            )
        for _ in range(MOST_ROUNDS):
            for _, seen in sorted(known.items()):
                if seen.order not in orders:
                    orders.add(seen.order)
                    wanted |= self._candidates(seen, shows)
            wanted -= known.keys()
            if not wanted and self.exact:
                wanted = set(_gaps(known))
            if not wanted:
                break
            results = yield [self.at(time) for time in sorted(wanted)]
            known |= {point[self.which]: seen for point, seen in results.items()}
            wanted = set()
        return pieces({time: seen.order for time, seen in known.items()})

    def _candidates(self, seen: Seen, shows: Collection[int]) -> set[int]:
        """Times at which the event comes at an instant of a run, or just before."""
        found = set()
        for instant in set(seen.times):
            for show in shows:
                time = instant - show
                found |= {one for one in (time - 1, time) if self.low <= one <= self.high}
        return found


def moved(point: Point, which: int, time: int) -> Point:
    """A point with another time of one event."""
    return (*point[:which], time, *point[which + 1 :])


def moments(seen: Seen, later: Seen, time: int, other: int) -> list[int]:
    """When an event has effects, as times (ms) of its run minus the event's own time.

    They are found by moving it by 1 ms: up to the first record that moves, both runs are the
    same. Later events of the scenario that move equally are effects, too.
    """
    pairs = list(zip(seen.times, later.times, strict=False))
    first = next((at for at, (one, two) in enumerate(pairs) if one != two), None)
    if first is None:
        return []
    shift = other - time
    places = [first, *(at for at in seen.outside if at > first)]
    shows = [
        pairs[at][0] for at in places if at < len(pairs) and pairs[at][1] == pairs[at][0] + shift
    ]
    return [one - time for one in dict.fromkeys(shows)][:MOST_EFFECTS]


def _gaps(known: Mapping[int, Seen]) -> Iterable[int]:
    """The midpoints between neighbours with different orders."""
    times = sorted(known)
    for one, two in pairwise(times):
        if two - one > 1 and known[one].order != known[two].order:
            yield (one + two) // 2


def pieces(orders: Mapping[int, str]) -> list[LinePiece]:
    """Merge neighbours with the same order."""
    made: list[LinePiece] = []
    for time in sorted(orders):
        if made and made[-1].order == orders[time]:
            made[-1] = made[-1]._replace(last=time)
        else:
            made.append(LinePiece(time, time, orders[time]))
    return made


def shrunk(base: Point, point: Point, holds: Callable[[Seen], bool]) -> Search[Point]:
    """The smallest shift from a base for which something still holds.

    Each event in turn is put back if it need not be moved, or else moved by the minimum, to
    1 ms; this is repeated until nothing changes.
    """
    while True:
        before = point
        for which, time in enumerate(base):
            if point[which] == time:
                continue
            home = moved(point, which, time)
            results = yield [home]
            if holds(results[home]):
                point = home
                continue
            near, far = time, point[which]
            while abs(far - near) > 1:
                middle = (near + far) // 2
                there = moved(point, which, middle)
                results = yield [there]
                near, far = (near, middle) if holds(results[there]) else (middle, far)
            point = moved(point, which, far)
        if point == before:
            return point


def shift(base: Point, point: Point) -> tuple[int, int]:
    """The number of moved events, and the total shift (ms)."""
    shifts = [abs(one - two) for one, two in zip(base, point, strict=True)]
    return sum(1 for one in shifts if one), sum(shifts)
