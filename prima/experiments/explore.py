"""Explorations: all orders of events that shifts of some of them lead to (docs/experiments.md)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from typing import Any, TypeVar

from prima.errors import UsageError
from prima.experiments.examine import Examiner, Finding, Seen
from prima.experiments.lines import (
    EventLine,
    LinePiece,
    Point,
    Search,
    moved,
    pieces,
    shift,
    shrunk,
)
from prima.experiments.pools import Pool, Runs
from prima.experiments.scenariotext import Variant
from prima.experiments.settings import ExperimentSettings
from prima.experiments.variants import Made
from prima.language.distributions import written
from prima.language.values import LONGEST_MS, read_value
from prima.pool import Died
from prima.version import __version__

MOST_DEPTH = 4
MOST_MOVES = 32

Found = TypeVar("Found")


class Enough(Exception):
    """The maximum number of runs has been made."""


@dataclass(frozen=True)
class ExplorationPlan:
    """The settings of an exploration."""

    scenario: str
    moves: tuple[str, ...] = ()
    """Paths of times; all of the scenario's events if empty."""
    within: int = 5_000
    """How far each may be moved (ms)."""
    depth: int = 2
    """The maximum number of events moved at once."""
    step: int = 0
    """A grid (ms) whose points are also tried; 0 for none."""
    most: int = 20_000
    """Runs at most."""
    policy: str = ""
    isolate: str = "ea"


@dataclass(slots=True)
class FoundOrder:
    """An order of events: its signature, the smallest shift that leads to it, and its runs."""

    signature: str
    point: Point
    runs: int


@dataclass(slots=True)
class FoundProblem:
    """A finding, and the smallest shift that leads to it."""

    finding: Finding
    point: Point
    runs: int


class Exploration:
    """All runs of one exploration, made as its searches request them."""

    def __init__(self, plan: ExplorationPlan) -> None:
        """Plan it.

        Raises:
            DocumentError: the scenario has errors.
            UsageError: the times cannot be moved.
        """
        self.plan = plan
        if not 1 <= plan.depth <= MOST_DEPTH:
            raise UsageError(f"--depth: write a number from 1 to {MOST_DEPTH}.")
        if not 1 <= plan.within <= LONGEST_MS:
            raise UsageError("--within: write a time above 0, at most 86400s.")
        settings = ExperimentSettings(isolate=plan.isolate)
        moves = list(plan.moves) or _events(plan.scenario, settings)
        if not moves:
            message = "there is nothing to move: no <when> has a time that is not drawn."
            raise UsageError(f"{plan.scenario}: {message} Name other times: --move answer.after.")
        if len(moves) > MOST_MOVES:
            raise UsageError(f"{len(moves)} events are too many to move; name some: --move PATH.")
        self.stage = Examiner.of([plan.scenario], moves, settings)
        self.targets = self.stage.targets(0)
        for target in self.targets:
            if target.kind != "duration":
                message = f"{target.path}: only times can be moved; vary others by prima sweep."
                raise UsageError(message)
            if not isinstance(read_value("delay", target.written), int):
                message = f'{target.path}: "{target.written}" is drawn, and cannot be moved.'
                raise UsageError(f"{message} Write a time, such as 5s.")
        self.base: Point = tuple(int(read_value("duration", one.written)) for one in self.targets)
        self.seen: dict[Point, Seen] = {}
        self.orders: list[FoundOrder] = []
        """All orders, the smallest shifts first."""
        self.problems: list[FoundProblem] = []
        self.complete = False
        """Whether all runs of the plan were made."""
        self.most: int | None = plan.most
        self.kept: dict[Point, Seen] = {}
        """Runs of an earlier, interrupted exploration."""
        self.keep: Callable[[Point, Seen], object] = lambda _point, _seen: None
        """Called with each run that is made."""
        self._runs: Runs | None = None

    # Runs ----------------------------------------------------------------------

    def variant(self, point: Point) -> Variant:
        """The run of a point."""
        pairs = zip(self.targets, point, self.base, strict=True)
        values = tuple(
            one.as_it_is if time == base else written("duration", time) for one, time, base in pairs
        )
        return Variant(0, 0, self.plan.policy, 0, values)

    def explore(self, pool: Pool) -> Iterator[int]:
        """Make all runs; yields their number after each batch.

        Raises:
            UsageError: a policy is unknown.
            RunError: no process can be started.
        """
        from prima.loading.heads import chosen_policy

        if self.plan.policy:
            chosen_policy(self.plan.policy, self.stage.loaded(self.variant(self.base)))
        with pool(self.stage) as self._runs:
            try:
                yield from self._lines()
                self.complete = True
            except Enough:
                pass
            yield from self._shrink()

    def _lines(self) -> Iterator[int]:
        yield from self._make([self.base])
        base = self.seen[self.base]
        if not base.times:
            raise UsageError(f"{self.plan.scenario}: it cannot be run: {base.failures}")
        reached: set[Point] = {self.base}
        frontier = [self.base]
        for depth in range(1, self.plan.depth + 1):
            lines = [line for point in frontier for line in self._from(point, depth == 1)]
            found: dict[EventLine, list[LinePiece]] = {}
            yield from self._together({line: line.search() for line in lines}, found)
            frontier = []
            for line in lines:
                frontier += [one for one in self._next(line, found[line]) if one not in reached]
                reached.update(frontier)
            frontier.sort(key=lambda point: (*shift(self.base, point), point))

    def _from(self, point: Point, exact: bool) -> Iterator[EventLine]:
        """The lines along the events that have not been moved."""
        for which, time in enumerate(self.base):
            if point[which] != time:
                continue
            target = self.targets[which]
            low = int(target.attribute.low or 0) if target.attribute else 0
            low = max(time - self.plan.within, low, 0)
            high = min(time + self.plan.within, LONGEST_MS)
            yield EventLine(point, which, low, high, self.plan.step, exact)

    def _next(self, line: EventLine, found: list[LinePiece]) -> Iterator[Point]:
        """The points from which to continue: one of each piece, and those of the grid."""
        home = self.base[line.which]
        times = [one.nearest(home) for one in found]
        if self.plan.step:
            times += range(home, line.high, self.plan.step)
            times += range(home, line.low, -self.plan.step)
        for time in dict.fromkeys(times):
            if time != home:
                yield line.at(time)

    def _together(
        self, searches: dict[Any, Search[Found]], found: dict[Any, Found]
    ) -> Iterator[int]:
        """Advance searches together, so that their runs are made at once."""
        asking: dict[Any, list[Point]] = {name: [] for name in searches}
        while asking:
            yield from self._make(point for points in asking.values() for point in points)
            for name, points in list(asking.items()):
                results = {one: self.seen[one] for one in points}
                try:
                    search = searches[name]
                    asking[name] = search.send(results) if points else next(search)
                except StopIteration as stop:
                    found[name] = stop.value
                    del asking[name]

    def _make(self, points: Iterable[Point]) -> Iterator[int]:
        """Make the runs that have not been made yet.

        Raises:
            Enough: the maximum number of runs has been made.
        """
        wanted = [one for one in dict.fromkeys(points) if one not in self.seen]
        for point in [one for one in wanted if one in self.kept]:
            self.seen[point] = self.kept[point]
        missing = [one for one in wanted if one not in self.kept]
        left = len(missing) if self.most is None else max(self.most - len(self.seen), 0)
        assert self._runs is not None
        made = self._runs(map(self.variant, missing[:left]))
        for point, (_, result) in zip(missing[:left], made, strict=True):
            self.seen[point] = _seen(result)
            self.keep(point, self.seen[point])
            yield len(self.seen)
        if len(missing) > left:
            raise Enough

    # Results -------------------------------------------------------------------

    def settle(self) -> None:
        """Collect orders and problems from the runs made so far, with the smallest shifts tried."""
        self.orders = self._orders()
        self.problems = self._problems()

    def _shrink(self) -> Iterator[int]:
        """Find the smallest shifts, also of what is found on the way."""
        self.most = None
        self.settle()
        done: set[Any] = set()
        while searches := {name: one for name, one in self._searches() if name not in done}:
            found: dict[Any, Point] = {}
            yield from self._together(searches, found)
            self._put(found)
            done |= found.keys()
            orders, problems = set(map(_name, self.orders)), set(map(_name, self.problems))
            self.orders += [one for one in self._orders() if _name(one) not in orders]
            self.problems += [one for one in self._problems() if _name(one) not in problems]
        self.orders.sort(key=lambda one: (*shift(self.base, one.point), one.point))

    def _searches(self) -> Iterator[tuple[Any, Search[Point]]]:
        """The searches for the smallest shift of each order and each problem, by their names."""
        for order in self.orders:
            yield _name(order), shrunk(self.base, order.point, _is(order.signature))
        for problem in self.problems:
            yield _name(problem), shrunk(self.base, problem.point, self._has(problem.finding))

    def _put(self, found: dict[Any, Point]) -> None:
        """Put orders and problems where searches have found them."""
        everything: list[FoundOrder | FoundProblem] = [*self.orders, *self.problems]
        for one in everything:
            one.point = found.get(_name(one), one.point)
        for problem in self.problems:
            there = self.findings(self.seen[problem.point])
            problem.finding = next(one for one in there if one[:2] == problem.finding[:2])

    def findings(self, seen: Seen) -> list[Finding]:
        """The findings of a run, including that it does not end although the base run does."""
        found = list(seen.found)
        if seen.ended == "until" and self.seen[self.base].ended not in ("until", ""):
            found.append(
                Finding("endless", "", "it does not end by itself, as the run as written does")
            )
        return found

    def _has(self, finding: Finding) -> Callable[[Seen], bool]:
        return lambda seen: any(one[:2] == finding[:2] for one in self.findings(seen))

    def _orders(self) -> list[FoundOrder]:
        made: dict[str, FoundOrder] = {}
        for point in self._by_shift():
            seen = self.seen[point]
            if seen.order:
                made.setdefault(seen.order, FoundOrder(seen.order, point, 0)).runs += 1
        return list(made.values())

    def _problems(self) -> list[FoundProblem]:
        made: dict[tuple[str, str], FoundProblem] = {}
        for point in self._by_shift():
            for finding in {one[:2]: one for one in self.findings(self.seen[point])}.values():
                made.setdefault(finding[:2], FoundProblem(finding, point, 0)).runs += 1
        return list(made.values())

    def _by_shift(self) -> list[Point]:
        return sorted(self.seen, key=lambda point: (*shift(self.base, point), point))

    def key(self) -> dict[str, Any]:
        """Everything that determines the runs, for resuming."""
        plan = asdict(self.plan)
        runs = {name: plan[name] for name in ("scenario", "policy", "isolate")}
        moves = [one.path for one in self.targets]
        return {"prima": __version__, **runs, "moves": moves, "files": self.stage.digests()}

    def boundaries(self, which: int) -> list[LinePiece]:
        """The pieces of one event's times, with the others as written."""
        times = {
            point[which]: seen.order
            for point, seen in self.seen.items()
            if point == moved(self.base, which, point[which])
        }
        return pieces(times)


def _name(one: FoundOrder | FoundProblem) -> Any:
    """The name of what was found: the same wherever it is found."""
    return one.signature if isinstance(one, FoundOrder) else one.finding[:2]


def _is(signature: str) -> Callable[[Seen], bool]:
    return lambda seen: seen.order == signature


def _seen(made: Made | Died) -> Seen:
    if isinstance(made, Seen):
        return made
    reason = f"its process ended with code {made.code}" if isinstance(made, Died) else made.failures
    return Seen(3, failures=reason, found=[Finding("error", reason, reason)])


def _events(scenario: str, settings: ExperimentSettings) -> list[str]:
    """The paths of all times of a scenario's events."""
    root = Examiner.of([scenario], [], settings).scripts[0].root
    paths = [f"when[{number}]" for number in range(1, len(root.all("when")) + 1)]
    times = Examiner.of([scenario], paths, settings).targets(0)
    return [one.path for one in times if isinstance(read_value("delay", one.written), int)]
