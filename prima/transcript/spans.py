"""The parts of a run: behaviors and their spells, streams, states, holds, floor. In seconds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from prima.transcript.measures import Measure
from prima.transcript.record import Entry

OPEN = 1 << 62
"""Marks a span that has not ended by the end of the transcript."""


def base(name: str) -> str:
    """An AB's name without the number of its loop."""
    return name.partition(".")[0]


@dataclass(slots=True)
class TimeSpan:
    """Something with a duration; an open one ends with the transcript."""

    begin: float
    end: float = -1.0
    closed: int = OPEN
    """The number of the record with which it ended, which orders spans by end."""

    def close(self, now: float, number: int) -> None:
        """End it."""
        self.end, self.closed = now, number

    @property
    def lasts(self) -> bool:
        """Whether it takes time, or has not ended."""
        return self.closed == OPEN or self.end > self.begin


@dataclass(slots=True)
class BehaviorSpan:
    """An Atomic Behavior: its request and state."""

    name: str
    asked: Entry
    """Its request; without one, its first start."""
    requested: bool
    state: str = "waiting"
    began: float | None = None
    last: float = 0.0
    """The time of its last record."""
    spell: Spell | None = None
    """The spell that has not ended, or waits for its next loop."""
    broken: Saying | None = None
    """Its saying that was interrupted."""
    late: bool = False
    """Whether it is a unit that has taken too long (U5)."""


@dataclass(slots=True, kw_only=True)
class Spell(TimeSpan):
    """An AB from a start to an end; loops without a gap between them are one spell."""

    behavior: BehaviorSpan
    start: Entry
    """The record of its first start."""
    cuts: list[float] = field(default_factory=list)
    """The times at which one loop ends and the next begins."""
    outcome: str = ""
    by: str = ""
    parts: list[Spell] = field(default_factory=list)
    """The spells in a unit."""
    paused: bool = False
    """Whether its last loop has ended, and the next has not begun."""
    uses: dict[str, DeviceUse] = field(default_factory=dict)
    saying: Saying | None = None

    @property
    def unit(self) -> bool:
        """Whether it is of an Information Unit."""
        return self.start.command == "iu"


@dataclass(slots=True, kw_only=True)
class DeviceUse(TimeSpan):
    """A device that a spell has."""

    device: str
    spell: Spell
    outcome: str = ""
    by: str = ""


@dataclass(slots=True, kw_only=True)
class Saying(TimeSpan):
    """A spell's speech, until it listens or is over; ``heard`` if it was broken off."""

    spell: Spell
    outcome: str = ""
    heard: str = ""


@dataclass(slots=True, kw_only=True)
class Hold(TimeSpan):
    """A waiting AB is held back by a rule."""

    name: str
    app: str
    by: str
    rule: str


@dataclass(slots=True, kw_only=True)
class FloorSpan(TimeSpan):
    """The stack of streams on the floor, the holder last; empty where nobody has it."""

    stack: list[str]
    rule: str


@dataclass(slots=True, kw_only=True)
class StreamState(TimeSpan):
    """A stream is ``active`` or ``suspended``."""

    tree: str
    app: str
    state: str
    rule: str = ""
    by: str = ""


@dataclass(slots=True)
class StreamPiece:
    """A piece of a stream: it ``runs``, is ``away`` (suspended, then resumed) or ``broken``.

    It is broken where another application has entered other than by a reaction; ``by`` names it.
    """

    begin: float
    end: float
    kind: str
    by: str = ""
    rule: str = ""


@dataclass(slots=True)
class StreamSpan:
    """A Communication Stream, from its first request to its end, with its pieces."""

    name: str
    asked: Entry
    """Its first request."""
    app: str
    begin: float
    end: float = -1.0
    ended: bool = False
    pieces: list[StreamPiece] = field(default_factory=list)
    windows: list[float] = field(default_factory=list)
    """When windows open or close."""
    running: set[str] = field(default_factory=set)
    since: float = 0.0
    """When the first of what runs began."""
    paused: float | None = None
    """When the last of what ran ended."""

    away: StreamPiece | None = None
    """Since when it is suspended, if it is."""

    def put(self, piece: StreamPiece) -> None:
        """Add a piece; pieces that run on without a gap are one."""
        last = self.pieces[-1] if self.pieces else None
        if last and piece.kind == last.kind == "runs" and last.end == piece.begin:
            last.end = piece.end
        elif piece.end > piece.begin or piece.kind == "broken":
            self.pieces.append(piece)


@dataclass(frozen=True, slots=True)
class Reaction:
    """An application's first start in reaction to an event."""

    event: Entry
    start: Entry
    begin: float
    end: float


@dataclass(frozen=True, slots=True)
class Run:
    """Everything that a transcript says about its run."""

    entries: list[Entry]
    end: float
    apps: list[str]
    """The applications as they were loaded."""
    behaviors: dict[str, BehaviorSpan]
    spells: list[Spell]
    uses: list[DeviceUse]
    sayings: list[Saying]
    streams: dict[str, StreamSpan]
    states: list[StreamState]
    floors: list[FloorSpan]
    holds: list[Hold]
    reactions: list[Reaction]
    events: dict[int, Entry]
    """Events by their serial numbers."""
    about: dict[str, list[tuple[int, Entry]]]
    """Records that say when an AB came, by its name, with the number of each."""
    phases: dict[str, list[Entry]]
    measure: Measure

    @property
    def head(self) -> dict[str, Any]:
        """The first record's data on the run; empty if it is not the run record."""
        first = self.entries[0] if self.entries else None
        return first.data if first is not None and first.phase == "run" else {}

    @property
    def languages(self) -> dict[str, str]:
        """The languages of applications, as far as the transcript says."""
        languages = {one.app: one.data.get("lang") for one in self.started}
        return {app: lang for app, lang in languages.items() if isinstance(lang, str)}

    @property
    def started(self) -> list[Entry]:
        """The records of applications that the mediator has started."""
        return [one for one in self.of("load") if one.actor == "mediator"]

    def of(self, phase: str) -> list[Entry]:
        """The records of a phase."""
        return self.phases.get(phase, [])

    def asked(self, name: str) -> Entry | None:
        """The request of an AB, by its name, if the transcript has it."""
        found = self.behaviors.get(base(name))
        return found.asked if found is not None and found.requested else None
