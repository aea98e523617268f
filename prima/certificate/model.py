"""A certificate as data: waits, causes of starvation, and what the two applications share."""

from __future__ import annotations

from dataclasses import dataclass, field

from prima.checks.prices import Gap, Price
from prima.checks.prices.bounds import Busy
from prima.errors import Place


@dataclass(slots=True)
class Delay:
    """The wait of one reaction of an application for the other, and its cause."""

    event: str
    devices: tuple[str, ...] = ()
    """The devices that both need."""
    lasts: int = 0
    """The longest wait (ms), as far as known."""
    what: str = ""
    place: Place | None = None
    """The place of the longest part; None if only the rest causes the wait."""
    listens: bool = False
    """Whether the user may speak in it: the time of their words is extra."""
    after: list[Place] = field(default_factory=list)
    """The other's reactions to the same event, for which it waits as a whole (F2)."""
    everything: bool = False
    """Whether it waits for all that the other does in one go, as driving ABs may (K1, K2)."""
    each: int | None = 0
    """How much longer (ms) for each other event that the other reacts to meanwhile; None if
    unbounded."""
    whole: bool = False
    """Whether it waits for all that the other does in one go: then it is longer, too, for each
    event whose reaction the other has begun before and not ended."""
    unknown: list[Gap] = field(default_factory=list)
    endless: list[Gap] = field(default_factory=list)
    response: Delay | None = None
    """How long its first word or movement towards the user may wait; None if it has none."""

    @property
    def known(self) -> bool:
        """Whether the wait is never longer than ``lasts``."""
        return not self.unknown and not self.endless


@dataclass(frozen=True, slots=True)
class Starving:
    """A cause of an unbounded wait of Commands other than reactions."""

    place: Place
    what: str
    rule: str
    devices: tuple[str, ...]
    """Commands on these devices wait."""
    leaving: bool = False
    """Whether those that leave the user wait, whatever their devices (K1)."""
    everything: bool = False
    """Whether all wait, whatever their devices: it may hold the floor (F2)."""


@dataclass(slots=True)
class Certificate:
    """How an EA can affect an FA on one robot, under the policy ``prima``. Times are in ms."""

    fa: str
    ea: str
    robot: str
    both: list[str]
    only_fa: list[str]
    only_ea: list[str]
    longest_unit: Price | None
    delays: list[Delay]
    leaves: list[Price]
    others: Busy
    """How long Commands other than reactions wait at most, each time that the EA is busy."""
    holds: list[tuple[Place, int]] = field(default_factory=list)
    starves: list[Starving] = field(default_factory=list)
    gaps: list[Gap] = field(default_factory=list)
    """Reasons why something of the EA is unknown."""
    long: list[Price] = field(default_factory=list)
    """Parts of the EA that keep the speaker for longer than a run's patience, if unset (E6)."""
    lacks: dict[str, list[str]] = field(default_factory=dict)
    """Commands of the EA that a robot cannot carry out, by robot."""
