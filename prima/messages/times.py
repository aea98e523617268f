"""Times of a run: milliseconds from its start, or None for never."""

from __future__ import annotations


def earliest(first: int | None, *others: int | None) -> int | None:
    """The earliest of some times, ignoring None; None if there is no other."""
    for time in others:
        if first is None or (time is not None and time < first):
            first = time
    return first
