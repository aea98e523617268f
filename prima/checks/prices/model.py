"""The outline of an application: its parts, states and reactions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from prima.errors import Place
from prima.markup.tree import Node

SPEECH = "speech"
"""The event by which links react to what the user says."""


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
    """Whether it works in loops, between which it gives way: ``lasts`` is one loop."""
    listens: bool = False
    """Whether the user may speak in it: what they say comes on top."""
    inner: tuple[Price, ...] = ()
    """The parts of a unit."""

    @property
    def names(self) -> set[str]:
        """What it and all in it is called."""
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
        """How long others wait, for people."""
        return f"{'' if self.known else 'at least '}{self.lasts / 1000:.1f} s"


@dataclass(frozen=True, slots=True)
class Gap:
    """Something that the documents do not determine: an unknown target or document."""

    place: Place
    reason: str


@dataclass(slots=True)
class PricedState:
    """What an application does without waiting for an event, in a form or after an event."""

    name: str
    node: Node
    parts: list[Price] = field(default_factory=list)
    times: int = 1
    """How often its parts are done at most, as its questions are asked again."""
    goes: dict[str, Node] = field(default_factory=dict)
    """The states that follow without a wait, with the elements that lead there."""
    calls: dict[str, Node] = field(default_factory=dict)
    """The states of subdialogs: they come back."""
    repeats: list[Gap] = field(default_factory=list)
    """What in it may be done again and again without a wait for an event."""
    unknown: list[Gap] = field(default_factory=list)
    """Why it may take longer than its parts: delayed events, content of arrays."""
    raises: set[str] = field(default_factory=set)
    """The events of the application's own that it may raise before it has ended."""
    brings: set[str] = field(default_factory=set)
    """The events from outside that it may bring, though the user says nothing: answers of services,
    what the robot sees."""
    onward: set[str] = field(default_factory=set)
    """The states that follow though the user says nothing."""


@dataclass(slots=True)
class PricedReaction:
    """What an application does about an event from the user or the surroundings (C5)."""

    events: tuple[str, ...]
    node: Node
    firsts: list[Price]
    """What may be its first Command."""
    responds: list[Price]
    """What may come up to its first word or movement towards the user, that included; empty
    where there is none."""
    does: PricedState
    stays: str | None = None
    """The state that goes on beside it; None where it is left, ``""`` where it may be any."""
    words: frozenset[str] | None = None
    """What the user says is made of these words, for a link; None where that is not known."""
    later: list[Gap] = field(default_factory=list)
    """Why its response may come later than its Commands have it: by delayed events."""
    made: Gap | None = None
    """Where and how it leads to itself again without a wait, if it does."""
    often: Gap | None = None
    """Why nobody knows how often its events come: the application makes them for itself."""


@dataclass(slots=True)
class EndlessLoop:
    """A loop that may run endlessly without a wait for an event."""

    place: Place
    what: str
    devices: frozenset[str]
    engages: bool
    leaves: bool
    """Whether all of it leaves the user: then it ranks below what does not (K2)."""
    states: frozenset[str]


@dataclass(slots=True)
class Outline:
    """All that is known of an application: its parts in document order, states and reactions."""

    parts: list[Price]
    states: dict[str, PricedState]
    reactions: list[PricedReaction]
    wakes: list[PricedState]
    """What is done about the application's own delayed events: no reactions."""
    holds: list[tuple[Place, int]]
    gaps: list[Gap]
    loops: list[EndlessLoop] | None = None
    """What may go on without an end, once somebody has looked."""
    backwards: tuple[dict[str, list[str]], dict[str, list[str]]] | None = None
    """The predecessors and the callers of each state, once somebody has looked."""

    @property
    def devices(self) -> set[str]:
        """All devices that it may use, as far as the documents tell."""
        return set().union(*(part.devices for part in self.parts))


def worst(held: Iterable[Price], devices: frozenset[str]) -> Price | None:
    """The part for which something that needs these devices may wait longest."""
    fitting = [price for price in held if price.devices & devices]
    return max(fitting, key=lambda price: price.lasts, default=None)


def devices_of(held: Sequence[Price]) -> frozenset[str]:
    """The devices of some parts together."""
    return frozenset().union(*(price.devices for price in held))
