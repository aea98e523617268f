"""Sweeps: runs of scenarios over factors, in one tidy table (docs/experiments.md).

The table grows in the order of the plan while runs are made, so an interrupted sweep leaves the
beginning of its table, and ``resume`` continues after it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from errno import ENOSPC
from itertools import chain, islice, product
from pathlib import Path

from prima.errors import UsageError, counted
from prima.experiments.design import Design
from prima.experiments.levels import Factor, cell, read_factor
from prima.experiments.pools import Pool
from prima.experiments.scenariotext import Variant
from prima.experiments.settings import ExperimentSettings
from prima.experiments.table import (
    check_name,
    columns,
    dictionary,
    line,
    read_rows,
    whole_rows,
    write_parquet,
)
from prima.experiments.variants import Made, Stage, discard
from prima.loading.files import is_name
from prima.loading.similar import in_words
from prima.loading.writing import make_folder, write_whole
from prima.messages import Json
from prima.pool import Died
from prima.version import __version__

MOST_CHECKED = 2_000
"""Number of levels tried before the first run, divided equally among scenarios and factors."""
PLAN, ORDERS, ROWS = "plan.json", "orders", "rows.csv"
"""Names in the folder beside a table."""


@dataclass(frozen=True)
class SweepQuestion:
    """The question of a sweep: scenarios, what is varied in them, how, and how often."""

    scenarios: tuple[str, ...]
    vary: Mapping[str, str] = field(default_factory=dict)
    """Levels by path, as in :mod:`prima.experiments.levels`."""
    policies: tuple[str, ...] = ()
    """Policies; each scenario's own if empty."""
    seeds: int = 1
    design: str = "full"
    runs: int | None = None
    bound: int | None = None
    patience: int | None = None
    """Rule E6's bound (ms), if not the scenario's."""
    isolate: str = "ea"
    folder: str = ""
    """The folder for files of values."""
    places: Mapping[str, str] = field(default_factory=dict)
    """Where in a study file its paths, policies and scenarios are written."""

    def placed(self, error: UsageError) -> UsageError:
        """A mistake with its place in the study file, if it concerns something in it."""
        message = in_words(error)
        for name, place in self.places.items():
            if message.startswith((f"{name}: ", f"{name} ")) or f'"{name}"' in message:
                return UsageError(f"{place}: {message}")
        return error


class Sweep:
    """The plan of a sweep, checked: everything that its runs need has been read."""

    def __init__(self, question: SweepQuestion) -> None:
        """Plan a sweep.

        Raises:
            DocumentError: a scenario has errors.
            UsageError: a factor, level, policy or design is wrong.
        """
        self.question = question
        try:
            self._check_scenarios(question)
            self._plan(question)
        except UsageError as error:
            raise question.placed(error) from None

    def _check_scenarios(self, question: SweepQuestion) -> None:
        """Refuse a scenario that is named twice: each of its runs would count twice."""
        seen: dict[str, str] = {}
        for name in question.scenarios:
            if not is_name(name):
                raise UsageError(f"{name}: this is not a file's name.")
            path = os.path.realpath(name)  # Path.resolve fails on loops of links
            if path in seen:
                also = f', as "{seen[path]}"' if seen[path] != name else ""
                raise UsageError(f'The scenario "{name}" is there twice{also}.')
            seen[path] = name

    def _plan(self, question: SweepQuestion) -> None:
        settings = ExperimentSettings(question.bound, question.patience, question.isolate)
        self.stage = Stage.of(question.scenarios, list(question.vary), settings)
        self.factors = self._factors()
        self._check_seeds()
        self.design = Design(question.design, self.factors, question.seeds, question.runs)
        self.policies = self._policies()
        self.columns = columns(self.factors)
        self._check_levels()

    def __len__(self) -> int:
        return len(self.design) * len(self.policies) * len(self.question.scenarios)

    def __iter__(self) -> Iterator[Variant]:
        return map(self.at, range(len(self)))

    def at(self, number: int) -> Variant:
        """One run, counted from 0."""
        place, index = divmod(number, len(self.design))
        scenario, policy = divmod(place, len(self.policies))
        return Variant(number, scenario, self.policies[policy], *self.design.at(index))

    def _factors(self) -> list[Factor]:
        """The factors; every scenario has to contain the varied values."""
        made = []
        for index, (path, levels) in enumerate(self.question.vary.items()):
            kinds = set()
            for number in range(len(self.question.scenarios)):
                target = self.stage.targets(number)[index]
                check_name(target)
                kinds.add(target.kind)
                factor = read_factor(target, levels, self.question.folder)
            if len(kinds) > 1:
                raise UsageError(f"{path}: it is of another kind in each scenario.")
            made.append(factor)
        return made

    def _check_seeds(self) -> None:
        if self.question.seeds < 1:
            raise UsageError("--seeds: write a whole number from 1.")
        drawn = [one.path for one in self.factors if one.quantile]
        if drawn and self.question.design == "full" and self.question.seeds == 1:
            message = f"{drawn[0]}: its values are drawn by seed: write how many, as --seeds 20"
            raise UsageError(f"{message}, or levels: LOW..HIGH/STEP.")

    def _policies(self) -> list[str]:
        from prima.loading.heads import chosen_policy

        policies = list(dict.fromkeys(self.question.policies))
        for scenario in range(len(self.question.scenarios)):
            written = tuple(one.as_it_is for one in self.stage.targets(scenario))
            loaded = self.stage.loaded(Variant(0, scenario, "", 0, written))
            for policy in policies:
                chosen_policy(policy, loaded)
        return policies or [""]

    def _check_levels(self) -> None:
        """Try each level once, with the others as written.

        Raises:
            UsageError: the scenario does not allow one.
        """
        scenarios = range(len(self.question.scenarios))
        most = max(MOST_CHECKED // max(len(self.factors) * len(scenarios), 1), 1)
        for scenario, (index, factor) in product(scenarios, enumerate(self.factors)):
            written = tuple(one.as_it_is for one in self.stage.targets(scenario))
            for level in factor.levels[:most]:
                values = (*written[:index], level, *written[index + 1 :])
                found = self.stage.problems(Variant(0, scenario, "", 0, values))
                if found:
                    message = " ".join(filter(None, (found[0].message, found[0].remedy)))
                    raise UsageError(f'{factor.path}: with "{level}": {message}')

    def row(self, variant: Variant, made: Made | Died, folder: str) -> list[Json]:
        """A row of the table."""
        if isinstance(made, Died):
            reason = f"its process ended with code {made.code}"
            made = Made(3, failures=reason if made.code >= 0 else f"{reason}: no memory left?")
        script = self.stage.scripts[variant.scenario]
        cells: dict[str, Json] = {
            "run": variant.number,
            "scenario": script.path,
            "policy": variant.policy or script.policy,
            "seed": variant.seed,
            "exit": made.exit,
            "ended": made.ended,
            "failures": made.failures,
            "expects_failed": made.expects_failed,
            "order": made.order,
            "transcript": f"{folder}/{ORDERS}/{made.order}.jsonl" if folder and made.order else "",
            **made.measures,
        }
        for factor, value in zip(self.factors, variant.values, strict=True):
            cells[factor.path] = cell(factor.kind, value)
        return [cells.get(one.name) for one in self.columns]

    def key(self) -> dict[str, Json]:
        """Everything that determines the table, for resuming."""
        question = asdict(self.question)
        del question["folder"], question["places"]
        return {
            "prima": __version__,
            "question": json.loads(json.dumps(question)),
            "levels": [list(one.levels) for one in self.factors],
            "runs": len(self),
            "files": [*self.stage.digests(), *(one.file for one in self.factors if one.file)],
        }

    def results(self, pool: Pool, begin: int = 0, folder: str = "") -> Iterator[list[Json]]:
        """Make the runs from a number on; yield their rows in order."""
        with pool(self.stage) as runs:
            for variant, made in runs(map(self.at, range(begin, len(self)))):
                yield self.row(variant, made, folder)


class Output:
    """A sweep's table on the disk, and the folder beside it."""

    def __init__(self, sweep: Sweep, path: str, pool: Pool) -> None:
        """Choose where a table is written.

        Raises:
            UsageError: it is neither a ``.csv`` nor a ``.parquet`` file.
        """
        self.sweep = sweep
        self.path = Path(path)
        self.pool = pool
        if self.path.suffix not in (".csv", ".parquet"):
            raise UsageError(f"{path}: name a table that ends with .csv or .parquet.")
        self.parquet = self.path.suffix == ".parquet"
        if self.parquet:
            from prima.experiments.table import pyarrow_module

            pyarrow_module()
        self.folder = self.path.with_suffix("")
        self.rows = self.folder / ROWS if self.parquet else self.path

    def write(self, resume: bool = False) -> Iterator[int]:
        """Make all runs; yields the number of rows each time one is written.

        If it ends early for any reason, the rows made so far and the table are on the disk.

        Raises:
            UsageError: something cannot be written, or the table to be resumed is of another sweep.
            RunError: no process can be started.
        """
        first: list[list[Json]] | None = None
        try:
            make_folder(self.folder)
            there = self._earlier() if resume else 0
            rows = self.sweep.results(self.pool, there, self.folder.name)
            first = list(islice(rows, 1))  # before it replaces a table: a cluster may not answer
            if not there:
                discard(self.folder / ORDERS)
                write_whole(self.rows, line([one.name for one in self.sweep.columns]))
            write_whole(self.folder / PLAN, json.dumps(self.sweep.key(), indent=1) + "\n")
            described = dictionary(self.path.name, self.sweep.columns)
            write_whole(self.folder / "dictionary.json", described)
            yield there
            yield from self._append(there, chain(first, rows))
        except OSError as error:
            remedy = "; make room, then --resume" if error.errno == ENOSPC else ""
            raise UsageError(f"{self.path}: cannot be written: {error.strerror}{remedy}.") from None
        finally:
            if self.parquet and first is not None and self.rows.is_file():
                write_parquet(self.rows, self.path, self.sweep.columns)
        self._write_orders()

    def _append(self, begin: int, rows: Iterator[list[Json]]) -> Iterator[int]:
        with self.rows.open("a", encoding="utf-8", newline="") as stream:
            for number, row in enumerate(rows, begin + 1):
                stream.write(line(row))
                stream.flush()
                yield number

    def _earlier(self) -> int:
        """The number of rows that an earlier sweep has left; an incomplete last one is removed.

        Raises:
            UsageError: it was another sweep.
        """
        plan = self.folder / PLAN
        if not plan.is_file() or not self.rows.is_file():
            return 0
        try:
            read = json.loads(plan.read_text(encoding="utf-8"))
        except (ValueError, RecursionError):
            read = None
        key = read if isinstance(read, dict) else {}
        if key != self.sweep.key():
            different = [one for one in self.sweep.key() if key.get(one) != self.sweep.key()[one]]
            what = {"prima": "with another version of PRIMA", "files": "with other documents"}
            why = what.get(different[0], "with other factors or options")
            message = f"{self.path}: it was made {why}, so it cannot be resumed."
            raise UsageError(f"{message} Begin anew without --resume, or name another file.")
        return whole_rows(self.rows, self.sweep.columns)

    def read(self) -> Iterator[dict[str, Json]]:
        """The rows of the table."""
        with self.rows.open(encoding="utf-8", newline="") as stream:
            yield from read_rows(stream, self.sweep.columns)

    def _write_orders(self) -> None:
        """Write the first run of each order: its scenario and its transcript."""
        folder = self.folder / ORDERS
        folder.mkdir(exist_ok=True)
        firsts: dict[str, int] = {}
        for row in self.read():
            if row["order"]:
                firsts.setdefault(str(row["order"]), int(str(row["run"])))
        left = {n: o for o, n in firsts.items() if not (folder / f"{o}.jsonl").is_file()}
        for variant in self.sweep:
            if not left:
                return
            if (order := left.pop(variant.number, None)) is not None:
                self.sweep.stage.save(folder, order, variant)


def estimate(sweep: Sweep, workers: int) -> str:
    """Estimates a sweep's duration and the size of its table, from ten runs across the plan."""
    from time import perf_counter

    chosen = [sweep.at(number) for number in range(0, len(sweep), -(-len(sweep) // 10))]
    sweep.stage.run(chosen[0])  # the first one of a process is much slower
    begin = perf_counter()
    size = sum(len(line(sweep.row(one, sweep.stage.run(one), "x"))) for one in chosen)
    each = (perf_counter() - begin) / len(chosen)
    seconds = each * len(sweep) / workers
    megabytes = size / len(chosen) * len(sweep) / 1e6
    time = f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
    time = time if seconds < 7200 else f"{seconds / 3600:.1f} h"
    where = "1 process" if workers == 1 else f"{workers} processes"
    return (
        f"{counted(len(sweep), 'run')}: about {time} with {where}"
        f" ({each * 1000:.0f} ms a run), a table of about {megabytes:.1f} MB"
    )
