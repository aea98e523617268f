"""Who waits, kept in order: of ABs that need the same devices only few can be the next.

ABs that need the same devices, have the same priority and leave the user alike are one
:class:`Line`. In a line the rules tell ABs apart by S2c to S2f alone, so that the first that may
start is found without a look at the others. Reactions stand in no line: there are few of them,
and S2b ranks them by what happens elsewhere.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Iterator

from prima.scheduler.behavior import Application, Behavior, Line, Rank

LATER: Rank = (1,)
"""S2c: the parent has not ended in this instant."""
NO_REACTION: Rank = (1, 0, 0)
"""S2b: it reacts to nothing."""


class Waiting:
    """The waiting ABs outside of units, by name and in lines."""

    def __init__(self) -> None:
        self.all: dict[str, Behavior] = {}
        self.lines: dict[tuple[frozenset[str], int, bool], Line] = {}
        """By devices, priority, and whether they leave the user."""
        self.reactions: dict[str, Behavior] = {}
        self._fresh: dict[str, Behavior] = {}
        """Those that were freed in the latest instant in which any was (S2c)."""
        self._freed = -1
        """That instant."""

    def add(self, ab: Behavior) -> None:
        """An AB begins to wait."""
        self.all[ab.name] = ab
        if ab.reaction is not None:
            self.reactions[ab.name] = ab
            return
        kind = (ab.devices, ab.priority, ab.leaves)
        line = self.lines.get(kind)
        if line is None:
            line = self.lines[kind] = Line(*kind)
        ab.line, ab.place = line, place_in_line(ab)
        ab.entry = ((*rank_priority(ab), *NO_REACTION, *LATER, *ab.place), ab)
        insort(line.entries, ab.entry)
        if ab.freed > self._freed:
            self._freed, self._fresh = ab.freed, {ab.name: ab}
        elif ab.freed == self._freed and ab.freed >= 0:
            self._fresh[ab.name] = ab

    def remove(self, ab: Behavior) -> None:
        """An AB waits no longer; one that did not wait is none of ours."""
        name, line = ab.name, ab.line
        if self.all.pop(name, None) is None:
            return
        if line is None:
            del self.reactions[name]
            return
        if self._fresh:
            self._fresh.pop(name, None)
        entries = line.entries
        assert ab.entry is not None
        del entries[0 if entries[0][1] is ab else bisect_left(entries, ab.entry)]
        if not entries:
            del self.lines[line.devices, line.priority, line.leaves]
        ab.line = None

    def moved(self, ab: Behavior) -> None:
        """Something has changed by which an AB is ranked."""
        if ab.name in self.all:
            self.remove(ab)
            self.add(ab)

    def of(self, app: Application) -> list[Behavior]:
        """The waiting ABs of an application."""
        return [ab for ab in app.members.values() if ab.name in self.all]

    def fresh(self, now: int) -> list[Behavior]:
        """The ABs that go before others of their line because of S2c, in this instant."""
        return [*self._fresh.values()] if self._freed == now else []

    def __iter__(self) -> Iterator[Behavior]:
        return iter(self.all.values())

    def __len__(self) -> int:
        return len(self.all)

    def __contains__(self, name: str) -> bool:
        return name in self.all


def rank_priority(ab: Behavior) -> Rank:
    """S2a: the higher priority goes first."""
    return (-ab.priority,)


def place_in_line(ab: Behavior) -> Rank:
    """The last parts of a rank, S2d to S2f: where an AB stands among those of its kind."""
    return (*rank_suspended(ab), *rank_request(ab), *rank_declared(ab))


def rank_suspended(ab: Behavior) -> Rank:
    """S2d: the stream suspended last goes first; the numbers of suspensions begin with 1."""
    suspended = ab.stream.suspended
    return (1,) if suspended is None else (-suspended,)


def rank_request(ab: Behavior) -> Rank:
    """S2e: the earlier request goes first."""
    return (ab.requested,)


def rank_declared(ab: Behavior) -> Rank:
    """S2f: the order in which applications were declared, then the serial number."""
    return (ab.app.order, ab.serial)
