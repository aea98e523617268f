"""Who waits, kept in order: of ABs that need the same devices only few can be the next.

ABs that need the same devices, have the same priority and leave the user alike are one
:class:`Line`. In a line the rules tell ABs apart by S2d to S2f alone, so that the first that may
start is found without a look at the others. Reactions stand in no line, and neither does what
S2c puts first for an instant: there are few of them, and they are ranked by what happens elsewhere.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Iterator
from typing import Final

from prima.scheduler.behavior import Behavior, Line, Rank

LATER: Final = 1
"""S2c: the parent has not ended in this instant."""
NO_REACTION: Final = (1, 0, 0)
"""S2b: it reacts to nothing."""


class Waiting:
    """The waiting ABs outside of units, by name and in lines."""

    def __init__(self) -> None:
        self.all: dict[str, Behavior] = {}
        self.lines: dict[tuple[frozenset[str], int, bool], Line] = {}
        """By devices, priority, and whether they leave the user."""
        self.apart: dict[str, Behavior] = {}
        """Those that stand in no line: reactions, and what was freed in this instant (S2c)."""
        self._now = 0
        """The instant, as far as anybody has told."""

    def settle(self, now: int) -> None:
        """It is another instant: who was freed in an earlier one gets in line."""
        if self._now != now:
            self._now = now
            if self.apart:
                for ab in list(self.apart.values()):
                    if ab.reaction is None:
                        del self.apart[ab.name]
                        self._get_in_line(ab)

    def add(self, ab: Behavior) -> None:
        """An AB begins to wait."""
        self.all[ab.name] = ab
        if ab.reaction is None and ab.freed < self._now:
            self._get_in_line(ab)
            return
        if ab.reaction is None:
            self.settle(ab.freed)
        self.apart[ab.name] = ab

    def _get_in_line(self, ab: Behavior) -> None:
        kind = (ab.devices, ab.priority, ab.leaves)
        line = self.lines.get(kind)
        if line is None:
            line = self.lines[kind] = Line(*kind)
        ab.line = line
        ab.rank = place(ab, *NO_REACTION, LATER)
        insort(line.ranks, ab.rank)

    def remove(self, ab: Behavior) -> None:
        """An AB waits no longer; one that did not wait is none of ours."""
        name, line, rank = ab.name, ab.line, ab.rank
        if name not in self.all:
            return
        del self.all[name]
        if line is None or rank is None:
            del self.apart[name]
            return
        ranks = line.ranks
        del ranks[0 if ranks[0] is rank else bisect_left(ranks, rank)]
        if not ranks:
            del self.lines[line.devices, line.priority, line.leaves]
        ab.line = ab.rank = None

    def moved(self, ab: Behavior) -> None:
        """Something has changed by which an AB is ranked."""
        if ab.name in self.all:
            self.remove(ab)
            self.add(ab)

    def __iter__(self) -> Iterator[Behavior]:
        return iter(self.all.values())

    def __len__(self) -> int:
        return len(self.all)

    def __contains__(self, name: str) -> bool:
        return name in self.all


def place(ab: Behavior, reacting: int, event: int, whose: int, continuing: int) -> Rank:
    """Where an AB stands (S2), given what S2b and S2c say of it."""
    return (
        -ab.priority,  # S2a: the higher priority goes first
        reacting,
        event,
        whose,
        continuing,
        rank_suspended(ab),
        ab.requested,  # S2e: the earlier request goes first
        rank_declared(ab),
        ab.serial,
        ab,
    )


def rank_suspended(ab: Behavior) -> int:
    """S2d: the stream suspended last goes first; the numbers of suspensions begin with 1."""
    suspended = ab.stream.suspended
    return 1 if suspended is None else -suspended


def rank_declared(ab: Behavior) -> int:
    """S2f: the order in which applications were declared; the serial number comes after it."""
    return ab.app.order
