"""What evaluating code of documents gives, and how it fails, whoever evaluates it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from prima.messages import Json

Scope = Any
"""A scope object, of whatever kind the evaluator has."""

MAX_SCRIPT_SECONDS = 3.0
"""What an application's code may take in one instant, all together."""
MAX_RUN_SECONDS = 300.0
"""What an application's code may take in a whole run."""
INSTANT_SECONDS = 120.0
"""What the code of all applications may take in one instant of a run, by the clock on the wall."""
RESULT_LIMIT = 100_000
"""Characters that a value may have when it leaves its application's scopes."""
SCOPES = ("application", "document", "dialog", "local")
"""The scopes of an expression, outermost first (VoiceXML 5.1.2)."""
LARGEST = 2**53
"""Whole numbers up to here are exact."""


class Pulse:
    """What goes on in this process, for a watchdog in another thread."""

    def __init__(self) -> None:
        self.evaluations = 0
        """How many evaluations by an engine have begun and ended: odd while one runs."""
        self.instants = 0
        """How many instants sessions have gone through."""


PULSE = Pulse()


class ScriptError(Exception):
    """An expression or script failed; becomes ``error.semantic`` in the application."""

    def __init__(self, message: str, places: list[tuple[int, int]] | None = None) -> None:
        super().__init__(message)
        self.places = places or []
        """Lines and columns of the functions that were being called, innermost first."""
        self.line, self.column = self.places[-1] if self.places else (0, 0)


def bounded(text: str) -> str:
    """Text that is not too long to leave its scopes.

    Raises:
        ScriptError: it is.
    """
    if len(text) > RESULT_LIMIT:
        raise ScriptError(f"it gives more than {RESULT_LIMIT:,} characters")
    return text


def plain_number(value: Json) -> Json:
    """A number as JSON has it: whole ones without a point; other values as they are."""
    if isinstance(value, float) and abs(value) < LARGEST and value == int(value):
        return int(value)
    return value


def whole(value: int) -> float:
    """A whole number as ``float``, which is infinite beyond the largest there is."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
