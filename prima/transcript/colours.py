"""Colours of applications, the same in reports, graphs and maps."""

from __future__ import annotations

from collections.abc import Iterable
from zlib import crc32

PALETTE = (
    ("#cfe3f7", "#1c5d99", "#1d3f61", "#7db7ee"),
    ("#fbdcc4", "#9a440a", "#5a3213", "#f0a46b"),
    ("#d4ecd3", "#2b6a2f", "#234a26", "#82cc86"),
    ("#e7d9f3", "#6c3a9c", "#43305c", "#c39df0"),
    ("#f7d6e0", "#9d2656", "#5b2239", "#f08bb0"),
    ("#fbeeb5", "#735800", "#4a3d0c", "#dcbb4e"),
    ("#e4e3de", "#57564f", "#3a3d43", "#aab0ba"),
)
"""Fill and line on light, fill and line on dark; the last is for no application."""
NOBODY = len(PALETTE) - 1
SALT = 1
"""Chosen so that the demo's applications that run together differ."""


def colours(apps: Iterable[str]) -> dict[str, int]:
    """Each application's place in the palette.

    Its name decides, so that it looks the same in pictures of other runs as well. Of two
    with the same colour, the one that comes later takes the next that is free.
    """
    found: dict[str, int] = {}
    free: set[int] = set()
    for app in dict.fromkeys(apps):
        free = free or set(range(NOBODY))
        wanted = crc32(app.encode("utf-8", "replace"), SALT) % NOBODY
        found[app] = min(free, key=lambda one: (one - wanted) % NOBODY)
        free.remove(found[app])
    return found


def fill(index: int, dark: bool = False) -> str:
    """The colour of an area."""
    return PALETTE[index][2 if dark else 0]


def stroke(index: int, dark: bool = False) -> str:
    """The colour of a line."""
    return PALETTE[index][3 if dark else 1]
