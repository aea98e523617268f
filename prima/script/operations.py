"""Operations of expressions in Python: variables, members and operators.

Work with long texts is counted.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from typing import Any

from prima.script.ecmascript import (
    CONSTANTS,
    UNDEFINED,
    Named,
    Scope,
    Scopes,
    alike,
    index_of,
    number,
    order,
    primitive,
    same,
    text,
    unit,
    units,
)
from prima.script.evaluation import SCOPES, ScriptError
from prima.script.globals import INHERITED, METHODS
from prima.script.surrogates import well_formed

Operation = Callable[[Any, Any, Scopes], Any]

LONGEST = 100_000
"""Maximum length of a text; no longer one could leave the scopes."""
LONGEST_KEY = 63
"""How many bytes of a member's name the engine's messages quote."""
SHORT = 200
"""Length up to which work with a text is not counted."""
HIGH, LOW = frozenset(map(chr, range(0xD800, 0xDC00))), frozenset(map(chr, range(0xDC00, 0xE000)))
"""High and low surrogates."""
MISSING = object()
"""The value of an undeclared variable."""


def sought(name: str, line: int, column: int, scopes: Scopes) -> Any:
    """A variable outside of the usual scopes.

    Raises:
        ScriptError: it is undeclared.
    """
    value = found(name, scopes, MISSING)
    if value is MISSING:
        raise ScriptError(f"ReferenceError: {name} is not defined", [(line, column)])
    return value


def found(name: str, scopes: Scopes, otherwise: Any = UNDEFINED) -> Any:
    """A variable's value, or ``otherwise`` if it is undeclared."""
    for scope in reversed(scopes):
        if name in scope:
            return scope[name]
    if name in CONSTANTS:
        return CONSTANTS[name]
    if name in SCOPES and isinstance(scope := scopes[SCOPES.index(name)], Named):
        return scope
    return otherwise


def holder_of(name: str, scopes: Scopes) -> Scope:
    """The innermost scope that has a variable, by its name as written.

    Raises:
        ScriptError: no scope declares it.
    """
    inner, _, last = name.rpartition(".")
    for scope in (scopes[SCOPES.index(inner)],) if inner else reversed(scopes):
        if last in scope:
            return scope
    raise ScriptError(f'ReferenceError: the variable "{name}" is not declared')


def member(value: Any, key: str, index: int, line: int, column: int, scopes: Scopes) -> Any:
    """A member of a value, by its name and the name as an index."""
    if isinstance(value, dict):
        if isinstance(value, Named) and key == value.name and key not in value:
            return value
        return value.get(key, UNDEFINED)
    if value is None or value is UNDEFINED:
        raise _unreadable(key, value, line, column)
    if isinstance(value, str):
        work(scopes, value)
        return float(units(value)) if key == "length" else unit(value, index)
    if not isinstance(value, list):
        return UNDEFINED
    if key == "length":
        return float(len(value))
    return value[index] if 0 <= index < len(value) else UNDEFINED


def member_of(value: Any, name: Any, line: int, column: int, scopes: Scopes) -> Any:
    """A member of a value, whose name is a value itself.

    Raises:
        ScriptError: the value is null or undefined, or the name is that of a built-in function,
            which Python does not have.
    """
    if value is None or value is UNDEFINED:
        key = "{}" if isinstance(name, list | dict) else text(name)
        raise _unreadable(key, value, line, column)
    key = _key(name, scopes)
    if type(value) is dict and key in value:
        return value[key]
    if _is_built_in(key, value):
        raise _built_in(key, line, column)
    return member(value, key, index_of(key), line, column, scopes)


def has_member(name: Any, value: Any, line: int, column: int, scopes: Scopes) -> bool:
    """``in``: whether a value has a member with a name.

    Raises:
        ScriptError: the value is neither an array nor an object, or as :func:`member_of`.
    """
    if not isinstance(value, list | dict):
        raise ScriptError("TypeError: invalid 'in' operand", [(line, column)])
    key = _key(name, scopes)
    if isinstance(value, dict) and (key in value or key == getattr(value, "name", None)):
        return True
    if _is_built_in(key, value):
        raise _built_in(key, line, column)
    if isinstance(value, dict):
        return False
    return key == "length" or 0 <= index_of(key) < len(value)


def _key(name: Any, scopes: Scopes) -> str:
    work(scopes, name)
    return text(primitive(name))


def _is_built_in(key: str, value: Any) -> bool:
    return key in INHERITED or (key in METHODS and not isinstance(value, dict))


def _built_in(key: str, line: int, column: int) -> ScriptError:
    message = f"TypeError: '{key}' is the name of a function that all such values have"
    return ScriptError(message, [(line, column)])


def _unreadable(key: str, value: Any, line: int, column: int) -> ScriptError:
    """The error of reading a member of null or undefined, in the engine's words: one line of text
    that can be written, whatever the name is."""
    whole = well_formed(key[:LONGEST_KEY]).partition("\0")[0].encode()
    quoted = whole[:LONGEST_KEY].decode(errors="ignore")
    message = f"TypeError: cannot read property '{quoted}' of {text(value)}"
    return ScriptError(message.splitlines()[0], [(line, column)])


def work(scopes: Scopes, value: Any) -> None:
    """Count work with a value that may be long.

    Raises:
        ScriptError: the application has taken too long in this instant.
    """
    if isinstance(value, str | list) and len(value) > SHORT:
        count = getattr(scopes[0], "count", None)
        if count is not None:
            count(len(value))


def equal(first: Any, second: Any, scopes: Scopes) -> bool:
    """``==``, with the work counted."""
    if type(first) is float and type(second) is float:
        return first == second
    work(scopes, first)
    work(scopes, second)
    return alike(first, second)


def identical(first: Any, second: Any, scopes: Scopes) -> bool:
    """``===``, with the work counted."""
    work(scopes, first)
    work(scopes, second)
    return same(first, second)


def numeric(value: Any, scopes: Scopes) -> float:
    """A value as a number, with the work counted."""
    if type(value) is float:
        return value
    work(scopes, value)
    return number(value)


def textual(value: Any, scopes: Scopes) -> str:
    """A value as text, with the work counted."""
    work(scopes, value)
    return text(value)


def add(first: Any, second: Any, scopes: Scopes) -> Any:
    """``+``, which joins texts as well."""
    if type(first) is float and type(second) is float:
        return first + second
    first, second = primitive(first), primitive(second)
    if not isinstance(first, str) and not isinstance(second, str):
        return number(first) + number(second)
    joined = join(text(first), text(second))
    if len(joined) > SHORT:
        if len(joined) > LONGEST:
            raise ScriptError("it used too much memory")
        work(scopes, joined)
    return joined


def join(first: str, second: str) -> str:
    """Two texts joined, with a surrogate pair at the joint combined."""
    if first[-1:] in HIGH and second[:1] in LOW:
        pair = (first[-1] + second[0]).encode("utf-16-le", "surrogatepass").decode("utf-16-le")
        return first[:-1] + pair + second[1:]
    return first + second


def _arithmetic(act: Callable[[float, float], float]) -> Operation:
    def calculate(first: Any, second: Any, scopes: Scopes) -> float:
        return act(numeric(first, scopes), numeric(second, scopes))

    return calculate


def _comparison(act: Callable[[Any, Any], bool]) -> Operation:
    def compare(first: Any, second: Any, scopes: Scopes) -> bool:
        if type(first) is float and type(second) is float:
            return act(first, second)
        first, second = primitive(first), primitive(second)
        if isinstance(first, str) and isinstance(second, str):
            if first.isascii() and second.isascii():
                return act(first, second)
            work(scopes, first)
            work(scopes, second)
            return act(order(first), order(second))
        return act(numeric(first, scopes), numeric(second, scopes))

    return compare


def divide(first: float, second: float) -> float:
    """Division, which is defined for zero as well."""
    if second:
        return first / second
    if first == 0 or first != first or second != second:
        return math.nan
    return math.copysign(math.inf, first) * math.copysign(1, second)


def remainder(first: float, second: float) -> float:
    """The remainder, with the sign of the dividend."""
    if second == 0 or math.isinf(first):
        return math.nan
    return math.fmod(first, second)


subtract, multiply = _arithmetic(operator.sub), _arithmetic(operator.mul)
divided, remaining = _arithmetic(divide), _arithmetic(remainder)
less, more = _comparison(operator.lt), _comparison(operator.gt)
at_most, at_least = _comparison(operator.le), _comparison(operator.ge)

OPERATIONS: dict[str, Operation] = {
    "==": equal, "===": identical, "<": less, ">": more, "<=": at_most, ">=": at_least,
    "+": add, "-": subtract, "*": multiply, "/": divided, "%": remaining,
    "!=": lambda first, second, scopes: not equal(first, second, scopes),
    "!==": lambda first, second, scopes: not identical(first, second, scopes),
}  # fmt: skip
"""Operators of two values."""
