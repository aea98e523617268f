"""Answers to a question or a link: options, grammars, and built-in types of PRIMA's language."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from prima.grammar.text import fold

if TYPE_CHECKING:
    from prima.grammar.grammar import Grammar
    from prima.messages import Json
    from prima.script.budget import Budget

Tell = Callable[[str], None]
TYPES = ("boolean", "number", "digits", "date", "time", "text")
"""The built-in types of PRIMA's own language; :mod:`prima.grammar.types` reads them."""


@dataclass(slots=True)
class Answers:
    """The answers to a question or a link: options first, then grammars, then its built-in type."""

    options: dict[str, Json] = field(default_factory=dict)
    grammars: Sequence[Grammar] = ()
    type: str = ""

    def match(self, text: str, budget: Budget | None = None, tell: Tell | None = None) -> Json:
        """The value of an utterance, or None if it is not an answer.

        A grammar with a failing tag does not take the utterance; ``tell`` gets the reason.
        """
        said = fold(text)
        if said in self.options:
            return self.options[said]
        for grammar in self.grammars:
            for found in grammar.match(text, budget=budget):
                if found.error is None:
                    return found.text if found.interpretation is None else found.interpretation
                if tell is not None:
                    tell(str(found.error))
        if not self.type:
            return None
        from prima.grammar.types import read  # most questions have none

        return read(self.type, text)

    def in_grammar(self, text: str) -> bool:
        """Whether an utterance is an answer none of whose words are free, as GARBAGE takes them."""
        known = replace(self, type="" if self.type == "text" else self.type, grammars=())
        return known.match(text) is not None or any(
            found.error is None and found.confidence == 1
            for grammar in self.grammars
            for found in grammar.match(text)
        )
