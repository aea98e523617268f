"""The simple types that attributes and arguments have, and how text becomes a value.

A *kind* is the name of a type: it determines how a text is read, its Python value, and the XML
Schema type that describes it. Times are integer milliseconds
everywhere; lengths are metres, angles degrees.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import TypeVar

Value = str | int | float | bool
Otherwise = TypeVar("Otherwise", bound=int | None)


class BadValue(ValueError):
    """A text is not of a kind; ``wrong`` continues a sentence that begins with the text.

    ``right`` is the text that was most likely meant, or nothing; ``beyond`` means that a number
    is out of its bounds.
    """

    def __init__(
        self, wrong: str, remedy: str = "", *, right: str = "", beyond: bool = False
    ) -> None:
        super().__init__(f"{wrong} {remedy}".rstrip())
        self.wrong = wrong
        self.remedy = remedy
        self.right = right
        self.beyond = beyond


_START = (
    "A-Z_a-z\u00c0-\u00d6\u00d8-\u00f6\u00f8-\u02ff\u0370-\u037d\u037f-\u1fff\u200c\u200d"
    "\u2070-\u218f\u2c00-\u2fef\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffd\U00010000-\U000effff"
)
"""Characters that begin a name, as in XML 1.0; ``\\i`` without the colon in XML Schema."""
_REST = f"{_START}0-9\u00b7\u0300-\u036f\u203f\u2040"
"""Characters that continue one, dot and hyphen apart; ``\\c`` in XML Schema."""

SHORT_NAME = f"[{_START}][{_REST}]*"
"""A name without dots and hyphens."""
NAME = rf"[{_START}][{_REST}.\-]*"
TARGET = f"#{NAME}"
_WORD = rf"[{_START}$][{_REST}$]*"
VARIABLE = rf"{_WORD}(?:\.{_WORD})*"
EVENT = rf"[{_REST}\-]+(?:\.[{_REST}\-]+)*\.?"
# Patterns that mean the same in Python and in XML Schema.
LANGUAGE = r"[A-Za-z]{1,8}(-[A-Za-z0-9]{1,8})*"
_DURATION = r"\+?([0-9]+(\.[0-9]*)?|\.[0-9]+)(ms|s)"
_NUMBER = r"[+\-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+\-]?[0-9]+)?"
_INTEGER = r"[+\-]?[0-9]{1,9}"
_DATE = r"[0-9]{4}-[0-9]{2}-[0-9]{2}(T[0-9]{2}:[0-9]{2}(:[0-9]{2})?)?"
_FILLED = r"[\s\S]*\S[\s\S]*"
NUMBER = re.compile(_NUMBER)
LONGEST_NAME = 500
"""Letters that a name may have."""
XML_SPACE = " \t\r\n"
VARIABLE_REMEDY = "Use letters, digits and _, not first a digit."
EVENT_REMEDY = 'Write one such as "touch.head".'

_XSD_NAME = r"[\i-[:]][\c-[:]]*"
_XSD_WORD = r"[\i$-[:]][\c$-[:.\-]]*"
_XSD_VARIABLE = rf"{_XSD_WORD}(\.{_XSD_WORD})*"
_XSD_EVENT = r"[\c-[:.]]+(\.[\c-[:.]]+)*\.?"
LONGEST_MS = 24 * 3600 * 1000
MOST_SEED = 999_999_999
"""The greatest seed that a scenario can have: whole numbers have nine digits."""


def _fits(form: str, text: str) -> bool:
    """Whether a text fits a pattern of names; most are ASCII, and the whole alphabet is slow."""
    if len(text) > LONGEST_NAME:
        return False
    return _alphabet(form, text.isascii()).fullmatch(text) is not None


@cache
def _alphabet(form: str, ascii_only: bool) -> re.Pattern[str]:
    """A pattern of names, for all letters or for those of ASCII."""
    if ascii_only:
        form = form.replace(_REST, "A-Za-z_0-9").replace(_START, "A-Za-z_")
    return re.compile(form)


def _duration(text: str) -> int:
    match = re.fullmatch(_DURATION, text)
    if match is None:
        raise BadValue("is not a time.", 'Write a number with its unit: "500ms" or "2.5s".')
    value = float(match[1]) * (1000 if match[3] == "s" else 1)
    if value > LONGEST_MS:
        raise BadValue("is longer than a day.", 'Write at most "86400s".')
    return round(value)


def _number(text: str) -> float:
    if NUMBER.fullmatch(text) is None or not math.isfinite(float(text)):
        raise BadValue("is not a number.", 'Write digits, as in "1.5".')
    return float(text)


def _integer(text: str) -> int:
    if re.fullmatch(_INTEGER, text) is None:
        raise BadValue("is not a whole number.", 'Write digits alone, at most nine, as in "2".')
    return int(text)


def _boolean(text: str) -> bool:
    if text not in ("true", "false"):
        raise BadValue('is neither "true" nor "false".', "Write one of them.")
    return text == "true"


def _pattern(pattern: str, what: str, remedy: str) -> Callable[[str], str]:
    def read(text: str) -> str:
        if not _fits(pattern, text):
            raise BadValue(f"is not {what}.", remedy)
        return text

    return read


FILE = re.compile(r"/|\.(?:xml|vxml|grxml|html?)$")
"""The end of a file's name, or a folder's."""


def _target(text: str) -> str:
    if not _fits(TARGET, text):
        file, mark, name = text.rpartition("#") if "#" in text else (text, "", text)
        named = FILE.search(file) is not None
        right = f"#{name}" if _fits(NAME, name) and (mark or not named) else ""
        remedy = f'Write "{right}".' if right else 'Write "#" and the id of a form.'
        if named:
            remedy = f"It leads to no file, only within this document. {remedy}"
        raise BadValue("is not a place to go to.", remedy, right=right)
    return text


def _list(pattern: str, what: str, none: str, remedy: str) -> Callable[[str], str]:
    """Reads names that are separated by spaces."""

    def read(text: str) -> str:
        if not text:
            raise BadValue(f"names no {what.split()[-1]}.", none)
        for name in re.split(f"[{XML_SPACE}]+", text):
            if "," in name:
                raise BadValue("holds a comma.", "Separate the names by spaces.")
            if not _fits(pattern, name):
                raise BadValue(f'holds "{name}", which is not {what} name.', remedy)
        return re.sub(f"[{XML_SPACE}]+", " ", text)

    return read


def _date(text: str) -> str:
    from datetime import datetime  # slows down the start, and is rarely needed

    if re.fullmatch(_DATE, text) is None:
        raise BadValue("is not a date.", 'Write it as "2005-03-01T10:00:00".')
    try:
        return datetime.fromisoformat(text).isoformat()
    except ValueError:
        raise BadValue(
            "is a date that no calendar has.", "Check its month, day and hour."
        ) from None


@lru_cache(maxsize=100)
def moment(date: str) -> int:
    """A date as ``2005-03-01T10:00:00`` (UTC) in ms since 1970.

    Raises:
        ValueError: it is not a date.
    """
    from datetime import UTC, datetime, timedelta

    since = datetime.fromisoformat(date).replace(tzinfo=UTC)
    return (since - datetime.fromtimestamp(0, UTC)) // timedelta(milliseconds=1)


def _filled(text: str) -> str:
    if not text.strip(XML_SPACE):
        raise BadValue("is empty.", "Write what it shall be.")
    return text


@dataclass(frozen=True, slots=True)
class Kind:
    """A simple type: how to read it, its pattern in XML Schema, and its meaning."""

    read: Callable[[str], Value]
    pattern: str
    doc: str


DRAWABLE = {"delay": "duration", "quantity": "number"}
"""Kinds of values that may be drawn from a distribution, and the kind of what is drawn."""


BETWEEN = re.compile(
    r"([0-9]+(?:\.[0-9]+)?)(ms|s)? *(?:-|\.\.\.?|to|\u2013|\u2026) *([0-9]+(?:\.[0-9]+)?)(ms|s)?(?:/.*)?"
)
"""Two amounts, most likely meant as a range."""


def _drawable(plain: Callable[[str], Value], pattern: str, doc: str) -> Kind:
    """The kind of a plain value or a distribution, which stays text, as its bounds count too.

    :class:`prima.language.distributions.Distributions` reads it.
    """
    drawn = rf"{pattern} *\.\. *{pattern}|[a-z]+\([^()]*\)"
    is_drawn = re.compile(drawn)

    def read(text: str) -> Value:
        if is_drawn.fullmatch(text):
            return text
        if (between := BETWEEN.fullmatch(text)) is None:
            return plain(text)
        low, unit, high, other = between.groups("")
        right = f"{low}{unit or other}..{high}{other or unit}"
        raise BadValue("is not a range.", f'Write "{right}".', right=right)

    return Kind(read, f"{pattern}|{drawn}", doc)


KINDS: dict[str, Kind] = {
    "duration": Kind(_duration, _DURATION, "a time with its unit, as in 2s or 500ms"),
    "delay": _drawable(
        _duration,
        _DURATION,
        "a time, as in 2s, or a distribution of times, as in normal(5s,1s) or 0s..20s",
    ),
    "number": Kind(_number, _NUMBER, "a number, as in 1.5"),
    "quantity": _drawable(
        _number,
        _NUMBER,
        "a number, as in 1.5, or a distribution of numbers, as in normal(1,0.2) or 0.5..2",
    ),
    "integer": Kind(_integer, _INTEGER, "a whole number"),
    "boolean": Kind(_boolean, "true|false", "true or false"),
    "id": Kind(
        _pattern(NAME, "a name", 'Begin with a letter; letters, digits, ".", "-", "_" follow.'),
        _XSD_NAME,
        "a name: a letter, then letters, digits, . - _",
    ),
    "variable": Kind(
        _pattern(VARIABLE, "a variable name", VARIABLE_REMEDY),
        _XSD_VARIABLE,
        "the name of a variable",
    ),
    "variables": Kind(
        _list(VARIABLE, "a variable", "Write its name.", VARIABLE_REMEDY),
        rf"{_XSD_VARIABLE}( {_XSD_VARIABLE})*",
        "names of variables, separated by spaces",
    ),
    "event": Kind(
        _pattern(EVENT, "an event name", EVENT_REMEDY),
        _XSD_EVENT,
        "an event name: words joined by dots",
    ),
    "events": Kind(
        _list(EVENT, "an event", EVENT_REMEDY, EVENT_REMEDY),
        rf"{_XSD_EVENT}( {_XSD_EVENT})*",
        "event names, separated by spaces",
    ),
    "expression": Kind(_filled, _FILLED, "an ECMAScript expression"),
    "text": Kind(str, "", "any text"),
    "target": Kind(_target, f"#{_XSD_NAME}", "# and the id of a form"),
    "path": Kind(_filled, _FILLED, "a file, relative to this document"),
    "language": Kind(
        _pattern(LANGUAGE, "a language tag", 'Write one such as "en".'),
        LANGUAGE,
        "a language tag, as in en or ja",
    ),
    "date": Kind(
        _date,
        _DATE,
        "a date and a time of day in UTC, as in 2005-03-01T10:00:00",
    ),
}


def read_value(kind: str, text: str) -> Value:
    """Read ``text`` as a value of ``kind``.

    Raises:
        BadValue: the text is not of that kind.
    """
    return KINDS[kind].read(text if kind == "text" else text.strip(XML_SPACE))


def milliseconds(text: str, default: Otherwise) -> int | Otherwise:
    """A time such as ``5s`` or ``500ms`` in ms, or the default for any other text."""
    try:
        return int(read_value("duration", text.strip())) if text.strip() else default
    except ValueError:
        return default


def shown(value: object) -> str:
    """A value in ECMAScript notation, for a message."""
    if value is None:
        return "undefined"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        if math.isnan(value):
            return "NaN"
        if math.isinf(value):
            return "Infinity" if value > 0 else "-Infinity"
        return f"{value:.15g}"
    if isinstance(value, dict | list | tuple):
        return json.dumps(value, ensure_ascii=False)
    return str(value)


def quoted(value: object) -> str:
    """A value in quotation marks; null and undefined, the same in plain data, without."""
    return "(null or undefined)" if value is None else f'"{shown(value)}"'


def outside(kind: str, low: float | None, high: float | None) -> str:
    """The message for a number out of its bounds, which are in the unit that authors write."""
    if low is not None and high is not None:
        return f"is out of range: from {written(kind, low)} to {written(kind, high)}."
    if low is not None:
        return f"is out of range: at least {written(kind, low)}."
    return (
        "is out of range." if high is None else f"is out of range: at most {written(kind, high)}."
    )


def written(kind: str, value: float) -> str:
    """A number, or a time in ms with its unit."""
    if DRAWABLE.get(kind, kind) != "duration":
        return f"{value:.12g}"
    return f"{value / 1000:g}s" if value >= 1000 or not value else f"{value:g}ms"


def is_beyond(value: object, low: float | None, high: float | None) -> bool:
    """Whether a value is a number below ``low`` or above ``high``, if given."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    return (low is not None and value < low) or (high is not None and value > high)
