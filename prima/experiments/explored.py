"""The results of an exploration as text, JSON and files."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any

from prima.errors import UsageError, counted
from prima.errors.visible import visible
from prima.experiments.examine import Finding, Seen
from prima.experiments.explore import Exploration, FoundOrder, FoundProblem
from prima.experiments.lines import Point
from prima.experiments.pools import Pool
from prima.experiments.variants import ORDER, discard
from prima.loading.writing import make_folder, write_whole
from prima.messages import Json
from prima.transcript.row import Row
from prima.version import __version__

RUNS, RESULT, ORDERS, PROBLEMS = "runs.jsonl", "explored.json", "orders", "problems"
"""Names in an exploration's folder."""
KINDS = ("endless", "error", "expect", "invariant")
"""The kinds of problems."""
WIDTH = 60
"""Characters of a row that a table of orders shows."""


class Explored:
    """The results of an exploration."""

    def __init__(self, exploration: Exploration) -> None:
        self.exploration = exploration

    @cached_property
    def _rows(self) -> dict[str, list[Row]]:
        """The rows of each order."""
        stage, variant = self.exploration.stage, self.exploration.variant
        made = {}
        for order in self.exploration.orders:
            one = variant(order.point)
            made[order.signature] = stage.rehearsed(one, stage.loaded(one)).rows()
        return made

    def difference(self, order: FoundOrder) -> str:
        """The first row that differs from the run as written."""
        base = self._rows[self.exploration.seen[self.exploration.base].order]
        for row, same in zip(self._rows[order.signature], base, strict=False):
            if row.key != same.key:
                text = " ".join(filter(None, (row.actor, row.app, row.what)))
                return f"{row.number}: {text}"
        return "" if len(self._rows[order.signature]) == len(base) else "its end"

    def shifts(self, point: Point) -> dict[str, tuple[float, float]]:
        """Each moved event's time and shift, in seconds."""
        one = self.exploration
        return {
            target.path: (time / 1000, (time - base) / 1000)
            for target, time, base in zip(one.targets, point, one.base, strict=True)
            if time != base
        }

    def moved(self, point: Point) -> str:
        """The same as a phrase."""
        moved = [f"{path} at {at:g} s ({by:+g} s)" for path, (at, by) in self.shifts(point).items()]
        return ", ".join(moved) or "as written"

    def data(self, written: bool) -> dict[str, Json]:
        """All results for JSON; times in seconds.

        Args:
            written: whether the problems are in a folder, too, where they have names.
        """
        one = self.exploration
        return {
            "prima": __version__,
            "scenario": one.plan.scenario,
            "policy": one.plan.policy or one.stage.scripts[0].policy,
            "moves": {
                target.path: time / 1000 for target, time in zip(one.targets, one.base, strict=True)
            },
            "within": one.plan.within / 1000,
            "step": one.plan.step / 1000,
            "depth": one.plan.depth,
            "complete": one.complete,
            "runs": len(one.seen),
            "orders": [self._order(order) for order in one.orders],
            "boundaries": {
                target.path: [
                    {"from": piece.first / 1000, "to": piece.last / 1000, "order": piece.order}
                    for piece in one.boundaries(which)
                ]
                for which, target in enumerate(one.targets)
            },
            "problems": [
                self._problem(problem, self.name(number, problem) if written else "")
                for number, problem in enumerate(one.problems, 1)
            ],
        }

    def _order(self, order: FoundOrder) -> dict[str, Json]:
        return {
            "order": order.signature,
            "runs": order.runs,
            "at": {path: at for path, (at, _) in self.shifts(order.point).items()},
            "difference": self.difference(order),
        }

    def _problem(self, problem: FoundProblem, name: str) -> dict[str, Json]:
        return {
            "kind": problem.finding.kind,
            "text": problem.finding.text,
            "runs": problem.runs,
            "at": {path: at for path, (at, _) in self.shifts(problem.point).items()},
            "scenario": f"{PROBLEMS}/{name}.xml" if name else None,
        }

    @staticmethod
    def name(number: int, problem: FoundProblem) -> str:
        """The name of a problem's files."""
        return f"{number}-{problem.finding.kind}"

    def text(self) -> Iterator[str]:
        """All results, line by line."""
        one = self.exploration
        wide = max(len(self.moved(order.point)) for order in one.orders)
        yield f"{'order':12}  {'runs':>6}  {'smallest shift':{wide}}  first difference"
        for order in one.orders:
            difference = visible(self.difference(order))
            difference = difference if len(difference) <= WIDTH else f"{difference[: WIDTH - 3]}..."
            moved = self.moved(order.point)
            yield f"{order.signature}  {order.runs:6}  {moved:{wide}}  {difference}".rstrip()
        for which, target in enumerate(one.targets):
            yield ""
            yield f"{target.path}:"
            for piece in one.boundaries(which):
                times = f"{piece.first / 1000:g} s to {piece.last / 1000:g} s"
                yield f"  {times:24}  {piece.order}"
        for number, problem in enumerate(one.problems, 1):
            yield ""
            yield f"{number}. {problem.finding.kind}, {counted(problem.runs, 'run')}:"
            yield f"   {visible(problem.finding.text)}"
            yield f"   {self.moved(problem.point)}"
        yield ""
        yield self.summary()

    def summary(self) -> str:
        """How much was tried, and how much was found."""
        one = self.exploration
        found = f"{counted(len(one.orders), 'order')}, {counted(len(one.problems), 'problem')}"
        runs = counted(len(one.seen), "run")
        if not one.complete and len(one.seen) < one.plan.most:
            return f"{runs}: {found}; not complete: it was interrupted"
        if not one.complete:
            return f"{runs}: {found}; not complete: raise --runs ({one.plan.most}), or move less"
        depth = min(one.plan.depth, len(one.targets))
        events = counted(depth, "event")
        return f"{runs}: {found}; complete for {events} moved at once by up to {one.plan.within / 1000:g} s"


class ExplorationFolder:
    """An exploration's folder: its runs, as they are made, and its results."""

    def __init__(self, exploration: Exploration, path: str) -> None:
        self.exploration = exploration
        self.path = Path(path)

    @contextmanager
    def keeping(self, resume: bool) -> Iterator[int]:
        """Keep runs as they are made; returns the number of those kept before.

        Raises:
            UsageError: nothing can be written, or the file to be resumed is of another exploration.
        """
        one = self.exploration
        try:
            make_folder(self.path)
            file = self.path / RUNS
            kept = self._earlier(file) if resume and file.is_file() else []
            head = json.dumps(one.key()) + "\n"
            write_whole(file, head + "".join(_line(point, seen) for point, seen in kept))
            one.kept = dict(kept)
            with file.open("a", encoding="utf-8") as stream:

                def keep(point: Point, seen: Seen) -> None:
                    stream.write(_line(point, seen))
                    stream.flush()

                one.keep = keep
                yield len(kept)
        except OSError as error:
            raise UsageError(f"{self.path}: cannot be written: {error.strerror}.") from None

    def _earlier(self, file: Path) -> list[tuple[Point, Seen]]:
        """The runs of an earlier exploration; an incomplete line is omitted."""
        with file.open(encoding="utf-8", errors="replace") as stream:
            if _read(stream.readline()) != self.exploration.key():
                message = f"{self.path}: it is of another exploration, version or document"
                raise UsageError(f"{message}. Begin anew without --resume, or name another folder.")
            lines = (_read(line) for line in stream)
            return [made for line in lines if (made := _run(line, len(self.exploration.base)))]

    def write(self, explored: Explored) -> None:
        """Write the results: orders and problems as scenarios with their transcripts.

        Those of an earlier exploration are removed.

        Raises:
            UsageError: something cannot be written.
        """
        try:
            discard(self.path / ORDERS)
            discard(self.path / PROBLEMS, f"[0-9]+-({'|'.join(KINDS)})")
            for order in self.exploration.orders:
                self._case(ORDERS, order.signature, order.point)
            for number, problem in enumerate(self.exploration.problems, 1):
                self._case(PROBLEMS, explored.name(number, problem), problem.point)
            data = json.dumps(explored.data(written=True), indent=1, ensure_ascii=False)
            write_whole(self.path / RESULT, data + "\n")
        except OSError as error:
            raise UsageError(f"{self.path}: cannot be written: {error.strerror}.") from None

    def _case(self, folder: str, name: str, point: Point) -> None:
        """Write a run as a scenario, and its transcript if it can be made."""
        there = self.path / folder
        there.mkdir(exist_ok=True)
        self.exploration.stage.save(there, name, self.exploration.variant(point))


def carried_out(
    exploration: Exploration, pool: Pool, output: str | Path | None, resume: bool
) -> Iterator[int]:
    """Make all runs, and write the results into a folder, if one is named.

    Yields the number of runs whenever one is made; first, of those kept from before.

    Raises:
        UsageError: a policy is unknown, or a file cannot be written or resumed.
        RunError: no process can be started.
    """
    if output is None:
        yield 0
        yield from exploration.explore(pool)
        return
    folder = ExplorationFolder(exploration, os.fspath(output))
    with folder.keeping(resume) as kept:
        yield kept
        yield from exploration.explore(pool)
    folder.write(Explored(exploration))


def _line(point: Point, seen: Seen) -> str:
    made = {"at": point, **asdict(seen), "measures": {}}
    return json.dumps(made, separators=(",", ":")) + "\n"


def _read(line: str) -> Any:
    try:
        return json.loads(line)
    except (ValueError, RecursionError):
        return None


def _run(data: Any, moves: int) -> tuple[Point, Seen] | None:
    """A kept run; None if it is incomplete or damaged."""
    try:
        point = tuple(int(one) for one in data.pop("at"))
        seen = Seen(**{**data, "found": [Finding(*one) for one in data["found"]]})
    except (AttributeError, KeyError, OverflowError, TypeError, ValueError):
        return None
    return (point, seen) if len(point) == moves and _sound(seen) else None


def _sound(seen: Seen) -> bool:
    """Whether a kept run has values of the right types, and names files of its own folder only."""
    words = (seen.ended, seen.failures, seen.order, *chain.from_iterable(seen.found))
    numbers = (seen.exit, seen.expects_failed)
    lists = (seen.times, seen.outside)
    return (
        all(type(one) is str for one in words)
        and all(type(one) is list for one in lists)
        and all(type(one) is int for one in (*numbers, *chain.from_iterable(lists)))
        and re.fullmatch(f"({ORDER})?", seen.order) is not None
        and all(one.kind in KINDS for one in seen.found)
    )
