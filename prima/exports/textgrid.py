"""Praat's TextGrid in its long text format."""

from __future__ import annotations

from collections.abc import Iterator

from prima.exports.timeline import Interval, Tier, TierPart, Timeline


def write(timeline: Timeline, languages: dict[str, str]) -> Iterator[str]:
    """The file, in pieces: interval tiers without gaps, and point tiers."""
    # Praat requires at least one tier, even if the run is empty.
    parts = timeline.parts() or [TierPart("run", Tier("run", "events", "robot"), [])]
    ends = (_end(mark) for part in parts if not part.tier.points for mark in part.marks)
    end = max(1, timeline.end, *ends)
    yield (
        'File type = "ooTextFile"\nObject class = "TextGrid"\n\n'
        f"xmin = 0\nxmax = {_seconds(end)}\ntiers? <exists>\n"
        f"size = {len(parts)}\nitem []:\n"
    )
    for number, part in enumerate(parts, 1):
        points = part.tier.points
        shown = part.marks if points else _filled(part.marks, end)
        kind, what = ("TextTier", "points") if points else ("IntervalTier", "intervals")
        yield (
            f'    item [{number}]:\n        class = "{kind}"\n        name = {_quoted(part.name)}\n'
            f"        xmin = 0\n        xmax = {_seconds(end)}\n"
            f"        {what}: size = {len(shown)}\n"
        )
        for place, mark in enumerate(shown, 1):
            fields = _point(mark) if points else _interval(mark)
            yield f"        {what} [{place}]:\n"
            yield from (f"            {name} = {value}\n" for name, value in fields.items())


def _point(mark: Interval) -> dict[str, str]:
    return {"number": _seconds(mark.start), "mark": _quoted(mark.text)}


def _interval(mark: Interval) -> dict[str, str]:
    times = {"xmin": _seconds(mark.start), "xmax": _seconds(_end(mark))}
    return times | {"text": _quoted(mark.text)}


def _end(mark: Interval) -> int:
    """The end of an interval; each lasts at least 1 ms."""
    return max(mark.end, mark.start + 1)


def _filled(marks: list[Interval], end: int) -> list[Interval]:
    """Intervals with empty ones between them, from 0 to the end."""
    filled: list[Interval] = []
    last = 0
    for mark in marks:
        if mark.start > last:
            filled.append(Interval(last, mark.start, ""))
        filled.append(mark)
        last = _end(mark)
    if last < end:
        filled.append(Interval(last, end, ""))
    return filled


def _seconds(time: int) -> str:
    return f"{time / 1000:.3f}".rstrip("0").rstrip(".")


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"'
