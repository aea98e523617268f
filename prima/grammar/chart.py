"""Matching: which expansions match which stretches of an utterance, each found once.

A chart in the manner of generalised parsing with memory: every expansion is tried once at
every position, and every requester is notified of each end. So left recursion, mutually recursive
rules and ambiguity take only polynomial work; nothing recurses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from prima.grammar.model import (
    Alternatives,
    BuiltIn,
    Part,
    Reference,
    Repeat,
    Sequence,
    Special,
    Tag,
    Words,
)
from prima.grammar.text import AsGiven, MatchedUtterance

if TYPE_CHECKING:
    from prima.messages import Json

MAX_STEPS = 200_000
"""Maximum number of steps for one utterance; one that needs more matches nothing."""
MOST_READ = 300
"""Maximum number of characters that a built-in type reads inside an utterance."""
MOST_EMPTY = 1000
"""How often a repeated expansion may match nothing; if it must more often, once counts for all."""


class ChartWay(NamedTuple):
    """One way to match a stretch: the part before, and the last part."""

    rank: int
    """The number of the alternative, in the order of the grammar."""
    cost: float
    left: Cell | None
    right: Cell | None
    lost: int = 0
    """How many words GARBAGE takes: any other match is better, at whatever cost."""


class Cell:
    """An expansion matched from one position to another, in all ways."""

    __slots__ = ("end", "number", "part", "start", "value", "ways")

    def __init__(self, part: Part | None, start: int, end: int, number: int) -> None:
        self.part = part
        """None for the beginning of a sequence or of repeats."""
        self.start = start
        self.end = end
        self.number = number
        self.ways: list[ChartWay] = []
        self.value: Json = None
        """The value that a built-in type read."""


class ChartSpot:
    """An expansion begun at one position."""

    __slots__ = ("begun", "ends", "part", "start", "waiting")

    def __init__(self, part: Part, start: int) -> None:
        self.part = part
        self.start = start
        self.ends: dict[int, Cell] = {}
        self.begun: dict[tuple[int, int], Cell] = {}
        """Progress of a sequence or of repeats: parts done and end to cell."""
        self.waiting: list[Waiting] = []


class Waiting(NamedTuple):
    """A request for an expansion: the requesting spot, its parts so far, and their match."""

    spot: ChartSpot
    done: int
    before: Cell | None


class Chart:
    """All matches of one utterance."""

    def __init__(
        self, said: MatchedUtterance, root: Reference, most_steps: int = MAX_STEPS
    ) -> None:
        self.utterance = said
        self.said = said.said
        self.steps_left = most_steps
        self.open = False
        """Whether an utterance that begins with this one may match."""
        self._given: AsGiven | None = None
        self._spots: dict[tuple[int, int], ChartSpot] = {}
        self._cells = 0
        self._todo: list[tuple[Waiting | None, ChartSpot | Cell]] = []
        self._top = ChartSpot(root, 0)
        self._todo.append((None, self._top))

    def run(self, prefixes: bool = False) -> Cell | None:
        """Find all matches; give the match of the whole utterance, if any."""
        self._prefixes = prefixes
        todo = self._todo
        while todo:
            self.steps_left -= 1
            if self.steps_left < 0:
                return None
            waiting, item = todo.pop()
            if isinstance(item, ChartSpot):
                self._begin(item)
            elif waiting is not None:
                self._resume(waiting, item)
        return self._top.ends.get(len(self.said))

    def _call(self, part: Part, start: int, waiting: Waiting) -> None:
        """Request an expansion at a position."""
        key = (id(part), start)
        spot = self._spots.get(key)
        if spot is None:
            spot = self._spots[key] = ChartSpot(part, start)
            self._todo.append((None, spot))
        spot.waiting.append(waiting)
        for cell in spot.ends.values():
            self._todo.append((waiting, cell))

    def _cell(self, part: Part | None, start: int, end: int) -> Cell:
        self._cells += 1
        return Cell(part, start, end, self._cells)

    def _finish(self, spot: ChartSpot, end: int, way: ChartWay) -> Cell:
        """Add a way in which an expansion matches up to a position."""
        cell = spot.ends.get(end)
        if cell is None:
            cell = spot.ends[end] = self._cell(spot.part, spot.start, end)
            self._todo.extend((waiting, cell) for waiting in spot.waiting)
        cell.ways.append(way)
        return cell

    def _begin(self, spot: ChartSpot) -> None:
        part, start = spot.part, spot.start
        match part:
            case Words(folded):
                self._words(spot, folded)
            case Alternatives():
                self._choice(spot, part)
            case Sequence():
                self._go_on(spot, 0, start, _NO_WAY)
            case Repeat():
                self._again(spot, 0, start, _NO_WAY)
            case Reference():
                if part.rule is not None:
                    self._call(part.rule.body, start, Waiting(spot, 0, None))
            case Tag():
                self._finish(spot, start, _NO_WAY)
            case Special():
                self._special(spot, part.name)
            case BuiltIn():
                self._built_in(spot, part)

    def _resume(self, waiting: Waiting, cell: Cell) -> None:
        """Resume a request whose expansion has matched."""
        spot = waiting.spot
        match spot.part:
            case Alternatives(costs=costs):
                way = ChartWay(waiting.done, costs[waiting.done], None, cell)
                self._finish(spot, cell.end, way)
            case Sequence():
                self._go_on(
                    spot, waiting.done + 1, cell.end, ChartWay(0, 0.0, waiting.before, cell)
                )
            case Repeat():
                self._repeated(spot, waiting, cell)
            case _:
                self._finish(spot, cell.end, ChartWay(0, 0.0, None, cell))

    # Kinds of expansions

    def _words(self, spot: ChartSpot, folded: str) -> None:
        start = spot.start
        if self.said.startswith(folded, start):
            end = start + len(folded)
            if self.utterance.edges[end]:
                self._finish(spot, self.utterance.after(end), _NO_WAY)
        if self._prefixes and len(folded) > len(self.said) - start:
            self.open |= folded.startswith(self.said[start:])

    def _choice(self, spot: ChartSpot, part: Alternatives) -> None:
        start, said = spot.start, self.said
        index = part.index
        left = len(said) - start
        tried = set(index.others)
        for length in index.lengths:
            if length > left:
                self.open = self.open or (self._prefixes and index.goes_on(said[start:]))
                break
            found = index.by_prefix.get(said[start : start + length])
            if found is not None and self.utterance.edges[start + length]:
                tried.update(found)
        for number in sorted(tried):
            self._call(part.parts[number], start, Waiting(spot, number, None))
        self.steps_left -= len(index.lengths) + len(tried)

    def _go_on(self, spot: ChartSpot, done: int, end: int, way: ChartWay) -> None:
        """Continue a sequence after so many parts."""
        part = spot.part
        assert isinstance(part, Sequence)
        if done == len(part.parts):
            self._finish(spot, end, way)
            return
        cell = spot.begun.get((done, end))
        if cell is None:
            cell = spot.begun[done, end] = self._cell(None, spot.start, end)
            self._call(part.parts[done], end, Waiting(spot, done, cell))
        cell.ways.append(way)

    def _repeated(self, spot: ChartSpot, waiting: Waiting, cell: Cell) -> None:
        """Add one repetition of a repeated expansion."""
        part, done = spot.part, waiting.done
        assert isinstance(part, Repeat)
        empty = cell.end == cell.start
        if empty and done >= part.low:
            return  # a repetition of nothing adds nothing
        cost = part.more if done >= part.low else 0.0
        done = _one_more(part, done, empty)
        if part.high is None or part.high > len(self.said):
            done = min(done, part.low)  # any more make no difference
        self._again(spot, done, cell.end, ChartWay(0, cost, waiting.before, cell))

    def _again(self, spot: ChartSpot, done: int, end: int, way: ChartWay) -> None:
        """Continue after so many repetitions."""
        part = spot.part
        assert isinstance(part, Repeat)
        cell = spot.begun.get((done, end))
        if cell is None:
            cell = spot.begun[done, end] = self._cell(None, spot.start, end)
            times = part.low if done == _ENOUGH else done
            if times >= part.low:
                stop = 0.0 if times == part.high else part.stop
                self._finish(spot, end, ChartWay(-times, stop, cell, None))
            if done not in (part.high, _ENOUGH):
                self._call(part.part, end, Waiting(spot, done, cell))
        cell.ways.append(way)

    def _special(self, spot: ChartSpot, name: str) -> None:
        if name == "VOID":
            return
        self._finish(spot, spot.start, _NO_WAY)
        if name == "GARBAGE":
            self.open = True
            ends = self.utterance.words_from(spot.start)
            self.steps_left -= len(ends)
            for words, end in enumerate(ends, 1):
                way = ChartWay(0, 0.0, None, None, words)
                self._finish(spot, self.utterance.after(end), way)

    def _built_in(self, spot: ChartSpot, part: BuiltIn) -> None:
        start, mode = spot.start, self.utterance.mode
        rest = self.said[start:]
        self.open = self.open or (self._prefixes and part.open(rest, mode))
        given = self._given = self._given or AsGiven(self.utterance)
        for end in self.utterance.words_from(start):
            whole = start == 0 and end == len(self.said)
            if end - start > MOST_READ and not whole:
                continue
            value = part.read(self.utterance.text if whole else given.text(start, end), mode)
            self.steps_left -= 20
            if value is not None:
                self._finish(spot, self.utterance.after(end), _NO_WAY).value = value


_NO_WAY = ChartWay(0, 0.0, None, None)
_ENOUGH = -1
"""So many repetitions as are required, of which some match nothing."""


def _one_more(part: Repeat, done: int, empty: bool) -> int:
    """How many repetitions there are after one more.

    As soon as one of those required matches nothing, no more than these are needed: then the
    missing ones are counted, below :data:`_ENOUGH`.
    """
    if done < 0 or not empty:
        return done + 1
    missing = part.low - done - 1
    return _ENOUGH - missing if missing < MOST_EMPTY else _ENOUGH
