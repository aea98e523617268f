"""The rules of selection (S, F, K), each a short function, and the policies made of them.

A policy answers three questions about a waiting AB: where it ranks, whether
something other than a device keeps it from starting, and whether it holds its
devices back from lower-ranked ones while it waits. ``prima`` is the thesis;
``fifo``, ``fair``, ``fixed`` and ``none`` are the baselines it is compared with.
"""

from __future__ import annotations

from prima.deferred import dataclass
from prima.errors import UsageError, did_you_mean, one_of
from prima.scheduler.behavior import RUNNING, Behavior, Rank, Stream
from prima.scheduler.memory import Memory
from prima.scheduler.waiting import (
    LATER,
    NO_REACTION,
    place,
    rank_declared,
)

Refusal = tuple[str, str]
"""The rule that keeps an AB from starting, and what it is kept back by."""


def rank_reaction(ab: Behavior, memory: Memory) -> tuple[int, int, int]:
    """S2b: reactions, the latest event's first; of one event, the active application's."""
    if ab.reaction is None:
        return NO_REACTION
    return (0, -ab.reaction, 0 if memory.active is ab.app else 1)


def rank_continuing(ab: Behavior, now: int) -> int:
    """S2c: a parent that has ended in this instant goes before others."""
    return 0 if ab.freed == now else LATER


def outranks(priority: int, stream: Stream) -> bool:
    """F2: whether a priority is higher than that of all that the floor's stream has."""
    contending = stream.contending()
    return bool(contending) and all(priority > other.priority for other in contending)


def refused_by_floor(ab: Behavior, memory: Memory) -> Refusal | None:
    """F2: another application's floor lets only certain ABs start."""
    holder = memory.holder
    if holder is None or holder.app is ab.app:
        return None
    if ab.reaction is not None and ab.reaction not in holder.causes:
        return None
    priority = max(one.priority for one in ab.meant())
    return None if outranks(priority, holder) else ("F2", holder.name)


def composes_with_floor(ab: Behavior, memory: Memory) -> bool:
    """X5: whether the floor's stream does nothing but a motion that this one can carry."""
    holder = memory.holder
    if holder is None or ab.motion != "free":
        return False
    contending = holder.contending()
    return bool(contending) and all(
        other.motion == "faithful" and other.state is RUNNING for other in contending
    )


def refused_by_channel(ab: Behavior, memory: Memory) -> Refusal | None:
    """K1: an AB that leaves the user waits while another application engages the user."""
    if not ab.leaves:
        return None
    for stream in memory.engaged.values():
        if stream.app is not ab.app and stream.engages_user():
            return ("K1", stream.name)
    return None


@dataclass(frozen=True, slots=True)
class Policy:
    """The thesis's policy, ``prima``."""

    name: str = "prima"
    floor: bool = True
    """Whether reactions take the floor (F1) and the channel is kept (K1)."""
    exclusive: bool = True
    """Whether an AB waits for its devices (S1); only ``none`` does without."""
    rules: tuple[str, ...] = ("S2a", *["S2b"] * 3, "S2c", "S2d", "S2e", "S2f", "S2f")
    """The name of the rule behind each number of a rank."""
    turning: bool = False
    """Whether a start changes how other ABs rank."""
    extensions: frozenset[str] = frozenset()
    """Which of :data:`EXTENSIONS` are on."""

    def has(self, extension: str) -> bool:
        """Whether an extension is on."""
        return extension in self.extensions

    def rank(self, ab: Behavior, memory: Memory, now: int) -> Rank:
        """Where a waiting AB stands: the smallest goes first (S2)."""
        reacting, event, whose = rank_reaction(ab, memory)
        return place(ab, reacting, event, whose, rank_continuing(ab, now))

    def decided(self, winner: Rank, loser: Rank) -> str:
        """The rule by which one rank goes before another; they differ in the serial number at least."""
        for index, rule in enumerate(self.rules):
            ours: int = winner[index]
            its: int = loser[index]
            if ours != its:
                return rule
        raise AssertionError("two ABs have one serial number")

    def refusal(self, ab: Behavior, memory: Memory) -> Refusal | None:
        """What else than a device keeps the AB from starting (F2, K1)."""
        if not memory.floor and not memory.engaged:
            return None
        if self.has("x5") and composes_with_floor(ab, memory):
            return refused_by_channel(ab, memory)
        return refused_by_floor(ab, memory) or refused_by_channel(ab, memory)

    def holds_back(self, ab: Behavior) -> bool:
        """S3: whether a waiting AB keeps its devices from those it outranks."""
        return ab.reaction is not None

    @property
    def lined(self) -> bool:
        """Whether ABs of one line start in its order, so that most need no look (S1-S4, F, K)."""
        return not self.extensions


@dataclass(frozen=True, slots=True)
class Fifo(Policy):
    """Waiting ABs in the order of their requests; no floor, channel or reactivity."""

    name: str = "fifo"
    floor: bool = False
    rules: tuple[str, ...] = ("fifo", "S2f", "S2f")

    def rank(self, ab: Behavior, memory: Memory, now: int) -> Rank:
        """The earlier request goes first."""
        return (ab.requested, rank_declared(ab), ab.serial, ab)

    def refusal(self, ab: Behavior, memory: Memory) -> Refusal | None:
        """Nothing but devices keeps an AB from starting."""
        return None

    def holds_back(self, ab: Behavior) -> bool:
        """Every waiting AB holds its devices back from later ones."""
        return True

    @property
    def lined(self) -> bool:
        """Other orders than the lines'."""
        return False


@dataclass(frozen=True, slots=True)
class Fair(Fifo):
    """Like ``fifo``, but the application goes first that has not had its turn."""

    name: str = "fair"
    turning: bool = True
    rules: tuple[str, ...] = ("fair", "fifo", "S2f", "S2f")

    def rank(self, ab: Behavior, memory: Memory, now: int) -> Rank:
        """The application whose turn is longest ago, then the earlier request."""
        return (ab.app.last_turn, ab.requested, rank_declared(ab), ab.serial, ab)


@dataclass(frozen=True, slots=True)
class Fixed(Fifo):
    """One application, named, always outranks the other (a subsumption architecture)."""

    name: str = "fixed"
    rules: tuple[str, ...] = ("fixed", "fifo", "S2f", "S2f")
    first: str = ""

    def rank(self, ab: Behavior, memory: Memory, now: int) -> Rank:
        """The named application (else the one declared first), then the earlier request."""
        top = ab.app.name == self.first if self.first else ab.app.order == 0
        return (0 if top else 1, ab.requested, rank_declared(ab), ab.serial, ab)


@dataclass(frozen=True, slots=True)
class Unmediated(Fifo):
    """No mediator: every Command reaches its devices at once."""

    name: str = "none"
    exclusive: bool = False
    rules: tuple[str, ...] = ("none", "S2f", "S2f")

    def holds_back(self, ab: Behavior) -> bool:
        """Nothing is ever held back."""
        return False


POLICIES = ("prima", "fifo", "fair", "fixed", "none")
EXTENSIONS = ("x1", "x2", "x3", "x4", "x5", "x6")
"""The extensions of ``prima`` (rules X1-X6), each written behind a plus: ``prima+x1+x3``."""


def policy_named(text: str) -> Policy:
    """Give the policy for ``prima``, ``fifo``, ``fair``, ``fixed``, ``fixed:APP`` or ``none``.

    ``prima`` may have extensions: ``prima+x1``, ``prima+x2+x4``, ``prima+all``.

    Raises:
        UsageError: no policy or extension has that name.
    """
    base, *extensions = text.split("+")
    if base == "prima" and extensions:
        return Policy(name=text, extensions=_extensions(extensions))
    name, colon, first = text.partition(":")
    if name == "fixed" and (first or not colon):
        return Fixed(first=first)
    simple: dict[str, type[Policy]] = {
        "prima": Policy,
        "fifo": Fifo,
        "fair": Fair,
        "none": Unmediated,
    }
    if name not in simple or colon:
        hint = did_you_mean(name, POLICIES) or f"Write {one_of(POLICIES)}."
        raise UsageError(f'There is no policy "{text}". {hint}')
    return simple[name]()


def _extensions(names: list[str]) -> frozenset[str]:
    for name in names:
        if name != "all" and name not in EXTENSIONS:
            hint = did_you_mean(name, EXTENSIONS) or f"Write {one_of(EXTENSIONS)}, or all."
            raise UsageError(f'There is no extension "{name}". {hint}')
    return frozenset(EXTENSIONS if "all" in names else names)
