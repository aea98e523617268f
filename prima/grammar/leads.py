"""What the expansions of an SRGS grammar begin with."""

from __future__ import annotations

from collections.abc import Iterable

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
from prima.grammar.prefixes import NOTHING, UNKNOWN, Finder, Lead, Leads
from prima.grammar.text import join


def index_choices(documents: Iterable[Document]) -> None:
    """Index the alternatives of all rules of some documents, whose references are resolved."""
    for document in documents:
        finder = _Finder(document.mode == "dtmf")
        for rule in document.rules.values():
            todo: list[Part] = [rule.body]
            while todo:
                part = todo.pop()
                if isinstance(part, Choice):
                    by_lead, others = finder.table(part.parts)
                    lengths = sorted({len(text) for text in by_lead})
                    part.index = LeadIndex(by_lead, lengths, others, sorted(by_lead))
                    todo += part.parts
                elif isinstance(part, Sequence):
                    todo += part.parts
                elif isinstance(part, Repeat):
                    todo.append(part.part)


class _Finder(Finder[Part]):
    def __init__(self, keys: bool) -> None:
        super().__init__()
        self._keys = keys

    def simple(self, part: Part) -> Leads | None:
        match part:
            case Words(folded):
                return (Lead(folded, True),)
            case Tag() | Special("NULL"):
                return NOTHING
            case Special("VOID"):
                return ()
        return None

    def composed(self, part: Part, depth: int) -> Leads:
        match part:
            case Sequence(parts):
                return self.in_turn(parts, depth)
            case Choice(parts):
                return self.any_of(parts, depth)
            case Repeat(_, _, 0):
                return NOTHING
            case Repeat(inner, low, high):
                return self.repeated(self.leads(inner, depth), low, high != 1)
            case Reference(rule=rule) if rule is not None:
                return self.leads(rule.body, depth)
        return UNKNOWN

    def join(self, one: str, two: str) -> str:
        if self._keys or not one or not two:
            return one + two
        return join((one, two))
