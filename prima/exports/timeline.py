"""A run on a time axis: tiers of intervals and points, which all formats write.

Times are whole milliseconds of the run.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count

from prima.errors import UsageError, did_you_mean, one_of
from prima.errors.visible import visible
from prima.messages import Json

TAG = re.compile(r"[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8})*")
"""The form of a language tag (BCP 47)."""
MOST_MARKS = 1_000_000
"""Maximum number of intervals and points of one export."""
MOST_LETTERS = 200_000_000
"""Maximum length of all their texts and details together."""
MOST_TIERS = 1000
"""Maximum number of tiers, including those for overlaps."""
LONGEST_TEXT = 5000
"""Maximum length of one text."""
LONGEST_NAME = 100
"""Maximum length of a tier's name, and of its owner's."""
MOST_PARTS = 8
"""Maximum number of a unit's parts that its text names."""

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
"""The details of an interval or a point besides its text."""


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
"""Kinds of tiers in order, with the names of those that occur once."""
POINTS = frozenset({"user-does", "events", "why"})
"""Kinds of tiers with points."""


@dataclass(slots=True)
class Interval:
    """Something from ``start`` to ``end`` (ms); a point if they are equal."""

    start: int
    end: int
    text: str
    about: dict[str, str] = field(default_factory=dict)
    """Details by the names of :data:`COLUMNS`, without empty ones."""


@dataclass(slots=True)
class Tier:
    """Intervals of one kind, by their start; with ``points``, all are points.

    ``kind`` is one of :data:`KINDS`; ``who`` is the owner: an application's name,
    ``user``, ``robot`` or ``environment``.
    """

    name: str
    kind: str
    who: str
    points: bool = False
    marks: list[Interval] = field(default_factory=list)

    def lanes(self) -> list[list[Interval]]:
        """The marks in as few lanes as possible, without overlaps; each takes 1 ms at least."""
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
            heappush(busy, (max(mark.end, mark.start + 1), lane))
        return lanes


@dataclass(slots=True)
class TierPart:
    """A tier, or a part of it without overlaps, with a unique name."""

    name: str
    tier: Tier
    marks: list[Interval]


@dataclass(slots=True)
class Timeline:
    """All tiers of a run, those of the applications first; ``end`` in ms."""

    tiers: list[Tier]
    end: int
    head: dict[str, Json]
    """The data of the run record; empty if the transcript does not begin with it."""
    name: str = ""
    """The transcript's name, for messages."""
    over: bool = False
    """Whether the transcript has the end of the run."""
    _parts: list[TierPart] | None = None
    languages: dict[str, str] = field(default_factory=dict)
    """The languages of applications, as far as the transcript has them."""

    @property
    def marks(self) -> int:
        """The number of intervals and points."""
        return sum(len(tier.marks) for tier in self.tiers)

    def check_names(self, names: Iterable[str]) -> None:
        """Check that applications are part of this run; the empty name is allowed.

        Raises:
            UsageError: an application is unknown.
        """
        known = {tier.who for tier in self.tiers if tier.kind in ("does", "says", "streams")}
        for name in names:
            if name and name not in known:
                hint = did_you_mean(name, known) or f"There is {one_of(known) or 'none'}."
                raise UsageError(f'{self.name}: unknown application "{name}". {hint}')

    def parts(self) -> list[TierPart]:
        """The tiers without overlaps; overlapping marks go to ``NAME-2`` and so on.

        Raises:
            UsageError: there are too many.
        """
        if self._parts is None:
            self._parts = list(self._divided())
        return self._parts

    def _divided(self) -> Iterator[TierPart]:
        names: set[str] = set()
        lanes = ((tier, n, lane) for tier in self.tiers for n, lane in enumerate(tier.lanes(), 1))
        for tier, number, marks in lanes:
            if len(names) == MOST_TIERS:
                message = f"more than {MOST_TIERS} tiers, because too many intervals overlap."
                raise UsageError(f"{self.name}: {message} Try --to csv.")
            name = unused(tier.name if number == 1 else f"{tier.name}-{number}", names)
            yield TierPart(name, tier, marks)


def unused(name: str, names: set[str]) -> str:
    """A name that is not in ``names``; adds it."""
    found = name
    for number in count(2):
        if found not in names:
            break
        found = f"{name}-{number}"
    names.add(found)
    return found


def clean(text: object, longest: int = LONGEST_TEXT) -> str:
    """One line of text of limited length that every format can hold."""
    line = str(text)
    if len(line) > longest:
        line = line[:longest] + "..."
    return visible(BLANKS.sub(" ", line)).strip()
