"""Lone surrogates, which ECMAScript's texts may contain and UTF-8 may not."""

from __future__ import annotations

import json
import re
from typing import Any

SURROGATE = re.compile("[\ud800-\udfff]")
"""A surrogate, as in texts of ECMAScript."""


def well_formed(text: str) -> str:
    """Text in which surrogate pairs are joined, and lone surrogates are U+FFFD."""
    if text.isascii() or SURROGATE.search(text) is None:
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "replace")


def as_json(value: Any) -> str:
    """Plain data as JSON, all texts of which are well-formed.

    Raises:
        ValueError: JSON has no such numbers.
    """
    return well_formed(json.dumps(value, ensure_ascii=False, allow_nan=False))


HALF_PAIR = re.compile(r"(?<!\\)((?:\\\\)*)\\ud[89a-f][0-9a-f]{2}")
"""A lone surrogate in ECMAScript's JSON, which is an escape there; pairs are letters."""


def well_formed_json(text: str) -> str:
    """The same for texts in JSON written by ECMAScript."""
    return HALF_PAIR.sub(r"\1\\ufffd", text) if "\\ud" in text else text
