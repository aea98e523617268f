"""Commands: what applications request from the robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

Json = Any
Data = Mapping[str, Json]
Record = dict[str, Json]
"""A line of the transcript under construction: field names to values."""
Fate = Literal["ended", "done", "cancelled", "expired", "failed", "interrupted", "unit-timeout"]
"""Notices to an application about its Commands; ``expired``: part of a run was too late (X8)."""
Verb = Literal["start", "abort", "interrupt", "stop", "send"]
"""The orders to devices."""
PROMOTED = -1
"""As a request's cause: the latest promoted event."""
NO_DEVICES: frozenset[str] = frozenset()


def line_of(source: str) -> str | None:
    """The ``FILE:LINE`` of a place with its column, for a record; None if there is no place."""
    line = source.rpartition(":")[0]
    return line if line.rpartition(":")[2].isdigit() else source or None


BEEP: Final = "[beep]"
"""The signal before a recording, as written in a text."""
STOPS: Final = ".!?。！？"
"""Characters that end a sentence of a text."""
SERVICE: Final = "service:"
"""The prefix of the URI of a scenario's service."""


@dataclass(frozen=True, slots=True)
class Cue:
    """Something in a text besides its words, for the device that says it.

    A device may ignore cues and simply speak. Those of one text are in the order in which they
    occur; ``lasts`` and ``end`` are properly nested.
    """

    at: int
    """The number of characters of the text before it."""
    kind: Literal[
        "pause",
        "sentence",
        "rate",
        "lasts",
        "end",
        "mark",
        "earlier",
        "hotword",
        "record",
        "finalsilence",
        "longest",
        "sound",
    ]
    """``pause``: silence of ``value`` ms. ``sentence``: the pause that a full stop makes.
    ``sound``: the text before the next ``end`` is the sound ``value``, the signal ``[beep]`` or
    a recording that the device has made. ``rate``: from here on ``value`` times the usual rate. ``lasts``: what stands before its
    ``end`` takes ``value`` ms. ``mark``: a place named ``value``, to be told as passed.
    ``earlier``: marks of what the application said just before count for this question.
    ``hotword``: what the user says breaks off this question only if it is understood; with a
    ``value``, ``voice`` or ``dtmf``, what comes otherwise than so is not listened to.
    ``record``: the answer is a recording, of which the device tells how long it is; one of
    ``value`` ms is the longest, and 0 is without end. ``finalsilence``: it is over after so many
    ms of silence. ``longest``: the device listens no longer than ``value`` ms to what the user
    says, and tells that it was too long."""
    value: float | str | None = None


@dataclass(slots=True)
class Command:
    """An application's request (thesis 4.1, Table 4.1)."""

    type: str
    args: dict[str, Json] = field(default_factory=dict)
    text: str | None = None
    now: bool = False
    extra: dict[str, Json] = field(default_factory=dict)
    lang: str = ""
    source: str = ""
    """Its place in the document: ``FILE:LINE:COLUMN``, like all such places here."""
    restartable: bool = False
    """Whether it yields to a reaction and starts again afterwards (rule X2)."""
    cues: tuple[Cue, ...] = ()
    """Pauses, rates and marks of its text."""
    hook: Any = None
    """Data that the application keeps with the Command; nothing else uses it."""
    replaces: str = ""
    """The type that its application asked for, if the robot lacks that one (rule X6)."""

    @property
    def asked(self) -> str:
        """The type that its application asked for, as in the names of its events."""
        return self.replaces or self.type

    def cued(self, *kinds: str) -> bool:
        """Whether its text has a cue of one of these kinds."""
        return any(cue.kind in kinds for cue in self.cues)


@dataclass(slots=True)
class Group:
    """Commands marked as one unit: one Atomic Behavior (rule U4)."""

    steps: list[Step]
    longest: int | None = None
    source: str = ""
    restartable: bool = False

    @property
    def now(self) -> bool:
        """Whether the unit is wanted now, as its first Command is (rule O2)."""
        return bool(self.steps) and self.steps[0].what.now


@dataclass(slots=True)
class Step:
    """A node of a requested tree; ``after`` are indices of steps it waits for."""

    what: Command | Group
    after: tuple[int, ...] = ()
