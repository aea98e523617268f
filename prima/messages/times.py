"""Times of a run: milliseconds from its start, or None for never."""

from __future__ import annotations


def earliest(*times: int | None) -> int | None:
    """The earliest of some times, ignoring None; None if there is no other."""
    first: int | None = None
    for time in times:
        if first is None or (time is not None and time < first):
            first = time
    return first
