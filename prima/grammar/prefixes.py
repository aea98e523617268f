"""What the parts of a grammar begin with: so that of many alternatives only few are tried.

The grammars of both languages are indexed so. An alternative that an index leaves out cannot
match; one that it gives may.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Generic, NamedTuple, TypeVar

MOST_LEADS = 16
"""How many beginnings of one part are told apart."""
MOST_LETTERS = 200
"""How long a beginning is that is still looked beyond."""
MAX_DEPTH = 40
"""How deep in parts and rules beginnings are looked for."""


class Lead(NamedTuple):
    """One way in which a part begins."""

    text: str
    """Folded; every match that begins in this way begins with this text."""
    whole: bool
    """Whether the text is the whole match."""


Leads = tuple[Lead, ...]
NOTHING: Leads = (Lead("", True),)
UNKNOWN: Leads = (Lead("", False),)
Part = TypeVar("Part")


class Finder(Generic[Part]):
    """Finds the beginnings of parts, each once."""

    def __init__(self) -> None:
        self._known: dict[int, Leads] = {}

    def simple(self, part: Part) -> Leads | None:
        """How a part begins that holds no others; None of one that does."""
        raise NotImplementedError

    def composed(self, part: Part, depth: int) -> Leads:
        """How a part begins by what it holds."""
        raise NotImplementedError

    def join(self, one: str, two: str) -> str:
        """A beginning with what comes after it."""
        raise NotImplementedError

    def table(self, parts: Sequence[Part]) -> tuple[dict[str, list[int]], list[int]]:
        """Alternatives, by number, under their beginnings; and those that may begin with anything."""
        by_lead: dict[str, list[int]] = {}
        others: list[int] = []
        for number, part in enumerate(parts):
            texts = {lead.text for lead in self.leads(part, 0)}
            if "" in texts:
                others.append(number)
                continue
            for text in texts:
                by_lead.setdefault(text, []).append(number)
        return by_lead, others

    def leads(self, part: Part, depth: int) -> Leads:
        """In which ways a part begins; none at all if nothing matches it."""
        simple = self.simple(part)
        if simple is not None:
            return simple
        known = self._known.get(id(part))
        if known is None:
            self._known[id(part)] = UNKNOWN  # while it is looked for: it may refer to itself
            found = UNKNOWN if depth >= MAX_DEPTH else self.composed(part, depth + 1)
            known = self._known[id(part)] = found
        return known

    def any_of(self, parts: Sequence[Part], depth: int) -> Leads:
        """The beginnings of alternatives."""
        found: set[Lead] = set()
        for part in parts:
            found.update(self.leads(part, depth))
            if len(found) > MOST_LEADS:
                return UNKNOWN
        return tuple(sorted(found))

    def in_turn(self, parts: Sequence[Part], depth: int) -> Leads:
        """The beginnings of parts one after another."""
        found: set[Lead] = set(NOTHING)
        for part in parts:
            leads = self.leads(part, depth)
            if leads == NOTHING:
                continue
            begun = [lead for lead in found if lead.whole]
            if not begun:
                break
            longer = {lead for lead in found if not lead.whole}
            for then in leads:
                for one in begun:
                    text = self.join(one.text, then.text)
                    longer.add(Lead(text, then.whole and len(text) < MOST_LETTERS))
            if len(longer) > MOST_LEADS:
                return tuple(sorted({Lead(lead.text, False) for lead in found}))
            found = longer
        return tuple(sorted(found))

    @staticmethod
    def repeated(once: Leads, low: int, more: bool) -> Leads:
        """The beginnings of what comes once or ``more`` than once, or if ``low`` is 0 not at all."""
        if more:
            once = tuple(Lead(lead.text, False) for lead in once)
        return once if low else (*NOTHING, *once)
