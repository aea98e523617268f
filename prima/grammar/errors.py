"""Errors of grammars, divided by how a caller handles them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from prima.errors import DocumentError, Hint, Place, Problem, suggestion
from prima.errors.problems import Span
from prima.errors.words import one_of

MOST_PROBLEMS = 100
"""Maximum number of problems reported for one grammar."""
MOST_RULES = 5
"""Maximum number of rules that a remedy names."""


class GrammarError(DocumentError):
    """A grammar is not legal; ``problems`` lists what is wrong, with places and remedies."""


class UnsupportedFormat(GrammarError):
    """The grammar's format is not SRGS, or the format of its tags is unknown."""


class UnsupportedLanguage(GrammarError):
    """The grammar is in a language that the caller does not accept."""


class UnsupportedBuiltIn(GrammarError):
    """There is no such built-in type, or it does not have such parameters."""


class NotThere(LookupError):
    """A grammar's file cannot be read; ``meant`` is the name of another, probably meant."""

    def __init__(self, why: str, meant: str = "") -> None:
        super().__init__(why)
        self.meant = meant


Where = Callable[[], Place]
"""Computes a place on demand."""


class Problems:
    """Collects what is wrong while a grammar is read."""

    def __init__(self) -> None:
        self.found: list[Problem] = []
        self.warnings: list[Problem] = []
        """Warnings: what is accepted and yet reported."""
        self.kind: type[GrammarError] = GrammarError

    @property
    def full(self) -> bool:
        """Whether the maximum has been reached."""
        return len(self.found) >= MOST_PROBLEMS

    def note(self, where: Where, code: str, message: str, remedy: str | Hint = "") -> None:
        """Note a problem, up to the maximum."""
        if not self.full:
            self.found.append(Problem(where(), "error", code, message, remedy))

    def warn(self, where: Where, code: str, message: str, remedy: str | Hint = "") -> None:
        """Note something accepted that is better written in another way."""
        if len(self.warnings) < MOST_PROBLEMS:
            self.warnings.append(Problem(where(), "warning", code, message, remedy))

    def unsupported(
        self, kind: type[GrammarError], where: Where, code: str, message: str, remedy: str = ""
    ) -> None:
        """Note something legal but unsupported; it determines the error unless more is wrong."""
        if not self.found:
            self.kind = kind
        self.note(where, code, message, remedy)

    def extend(self, problems: Iterable[Problem]) -> None:
        """Add the problems of another document."""
        self.found.extend(list(problems)[: MOST_PROBLEMS - len(self.found)])

    def check(self) -> None:
        """Stop reading if anything was noted.

        Raises:
            GrammarError: with all problems.
        """
        if self.found:
            raise self.kind(self.found)


def other_rule(name: str, known: Iterable[str], *spans: Span) -> Hint:
    """The remedy for an unknown rule: the nearest known one, or the first few."""
    rules = [one for one in known if one]
    there = Hint(f"Write {one_of(rules, MOST_RULES)}." if rules else "Define it.")
    return suggestion(name, rules, *spans) or there
