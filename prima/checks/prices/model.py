"""The outline of an application: its parts, states and reactions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from prima.errors import Place
from prima.markup.tree import Node

UNKNOWN_LETTERS = 20
"""The assumed text of an expression."""
SPEECH = "speech"
"""The event by which links react to the user's words."""


@dataclass(frozen=True, slots=True)
class Price:
    """An indivisible part of an application (rules U1, U4, U5)."""

    node: Node
    what: str
    """``unit``, ``question``, ``recording``, ``call`` or the Command's name."""
    devices: frozenset[str]
    lasts: int
    """The longest wait of others (ms), as far as the documents determine it."""
    unknown: str = ""
    """Why it may take longer; empty if it may not."""
    leaves: bool = False
    engages: bool = False
    loops: bool = False
    """Whether it works in loops, yielding between them: ``lasts`` is one loop."""
    listens: bool = False
    """Whether the user may speak in it, which adds to its duration."""
    inner: tuple[Price, ...] = ()
    """The parts of a unit."""

    @property
    def names(self) -> set[str]:
        """The names of it and its parts."""
        return {self.what}.union(*(one.names for one in self.inner))

    @property
    def known(self) -> bool:
        """Whether ``lasts`` is the longest."""
        return not self.unknown

    @property
    def place(self) -> Place:
        """The element's place."""
        return self.node.place

    @property
    def seconds(self) -> str:
        """How long others wait, as text."""
        return f"{'' if self.known else 'at least '}{self.lasts / 1000:.1f} s"


@dataclass(frozen=True, slots=True)
class Gap:
    """Something that the documents do not determine: an unknown target or document."""

    place: Place
    reason: str


@dataclass(slots=True)
class PricedState:
    """An application's activity, in a form or after an event, until it waits for an event."""

    name: str
    node: Node
    parts: list[Price] = field(default_factory=list)
    times: int = 1
    """How often its parts are carried out at most, as its questions are repeated."""
    goes: dict[str, Node] = field(default_factory=dict)
    """The states that follow without a wait, with the elements that lead there."""
    calls: dict[str, Node] = field(default_factory=dict)
    """The states of subdialogs, which return."""
    repeats: list[Gap] = field(default_factory=list)
    """Parts of it that may be repeated without a wait for an event."""
    unknown: list[Gap] = field(default_factory=list)
    """Why it may take longer than its parts: delayed events, content of arrays."""
    raises: set[str] = field(default_factory=set)
    """The application's own events that it may raise before it has ended."""
    brings: set[str] = field(default_factory=set)
    """The outside events that it may cause without the user speaking: answers of services,
    what the robot sees."""
    onward: set[str] = field(default_factory=set)
    """The states that follow without the user speaking."""


@dataclass(slots=True)
class PricedReaction:
    """An application's reaction to an event from the user or the surroundings (C5)."""

    events: tuple[str, ...]
    node: Node
    firsts: list[Price]
    """Its possible first Commands."""
    responds: list[Price]
    """Its possible Commands up to and including its first word or movement towards the user; empty
    if there is none."""
    together: Mapping[frozenset[str], int]
    """How long (ms) those of its first Commands that begin at once, in branches, keep devices."""
    does: PricedState
    stays: str | None = None
    """The state that continues alongside it; None if it is left, ``""`` if it may be any."""
    words: frozenset[str] | None = None
    """For a link, the possible words of the user; None if unknown."""
    later: list[Gap] = field(default_factory=list)
    """Why its response may come later than by its Commands: delayed events."""
    made: Gap | None = None
    """Where and how it leads to itself again without a wait, if it does."""
    often: Gap | None = None
    """Why the frequency of its events is unknown: the application causes them itself."""


@dataclass(slots=True)
class EndlessLoop:
    """A loop that may run endlessly without a wait for an event."""

    place: Place
    what: str
    devices: frozenset[str]
    engages: bool
    leaves: bool
    """Whether all of it leaves the user, so that it ranks below everything that does not (K2)."""
    states: frozenset[str]


@dataclass(slots=True)
class Outline:
    """An application's parts in document order, its states and its reactions."""

    parts: list[Price]
    states: dict[str, PricedState]
    reactions: list[PricedReaction]
    wakes: list[PricedState]
    """The handling of the application's own delayed events, which are not reactions."""
    holds: list[tuple[Place, int]]
    gaps: list[Gap]
    joins: list[PricedReaction] = field(default_factory=list)
    """What it does about events from outside without reacting (C5): it continues a stream (O1)."""
    loops: list[EndlessLoop] | None = None
    """Endless activity, computed on demand."""
    backwards: tuple[dict[str, list[str]], dict[str, list[str]]] | None = None
    """The predecessors and the callers of each state, computed on demand."""

    @property
    def handled(self) -> list[PricedReaction]:
        """What it does about events, whether it reacts to them or not."""
        return [*self.reactions, *self.joins]

    @property
    def devices(self) -> set[str]:
        """All devices that it may use, as far as the documents determine them."""
        return set().union(*(part.devices for part in self.parts))


def worst(held: Iterable[Price], devices: frozenset[str]) -> Price | None:
    """The part that may keep a request for these devices waiting longest."""
    fitting = [price for price in held if price.devices & devices]
    return max(fitting, key=lambda price: price.lasts, default=None)


def devices_of(held: Sequence[Price]) -> frozenset[str]:
    """The devices of some parts together."""
    return frozenset().union(*(price.devices for price in held))


def chains(prices: Iterable[Price]) -> dict[frozenset[str], int]:
    """How long (ms) Commands that may begin at once keep devices, by those devices.

    Those that share a device run one after another.
    """
    found: dict[frozenset[str], int] = {}
    for price in prices:
        held, lasts = price.devices, price.lasts
        for one in [one for one in found if one & price.devices]:
            held, lasts = held | one, lasts + found.pop(one)
        found[held] = lasts
    return found


def add_longer(kept: dict[frozenset[str], int], more: Mapping[frozenset[str], int]) -> None:
    """Add how long devices are kept otherwise: of the same devices the longer time."""
    for held, lasts in more.items():
        kept[held] = max(lasts, kept.get(held, 0))
