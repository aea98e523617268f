"""ECMAScript's values in Python, and their conversions (ECMAScript 2024, chapter 7).

The values are Python's: ``float``, ``str``, ``bool``, ``None`` (null), :data:`UNDEFINED`, ``list``
and ``dict``.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from prima.script.evaluation import LARGEST, ScriptError, bounded, plain_number, whole
from prima.script.surrogates import SURROGATE, well_formed

if TYPE_CHECKING:
    from prima.messages import Json


class Undefined:
    """The type of :data:`UNDEFINED`."""

    def __repr__(self) -> str:
        return "undefined"


UNDEFINED = Undefined()
"""The value of an uninitialised variable."""


class Scope(dict[str, Any]):
    """The variables of an application, document, dialog or piece of content."""

    __slots__ = ("__weakref__",)


class Named(Scope):
    """A scope that its own expressions know by name: ``application``, ``document``, ``dialog``."""

    __slots__ = ("count", "name")
    name: str
    """Its name: a scope contains itself as a variable."""
    count: Callable[[int], None]
    """Counts work with so many characters, in an application's scope."""


Scopes = tuple[Scope, Scope, Scope, Scope]
"""The scopes that an expression sees: application, document, dialog and local."""

DEEPEST = 100
"""Maximum nesting of lists and objects in a value from outside."""
CONSTANTS = {"undefined": UNDEFINED, "NaN": math.nan, "Infinity": math.inf}
SPACE = " \t\n\v\f\r\xa0\ufeff\u1680\u2000\u2001\u2002\u2003\u2004\u2005\u2006\u2007\u2008\u2009\u200a\u2028\u2029\u202f\u205f\u3000"
"""White space in ECMAScript."""
NUMERIC = re.compile(
    r"[+-]?(?:Infinity|(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)(?:[eE][+-]?[0-9]++)?)"
    r"|0[xX][0-9a-fA-F]++|0[oO][0-7]++|0[bB][01]++"
)
INDEX = re.compile("0|[1-9][0-9]{0,9}")
MOST_INDEX = 2**32 - 2


def truth(value: Any) -> bool:
    """A value as a condition (7.1.2)."""
    if value is True or value is False:
        return bool(value)
    if isinstance(value, list | dict):
        return True
    return value is not UNDEFINED and bool(value) and value == value


def primitive(value: Any) -> Any:
    """An array or object converted to a primitive value (7.1.1)."""
    return text(value) if isinstance(value, list | dict) else value


def number(value: Any) -> float:
    """A value as a number (7.1.4)."""
    if isinstance(value, float):
        return value
    if value is None or isinstance(value, bool):
        return float(value or 0)
    if value is UNDEFINED:
        return math.nan
    code = text(value).strip(SPACE)
    if not code:
        return 0.0
    if NUMERIC.fullmatch(code) is None:
        return math.nan
    return whole(int(code, 0)) if code[1:2] in tuple("xXoObB") else float(code)


def text(value: Any) -> str:
    """A value as text (7.1.17)."""
    if isinstance(value, str):
        return value
    if isinstance(value, float):
        return number_text(value)
    if value is None or isinstance(value, bool):
        return "null" if value is None else str(value).lower()
    if isinstance(value, list):
        return ",".join("" if one is None or one is UNDEFINED else text(one) for one in value)
    if isinstance(value, dict):
        if "toString" in value:  # not a function
            raise ScriptError("TypeError: toPrimitive")
        return "[object Object]"
    return "undefined"


def number_text(value: float) -> str:
    """A number as text (6.1.6.1.20)."""
    if value != value or math.isinf(value):
        return "NaN" if value != value else "Infinity" if value > 0 else "-Infinity"
    if value == int(value) and abs(value) < LARGEST:
        return str(int(value))
    found, _, exponent = repr(value).partition("e")
    power = int(exponent or 0)
    sign, digits = ("-", found[1:]) if found[0] == "-" else ("", found)
    if -7 < power < 0:
        return f"{sign}0.{'0' * (-power - 1)}{digits.replace('.', '')}"
    if 0 < power < 21:
        return sign + digits.replace(".", "").ljust(power + 1, "0")
    return f"{sign}{digits}e{power:+d}" if exponent else sign + digits.removesuffix(".0")


def kind_of(value: Any) -> str:
    """The result of ``typeof``."""
    if isinstance(value, bool):
        return "boolean"
    if isinstance(value, float | str):
        return "number" if isinstance(value, float) else "string"
    return "undefined" if value is UNDEFINED else "object"


def same(first: Any, second: Any) -> bool:
    """``===`` (7.2.14)."""
    if type(first) is not type(second):
        return False
    return first is second if isinstance(first, list | dict) else bool(first == second)


def alike(first: Any, second: Any) -> bool:
    """``==`` (7.2.13)."""
    if type(first) is type(second):
        return same(first, second)
    absent = (None, UNDEFINED)
    if first in absent or second in absent:
        return first in absent and second in absent
    if isinstance(first, list | dict) and isinstance(second, list | dict):
        return first is second
    first, second = primitive(first), primitive(second)
    if isinstance(first, str) and isinstance(second, str):
        return first == second
    return number(first) == number(second)


def index_of(key: str) -> int:
    """A member's name as an index (6.1.7), or -1."""
    return index if INDEX.fullmatch(key) and (index := int(key)) <= MOST_INDEX else -1


def unit(value: str, index: int) -> Any:
    """One of the 16-bit units of a text in ECMAScript."""
    if value.isascii():
        return value[index] if 0 <= index < len(value) else UNDEFINED
    found = value.encode("utf-16-be", "surrogatepass")[max(2 * index, 0) : 2 * index + 2]
    return found.decode("utf-16-be", "surrogatepass") if found else UNDEFINED


def units(value: str) -> int:
    """The length of a text in ECMAScript."""
    return len(value) if value.isascii() else len(value.encode("utf-16-le", "surrogatepass")) // 2


def order(value: str) -> str | bytes:
    """The sort key of texts."""
    return value.encode("utf-16-be", "surrogatepass")


def escaped(value: str) -> str:
    """Text in which surrogate pairs are joined, and lone surrogates are JSON escapes."""
    if SURROGATE.search(value) is None:
        return value
    value = value.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")
    return SURROGATE.sub(lambda found: f"\\u{ord(found[0]):04x}", value)


def stringify(value: Any, around: tuple[int, ...] = ()) -> str:
    """A value as JSON (25.5.2); unsupported values are omitted, or null.

    Raises:
        ScriptError: something contains itself.
    """
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, float) and not math.isfinite(value):
        return "null"
    if not isinstance(value, list | dict):
        return "null" if value is UNDEFINED else text(value)
    if id(value) in around:
        raise ScriptError("TypeError: circular reference")
    around = (*around, id(value))
    if isinstance(value, list):
        return f"[{','.join(stringify(one, around) for one in value)}]"
    pairs = [
        f"{_quoted(key)}:{stringify(one, around)}"
        for key, one in sorted(value.items(), key=_position)
        if one is not UNDEFINED
    ]
    return f"{{{','.join(pairs)}}}"


def _quoted(value: str) -> str:
    return json.dumps(value, ensure_ascii=False)


def _position(pair: tuple[str, Any]) -> tuple[bool, int]:
    """The sort key of names: numbers come first, in their order (10.1.11.1)."""
    index = index_of(pair[0])
    return (index < 0, index)


def inward(value: Json, depth: int = 0) -> Any:
    """A copy of a value from outside as a value here: numbers are ``float``.

    Raises:
        ScriptError: its lists or objects are nested too deep.
    """
    if isinstance(value, str):
        return well_formed(value if type(value) is str else str.__str__(value))
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return whole(value) if isinstance(value, int) else float(value)
    if depth > DEEPEST:
        raise ScriptError("it is nested too deep")
    if isinstance(value, list | tuple):
        return [inward(one, depth + 1) for one in value]
    if isinstance(value, Mapping):
        return {well_formed(str(key)): inward(one, depth + 1) for key, one in value.items()}
    return value


def outward(value: Any) -> Json:
    """A value as plain data; undefined becomes None.

    Raises:
        ScriptError: it is too long, or contains itself.
    """
    if value is UNDEFINED:
        return None
    if isinstance(value, str):
        return bounded(well_formed(value))
    if isinstance(value, list | dict):
        return json.loads(bounded(well_formed(stringify(value))))
    return plain_number(value)
