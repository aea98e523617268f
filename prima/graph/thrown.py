"""Where a ``throw`` leads: to the handlers that may take the event, each with its reason."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from prima.graph.words import condition, joined, ordinal

MOST_DEEP = 4
"""So many handlers that throw in turn are followed."""
MOST_FOLLOWED = 2000
"""Throws of one application that are followed."""
T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Taker(Generic[T]):
    """A handler that takes an event from its ``count``-th time on, if its condition holds."""

    handler: T
    count: int
    cond: str

    def told(self, told: str) -> str:
        """A reason that leads to this handler."""
        times = f", {ordinal(self.count)} time" if self.count > 1 else ""
        return joined(told + times, [condition(self.cond, "", False)] if self.cond else [])


def chosen(takers: Iterable[Taker[T]]) -> tuple[list[Taker[T]], bool]:
    """Those handlers that may ever run, and whether one of them always does.

    Of those for one count the innermost and first runs whose condition holds
    (VoiceXML 2.0, 5.2.4).

    Args:
        takers: all that take the event, innermost first and each scope's in document order.
    """
    kept: list[Taker[T]] = []
    settled: set[int] = set()
    for one in takers:
        if one.count not in settled:
            kept.append(one)
        if not one.cond:
            settled.add(one.count)
    return kept, 1 in settled


@dataclass(slots=True)
class Throws:
    """Follows throws, as far as they do not go round."""

    under_way: list[str] = field(default_factory=list)
    followed: int = 0

    @contextmanager
    def following(self, event: str) -> Iterator[bool]:
        """Whether a throw of an event is to be followed; while it is, it is not so again."""
        if event in self.under_way or len(self.under_way) == MOST_DEEP:
            yield False
            return
        self.followed += 1
        self.under_way.append(event)
        try:
            yield self.followed <= MOST_FOLLOWED
        finally:
            self.under_way.pop()
