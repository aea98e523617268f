"""TOML: settings and study files."""

from __future__ import annotations

from typing import Any


def parse_toml(text: str) -> dict[str, Any]:
    """Read TOML.

    Raises:
        ValueError: it is malformed, or too deep.
    """
    import tomllib  # most projects have no such files

    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError("it holds values inside values without end") from None
