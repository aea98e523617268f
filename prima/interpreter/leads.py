"""What the parts of a grammar in PRIMA's own language begin with.

Beginnings are compared without spaces, so that it does not matter where a script has some.
"""

from __future__ import annotations

from prima.grammar.prefixes import NOTHING, UNKNOWN, Finder, Lead, Leads
from prima.interpreter.grammar import Choice, Grammar, Index, Part, Reference, Sequence, Tag, Words


def index_choices(grammar: Grammar) -> None:
    """Index the alternatives of a grammar whose references all lead to rules."""
    finder = _Finder(grammar)
    for choice in grammar.large():
        by_lead, others = finder.table(choice.parts)
        choice.index = Index(by_lead, sorted({len(text) for text in by_lead}), others)


class _Finder(Finder[Part]):
    def __init__(self, grammar: Grammar) -> None:
        super().__init__()
        self._rules = grammar.rules

    def simple(self, part: Part) -> Leads | None:
        match part:
            case Words(words):
                return (Lead(words.replace(" ", ""), True),)
            case Tag():
                return NOTHING
        return None

    def composed(self, part: Part, depth: int) -> Leads:
        match part:
            case Reference(rule):
                return self.leads(self._rules[rule], depth)
            case Choice(parts):
                return self.any_of(parts, depth)
            case Sequence(_, _, 0):
                return NOTHING
            case Sequence(parts, low, high):
                return self.repeated(self.in_turn(parts, depth), low, high > 1)
        return UNKNOWN

    def join(self, one: str, two: str) -> str:
        return one + two
