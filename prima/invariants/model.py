"""The model of a run by its records: Atomic Behaviors, streams, and what happens to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

Record = Mapping[str, Any]


def ms(seconds: float) -> int:
    """Converts seconds to milliseconds, in which all times are compared."""
    return round(seconds * 1000)


LINKED, WAITING, RUNNING, GONE = "linked", "waiting", "running", "gone"
EXTENSIONS = frozenset(("x1", "x2", "x3", "x4", "x5", "x6", "x7", "x8", "x9", "x10"))
COMPOSED = {"free", "faithful"}
SEEKING = ("active-sensing-human", "tracking-human")
"""Commands that search or track, so that their stream engages even an absent user (K1)."""


@dataclass(slots=True, eq=False)
class AB:
    """An Atomic Behavior by its records; a feedback Command is one, with all its loops."""

    name: str
    command: str
    app: str
    tree: Tree
    devices: frozenset[str]
    high: bool
    leaves: bool
    engages: bool
    feedback: bool
    question: bool
    state: int | None
    unit: AB | None
    cause: int | None
    """The event reacted to: the reactive flag, until the AB starts (C5)."""
    parents: set[str]
    requested: int
    place: int
    """The index of its request among the records."""
    urgent: bool = False
    """Whether it is wanted ``now``, and so never linked (O2)."""
    restartable: bool = False
    motion: str = ""
    fresh_until: int | None = None
    """Until when (ms) the reaction is worth starting (X8)."""
    says: bool = False
    """Whether the robot speaks meanwhile, for F6 and X9."""
    spans: bool = False
    """Whether it is a unit that spans questions and states (U5), for X7."""
    connect: bool = False
    """Whether the robot has to see the user, or turn to them, before it starts (X4)."""
    inserted: str = ""
    put_before: str = ""
    """The AB before which it was inserted."""
    waits_as: str = ""
    """The AB for which its wait for the speaker counts (E6): itself, or what it was put before."""
    phase: str = WAITING
    loop: int = 0
    starts: int = 0
    started: int = -1
    """The index of its latest start among the records."""
    started_at: int = -1
    reacted: int | None = None
    """The event that it reacted to when it started; what starts again has no flag."""
    followed_at: int = -1
    """When one of its parents or its loop ended, or a window requested it (S2c)."""
    freed_at: int = -1
    """When its last parent ended or was cancelled."""
    joined_at: int = -1
    """When it began to wait for what was inserted for its stream (X1, X9)."""
    interrupted: bool = False
    """Whether it has to start again from its beginning (X2)."""
    content: list[Record] = field(default_factory=list)
    """The requests inside the unit since it started from its beginning."""
    before: list[Record] = field(default_factory=list)
    """The same for the time before it was interrupted."""
    reacted_to: int | None = None
    """The event that caused its request."""
    listening: bool = False
    silent: bool = False
    """Whether O2 or E1 may have suppressed its notices while it runs."""
    last_loop: bool = False
    """Whether its tree has failed, so that no loop follows the one that runs (E1)."""
    said: tuple[str, str, int] | None = None
    """Why it waits, because of what, and since when, by its latest ``hold``."""

    @property
    def begins_now(self) -> bool:
        """O2: whether it waits for nothing of its own application; what resumes does."""
        return self.urgent and not self.starts

    def inside(self, other: AB) -> bool:
        """Whether this is part of the unit ``other``, at any depth."""
        unit = self.unit
        while unit is not None and unit is not other:
            unit = unit.unit
        return unit is other

    @property
    def outermost(self) -> AB:
        """The AB that is cut if this one is: the unit around it, or itself."""
        return self if self.unit is None else self.unit.outermost

    @property
    def contends(self) -> bool:
        """Whether it runs or waits, that is, neither it nor a unit around it is linked."""
        return self.phase != LINKED and self.outermost.phase != LINKED

    @property
    def asks(self) -> bool:
        """Whether it is a question itself: a unit leaves that to its Commands."""
        return "speech-recognition" in self.devices and self.command != "iu"

    @property
    def drives(self) -> bool:
        """Whether it has the wheels itself: a unit leaves them to its Commands (F5)."""
        return "locomotion" in self.devices and self.command != "iu"

    @property
    def moves(self) -> bool:
        """Whether it is a feedback Command that moves the robot (F5)."""
        return self.feedback and "locomotion" in self.devices

    @property
    def shown(self) -> str:
        """Its name, with the number of its loop."""
        return f"{self.name}.{self.loop}" if self.loop else self.name


@dataclass(slots=True, eq=False)
class Tree:
    """A Communication Stream."""

    name: str
    app: str
    members: dict[str, AB] = field(default_factory=dict)
    windows: int = 0
    started: int = -1
    """The index of its latest start: a stream that has not begun is not suspended (S2d)."""
    spoken: bool = False
    engaged: bool = False
    cause: int | None = None
    causes: set[int] = field(default_factory=set)
    hold: int | None = None
    """How long (ms) its latest request holds it afterwards (X3)."""
    hold_state: int | None = None
    """The state that requested this."""
    until: int | None = None
    """Until when (ms) it is held."""
    held: int = -1
    """The index of the record by which it began to be held."""
    joined: int = -1
    """The index of the record by which a request joined it while held."""
    requested: int = -1
    """The index of the latest request."""
    suspended: bool = False
    waits: bool = False
    """Whether another application has kept one of its ABs waiting since it was suspended."""
    rank: int = 0
    """The index of the start that suspended it: the latest goes first (S2d)."""
    moved_away: bool = False
    """Whether the robot may have been moved since one of its ABs relied on its place (X1)."""
    words: str = ""
    """The words to say when it resumes, by its latest request (X9)."""
    words_due: bool = False
    """Whether another application has spoken since it was suspended (X9)."""
    place: tuple[float, float] | None = None
    """Where the robot has gone for it: what follows relies on that place (X1)."""

    @property
    def open(self) -> bool:
        """C1: whether it has an AB in working memory or an open window, or is held (X3)."""
        return bool(self.members) or self.windows > 0 or self.until is not None

    @property
    def runs(self) -> bool:
        """Whether an AB of it runs."""
        return any(ab.phase == RUNNING for ab in self.members.values())

    def contending(self) -> list[AB]:
        """The running and waiting ABs, and linked ones for which an AB was inserted."""
        return [one for ab in self.members.values() if ab.contends for one in self.meant(ab)]

    def meant(self, ab: AB) -> list[AB]:
        """The ABs in memory for which an AB was inserted (X1, X4, X9); else the AB itself."""
        if not ab.inserted:
            return [ab]
        behind = [one for one in self.members.values() if ab.name in one.parents]
        return [meant for one in behind for meant in self.meant(one)] or [ab]

    def put_first(self) -> list[AB]:
        """X1, X9: the AB that is inserted before all that wait in the stream."""
        return [ab for ab in self.members.values() if ab.inserted in ("X1", "X9")]

    def engages(self, sensed: bool) -> bool:
        """K1: from the first engaging start to the end, unless all contending ABs leave.

        ``sensed``: whether somebody was seen, heard or felt recently.
        """
        contending = self.contending()
        leaves = bool(contending) and all(ab.leaves for ab in contending)
        seeks = any(ab.command in SEEKING for ab in contending)
        return self.engaged and not leaves and (sensed or seeks)


@dataclass(slots=True)
class Cut:
    """A cancellation that has to be justified by the other records of its instant."""

    ab: AB
    was: str
    rule: str
    place: int
    tree_devices: frozenset[str]


def base(behavior: str) -> str:
    """An AB's name without the number of its loop."""
    return behavior.partition(".")[0]
