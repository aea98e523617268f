"""The prefixes of a grammar's expansions, so that only few of many alternatives are tried.

An alternative that an index omits cannot match; one that it returns may.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain
from typing import NamedTuple

from prima.grammar.model import (
    Alternatives,
    GrammarDocument,
    Part,
    PrefixIndex,
    Reference,
    Repeat,
    Sequence,
    Special,
    Tag,
    Words,
    walk,
)
from prima.grammar.text import join

MOST_PREFIXES = 16
"""Maximum number of prefixes of one part."""
MOST_LETTERS = 200
"""Length up to which a prefix is extended by what follows."""
MAX_DEPTH = 40
"""Maximum depth of parts and rules in the search for prefixes."""


class Prefix(NamedTuple):
    """One way in which a part begins."""

    text: str
    """Folded; every match of this kind begins with this text."""
    whole: bool
    """Whether the text is the whole match."""


Prefixes = tuple[Prefix, ...]
NOTHING: Prefixes = (Prefix("", True),)
UNKNOWN: Prefixes = (Prefix("", False),)


def index_choices(documents: Iterable[GrammarDocument]) -> None:
    """Index the alternatives of all rules of documents with resolved references."""
    for document in documents:
        finder = _Finder(document.mode == "dtmf")
        for part in chain.from_iterable(walk(rule.body) for rule in document.rules.values()):
            if isinstance(part, Alternatives):
                part.index = finder.index(part.parts)


class _Finder:
    """Finds the prefixes of parts, each once."""

    def __init__(self, keys: bool) -> None:
        self._keys = keys
        self._known: dict[int, Prefixes] = {}

    def index(self, parts: list[Part]) -> PrefixIndex:
        """Alternatives by their prefixes."""
        by_prefix: dict[str, list[int]] = {}
        others: list[int] = []
        for number, part in enumerate(parts):
            texts = {one.text for one in self._prefixes(part, 0)}
            if "" in texts:
                others.append(number)
                continue
            for text in texts:
                by_prefix.setdefault(text, []).append(number)
        lengths = sorted({len(text) for text in by_prefix})
        return PrefixIndex(by_prefix, lengths, others, sorted(by_prefix))

    def _prefixes(self, part: Part, depth: int) -> Prefixes:
        """The prefixes of a part; none at all if it cannot match."""
        match part:
            case Words(folded):
                return (Prefix(folded, True),)
            case Tag() | Special("NULL"):
                return NOTHING
            case Special("VOID"):
                return ()
        known = self._known.get(id(part))
        if known is None:
            self._known[id(part)] = UNKNOWN  # during the search: it may refer to itself
            found = UNKNOWN if depth >= MAX_DEPTH else self._composed(part, depth + 1)
            known = self._known[id(part)] = found
        return known

    def _composed(self, part: Part, depth: int) -> Prefixes:
        """The prefixes of a compound part."""
        match part:
            case Sequence(parts):
                return self._in_turn(parts, depth)
            case Alternatives(parts):
                return self._any_of(parts, depth)
            case Repeat(_, _, 0):
                return NOTHING
            case Repeat(inner, low, high):
                once = self._prefixes(inner, depth)
                if high != 1:
                    once = tuple(Prefix(one.text, False) for one in once)
                return once if low else (*NOTHING, *once)
            case Reference(rule=rule) if rule is not None:
                return self._prefixes(rule.body, depth)
        return UNKNOWN

    def _any_of(self, parts: list[Part], depth: int) -> Prefixes:
        """The prefixes of alternatives."""
        found: set[Prefix] = set()
        for part in parts:
            found.update(self._prefixes(part, depth))
            if len(found) > MOST_PREFIXES:
                return UNKNOWN
        return tuple(sorted(found))

    def _in_turn(self, parts: list[Part], depth: int) -> Prefixes:
        """The prefixes of parts one after another."""
        found: set[Prefix] = set(NOTHING)
        for part in parts:
            then = self._prefixes(part, depth)
            if then == NOTHING:
                continue
            if not any(one.whole for one in found):
                break
            longer = self._extended(found, then)
            if len(longer) > MOST_PREFIXES:
                return tuple(sorted({Prefix(one.text, False) for one in found}))
            found = longer
        return tuple(sorted(found))

    def _extended(self, found: set[Prefix], then: Prefixes) -> set[Prefix]:
        """Prefixes of parts, whole matches being followed by those of the next part."""
        longer = {one for one in found if not one.whole}
        for one in found - longer:
            for two in then:
                text = self._joined(one.text, two.text)
                longer.add(Prefix(text, two.whole and len(text) < MOST_LETTERS))
        return longer

    def _joined(self, one: str, two: str) -> str:
        if self._keys or not one or not two:
            return one + two
        return join((one, two))
