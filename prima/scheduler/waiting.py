"""Who waits, kept in order: of ABs that need the same devices only few can be the next.

ABs that need the same devices, have the same priority and leave the user alike are one
:class:`Line`. In a line the rules tell ABs apart by S2c to S2f alone, so that the first that may
start is found without a look at the others. Reactions stand in no line: there are few of them,
and S2b ranks them by what happens elsewhere.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Iterator

from prima.scheduler.behavior import Application, Behavior, Rank

LEAST: Rank = ((-1,),)
"""Before all others of a line."""
Kind = tuple[frozenset[str], int, bool]
"""Devices, priority, and whether it leaves the user."""


class Line:
    """The waiting ABs of one kind that react to nothing, first come first."""

    def __init__(self, kind: Kind) -> None:
        self.devices, self.priority, self.leaves = kind
        self.entries: list[tuple[Rank, Behavior]] = []

    def below(self, rank: Rank) -> int:
        """Where those begin that stand behind a rank."""
        return bisect_left(self.entries, (rank,))


class Waiting:
    """The waiting ABs outside of units, by name and in lines."""

    def __init__(self) -> None:
        self.all: dict[str, Behavior] = {}
        self.lines: dict[Kind, Line] = {}
        self.reactions: dict[str, Behavior] = {}
        self.by_app: dict[str, dict[str, Behavior]] = {}
        self._fresh: dict[str, Behavior] = {}
        """Those that began to wait in the instant in which they were freed (S2c), and older ones."""
        self._places: dict[str, tuple[Line, Rank]] = {}

    def add(self, ab: Behavior) -> None:
        """An AB begins to wait."""
        self.all[ab.name] = ab
        self.by_app.setdefault(ab.app.name, {})[ab.name] = ab
        if ab.reaction is not None:
            self.reactions[ab.name] = ab
            return
        kind = (ab.devices, ab.priority, ab.leaves)
        line = self.lines.get(kind)
        if line is None:
            line = self.lines[kind] = Line(kind)
        rank = rank_in_line(ab)
        insort(line.entries, (rank, ab))
        self._places[ab.name] = line, rank
        if ab.freed >= 0:
            self._fresh[ab.name] = ab

    def remove(self, ab: Behavior) -> None:
        """An AB waits no longer; one that did not wait is none of ours."""
        if self.all.pop(ab.name, None) is None:
            return
        own = self.by_app[ab.app.name]
        del own[ab.name]
        if not own:
            del self.by_app[ab.app.name]
        self._fresh.pop(ab.name, None)
        if self.reactions.pop(ab.name, None) is not None:
            return
        line, rank = self._places.pop(ab.name)
        del line.entries[line.below(rank)]
        if not line.entries:
            del self.lines[line.devices, line.priority, line.leaves]

    def moved(self, ab: Behavior) -> None:
        """Something has changed by which an AB is ranked."""
        if ab.name in self.all:
            self.remove(ab)
            self.add(ab)

    def of(self, app: Application) -> list[Behavior]:
        """The waiting ABs of an application."""
        return list(self.by_app.get(app.name, {}).values())

    def fresh(self, now: int) -> list[Behavior]:
        """The ABs that go before others of their line because of S2c, in this instant."""
        if not self._fresh:
            return []
        for name in [name for name, ab in self._fresh.items() if ab.freed != now]:
            del self._fresh[name]
        return list(self._fresh.values())

    def stands(self, name: str, line: Line, rank: Rank) -> bool:
        """Whether an AB stands in a line behind a rank."""
        found = self._places.get(name)
        return found is not None and found[0] is line and found[1] > rank

    def __iter__(self) -> Iterator[Behavior]:
        return iter(self.all.values())

    def __len__(self) -> int:
        return len(self.all)

    def __contains__(self, name: str) -> bool:
        return name in self.all


def rank_in_line(ab: Behavior) -> Rank:
    """The last parts of a rank, S2d to S2f: where an AB stands among those of its kind."""
    return (rank_suspended(ab), rank_request(ab), rank_declared(ab))


def rank_suspended(ab: Behavior) -> tuple[int, ...]:
    """S2d: the stream suspended last goes first."""
    suspended = ab.stream.suspended
    return (1,) if suspended is None else (0, -suspended)


def rank_request(ab: Behavior) -> tuple[int, ...]:
    """S2e: the earlier request goes first."""
    return (ab.requested,)


def rank_declared(ab: Behavior) -> tuple[int, ...]:
    """S2f: the order in which applications were declared, then the serial number."""
    return (ab.app.order, ab.serial)
