"""Grammars as data: rules and their expansions (SRGS 1.0 sections 2 and 3)."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from prima.grammar.errors import Where
from prima.grammar.media import Form

if TYPE_CHECKING:
    from prima.messages import Json

Mode = Literal["voice", "dtmf", ""]
"""The input mode of a grammar; empty for both."""


@dataclass(slots=True, eq=False)
class Words:
    """Tokens one after another (SRGS 2.1): folded, and as the grammar writes them."""

    folded: str
    tokens: tuple[str, ...]


@dataclass(slots=True, eq=False)
class Sequence:
    """Expansions one after another (SRGS 2.3); an empty one matches silence."""

    parts: list[Part]


@dataclass(slots=True, eq=False)
class Alternatives:
    """Alternatives with the cost of their weights (SRGS 2.4), best cost nought."""

    parts: list[Part]
    costs: list[float]
    index: PrefixIndex


@dataclass(slots=True, eq=False)
class Repeat:
    """A repeated expansion (SRGS 2.5); ``high`` None means unbounded.

    ``more`` and ``stop`` are the costs of one more repetition and of stopping (repeat probability).
    """

    part: Part
    low: int
    high: int | None
    more: float = 0.0
    stop: float = 0.0


@dataclass(slots=True, eq=False)
class Reference:
    """A rule by its URI (SRGS 2.2), and by its document and name once resolved.

    It does not hold the rule itself, so that a grammar with a chain of any length can be pickled.
    """

    uri: str
    where: Where
    media: str = ""
    home: GrammarDocument | None = None
    name: str = ""
    lead: int = 0
    """Characters at that place before the URI."""

    @property
    def rule(self) -> Rule | None:
        """The rule, once resolved."""
        return self.home.rules.get(self.name) if self.home is not None else None

    def resolve(self, rule: Rule) -> None:
        """Resolve it to a rule."""
        self.home, self.name = rule.document, rule.name


@dataclass(slots=True, eq=False)
class Special:
    """NULL, VOID or GARBAGE (SRGS 2.2.3)."""

    name: str


@dataclass(slots=True, eq=False)
class Tag:
    """The content of a tag (SRGS 2.6)."""

    code: str
    where: Where


@dataclass(slots=True, eq=False)
class BuiltIn:
    """A built-in type (VoiceXML Appendix P), which reads a text or keys as a value."""

    name: str
    read: Callable[[str, str], Json]
    """Text and mode to value; None if it does not match."""
    open: Callable[[str, str], bool]
    """Whether more may follow a text."""


Part = Words | Sequence | Alternatives | Repeat | Reference | Special | Tag | BuiltIn


def walk(body: Part) -> Iterator[Part]:
    """An expansion and all inside it, without the rules that it refers to."""
    todo = [body]
    while todo:
        part = todo.pop()
        yield part
        if isinstance(part, Alternatives | Sequence):
            todo += part.parts
        elif isinstance(part, Repeat):
            todo.append(part.part)


@dataclass(slots=True)
class PrefixIndex:
    """The alternatives of a choice by their initial words, each under all of its own."""

    by_prefix: dict[str, list[int]]
    lengths: list[int]
    others: list[int]
    """Alternatives that begin with something else."""
    ordered: list[str] = field(default_factory=list)
    """The keys of ``by_prefix``, sorted."""

    def goes_on(self, text: str) -> bool:
        """Whether a text is a proper prefix of some alternatives' initial words."""
        place = bisect_right(self.ordered, text)
        return place < len(self.ordered) and self.ordered[place].startswith(text)


@dataclass(slots=True, eq=False)
class Rule:
    """A rule definition (SRGS 3)."""

    name: str
    body: Part
    document: GrammarDocument
    public: bool = False


@dataclass(slots=True, eq=False)
class GrammarDocument:
    """One grammar document: its header (SRGS 4) and its rules."""

    uri: str
    where: Where
    mode: Mode = "voice"
    lang: str = ""
    root: str = ""
    base: str = ""
    tag_format: str = ""
    formatted: Where | None = None
    """The place of the tag format's declaration, if any."""
    rules: dict[str, Rule] = field(default_factory=dict)
    globals: list[Tag] = field(default_factory=list)
    """Global tags of the header, run once before those of rules."""
    tags: list[Tag] = field(default_factory=list)
    references: list[Reference] = field(default_factory=list)
    meta: dict[str, str] = field(default_factory=dict)
    dialect: str = ""
    """How tags are read: ``script``, ``literals``, ``legacy``, or ``last`` (PRIMA's own language)."""
    faults: dict[str, str] = field(default_factory=dict)
    """Scripts of tags used so far, with why each is not well-formed by itself; empty if it is."""
    form: Form = "XML"
    merges: bool = False
    """Whether slots filled by referenced rules become slots of the referring rule."""

    def public(self) -> list[str]:
        """The names of the rules that other documents may refer to."""
        return [name for name, rule in self.rules.items() if rule.public]
