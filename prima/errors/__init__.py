"""Errors, divided by their cause.

The *author* of a document gets a list of :class:`Problem`, all at once, inside
a :class:`DocumentError`. Whoever called the program wrongly, or named something
that cannot be read or written, gets a :class:`UsageError`. A run that had to be
aborted raises a :class:`RunError`. An error of a robot or a service is not an
exception but an event that a document can handle; a programming error is an
assertion.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Self

from prima.errors.diagnosis import Diagnosis
from prima.errors.guesses import (
    did_you_mean,
    few_guesses,
    guessable,
    meant,
    nearest_word,
    replaced,
    suggestion,
)
from prima.errors.problems import (
    LONGEST_TEXT,
    MOST_TOLD,
    SEVERITIES,
    Edit,
    Fix,
    Hint,
    Place,
    Problem,
    Severity,
    Span,
    brief,
    few,
    has_errors,
    in_order,
    listed,
)
from prima.errors.words import argument, counted, one_of, with_article

__all__ = [
    "LONGEST_TEXT", "MOST_TOLD", "SEVERITIES", "TOO_MUCH", "Diagnosis", "DocumentError", "Edit",
    "Fix", "Hint", "MissingFile", "Place", "PrimaError", "Problem", "RunError", "Severity", "Span",
    "UsageError", "argument", "brief", "counted", "did_you_mean", "few", "few_guesses", "guessable", "has_errors",
    "in_order", "listed", "meant", "nearest_word", "one_of", "replaced", "suggestion",
    "with_article",
]  # fmt: skip

TOO_MUCH = (
    "the run made more records, or more text, than a run may."
    " Let what comes again and again in it wait longer each time, or end the run earlier (until)."
)
"""The message for a run that exceeds its limits, with a remedy."""


class PrimaError(Exception):
    """The root of every error that the package raises on purpose."""


class DocumentError(PrimaError):
    """Documents have errors; ``problems`` lists them in document order."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = sorted(problems)
        super().__init__("\n".join(map(str, listed(self.problems))))

    @classmethod
    def of(cls, place: Place, code: str, message: str, remedy: str | Hint = "") -> Self:
        """An error of one problem, because of which a document is not read."""
        return cls([Problem(place, "error", code, message, remedy)])

    def __reduce__(self) -> tuple[type[DocumentError], tuple[list[Problem]]]:
        return type(self), (self.problems,)  # the message is not an argument


class UsageError(PrimaError):
    """The caller asked for something that does not exist or is impossible."""


class MissingFile(UsageError):
    """A file does not exist; ``args`` holds its path."""

    def __str__(self) -> str:
        return f"{self.args[0]}: cannot be read: No such file or directory."


class RunError(PrimaError):
    """A run cannot begin or go on: no process can be started, or a robot is out of reach.

    Functions that give a transcript do not raise it where a run exceeds its limits: ``outcome`` of
    the transcript is ``limit`` then.
    """
