"""The targets of a ``throw``: the handlers that may take the event, with reasons."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from prima.graph.labels import condition, joined, ordinal

Act = TypeVar("Act")


@dataclass(frozen=True, slots=True)
class Taker(Generic[Act]):
    """A handler that takes events from their ``count``-th time on, if its condition holds."""

    acts: Sequence[Act]
    events: Sequence[str]
    """The prefixes of the events; the empty one takes all."""
    count: int
    cond: str
    stays: bool
    """Whether it does something without a transition."""
    named: bool = True
    """Whether the document names its events; else it shows only where they are thrown."""

    def label(self, cause: str) -> str:
        """The label of an edge that leads through this handler."""
        times = f", {ordinal(self.count)} time" if self.count > 1 else ""
        return joined(cause + times, [condition(self.cond)] if self.cond else [])


def chosen(takers: Iterable[Taker[Act]]) -> tuple[list[Taker[Act]], bool]:
    """The handlers that may run, and whether one of them always does.

    Of those for one count the innermost and first runs whose condition holds
    (VoiceXML 2.0, 5.2.4).

    Args:
        takers: all that take the event, innermost first and each scope's in document order.
    """
    kept: list[Taker[Act]] = []
    settled: set[int] = set()
    for one in takers:
        if one.count not in settled:
            kept.append(one)
        if not one.cond:
            settled.add(one.count)
    return kept, 1 in settled
