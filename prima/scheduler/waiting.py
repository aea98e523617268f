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

Key = tuple[int, int, int, int]
"""What orders a line: S2d (twice), S2e and S2f."""
LEAST: Key = (-1, 0, 0, 0)
"""Before all others."""
BITS = 40
"""Of a serial number, which stands behind the application's in one number."""
Kind = tuple[frozenset[str], int, bool]
"""Devices, priority, and whether it leaves the user."""


class Line:
    """The waiting ABs of one kind that react to nothing, first come first."""

    def __init__(self, kind: Kind) -> None:
        self.devices, self.priority, self.leaves = kind
        self.entries: list[tuple[Key, Behavior]] = []

    def below(self, key: Key) -> int:
        """Where those begin that stand behind a key."""
        return bisect_left(self.entries, (key,))


class Waiting:
    """The waiting ABs outside of units, by name and in lines."""

    def __init__(self) -> None:
        self.all: dict[str, Behavior] = {}
        self.lines: dict[Kind, Line] = {}
        self.reactions: dict[str, Behavior] = {}
        self.by_app: dict[str, dict[str, Behavior]] = {}
        self._fresh: dict[str, Behavior] = {}
        """Those that began to wait in the instant in which they were freed (S2c), and older ones."""
        self._places: dict[str, tuple[Line, Key]] = {}

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
        key = line_key(ab)
        insort(line.entries, (key, ab))
        self._places[ab.name] = line, key
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
        line, key = self._places.pop(ab.name)
        del line.entries[line.below(key)]
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
        for name in [name for name, ab in self._fresh.items() if ab.freed != now]:
            del self._fresh[name]
        return list(self._fresh.values())

    def stands(self, name: str, line: Line, key: Key) -> bool:
        """Whether an AB stands in a line behind a key."""
        found = self._places.get(name)
        return found is not None and found[0] is line and found[1] > key

    def __iter__(self) -> Iterator[Behavior]:
        return iter(self.all.values())

    def __len__(self) -> int:
        return len(self.all)

    def __contains__(self, name: str) -> bool:
        return name in self.all


def line_key(ab: Behavior) -> Key:
    """Where an AB stands among those of its kind (S2d, S2e, S2f)."""
    suspended = ab.stream.suspended
    order = (1, 0) if suspended is None else (0, -suspended)
    return (*order, ab.requested, ab.app.order << BITS | ab.serial)


def key_of(rank: Rank) -> Key:
    """The key that belongs to a rank."""
    order = rank[3] if len(rank[3]) == 2 else (1, 0)
    return (order[0], order[1], rank[4][0], rank[5][0] << BITS | rank[5][1])


def rank_of(key: Key) -> Rank:
    """The last parts of a rank, S2d to S2f, that belong to a key."""
    suspended = (1,) if key[0] else (0, key[1])
    return (suspended, (key[2],), (key[3] >> BITS, key[3] & (1 << BITS) - 1))
