"""The rows of a run's table that a failure shows."""

from __future__ import annotations

from prima.testing.facts import Window
from prima.transcript.row import Row
from prima.transcript.table import format_head, format_row, shape_of

AROUND = 2
"""Rows shown before and after the one that matters."""
MOST_ROWS = 4
"""Rows shown at each end of a long period."""
GAP = "       ..."
"""Stands for omitted rows."""


def around(rows: list[Row], looked: Window | None, near: int | None) -> str:
    """The rows of the table in a window, and around a time (ms); dots mark omitted rows."""
    chosen: set[int] = set()
    if looked is not None:
        chosen |= _within(rows, looked)
    if near is not None:
        at = max((index for index, row in enumerate(rows) if row.time * 1000 <= near), default=0)
        chosen |= set(range(at - AROUND, at + AROUND + 1))
    kept = sorted(chosen & set(range(len(rows))))
    if not kept:
        return ""
    shape = shape_of([rows[index] for index in kept])
    lines = [format_head(shape)]
    for before, index in zip([kept[0] - 1, *kept], kept, strict=False):
        lines += [GAP] if index > before + 1 else []
        lines += format_row(rows[index], shape)
    return "\n".join(lines) + "\n"


def _within(rows: list[Row], window: Window) -> set[int]:
    """The rows of a window and the ones before and after it; both ends of a long window."""
    closes = float("inf") if window.closes is None else window.closes
    inside = [
        index for index, row in enumerate(rows) if window.opens <= round(row.time * 1000) <= closes
    ]
    if not inside:
        last = sum(row.time * 1000 < window.opens for row in rows)
        return {last - 1, last}
    found = [inside[0] - 1, *inside, inside[-1] + 1]
    if len(found) > 2 * MOST_ROWS:
        found = [*found[:MOST_ROWS], *found[-MOST_ROWS:]]
    return set(found)
