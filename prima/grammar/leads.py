"""What expansions begin with: so that of many alternatives only those in question are tried."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from prima.grammar.model import (
    Choice,
    Document,
    LeadIndex,
    Part,
    Reference,
    Repeat,
    Sequence,
    Special,
    Tag,
    Words,
)
from prima.grammar.text import join

MOST_LEADS = 16
"""How many beginnings of one expansion are told apart."""
MOST_LETTERS = 200
"""How long a beginning is that is still looked beyond."""
MAX_DEPTH = 40
"""How deep in expansions and rules beginnings are looked for."""


class Lead(NamedTuple):
    """One way in which an expansion begins."""

    text: str
    """Folded; every match that begins in this way begins with this text."""
    whole: bool
    """Whether the text is the whole match."""


UNKNOWN = (Lead("", False),)
NOTHING = (Lead("", True),)
Leads = tuple[Lead, ...]


def index_choices(documents: Iterable[Document]) -> None:
    """Index the alternatives of all rules of some documents, whose references are resolved."""
    for document in documents:
        finder = _Finder(document.mode == "dtmf")
        for rule in document.rules.values():
            todo: list[Part] = [rule.body]
            while todo:
                part = todo.pop()
                if isinstance(part, Choice):
                    part.index = finder.index(part.parts)
                    todo += part.parts
                elif isinstance(part, Sequence):
                    todo += part.parts
                elif isinstance(part, Repeat):
                    todo.append(part.part)


class _Finder:
    """Finds the beginnings of expansions, each once."""

    def __init__(self, keys: bool) -> None:
        self._keys = keys
        self._known: dict[int, Leads] = {}

    def index(self, parts: list[Part]) -> LeadIndex:
        by_lead: dict[str, list[int]] = {}
        others: list[int] = []
        for number, part in enumerate(parts):
            texts = {lead.text for lead in self.leads(part, 0)}
            if "" in texts:
                others.append(number)
                continue
            for text in texts:
                by_lead.setdefault(text, []).append(number)
        return LeadIndex(by_lead, sorted({len(text) for text in by_lead}), others, sorted(by_lead))

    def leads(self, part: Part, depth: int) -> Leads:
        """In which ways an expansion begins; none at all if nothing matches it."""
        match part:
            case Words(folded):
                return (Lead(folded, True),)
            case Tag() | Special("NULL"):
                return NOTHING
            case Special("VOID"):
                return ()
        known = self._known.get(id(part))
        if known is None:
            self._known[id(part)] = UNKNOWN  # while it is looked for: it may refer to itself
            known = self._known[id(part)] = self._leads(part, depth + 1)
        return known

    def _leads(self, part: Part, depth: int) -> Leads:
        if depth > MAX_DEPTH:
            return UNKNOWN
        match part:
            case Sequence(parts):
                return self._sequence(parts, depth)
            case Choice(parts):
                return self._union(parts, depth)
            case Repeat(_, _, 0):
                return NOTHING
            case Repeat(inner, low, high):
                once = self.leads(inner, depth)
                if high != 1:
                    once = tuple(Lead(lead.text, False) for lead in once)
                return once if low else (*NOTHING, *once)
            case Reference(rule=rule) if rule is not None:
                return self.leads(rule.body, depth)
        return UNKNOWN

    def _union(self, parts: list[Part], depth: int) -> Leads:
        found: set[Lead] = set()
        for part in parts:
            found.update(self.leads(part, depth))
            if len(found) > MOST_LEADS:
                return UNKNOWN
        return tuple(sorted(found))

    def _sequence(self, parts: list[Part], depth: int) -> Leads:
        found: set[Lead] = set(NOTHING)
        for part in parts:
            if isinstance(part, Tag):
                continue
            begun = [lead for lead in found if lead.whole]
            if not begun:
                break
            longer = {lead for lead in found if not lead.whole}
            for then in self.leads(part, depth):
                for one in begun:
                    text = self._join(one.text, then.text)
                    longer.add(Lead(text, then.whole and len(text) < MOST_LETTERS))
            if len(longer) > MOST_LEADS:
                return tuple(sorted({Lead(lead.text, False) for lead in found}))
            found = longer
        return tuple(sorted(found))

    def _join(self, one: str, two: str) -> str:
        if self._keys or not one or not two:
            return one + two
        return join((one, two))
