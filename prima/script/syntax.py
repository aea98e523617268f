"""Checks by the engine whether code is ECMAScript, and where it is not."""

from __future__ import annotations

import json
import re
from typing import Any

import _quickjs as quickjs

from prima.script.evaluation import ScriptError
from prima.script.names import script_names
from prima.script.parse import CLOSING, MOST_CODE, lone_bracket
from prima.script.sandbox import MEMORY_LIMIT, STACK_LIMIT, reason

MOST_NAMES = 5_000
"""Maximum number of names declared by one script: the engine compares each with all others."""
TIME_LIMIT = 0.5
"""Seconds of processor time that one evaluation may take."""
FAILURES = (
    *(quickjs.JSException, quickjs.StackOverflow),
    *(TypeError, ValueError, OverflowError, MemoryError, SystemError),
)
"""Exceptions of the engine, and of the binding for values that it cannot convert to Python."""


def confined(memory: int = MEMORY_LIMIT) -> Any:
    """A new engine with the limits of all engines, and so many bytes."""
    context = quickjs.Context()
    context.set_memory_limit(memory)
    context.set_max_stack_size(STACK_LIMIT)
    context.set_time_limit(TIME_LIMIT)
    return context


CALLED = re.compile(r"<input>:(\d+):(\d+)")


def script_error(error: Exception) -> ScriptError:
    """An exception of the engine in our words, with the places on the call stack."""
    text = str(error)
    message = reason(text or type(error).__name__, TIME_LIMIT)
    # The outermost place is in this code; inner ones may be in a function declared elsewhere.
    # The first line is ours: an error there is reported at the beginning of the code.
    found = [(int(line), int(column)) for line, column in CALLED.findall(text)]
    return ScriptError(
        message, [(line - 1, column) if line > 1 else (1, 1) for line, column in found]
    )


DECLARE = "((F, read) => (body) => { new F(read(body)); })(Function, JSON.parse)"
"""Compiles the body of a function, given as JSON; created once, as that takes as long."""
MOST_SOUND, LONG_CODE = 20_000, 500
"""The size of the cache of compiled code, and the maximum length of code in it."""


OF_BRACKETS = re.compile(r"expecting '|nexpected token")
"""What the engine says where a bracket may lack the other one."""
PLACE = re.compile(r"<(?:input|anonymous|evalScript)>:(\d+):(\d+)")


class Syntax:
    """Compiles code by itself, without running it."""

    now, spent = 0, 0.0

    def __init__(self, context: Any = None) -> None:
        self._declare = (context or confined()).eval(DECLARE)
        self._sound: set[str] = set()
        """Expressions compiled successfully."""
        self._lenient: dict[str, str] = {}

    def expression(self, code: str) -> None:
        """Compile an expression by itself, so that its brackets cannot close ours.

        Raises:
            ScriptError: with the line and column inside the expression.
        """
        if code in self._sound:
            return
        self._compile(code, f"return (\n{code}\n)")
        self._compile(code, f"return [\n{code}\n]")  # code that closes one fails in the other
        if len(code) <= LONG_CODE and len(self._sound) < MOST_SOUND:
            self._sound.add(code)

    def script(self, code: str) -> None:
        """Compile a script by itself.

        Raises:
            ScriptError: with the line and column inside the script.
        """
        if len(code) > MOST_CODE:
            raise ScriptError(f"it has more than {MOST_CODE:,} characters")
        if len(declared := script_names(code).declared) > MOST_NAMES:
            raise ScriptError(f"it declares {len(declared):,} names, more than {MOST_NAMES:,}")
        self._compile(code, f"return [function () {{\n{code}\n}}]")
        self._compile(code, f"return (function () {{\n{code}\n}})")

    def lenient(self, code: str) -> str:
        """Convert an expression of other platforms, ``x = 1; x + 1`` or nothing, to ECMAScript.

        Several statements give the value of the last, no statement gives undefined.
        """
        kept = self._lenient.get(code)
        if kept is None:
            several = self.has_statements(code)
            # Its lines are counted as those of any (``statement_place``).
            kept = self._lenient[code] = f"eval({json.dumps(chr(10) + code)})" if several else code
        return kept

    def faults(self, codes: list[tuple[str, bool]]) -> list[tuple[str, int, int] | None]:
        """The errors of several codes, with line and column; None for correct ones.

        Args:
            codes: the codes, and whether they are scripts.
        """
        found: list[tuple[str, int, int] | None] = []
        for code, is_script in codes:
            try:
                (self.script if is_script else self.expression)(code)
                found.append(None)
            except ScriptError as error:
                found.append((str(error), error.line, error.column))
        return found

    def has_statements(self, code: str) -> bool:
        """Whether code that should be one expression is a script instead."""
        try:
            self.expression(code)
        except ScriptError:
            try:
                self.script(code)
            except ScriptError:
                return False
            return True
        return False

    def _compile(self, code: str, body: str) -> None:
        try:
            self._declare(json.dumps(body))
        except (quickjs.JSException, quickjs.StackOverflow) as error:
            raise _placed(str(error) or type(error).__name__, code) from None


def column_in(code: str, line: int, column: int) -> int:
    """Convert a column of the engine, which counts bytes, to characters."""
    if code.isascii() or line <= 0:
        return column
    there = code.split("\n", line)[line - 1 : line] or [""]
    seen = there[0].encode(errors="replace")[: max(column - 1, 0)]
    return len(seen.decode(errors="ignore")) + 1


def _place(code: str, at: int) -> tuple[int, int]:
    """The line and column of an offset."""
    return code.count("\n", 0, at) + 1, at - code.rfind("\n", 0, at)


def _alone(code: str, bracket: str, at: int) -> ScriptError:
    """The error of code with a bracket at an offset that lacks the other one."""
    lacks = "is not closed" if bracket in CLOSING else "closes nothing"
    return ScriptError(f'its "{bracket}" {lacks}', place=_place(code, at))


def _placed(said: str, code: str) -> ScriptError:
    """The engine's error with its place in the code, without our lines around it."""
    place = PLACE.search(said)
    line, column = (int(place[1]) - 3, int(place[2])) if place else (0, 0)
    beyond = line > code.count("\n") + 1
    if beyond or OF_BRACKETS.search(said):
        if lone := lone_bracket(code):
            return _alone(code, *lone)
        if beyond:
            return ScriptError("it ends too early", place=_place(code, len(code)))
    there = (line, column_in(code, line, column)) if line > 0 else None
    return ScriptError(reason(said, TIME_LIMIT), place=there)
