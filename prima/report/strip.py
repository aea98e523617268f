"""A part of a run as a text timeline: events, a lane for each application, floor."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from prima.errors.visible import visible
from prima.report.lanes import Bar, make_lanes
from prima.transcript.row import Row
from prima.transcript.run import Run

STEPS = (1, 2, 5, 10, 30, 60, 300, 1800, 7200)
"""Seconds between marks of the axis."""
TAKEN = "\0"
"""A space within a bar, which no other text may fill."""
LEGEND = "[...] it runs   : suspended   - waits, by the rule named   v an event"


@dataclass
class Axis:
    """Maps times to columns: seconds ``begin`` to ``end`` in columns after ``left``."""

    begin: float
    end: float
    left: int
    columns: int

    def at(self, time: float) -> int:
        """The column of a time, cut to the part that is shown."""
        share = (time - self.begin) / max(self.end - self.begin, 0.001)
        return round(min(max(share, 0.0), 1.0) * (self.columns - 1))

    def shows(self, bar: Bar) -> bool:
        """Whether any of it is in the part that is shown."""
        return bar.end >= self.begin and bar.begin <= self.end


@dataclass
class Lane:
    """Lines of letters; overlapping texts go to the next line."""

    axis: Axis
    lines: list[list[str]] = field(default_factory=list)

    def put(self, at: int, text: str) -> None:
        """Write a text at a column of the first line that has room for it."""
        text = text[: self.axis.columns - at]
        room = slice(at, at + len(text) + 1)
        line = next((line for line in self.lines if not "".join(line[room]).strip()), None)
        if line is None:
            line = [" "] * self.axis.columns
            self.lines.append(line)
        line[at : at + len(text)] = list(text)

    def fill(self, at: int, text: str) -> None:
        """Write a text into the free part of the first line."""
        if not self.lines:
            self.lines.append([" "] * self.axis.columns)
        line = self.lines[0]
        for column, letter in enumerate(text, at):
            if column < len(line) and line[column] == " ":
                line[column] = letter

    def text(self, name: str) -> list[str]:
        """The lines with the lane's name before the first."""
        names = [name, *([""] * len(self.lines))]
        return [
            f"{names[index]:<{self.axis.left}}{''.join(line)}".replace(TAKEN, " ").rstrip()
            for index, line in enumerate(self.lines)
        ]


def draw(run: Run, rows: Sequence[Row], begin: float, end: float, columns: int) -> str:
    """The part of a run from ``begin`` to ``end`` (s), at most so many columns wide."""
    lanes = make_lanes(run, rows)
    left = max([8, *map(len, lanes.apps)]) + 2
    axis = Axis(begin, end, left, max(columns - left, 20))
    lines = _events(rows, axis)
    for app in lanes.apps:
        lane = Lane(axis)
        for bar in _of(app, lanes.behaviors, axis):
            lane.put(axis.at(bar.begin), _bar(bar, axis))
        for bar in _of(app, lanes.held, axis):
            width = axis.at(bar.end) - axis.at(bar.begin)
            rule = bar.text.rpartition("(")[2].rstrip(")")
            lane.fill(axis.at(bar.begin), f"{rule:->{width}}" if width > len(rule) else "")
        for bar in _of(app, lanes.away, axis):
            lane.fill(axis.at(bar.begin), ":" * (axis.at(bar.end) - axis.at(bar.begin)))
        lines += lane.text(app)
    floor = Lane(axis)
    for bar in (bar for bar in lanes.floor if axis.shows(bar)):
        floor.put(axis.at(bar.begin), _bar(bar, axis))
    lines += floor.text("floor")
    return "\n".join([*lines, *_axis(axis), LEGEND])


def _of(app: str, bars: Iterable[Bar], axis: Axis) -> list[Bar]:
    return [bar for bar in bars if bar.app == app and axis.shows(bar)]


def _bar(bar: Bar, axis: Axis) -> str:
    """A bar of its length, with as much of its text as fits."""
    width = max(axis.at(bar.end) - axis.at(bar.begin), 2)
    text = visible(bar.text or bar.name).strip('"')
    shown = f"{text[: width - 2]:<{width - 2}}"
    return f"[{shown}]".replace(" ", TAKEN)


def _events(rows: Iterable[Row], axis: Axis) -> list[str]:
    """The events of the user and the surroundings."""
    lane = Lane(axis)
    for row in rows:
        if row.actor != "R" and axis.begin <= row.time <= axis.end:
            at = axis.at(row.time)
            text = f"v {visible(row.what)}"
            room = axis.columns - at
            if len(text) > room:  # near the right end: the mark follows the words
                at, text = max(at - len(text) + 1, 0), f"{text[2:]} v"
            lane.put(at, text)
    return lane.text("events")


def _axis(axis: Axis) -> list[str]:
    """Seconds."""
    span = axis.end - axis.begin
    step = next((one for one in STEPS if span / one <= 8), STEPS[-1])
    lane = Lane(axis)
    first = -int(-axis.begin // step) * step
    for second in range(first, int(axis.end) + 1, step):
        if axis.at(second) + len(str(second)) <= axis.columns:
            lane.fill(axis.at(second), str(second))
    return lane.text("seconds")
