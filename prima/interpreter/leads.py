"""What the parts of a grammar begin with: of very many alternatives only a few are tried.

Beginnings are compared without spaces, so that it does not matter where a script has some. An
alternative that an index leaves out cannot match; one that it gives may.
"""

from __future__ import annotations

from typing import NamedTuple

from prima.interpreter.grammar import Choice, Grammar, Index, Part, Reference, Sequence, Tag, Words

FEW = 8
"""So many alternatives are all tried."""
MOST_LEADS = 16
"""How many beginnings of one part are told apart."""
MOST_LETTERS = 200
"""How long a beginning is that is still looked beyond."""
MAX_DEPTH = 40
"""How deep in parts and rules beginnings are looked for."""


class Lead(NamedTuple):
    """One way in which a part begins."""

    text: str
    """Folded, without spaces; every match that begins in this way begins with this text."""
    whole: bool
    """Whether the text is the whole match."""


NOTHING = (Lead("", True),)
UNKNOWN = (Lead("", False),)
Leads = tuple[Lead, ...]


def index_choices(grammar: Grammar) -> None:
    """Index the alternatives of a grammar whose references all lead to rules."""
    finder = _Finder(grammar)
    todo: list[Part] = list(grammar.rules.values())
    while todo:
        part = todo.pop()
        if isinstance(part, Choice):
            if len(part.parts) > FEW:
                part.index = finder.index(part.parts)
            todo += part.parts
        elif isinstance(part, Sequence):
            todo += part.parts


class _Finder:
    """Finds the beginnings of parts, each once."""

    def __init__(self, grammar: Grammar) -> None:
        self._rules = grammar.rules
        self._known: dict[int, Leads] = {}

    def index(self, parts: list[Part]) -> Index:
        by_lead: dict[str, list[int]] = {}
        others: list[int] = []
        for number, part in enumerate(parts):
            texts = {lead.text for lead in self._leads(part, 0)}
            if "" in texts:
                others.append(number)
                continue
            for text in texts:
                by_lead.setdefault(text, []).append(number)
        return Index(by_lead, sorted({len(text) for text in by_lead}), others)

    def _leads(self, part: Part, depth: int) -> Leads:
        """In which ways a part begins; none at all if nothing matches it."""
        match part:
            case Words(words):
                return (Lead(words.replace(" ", ""), True),)
            case Tag():
                return NOTHING
        known = self._known.get(id(part))
        if known is None:
            self._known[id(part)] = UNKNOWN  # while it is looked for: it may refer to itself
            known = self._known[id(part)] = self._find(part, depth + 1)
        return known

    def _find(self, part: Part, depth: int) -> Leads:
        if depth > MAX_DEPTH:
            return UNKNOWN
        match part:
            case Reference(rule):
                return self._leads(self._rules[rule], depth)
            case Choice(parts):
                return self._union(parts, depth)
            case Sequence(_, _, 0):
                return NOTHING
            case Sequence(parts, low, high):
                once = self._sequence(parts, depth)
                if high > 1:
                    once = tuple(Lead(lead.text, False) for lead in once)
                return once if low else (*NOTHING, *once)
        return UNKNOWN

    def _union(self, parts: list[Part], depth: int) -> Leads:
        found: set[Lead] = set()
        for part in parts:
            found.update(self._leads(part, depth))
            if len(found) > MOST_LEADS:
                return UNKNOWN
        return tuple(found)

    def _sequence(self, parts: list[Part], depth: int) -> Leads:
        """The beginnings of parts one after another."""
        found: set[Lead] = set(NOTHING)
        for part in parts:
            if isinstance(part, Tag):
                continue
            begun = [lead for lead in found if lead.whole]
            if not begun:
                break
            longer = {lead for lead in found if not lead.whole}
            for then in self._leads(part, depth):
                for one in begun:
                    text = one.text + then.text
                    longer.add(Lead(text, then.whole and len(text) < MOST_LETTERS))
            if len(longer) > MOST_LEADS:
                return tuple({Lead(lead.text, False) for lead in found})
            found = longer
        return tuple(found)
