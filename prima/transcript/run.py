"""The fold of a run's records into behaviors, streams, floor, holds and reactions.

:func:`run_of` goes through the records once, in time and memory linear in them. Table, reasons,
report, graphs and exports are views of the :class:`Run` that comes out. Times are seconds.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress

from prima.errors import UsageError
from prima.messages import Record
from prima.transcript.fold import Fold
from prima.transcript.record import Entry, lacking
from prima.transcript.spans import Run


def run_of(records: Iterable[Record], name: str = "") -> Run:
    """Fold records; ``name`` is the transcript's, for messages.

    Raises:
        UsageError: a record lacks a field of its phase.
    """
    fold = Fold()
    for number, record in enumerate(records, 1):
        with suppress(KeyError, TypeError, ValueError, AttributeError):
            if not lacking(record):
                fold.add(Entry(record))
                continue
        raise UsageError(f"{name}: record {number} lacks a field of its phase.")
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
