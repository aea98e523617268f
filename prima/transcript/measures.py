"""Measures of a run, counted from its records one by one."""

from __future__ import annotations

from dataclasses import dataclass

from prima.transcript.criteria import Criteria
from prima.transcript.observer import Observer
from prima.transcript.record import Entry


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
    """Measures during a run, without keeping records.

    Args:
        delays: whether the delay of each reaction is kept among the criteria.
    """

    def __init__(self, delays: bool = False) -> None:
        self.records = 0
        self._last = 0.0
        self._counted = {"collision": 0, "starve": 0}
        self.observer = Observer(delays)

    def add(self, entry: Entry) -> None:
        """Add a record."""
        self.records += 1
        self._last = entry.time
        if entry.phase in self._counted:
            self._counted[entry.phase] += 1
        self.observer.add(entry)

    def criteria(self) -> Criteria:
        """The thesis's criteria so far."""
        return self.observer.result()

    def summary(self) -> Summary:
        """The result so far."""
        found = self.criteria()
        return Summary(
            self._last,
            found.broken,
            self._counted["collision"],
            found.reactions,
            found.reaction_mean,
            found.reaction_max,
            found.responses,
            found.response_mean,
            found.response_max,
            self._counted["starve"],
        )
