"""Some answers that a question takes, to offer to users who type, or to spot in what is heard."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from prima.grammar.answers import Answers
from prima.grammar.model import (
    Alternatives,
    BuiltIn,
    Part,
    Reference,
    Repeat,
    Sequence,
    Special,
    Tag,
    Words,
)

MOST = 30
"""Maximum number of phrases."""
DEEP = 12
"""Maximum depth of nested parts."""
STEPS = 2000
"""Maximum number of expansions."""
TYPES = {"boolean": ["yes", "no"]}
"""Answers of built-in types with few values."""


def phrases(answers: Answers, most: int = MOST) -> list[str]:
    """Some answers that a field takes, folded, the shortest first."""
    found = dict.fromkeys(islice(answers.options, most))
    for grammar in answers.grammars:
        found |= dict.fromkeys(islice(_Phrases(most).of(grammar.expansion), most))
    found |= dict.fromkeys(TYPES.get(answers.type, ()))
    return sorted(filter(None, found), key=lambda phrase: len(phrase.split()))[:most]


class _Phrases:
    """Some phrases of one grammar, found in a bounded number of steps."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._left = STEPS

    def of(self, part: Part, depth: int = 0) -> Iterator[str]:
        """Phrases of an expansion, with each repeatable part as often as needed, and once."""
        self._left -= 1
        if depth > DEEP or self._left < 0:
            return
        match part:
            case Words(words):
                yield words
            case BuiltIn(name):
                yield from TYPES.get(name, ())
            case Tag() | Special("NULL") | Repeat(high=0):
                yield ""
            case Reference(rule=rule) if rule is not None:
                yield from self.of(rule.body, depth + 1)
            case Alternatives(parts):
                for one in parts:
                    yield from islice(self.of(one, depth + 1), self._most)
            case Sequence(parts):
                yield from self._joined(parts, depth + 1)
            case Repeat(inner, low) if low <= STEPS:
                yield from self._joined([inner] * max(low, 1), depth + 1)
                if not low:
                    yield ""

    def _joined(self, parts: list[Part], depth: int) -> list[str]:
        """Phrases of parts one after another."""
        found = [""]
        for part in parts:
            then = list(islice(self.of(part, depth), self._most))
            found = [" ".join(filter(None, (one, two))) for one in found for two in then][
                : self._most
            ]
        return found
