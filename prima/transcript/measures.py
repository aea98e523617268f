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


class Measure:
    """Counts while a run goes on; ``records`` need not be kept."""

    def __init__(self) -> None:
        self.records = 0
        self._last = 0.0
        self._broken = 0
        self._collisions = 0
        self._events: dict[int, float] = {}
        self._waits: dict[tuple[str, int], float] = {}

    def add(self, record: Record, time: float) -> None:
        """Take a record in; ``time`` in seconds."""
        self.records += 1
        self._last = time
        phase = record["phase"]
        if phase == "suspend":
            self._broken += 1
        elif phase == "collision":
            self._collisions += 1
        elif phase == "event" and record.get("serial"):
            self._events[record["serial"]] = time
        elif phase == "start" and record.get("cause") in self._events:
            key = (record["app"], record["cause"])
            self._waits.setdefault(key, time - self._events[record["cause"]])

    def summary(self) -> Summary:
        """What has been counted so far."""
        waits = self._waits.values()
        mean = sum(waits) / len(waits) if waits else 0.0
        longest = max(waits, default=0.0)
        return Summary(
            self._last,
            self._broken,
            self._collisions,
            len(waits),
            round(mean, 3),
            round(longest, 3),
        )


def summarize(records: Iterable[Record]) -> Summary:
    """Measure a transcript: how long it took, what broke, how soon events were answered."""
    measure = Measure()
    for record in records:
        measure.add(record, record["time"])
    return measure.summary()
