"""Results and errors of evaluating code, for all evaluators."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from prima.messages import Json

Scope = Any
"""A scope object of an evaluator."""

MAX_SCRIPT_SECONDS = 3.0
"""The total time that an application's code may take in one instant."""
MAX_RUN_SECONDS, MAX_SHARE = 10.0, 0.02
"""Limit of the time of an application's code in a run: so many seconds of processor time, plus this
share of the time that passes in the run."""
RESULT_LIMIT = 100_000
"""Maximum length of a value that leaves its application's scopes."""
DEEPEST = 400
"""Maximum depth of lists and objects in such a value, so that Python can read, compare and write it."""
SCOPES = ("application", "document", "dialog", "local")
"""The scopes of an expression, outermost first (VoiceXML 5.1.2)."""
LARGEST = 2**53
"""Whole numbers up to here are exact."""


class ScriptError(Exception):
    """An expression or script failed; becomes ``error.semantic`` in the application."""

    def __init__(
        self,
        message: str,
        places: list[tuple[int, int]] | None = None,
        place: tuple[int, int] | None = None,
    ) -> None:
        """``place`` is the line and column in the code; by default the outermost of ``places``."""
        super().__init__(message)
        self.places = places or []
        """Lines and columns in the functions on the call stack, innermost first."""
        self.line, self.column = place or (self.places[-1] if self.places else (0, 0))


class EngineLost(ScriptError):
    """The process of an engine has ended, and so must the application that uses it (E2)."""


class EngineElement:
    """An element of an array of the engine, which stays there (``Engine.elements``)."""

    __slots__ = ("array", "index")

    def __init__(self, array: Any, index: int) -> None:
        self.array = array
        self.index = index


def statement_place(error: ScriptError) -> tuple[int, int]:
    """The line and column in several statements, which are wrapped in two of our functions."""
    return error.places[-3] if len(error.places) > 2 else (0, 0)


def bounded(text: str) -> str:
    """Check that a text is short enough to leave its scopes.

    Raises:
        ScriptError: it is too long.
    """
    if len(text) > RESULT_LIMIT:
        raise ScriptError(f"it gives more than {RESULT_LIMIT:,} characters")
    return text


def read_json(text: str) -> Json:
    """Read a value that an engine gives as JSON.

    Raises:
        ScriptError: it is too long, or nested too deep.
    """
    try:
        value: Json = json.loads(bounded(text))
    except RecursionError:
        raise ScriptError("it is nested too deep") from None
    level: list[Json] = [value]
    for _ in range(DEEPEST + 1):
        if not level:
            return value
        level = [part for one in level for part in _parts(one)]
    raise ScriptError("it is nested too deep")


def _parts(value: Json) -> Iterable[Json]:
    """What a list or object holds."""
    if isinstance(value, dict):
        return value.values()
    return value if isinstance(value, list) else ()


def plain_number(value: Json) -> Json:
    """A number as in JSON: whole ones without a point; other values unchanged."""
    if isinstance(value, float) and abs(value) < LARGEST and value == int(value):
        return int(value)
    return value


def whole(value: int) -> float:
    """A whole number as ``float``, infinite beyond the largest one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def marked(value: Json) -> Json:
    """Plain data in which numbers that JSON lacks are replaced by objects with an unusual name."""
    if isinstance(value, float) and not math.isfinite(value):
        return {"\0": "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"}
    if isinstance(value, list | tuple):
        return [marked(one) for one in value]
    if isinstance(value, dict):
        return {key: marked(one) for key, one in value.items()}
    return value
