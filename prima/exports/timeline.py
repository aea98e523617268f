"""A run on a time axis: tiers of intervals and points, which each format writes in its way.

Times are whole milliseconds of the run.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count

from prima.errors import UsageError, did_you_mean, one_of
from prima.errors.visible import visible
from prima.messages import Json

TAG = re.compile(r"[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*")
"""A language tag (BCP 47), as far as its form goes."""
MOST_MARKS = 1_000_000
"""Intervals and points of one export."""
MOST_LETTERS = 200_000_000
"""Letters of all their texts and details together."""
MOST_TIERS = 1000
"""Tiers, those that hold what overlaps included."""
LONGEST_TEXT = 5000
"""Letters of one text."""
LONGEST_NAME = 100
"""Letters of a tier's name, and of whose it is."""
MOST_PARTS = 8
"""Parts of a unit that its text names."""

BLANKS = re.compile(r"[\t-\r\x1c-\x20\x85\u2028\u2029]+")

COLUMNS = (
    "application",
    "behavior",
    "stream",
    "command",
    "rule",
    "outcome",
    "by",
    "event",
    "serial",
    "seconds",
    "losers",
    "source",
    "note",
)
"""The details that an interval or a point may have, besides its text."""


KINDS = {
    "does": "",
    "says": "",
    "units": "",
    "streams": "",
    "user-says": "user: says",
    "user-does": "user: does",
    "events": "events",
    "reactions": "reactions",
    "floor": "floor",
    "holder": "floor holder",
    "why": "why",
    "device": "",
}
"""Kinds of tiers in their order, with the names of those that are there only once."""
POINTS = frozenset({"user-does", "events", "why"})
"""Kinds that consist of points."""


@dataclass(slots=True)
class Interval:
    """Something from ``start`` to ``end`` (ms); a point where these are the same."""

    start: int
    end: int
    text: str
    about: dict[str, str] = field(default_factory=dict)
    """Details by the names of :data:`COLUMNS`; those that are empty are left out."""


@dataclass(slots=True)
class Tier:
    """Intervals of one kind, by their start; ``points`` tells that all are points.

    ``kind`` is one of :data:`KINDS`; ``who`` whose it is: an application's name,
    ``user``, ``robot`` or ``environment``.
    """

    name: str
    kind: str
    who: str
    points: bool = False
    marks: list[Interval] = field(default_factory=list)

    def lanes(self, least: int = 1) -> list[list[Interval]]:
        """The marks divided so that in no part two overlap, as few parts as are needed.

        ``least`` is how long (ms) each counts at the least.
        """
        lanes: list[list[Interval]] = []
        busy: list[tuple[int, int]] = []
        free: list[int] = []
        for mark in self.marks:
            while busy and busy[0][0] <= mark.start:
                heappush(free, heappop(busy)[1])
            if free:
                lane = heappop(free)
            else:
                lane = len(lanes)
                lanes.append([])
            lanes[lane].append(mark)
            heappush(busy, (max(mark.end, mark.start + least), lane))
        return lanes


@dataclass(slots=True)
class Part:
    """A tier, or what of it no other part overlaps, with a name that no other has."""

    name: str
    tier: Tier
    marks: list[Interval]


@dataclass(slots=True)
class Timeline:
    """All tiers of a run, those of the applications first; ``end`` in ms."""

    tiers: list[Tier]
    end: int
    head: dict[str, Json]
    """What the run's first record tells; empty if the transcript does not begin with it."""
    name: str = ""
    """The transcript's, for messages."""
    over: bool = False
    """Whether the transcript tells how the run ended."""
    _parts: list[Part] | None = None
    languages: dict[str, str] = field(default_factory=dict)
    """The language of each application of which the transcript tells it."""

    @property
    def marks(self) -> int:
        """How many intervals and points there are."""
        return sum(len(tier.marks) for tier in self.tiers)

    def check_names(self, names: Iterable[str]) -> None:
        """Make sure that applications are of this run; the empty name is no application's.

        Raises:
            UsageError: there is no such application.
        """
        known = {tier.who for tier in self.tiers if tier.kind in ("does", "says", "streams")}
        for name in names:
            if name and name not in known:
                hint = did_you_mean(name, known) or f"There is {one_of(known) or 'none'}."
                raise UsageError(f'{self.name}: nothing is done by an application "{name}". {hint}')

    def parts(self) -> list[Part]:
        """Tiers in which nothing overlaps; what does goes to a second one, ``NAME-2`` and so on.

        Raises:
            UsageError: there would be too many.
        """
        if self._parts is None:
            names: set[str] = set()
            self._parts = []
            for tier in self.tiers:
                for number, marks in enumerate(tier.lanes(), 1):
                    if len(names) == MOST_TIERS:
                        message = f"it makes more than {MOST_TIERS} tiers, since too much overlaps."
                        raise UsageError(f"{self.name}: {message} Try --to csv.")
                    name = unused(tier.name if number == 1 else f"{tier.name}-{number}", names)
                    self._parts.append(Part(name, tier, marks))
        return self._parts


def unused(name: str, names: set[str]) -> str:
    """A name that is not among ``names`` yet, and is then."""
    found = name
    for number in count(2):
        if found not in names:
            break
        found = f"{name}-{number}"
    names.add(found)
    return found


def clean(text: object, longest: int = LONGEST_TEXT) -> str:
    """One line of text that every format can hold, not too long."""
    line = str(text)
    if len(line) > longest:
        line = line[:longest] + "..."
    return visible(BLANKS.sub(" ", line)).strip()
