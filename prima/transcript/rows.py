"""The rows of a transcript's table, made from its records."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prima.messages import Record
from prima.transcript.record import Entry
from prima.transcript.row import Row, row_of
from prima.transcript.spans import base

UNSEEN = frozenset(
    {"decision", "floor", "window", "leave", "stream-end", "suspend", "resume", "listening"}
)
"""Frequent phases that have no rows."""
ASKED = ("command", "text", "args", "extra", "inserted", "source")
"""Fields of a behavior's request that its row needs."""


def make_rows(entries: Iterable[Entry]) -> list[Row]:
    """The rows of a transcript, numbered; only records that may have a row are kept."""
    held: list[Entry] = []
    handled: set[int] = set()
    asked: dict[str, Entry] = {}
    ends: dict[str, float] = {}
    for record in entries:
        if record.cause:
            handled.add(record.cause)
        if record.phase == "request":
            asked[record.behavior] = record.only(ASKED)
        elif record.phase == "end":
            if record.command == "iu":
                ends[record.behavior] = record.time
            if record.goal:
                held.append(record)
        elif record.phase not in UNSEEN:
            held.append(record)
    rows = list(_rows(held, asked, handled))
    for number, row in enumerate(rows):
        row.number = number
    _bracket(rows, ends)
    return rows


def _rows(held: Iterable[Entry], asked: dict[str, Entry], handled: set[int]) -> Iterator[Row]:
    """The rows of records; of collisions, only the first of a pair, as every loop collides."""
    collided: set[tuple[str, str]] = set()
    for record in held:
        pair = (base(record.behavior), base(record.by))
        if record.phase == "collision" and pair in collided:
            continue
        row = row_of(record, asked, handled)
        if record.phase == "collision":
            collided.add(pair)
        if row is not None:
            yield row


class GrowingTable:
    """The table of a run in progress: rows are made as records come.

    It does not wait for later records, and keeps no rows, as a run may go on for months. A unit's rows begin with ``+`` and continue with a
    bar, as its last row is not known yet. What the camera sees has a row once an application
    reacts to it.
    """

    def __init__(self) -> None:
        self._count = 0
        """The number of rows so far."""
        self._asked: dict[str, Entry] = {}
        self._handled: set[int] = set()
        self._ignored: dict[int, Entry] = {}
        """Events without a reaction yet, by their serial numbers."""
        self._collided: set[tuple[str, str]] = set()
        self._units: set[str] = set()
        """Units that have a row and have not ended."""

    def add(self, records: Iterable[Record]) -> list[Row]:
        """Add the records of an instant, times in seconds; return their rows."""
        held = [Entry(record) for record in records]
        for record in held:
            if record.cause:
                self._handled.add(record.cause)
            if record.phase == "request":
                self._asked[record.behavior] = record.only(ASKED)
        reacted = [self._ignored.pop(one) for one in sorted(self._handled & self._ignored.keys())]
        rows = [row for record in (*reacted, *held) if (row := self._row(record)) is not None]
        for row in rows:
            row.number = self._count
            self._count += 1
        return rows

    def _row(self, record: Entry) -> Row | None:
        if record.phase == "event" and record.actor == "robot" and record.serial is not None:
            if record.serial not in self._handled:
                self._ignored[record.serial] = record
        elif record.phase == "collision":
            pair = (base(record.behavior), base(record.by))
            if pair in self._collided:
                return None
            self._collided.add(pair)
        row = row_of(record, self._asked, self._handled)
        if row is not None:
            if row.unit and row.unit not in self._units:
                self._units.add(row.unit)
                row.bracket = "+"
            elif self._units:
                row.bracket = "|"
        if record.phase in ("end", "cancel", "fail", "interrupt"):
            self._units.discard(record.behavior)
        return row


def _bracket(rows: list[Row], ends: dict[str, float]) -> None:
    """Mark the rows of units, from the first to the last.

    The answer to a unit's last question belongs to it (U5); rows between its interruption
    and its restart do not (X2).
    """
    left = list(range(len(rows) + 1))  # for each row, near the next one without a mark
    for indices in reversed(_unit_rows(rows, ends)):  # later units overwrite earlier ones
        first, last = indices[0], indices[-1]
        index = _next(left, first)
        while index <= last:
            inside = first < index < last
            rows[index].bracket = "|" if inside else "+" if first != last else "["
            left[index] = index + 1
            index = _next(left, index)


def _unit_rows(rows: list[Row], ends: dict[str, float]) -> list[list[int]]:
    """The indices of each unit's rows, a unit that starts again counting as another."""
    spans: dict[tuple[str, int], list[int]] = {}
    broken: dict[str, int] = {}
    for index, row in enumerate(rows):
        if row.kind == "interrupt":
            broken[row.behavior] = broken.get(row.behavior, 0) + 1
        if row.unit:
            spans.setdefault((row.unit, broken.get(row.unit, 0)), []).append(index)
    for (unit, _), indices in spans.items():
        final, after = rows[indices[-1]], indices[-1] + 1
        answer = rows[after] if after < len(rows) and final.kind == "q-and-a" else None
        if answer and answer.kind == "speech" and answer.time <= ends.get(unit, -1.0):
            indices.append(after)
    return list(spans.values())


def _next(left: list[int], index: int) -> int:
    """The first row without a mark at or after one; shortens the path for the next call."""
    while left[index] != index:
        left[index] = left[left[index]]
        index = left[index]
    return index
