"""Measures of a transcript, computed from its records."""

from __future__ import annotations

from dataclasses import dataclass

from prima.transcript.criteria import Criteria
from prima.transcript.observer import Observer
from prima.transcript.record import Entry
from prima.transcript.run import Run


@dataclass(frozen=True, slots=True)
class Summary:
    """Counts of a run; times in seconds."""

    seconds: float
    streams_broken: int
    """Streams broken other than by a reaction, as docs/measures.md defines it."""
    collisions: int
    reactions: int
    """Events that some application reacted to with a Command that started."""
    reaction_mean: float | None
    reaction_max: float | None
    responses: int
    """Reactions in which the robot said something or turned to the user."""
    response_mean: float | None
    response_max: float | None
    starved: int = 0
    """Behaviours that another application kept waiting for too long (E4, E6)."""


class Measure:
    """Measures during a run, without keeping records."""

    def __init__(self) -> None:
        self.records = 0
        self._last = 0.0
        self._counted = {"collision": 0, "starve": 0}
        self._observer = Observer(delays=False)

    def add(self, entry: Entry) -> None:
        """Add a record."""
        self.records += 1
        self._last = entry.time
        if entry.phase in self._counted:
            self._counted[entry.phase] += 1
        self._observer.add(entry)

    def summary(self) -> Summary:
        """The result so far."""
        counted = self._counted
        return _summary(self._last, self.criteria(), counted["collision"], counted["starve"])

    def criteria(self) -> Criteria:
        """The thesis's criteria so far."""
        return self._observer.result()


def summarize(run: Run) -> Summary:
    """Measure a run: duration, broken streams, reaction times."""
    last = run.entries[-1].time if run.entries else 0.0
    return _summary(last, run.criteria, len(run.of("collision")), len(run.of("starve")))


def _summary(last: float, found: Criteria, collisions: int, starved: int) -> Summary:
    return Summary(
        last,
        found.broken,
        collisions,
        found.reactions,
        found.reaction_mean,
        found.reaction_max,
        found.responses,
        found.response_mean,
        found.response_max,
        starved,
    )
