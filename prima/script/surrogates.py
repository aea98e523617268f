"""Halves of letters, which texts of ECMAScript may have and UTF-8 has not."""

from __future__ import annotations

import json
import re
from typing import Any

SURROGATE = re.compile("[\ud800-\udfff]")
"""Half of a letter, as ECMAScript has them in texts."""


def well_formed(text: str) -> str:
    """Text in which halves of letters are whole again, or U+FFFD: UTF-8 has none."""
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
"""Half a surrogate pair in JSON of ECMAScript: an escape there; whole pairs are letters."""


def well_formed_json(text: str) -> str:
    """The same for the texts in JSON that ECMAScript has written."""
    return HALF_PAIR.sub(r"\1\\ufffd", text) if "\\ud" in text else text
