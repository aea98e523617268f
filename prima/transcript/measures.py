"""Figures of a transcript, computed from its records alone."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from prima.messages import Record
from prima.transcript.criteria import Observer


@dataclass(frozen=True, slots=True)
class Summary:
    """Counts of a run; times in seconds."""

    seconds: float
    streams_broken: int
    """Streams broken by no reaction, as docs/measures.md defines it."""
    collisions: int
    reactions: int
    """Events that some application reacted to with a Command that started."""
    reaction_mean: float
    reaction_max: float
    responses: int
    """Reactions in which the robot said something or turned to the user."""
    response_mean: float
    response_max: float
    starved: int = 0
    """Behaviours that another application has kept waiting for too long (E4, E6)."""


class Measure:
    """Counts while a run goes on; ``records`` need not be kept."""

    def __init__(self) -> None:
        self.records = 0
        self._last = 0.0
        self._collisions = 0
        self._starved = 0
        self._observer = Observer(delays=False)

    def add(self, record: Record, time: float) -> None:
        """Take a record in; ``time`` in seconds."""
        self.records += 1
        self._last = time
        self._collisions += record["phase"] == "collision"
        self._starved += record["phase"] == "starve"
        self._observer.add(record, time)

    def summary(self) -> Summary:
        """What has been counted so far."""
        found = self._observer.result()
        return Summary(
            self._last,
            found.broken,
            self._collisions,
            found.reactions,
            found.reaction_mean,
            found.reaction_max,
            found.responses,
            found.response_mean,
            found.response_max,
            self._starved,
        )


def summarize(records: Iterable[Record]) -> Summary:
    """Measure a transcript: how long it took, what broke, how soon events were answered."""
    measure = Measure()
    for record in records:
        measure.add(record, record["time"])
    return measure.summary()
