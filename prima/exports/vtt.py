"""WebVTT (W3C): the speech of applications and user as captions with voices."""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import escape

from prima.exports.timeline import Interval, Tier, Timeline, clean


def write(timeline: Timeline, languages: dict[str, str]) -> Iterator[str]:
    """The file, in pieces: a cue for each utterance, and notes for other events."""
    cues: list[tuple[Interval, Tier]] = [
        (mark, tier)
        for tier in timeline.tiers
        if tier.kind in ("says", "user-says", "user-does", "events")
        for mark in tier.marks
    ]
    cues.sort(key=lambda one: (one[0].start, not one[1].points))
    yield "WEBVTT\n"
    head = [
        f"{name}: {timeline.head[name]}"
        for name in ("scenario", "policy")
        if timeline.head.get(name)
    ]
    if head:
        yield f"\nNOTE {escape(clean(', '.join(head)))}\n"
    for mark, tier in cues:
        if tier.points:
            yield f"\nNOTE {_time(mark.start)} {escape(mark.text)}\n"
        elif mark.text:
            end = max(mark.end, mark.start + 1)
            voice = escape(tier.who)
            yield f"\n{_time(mark.start)} --> {_time(end)}\n<v {voice}>{escape(mark.text)}</v>\n"


def _time(time: int) -> str:
    seconds, milliseconds = divmod(time, 1000)
    return f"{seconds // 3600:02}:{seconds // 60 % 60:02}:{seconds % 60:02}.{milliseconds:03}"
