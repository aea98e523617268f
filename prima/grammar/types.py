"""The built-in types of PRIMA's own language: VoiceXML's types, with values for ECMAScript."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prima.grammar.builtin import built_in
from prima.grammar.text import fold

if TYPE_CHECKING:
    from prima.messages import Json


def read(type: str, text: str) -> Json:
    """The value of an utterance, or None if the type does not match it."""
    if type == "text":
        return " ".join(text.split()) if fold(text) else None
    value = built_in(type, "").read(text, "voice")
    reader = _VALUES.get(type)
    return reader(value) if reader is not None and isinstance(value, str) else value


def _number(text: str) -> Json:
    value = float(text)
    return int(value) if value == int(value) else value


def _date(text: str) -> Json:
    """A whole date as ``2009-03-09``; None for a partial one."""
    return None if "?" in text else f"{text[:4]}-{text[4:6]}-{text[6:]}"


def _time(text: str) -> Json:
    """A time as ``21:30``; without a.m. or p.m. it is in 24 hours."""
    hour, part = int(text[:2]), text[4:]
    if part in ("a", "p"):
        hour = hour % 12 + (12 if part == "p" else 0)
    return f"{hour:02d}:{text[2:4]}"


_VALUES = {"number": _number, "date": _date, "time": _time}
