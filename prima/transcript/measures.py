"""Figures of a transcript, computed from its records alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from prima.messages import Record


@dataclass(frozen=True, slots=True)
class Summary:
    """Counts of a run; times in seconds."""

    seconds: float
    streams_broken: int
    """Streams suspended because another took the floor."""
    collisions: int
    reactions: int
    """Events that some application reacted to with a Command that started."""
    reaction_mean: float
    reaction_max: float


def summarize(records: Iterable[Record]) -> Summary:
    """Measure a run: how long it took, what broke, how soon events were answered."""
    last, broken, collisions = 0.0, 0, 0
    events: dict[int, float] = {}
    answered: dict[tuple[str, int], float] = {}
    for record in records:
        last = record["time"]
        phase = record["phase"]
        if phase == "suspend":
            broken += 1
        elif phase == "collision":
            collisions += 1
        elif phase == "event" and record.get("serial"):
            events[record["serial"]] = last
        elif phase == "start" and record.get("cause") in events:
            answered.setdefault((record["app"], record["cause"]), last)
    waits = [time - events[cause] for (_, cause), time in answered.items()]
    mean = sum(waits) / len(waits) if waits else 0.0
    return Summary(
        last, broken, collisions, len(waits), round(mean, 3), round(max(waits, default=0.0), 3)
    )
