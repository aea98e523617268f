"""TOML: settings and study files."""

from __future__ import annotations

import re
from typing import Any

MOST_CHARACTERS = 2_000_000
"""Characters of a text that is read."""
MOST_PARTS = 100
"""Maximum number of parts of a dotted key: reading one takes quadratic time."""
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_LONG_KEY = re.compile(rf"(?<![\w-]){_PART}(?:\.[ \t]*+{_PART}){{{MOST_PARTS}}}")


def parse_toml(text: str) -> dict[str, Any]:
    """Read TOML.

    Raises:
        ValueError: it is malformed, too long or too deep.
    """
    if len(text) > MOST_CHARACTERS:
        raise ValueError(f"it has more than {MOST_CHARACTERS:,} characters")
    if _LONG_KEY.search(text):
        raise ValueError(f"it has a key of more than {MOST_PARTS} parts")
    import tomllib  # most projects have no such files

    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except ValueError:  # Python's own limit on the digits of a number
        raise ValueError("a number in it has too many digits") from None
    except RecursionError:
        raise ValueError("it holds values inside values without end") from None
