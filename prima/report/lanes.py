"""What a timeline shows of a run: its bars and flags, from the records alone, in linear time."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from prima.messages import Record
from prima.transcript.colours import apps_of
from prima.transcript.table import Row, describe

MOST_APPS = 24
"""Applications that have a lane of their own; the others have none."""
MOST_DEVICES = 16
"""Devices that have a lane of their own."""
MOST_ON_FLOOR = 8
"""Streams of the stack of the floor that are named."""


@dataclass(slots=True)
class Bar:
    """Something that lasts, in seconds; ``end`` is less than 0 until it is known."""

    begin: float
    end: float = -1.0
    name: str = ""
    app: str = ""
    text: str = ""
    row: int = -1
    """The table's row that tells of it, or -1."""
    devices: tuple[str, ...] = ()
    cuts: list[float] = field(default_factory=list)
    """Where one loop ends and the next begins, or where a window opens or closes."""
    by: str = ""
    """The stream or AB because of which a stream is suspended."""


@dataclass(slots=True)
class Lanes:
    """All that a timeline shows of one run."""

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


def make_lanes(records: Sequence[Record], rows: Sequence[Row]) -> Lanes:
    """The lanes of a run with its table's rows."""
    seconds = float(max((record["time"] for record in records), default=0.0))
    apps = apps_of(records)
    behaviors = _behaviors(records, rows)
    devices = sorted({device for bar in behaviors for device in bar.devices})
    lanes = Lanes(
        seconds,
        apps,
        apps[:MOST_APPS],
        devices[:MOST_DEVICES],
        behaviors,
        _between(records, "tree", {"suspend"}, {"resume", "stream-end"}),
        _between(records, "behavior", {"hold"}, {"start", "cancel", "fail"}),
        _floor(records),
        _streams(records),
    )
    for bars in (lanes.behaviors, lanes.away, lanes.held, lanes.floor, lanes.streams):
        for bar in bars:
            bar.end = bar.end if bar.end >= 0 else seconds
    marks = _Marks(records, rows)
    untold = [bar for bar in behaviors if bar.row < 0]
    for bar in (*untold, *lanes.away, *lanes.held, *lanes.floor, *lanes.streams):
        bar.row = marks.row(bar.by or bar.name, bar.begin)
    return lanes


class _Marks:
    """The row of the table that a stream or an AB belongs to from a moment on."""

    def __init__(self, records: Iterable[Record], rows: Iterable[Row]) -> None:
        tree_of = {r["behavior"]: r.get("tree") for r in records if r["phase"] == "request"}
        self._rows: dict[str, list[tuple[float, int]]] = {}
        self._all = [(row.time, row.number) for row in rows]
        for row in rows:
            name = _base(row.behavior)
            for key in {name, tree_of.get(name) or ""} - {""}:
                self._rows.setdefault(key, []).append((row.time, row.number))

    def row(self, name: str, begin: float) -> int:
        """The first row of a stream or AB from then on; else its last, or the last of all."""
        own = self._rows.get(_base(name), [])
        place = bisect_left(own, (begin, -1))
        if own:
            return own[min(place, len(own) - 1)][1]
        place = bisect_left(self._all, (begin, len(self._all)))
        return self._all[max(place - 1, 0)][1] if self._all else -1


def _base(behavior: str) -> str:
    return behavior.partition(".")[0]


def _behaviors(records: Iterable[Record], rows: Iterable[Row]) -> list[Bar]:
    """Every AB that ran; loops that follow one another without a gap are one bar."""
    row_of = {(row.behavior, row.time): row.number for row in rows if row.behavior}
    last_row: dict[str, int] = {}
    asked: dict[str, Record] = {}
    made: list[Bar] = []
    last: dict[str, Bar] = {}
    for record in records:
        phase, behavior, time = record["phase"], record.get("behavior") or "", record["time"]
        name = _base(behavior)
        bar = last.get(name)
        if phase == "request":
            asked[name] = record
        elif phase == "start" and bar is not None and bar.end == time and not record.get("resumed"):
            bar.cuts.append(time)
            bar.end = -1.0
        elif phase == "start":
            request = asked.get(name, record)
            row = row_of.get((behavior, time), last_row.get(name, -1))
            last_row[name] = row
            unit = record["command"] == "iu"
            words = describe(record["command"], record.get("text"), request.get("args"))
            devices = tuple(record.get("devices") or ())[:MOST_DEVICES]
            bar = Bar(time, -1.0, name, record["app"], "unit" if unit else words, row, devices)
            last[name] = bar
            made.append(bar)
        elif phase in ("end", "cancel", "fail", "interrupt") and bar is not None and bar.end < 0:
            bar.end = time
    return made


def _between(records: Iterable[Record], key: str, begin: set[str], end: set[str]) -> list[Bar]:
    """From the first record of some phases about a thing to the next of others about it."""
    made: list[Bar] = []
    under_way: dict[str, Bar] = {}
    for record in records:
        name = _base(record.get(key) or "")
        if not name:
            continue
        if record["phase"] in begin and name not in under_way:
            app = record.get("app") or name.partition(":")[0].partition("#")[0]
            by = record.get("by") or ""
            why = f"{by or 'another'} ({record.get('rule') or 'no rule'})"
            cause = by if record["phase"] == "suspend" else name
            under_way[name] = Bar(record["time"], -1.0, name, app, why, by=cause)
            made.append(under_way[name])
        elif record["phase"] in end and name in under_way:
            under_way.pop(name).end = record["time"]
    return [bar for bar in made if bar.end < 0 or bar.end > bar.begin]


def _floor(records: Iterable[Record]) -> list[Bar]:
    """Who holds the floor, from and until when; its text names the stack beneath."""
    made: list[Bar] = []
    for record in records:
        if record["phase"] != "floor":
            continue
        if made and made[-1].end < 0:
            made[-1].end = record["time"]
        stack = (record.get("floor") or [])[-MOST_ON_FLOOR:]
        if stack:
            app = stack[-1].partition(":")[0]
            made.append(Bar(record["time"], -1.0, stack[-1], app, " on ".join(reversed(stack))))
    return [bar for bar in made if bar.end < 0 or bar.end > bar.begin]


def _streams(records: Iterable[Record]) -> list[Bar]:
    """Every Communication Stream, from its first request to its end, with its windows."""
    made: list[Bar] = []
    under_way: dict[str, Bar] = {}
    for record in records:
        tree = record.get("tree") or ""
        if not tree:
            continue
        if record["phase"] == "request" and tree not in under_way:
            app = record["app"]
            under_way[tree] = Bar(record["time"], -1.0, tree, app, f"stream {tree}")
            made.append(under_way[tree])
        elif record["phase"] == "window" and tree in under_way:
            cuts = under_way[tree].cuts
            if not cuts or cuts[-1] != record["time"]:
                cuts.append(record["time"])
        elif record["phase"] == "stream-end" and tree in under_way:
            under_way.pop(tree).end = record["time"]
    return made
