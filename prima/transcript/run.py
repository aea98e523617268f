"""The fold of a run's records into behaviors, streams, floor, holds and reactions.

:func:`run_of` goes through the records once, in time and memory linear in them. Table, reasons,
report, graphs and exports are views of the :class:`Run` that comes out. Times are seconds.
"""

from __future__ import annotations

from collections.abc import Iterable

from prima.errors import UsageError
from prima.messages import Record
from prima.transcript.fold import Fold
from prima.transcript.record import Entry, lacking
from prima.transcript.spans import Run

NEEDED = {
    "suspend": ("tree", "app"),
    "resume": ("tree", "app"),
    "interrupt": ("behavior", "command"),
    "cancel": ("behavior",),
    "send": ("app", "data"),
}
"""Fields that views need besides the required ones."""


def run_of(records: Iterable[Record], name: str = "") -> Run:
    """Fold records; ``name`` is the transcript's, for messages.

    Raises:
        UsageError: a record lacks a field of its phase.
    """
    fold = Fold()
    for number, record in enumerate(records, 1):
        try:
            needed = NEEDED.get(record["phase"], ())
            lacks = lacking(record) or any(record.get(one) is None for one in needed)
            if not lacks:
                fold.add(Entry(record))
        except (KeyError, TypeError, ValueError, AttributeError):
            lacks = True
        if lacks:
            raise UsageError(f"{name}: record {number} lacks a field of its phase.") from None
    return fold.run()


def until(run: Run, time: float) -> Run:
    """The run up to and including a time."""
    fold = Fold()
    for entry in run.entries:
        if entry.time > time:
            break
        fold.add(entry)
    return fold.run()


__all__ = ["Fold", "Run", "run_of", "until"]
