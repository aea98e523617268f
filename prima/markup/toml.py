"""TOML: settings and study files."""

from __future__ import annotations

import re
from typing import Any

from prima.errors import Place
from prima.markup.encodings import byte_place, end_place

MOST_CHARACTERS = 2_000_000
"""Characters of a text that is read."""
MOST_PARTS = 100
"""Maximum number of parts of a dotted key: reading one takes quadratic time."""
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:\.[ \t]*+{_PART}){{{MOST_PARTS}}}")
_PLACE = re.compile(
    r"(?P<reason>.*) \(at (?:line (?P<line>\d+), column (?P<column>\d+)|end of document)\)",
    re.DOTALL,
)
"""How Python reports where an error is."""


class NotToml(ValueError):
    """A file is not TOML, or not what is read of it; ``place`` is where."""

    def __init__(self, place: Place, reason: object) -> None:
        super().__init__(f"{place}: not TOML: {reason}.")
        self.place = place
        self.reason = reason


def parse_toml(file: str, data: bytes) -> tuple[str, dict[str, Any]]:
    """Read TOML: its text, with line feeds alone, and what it holds.

    Raises:
        NotToml: it is malformed, too long or too deep.
    """
    try:
        text = data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise NotToml(byte_place(file, "utf-8-sig", error), "it is not UTF-8") from None
    place = Place(file)
    if len(text) > MOST_CHARACTERS:
        raise NotToml(place, f"it has more than {MOST_CHARACTERS:,} characters")
    if key := _LONG_KEY.search(text):
        place = end_place(file, text[: key.start()])
        raise NotToml(place, f"it has a key of more than {MOST_PARTS} parts")
    import tomllib  # most projects have no such files

    try:
        return text, tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _located(file, text, str(error)) from None
    except ValueError:  # Python's own limit on the digits of a number
        raise NotToml(place, "a number in it has too many digits") from None
    except RecursionError:
        raise NotToml(place, "it holds values inside values without end") from None


def _located(file: str, text: str, message: str) -> NotToml:
    """An error with the place that Python's message ends with."""
    found = _PLACE.fullmatch(message)
    if found is None:
        return NotToml(Place(file), message)
    if found["line"]:
        return NotToml(Place(file, int(found["line"]), int(found["column"])), found["reason"])
    return NotToml(end_place(file, text), found["reason"])
