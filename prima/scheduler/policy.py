"""Policies: the thesis's, made of the rules of selection (S, F, K), and the baselines.

A policy answers three questions about a waiting AB: where it ranks, whether
something other than a device keeps it from starting, and whether it holds its
devices back from lower-ranked ones while it waits. ``prima`` is the thesis's policy;
``fifo``, ``fair``, ``fixed`` and ``none`` are the baselines it is compared with.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from prima.errors import UsageError, nearest_word, one_of
from prima.scheduler import rules
from prima.scheduler.behavior import Behavior
from prima.scheduler.memory import WorkingMemory
from prima.scheduler.rules import Rank, Refusal

Ranked = tuple[Rank, Behavior]
"""A rank with its waiting AB."""


@dataclass(frozen=True, slots=True)
class Policy:
    """The thesis's policy, ``prima``."""

    name: str
    floor: bool = True
    """Whether reactions take the floor (F1) and the channel is kept (K1)."""
    exclusive: bool = True
    """Whether an AB waits for its devices (S1); False only for ``none``."""
    rules: tuple[str, ...] = ("S2a", "X7", "S2b", "E6", "S2c", "S2d", "S2e", "S2f")
    """The name of the rule behind each place of a rank."""
    turning: bool = False
    """Whether starting an AB changes how others rank."""
    extensions: frozenset[str] = frozenset()
    """Which of :data:`EXTENSIONS` are on."""

    def rank(self, ab: Behavior, memory: WorkingMemory, now: int) -> Rank:
        """Where a waiting AB ranks: the smallest goes first (S2)."""
        return (
            rules.s2a(ab),
            not rules.third_turn(ab, memory),
            rules.s2b(ab, memory),
            rules.e6(ab, memory, now),
            rules.s2c(ab, now),
            rules.s2d(ab),
            rules.s2e(ab),
            rules.s2f(ab),
        )

    def ranked(self, found: Iterable[Behavior], memory: WorkingMemory, now: int) -> list[Ranked]:
        """Waiting ABs with their ranks, sorted; no two ranks are equal (S2f)."""
        ranked = [(self.rank(ab, memory, now), ab) for ab in found]
        ranked.sort(key=lambda one: one[0])
        return ranked

    def decided(self, winner: Rank, loser: Rank) -> str:
        """The rule by which one rank precedes another; the last rule if they are equal."""
        differ = (ours != its for ours, its in zip(winner, loser, strict=True))
        found = (rule for rule, differs in zip(self.rules, differ, strict=True) if differs)
        return next(found, self.rules[-1])

    def refusal(self, ab: Behavior, memory: WorkingMemory) -> Refusal | None:
        """What, other than a device, keeps the AB from starting (F2, F6, K1, X7)."""
        if rules.third_turn(ab, memory):
            return None
        if (kept := rules.x7(ab, memory)) is not None:
            return kept
        if rules.x5(ab, memory):
            return rules.k1(ab, memory)
        return rules.refusal(ab, memory)

    def holds_back(self, ab: Behavior, memory: WorkingMemory) -> bool:
        """S3, E6, X7: whether a waiting AB holds its devices back from lower-ranked ones."""
        return ab.reaction is not None or ab.wait.overdue or rules.third_turn(ab, memory)


@dataclass(frozen=True, slots=True)
class Fifo(Policy):
    """Waiting ABs in the order of their requests; no floor, channel or reactivity."""

    floor: bool = False
    rules: tuple[str, ...] = ("fifo", "S2f")

    def rank(self, ab: Behavior, memory: WorkingMemory, now: int) -> Rank:
        """The earlier request goes first."""
        return (rules.s2e(ab), rules.s2f(ab))

    def refusal(self, ab: Behavior, memory: WorkingMemory) -> Refusal | None:
        """Nothing but devices keeps an AB from starting."""
        return None

    def holds_back(self, ab: Behavior, memory: WorkingMemory) -> bool:
        """Every waiting AB holds its devices back from later ones."""
        return True


@dataclass(frozen=True, slots=True)
class Fair(Fifo):
    """Like ``fifo``, but the application whose last turn is longest ago goes first."""

    turning: bool = True
    rules: tuple[str, ...] = ("fair", "fifo", "S2f")

    def rank(self, ab: Behavior, memory: WorkingMemory, now: int) -> Rank:
        """The application whose last turn is longest ago, then the earlier request."""
        return (ab.app.last_turn, rules.s2e(ab), rules.s2f(ab))


@dataclass(frozen=True, slots=True)
class Fixed(Fifo):
    """One application, named, always outranks the other (a subsumption architecture)."""

    rules: tuple[str, ...] = ("fixed", "fifo", "S2f")
    first: str = ""

    def rank(self, ab: Behavior, memory: WorkingMemory, now: int) -> Rank:
        """The named application (else the one declared first), then the earlier request."""
        top = ab.app.name == self.first if self.first else ab.app.order == 0
        return (0 if top else 1, rules.s2e(ab), rules.s2f(ab))


@dataclass(frozen=True, slots=True)
class Unmediated(Fifo):
    """No mediator: every Command reaches its devices at once."""

    exclusive: bool = False


POLICIES: dict[str, type[Policy]] = {
    "prima": Policy,
    "fifo": Fifo,
    "fair": Fair,
    "fixed": Fixed,
    "none": Unmediated,
}
"""Every policy by its name; the command line, editors, studies and reports read this table."""
_WORDS = [
    word
    for name, policy in POLICIES.items()
    for word in ((name, f"{name}:APP") if policy is Fixed else (name,))
]
USAGE = f"{', '.join(_WORDS[:-1])} or {_WORDS[-1]}"
"""The syntax of policies, for the command line's help."""
BASELINES = tuple(name for name in POLICIES if name != "prima")
"""The policies that ``prima`` is compared with; each name is also used as a rule in its records."""
EXTENSIONS = ("x1", "x2", "x3", "x4", "x5", "x6", "x7", "x8", "x9", "x10")
"""The extensions of ``prima`` (rules X1-X10), each written after a plus: ``prima+x1+x3``."""


class UnknownPolicy(UsageError):
    """An unknown policy or extension; ``meant`` is the name most likely meant by ``word``."""

    def __init__(self, wrong: str, meant: str, remedy: str, word: str = "") -> None:
        self.wrong = wrong
        self.remedy = remedy
        self.meant = meant
        self.word = word
        super().__init__(f"{wrong} {self.remedy}")

    def __reduce__(self) -> tuple[type[UnknownPolicy], tuple[str, ...]]:
        return type(self), (self.wrong, self.meant, self.remedy, self.word)


def policy_named(text: str) -> Policy:
    """Give the policy for ``prima``, ``fifo``, ``fair``, ``fixed``, ``fixed:APP`` or ``none``.

    ``prima`` may have extensions: ``prima+x1``, ``prima+x2+x4``, ``prima+all``.

    Raises:
        UnknownPolicy: no policy or extension has that name.
    """
    base, *extensions = text.split("+")
    if base == "prima":
        return Policy(name=text, extensions=_extensions(extensions))
    name, colon, first = text.partition(":")
    if name == "fixed" and first:
        return Fixed(name, first=first)
    if name not in POLICIES or colon:
        wrong, meant = f'There is no policy "{text}".', nearest_word(name, POLICIES)
        if {base, *extensions} <= {"all", *EXTENSIONS}:
            meant = f"prima+{text}"
        remedy = f'Did you mean "{meant}"?' if meant else f"Write {one_of(POLICIES)}."
        raise UnknownPolicy(wrong, meant, f"{remedy} fixed:APP prefers the application APP.")
    return POLICIES[name](name)


def _extensions(names: list[str]) -> frozenset[str]:
    for name in names:
        if name != "all" and name not in EXTENSIONS:
            wrong = f'There is no extension "{name}".'
            meant = nearest_word(name, EXTENSIONS)
            remedy = f'Did you mean "{meant}"?' if meant else "Write all, or one of x1 to x10."
            raise UnknownPolicy(wrong, meant, remedy, name)
    return frozenset(EXTENSIONS if "all" in names else names)
