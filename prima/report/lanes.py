"""The bars of a timeline, computed in linear time."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from prima.transcript.row import Row, describe
from prima.transcript.run import Run
from prima.transcript.spans import FloorSpan, Hold, StreamState, base

MOST_APPS = 24
"""Maximum number of applications with a lane."""
MOST_DEVICES = 16
"""Maximum number of devices with a lane."""
LONGEST_NAME = 200
"""Maximum length of a name."""
MOST_ON_FLOOR = 8
"""Maximum number of named streams in the stack of the floor."""


@dataclass(slots=True)
class Bar:
    """Something with a duration, in seconds."""

    begin: float
    end: float
    name: str = ""
    app: str = ""
    text: str = ""
    row: int = -1
    """The table's row that shows it, or -1."""
    devices: tuple[str, ...] = ()
    cuts: list[float] = field(default_factory=list)
    """Where one loop ends and the next begins, or where a window opens or closes."""
    by: str = ""
    """The stream or AB because of which a stream is suspended."""


@dataclass(slots=True)
class Lanes:
    """The lanes of one run."""

    seconds: float
    every: list[str]
    """All applications; the first of them have lanes."""
    apps: list[str]
    devices: list[str]
    behaviors: list[Bar]
    away: list[Bar]
    """When streams are suspended."""
    held: list[Bar]
    """When behaviours are held back."""
    floor: list[Bar]
    streams: list[Bar]


def make_lanes(run: Run, rows: Sequence[Row]) -> Lanes:
    """The lanes of a run with its table's rows."""
    behaviors = _behaviors(run, rows)
    devices = sorted({device for bar in behaviors for device in bar.devices})
    lanes = Lanes(
        run.end,
        run.apps,
        run.apps[:MOST_APPS],
        devices[:MOST_DEVICES],
        behaviors,
        _away(run),
        [_waits(one, one.name, one.name) for one in run.holds if one.lasts],
        [_floor(one) for one in run.floors if one.stack and one.lasts],
        [
            Bar(one.begin, one.end, one.name, one.app, f"stream {one.name}", cuts=one.windows)
            for one in run.streams.values()
        ],
    )
    _find_rows(lanes, _Marks(run, rows))
    return lanes


def _away(run: Run) -> list[Bar]:
    states = [one for one in run.states if one.state == "suspended" and one.lasts]
    return [_waits(one, one.tree, one.by) for one in states]


def _find_rows(lanes: Lanes, marks: _Marks) -> None:
    """Give each bar its row."""
    unknown = [bar for bar in lanes.behaviors if bar.row < 0]
    for bar in (*unknown, *lanes.away, *lanes.held, *lanes.floor, *lanes.streams):
        bar.row = marks.row(bar.by or bar.name, bar.begin)


class _Marks:
    """Finds the row of a stream or an AB at a time."""

    def __init__(self, run: Run, rows: Iterable[Row]) -> None:
        self._rows: dict[str, list[tuple[float, int]]] = {}
        self._all = [(row.time, row.number) for row in rows]
        for row in rows:
            name, asked = base(row.behavior), run.asked(row.behavior)
            for key in {name, asked.tree if asked else ""} - {""}:
                self._rows.setdefault(key, []).append((row.time, row.number))

    def row(self, name: str, begin: float) -> int:
        """The first row of a stream or AB from that time on; else its last, or the last of all."""
        own = self._rows.get(base(name), [])
        place = bisect_left(own, (begin, -1))
        if own:
            return own[min(place, len(own) - 1)][1]
        place = bisect_left(self._all, (begin, len(self._all)))
        return self._all[max(place - 1, 0)][1] if self._all else -1


def _behaviors(run: Run, rows: Iterable[Row]) -> list[Bar]:
    """A bar for every AB that ran; consecutive loops are one bar."""
    row_of = {(row.behavior, row.time): row.number for row in rows if row.behavior}
    last_row: dict[str, int] = {}
    made: list[Bar] = []
    for spell in run.spells:
        start, name = spell.start, spell.behavior.name
        row = row_of.get((start.behavior, start.time), last_row.get(name, -1))
        last_row[name] = row
        words = describe(start.command, start.text, spell.behavior.asked.args)
        text = "unit" if spell.unit else words
        devices = tuple(start.devices)[:MOST_DEVICES]
        made.append(Bar(spell.begin, spell.end, name, start.app, text, row, devices, spell.cuts))
    return made


def _waits(span: StreamState | Hold, name: str, by: str) -> Bar:
    """A bar for a suspended stream or an AB that is held back; its text says why."""
    why = f"{span.by or 'another'} ({span.rule or 'no rule'})"
    return Bar(span.begin, span.end, name, span.app, why, by=by)


def _floor(span: FloorSpan) -> Bar:
    """Who holds the floor; its text names the stack beneath."""
    stack = span.stack[-MOST_ON_FLOOR:]
    app = stack[-1].partition(":")[0]
    return Bar(span.begin, span.end, stack[-1], app, " on ".join(reversed(stack)))
