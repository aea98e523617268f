"""What can be wrong with a grammar, divided by what a caller does about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from prima.errors import DocumentError, Hint, Place, Problem

MOST_PROBLEMS = 100
"""Problems of one grammar that are reported."""


class GrammarError(DocumentError):
    """A grammar is not legal; ``problems`` has everything that is wrong, with places and remedies."""


class UnsupportedFormat(GrammarError):
    """What the grammar is written in is not SRGS, or its tags are of an unknown format."""


class UnsupportedLanguage(GrammarError):
    """The grammar is in a language that the caller does not take."""


class UnsupportedBuiltIn(GrammarError):
    """There is no such built-in type, or it does not have such parameters."""


Where = Callable[[], Place]
"""Gives a place on demand."""


class Problems:
    """Collects what is wrong while a grammar is read."""

    def __init__(self) -> None:
        self.found: list[Problem] = []
        self.warnings: list[Problem] = []
        """What is accepted and yet reported."""
        self.kind: type[GrammarError] = GrammarError

    @property
    def full(self) -> bool:
        """Whether there are so many that no more are reported."""
        return len(self.found) >= MOST_PROBLEMS

    def note(self, where: Where, code: str, message: str, remedy: str | Hint = "") -> None:
        """Note one thing; after many, no more are looked at."""
        if not self.full:
            self.found.append(Problem(where(), "error", code, message, remedy))

    def warn(self, where: Where, code: str, message: str, remedy: str | Hint = "") -> None:
        """Note what is accepted, and yet better written in another way."""
        if len(self.warnings) < MOST_PROBLEMS:
            self.warnings.append(Problem(where(), "warning", code, message, remedy))

    def unsupported(
        self, kind: type[GrammarError], where: Where, code: str, message: str, remedy: str = ""
    ) -> None:
        """Note what is legal but not supported; it decides the error unless more is wrong."""
        if not self.found:
            self.kind = kind
        self.note(where, code, message, remedy)

    def extend(self, problems: Iterable[Problem]) -> None:
        """Take over what another document has."""
        self.found.extend(list(problems)[: MOST_PROBLEMS - len(self.found)])

    def check(self) -> None:
        """End the reading if anything was noted.

        Raises:
            GrammarError: with all problems.
        """
        if self.found:
            raise self.kind(self.found)


def refuse(
    kind: type[GrammarError], place: Place, code: str, message: str, remedy: str = ""
) -> GrammarError:
    """An error of one problem."""
    return kind([Problem(place, "error", code, message, remedy)])
