"""Sweeps and explorations: what their processes, a cluster and their search are worth.

``python -m bench.run --only Experiments`` measures them. All ways make the same runs, and what
came of them is compared.
"""

from __future__ import annotations

import re
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import islice
from time import perf_counter, process_time
from typing import TYPE_CHECKING, Any

from bench.fresh import ROOT, check, fresh

if TYPE_CHECKING:
    from prima.experiments.explore import Exploration
    from prima.experiments.pools import Pool
    from prima.experiments.sweep import Sweep

SCENARIO = "documents/scenarios/touched-on-the-way.xml"
WORKERS = 2
WARM = 8
"""Runs of each process that are not counted: of the first ones, starting is most."""


def _sweep(runs: int, seed: int = 1) -> Sweep:
    from prima.experiments.sweep import Sweep, SweepQuestion

    vary = {"when.at": "uniform(0s,20s)"}
    return Sweep(SweepQuestion((SCENARIO,), vary, seeds=seed, design="random", runs=runs))


def _rate(runs: int, pool: Pool) -> float:
    """Rows a second of a sweep, without the first ones."""
    sweep = _sweep(runs + WARM * WORKERS)
    rows = sweep.results(pool)
    began = 0.0
    count = 0
    for count, row in enumerate(rows, 1):
        check(row[sweep_exit(sweep)] == 0, f"run {count} is not fine: {row}")
        if count == WARM * WORKERS:
            began = perf_counter()
    check(count == len(sweep), f"{count} rows of {len(sweep)}")
    return runs / (perf_counter() - began)


def sweep_exit(sweep: Sweep) -> int:
    """The place of the exit code in a row."""
    return [one.name for one in sweep.columns].index("exit")


def pooled(runs: int) -> float:
    """Runs a second of a sweep on two processes of this machine."""
    from prima.experiments.pools import local

    return _rate(runs, local(WORKERS))


def independent(runs: int) -> float:
    """Runs a second of two processes that know nothing of each other."""
    with ThreadPoolExecutor(WORKERS) as both:
        figures = list(both.map(lambda _: fresh(alone, runs // WORKERS), range(WORKERS)))
    return sum(one.value for one in figures)


def alone(runs: int) -> float:
    """Runs a second of a sweep in this process."""
    sweep = _sweep(runs + WARM)
    plan = iter(sweep)
    for one in islice(plan, WARM):
        sweep.row(one, sweep.stage.run(one), "")
    began = perf_counter()
    for one in plan:
        check(sweep.row(one, sweep.stage.run(one), "")[sweep_exit(sweep)] == 0, "not fine")
    return runs / (perf_counter() - began)


def rows_seconds(runs: int) -> float:
    """Processor seconds of a sweep's rows: from the values to the table's line."""
    from prima.experiments.table import line

    sweep = _sweep(runs)
    return _seconds(sweep, lambda one: line(sweep.row(one, sweep.stage.run(one), "")))


def runs_seconds(runs: int) -> float:
    """Processor seconds of the same runs alone: from documents in memory to their end."""
    from prima import api

    sweep = _sweep(runs)
    plan = {one: sweep.stage.loaded(one) for one in sweep}
    return _seconds(sweep, lambda one: api.rehearse(plan[one], keep=False, rows=True))


def _seconds(sweep: Sweep, make: Callable[[Any], object]) -> float:
    plan = list(sweep)
    make(plan[0])
    began = process_time()
    for one in plan:
        make(one)
    return process_time() - began


def on_dask(runs: int) -> float:
    """Runs a second on two workers of Dask, as processes of this machine."""
    from prima.experiments.cluster import pool_of

    with _dask() as address:
        return _rate(runs, pool_of(address, None))


@contextmanager
def _dask() -> Iterator[str]:
    """A scheduler with its workers."""
    begun: list[subprocess.Popen[str]] = []
    try:
        address = _begin(begun, "Scheduler at:", "scheduler", "--host", "127.0.0.1", "--port", "0")
        for _ in range(WORKERS):
            _begin(begun, "Registered to:", "worker", address, "--nthreads", "1")
        yield address
    finally:
        for one in reversed(begun):
            one.terminate()
        for one in begun:
            one.wait()


def _begin(begun: list[subprocess.Popen[str]], said: str, *words: str) -> str:
    """Start a process; gives the address that it prints."""
    process = subprocess.Popen(
        [sys.executable, "-m", "dask", *words, "--no-dashboard"],
        stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, cwd=ROOT,
    )  # fmt: skip
    begun.append(process)
    assert process.stderr is not None
    for text in process.stderr:
        found = re.search(rf"{said}.*?(tcp://[0-9.:]+)", text)
        if found:
            threading.Thread(target=process.stderr.read, daemon=True).start()
            return found[1]
    raise RuntimeError(f"dask {words[0]} has ended")


def _exploration(within: int) -> Exploration:
    from prima.experiments.explore import Exploration, ExplorationPlan

    return Exploration(ExplorationPlan(SCENARIO, ("when",), within))


def explored(within: int) -> float:
    """Seconds until all orders of one event's times are known, with boundaries to 1 ms."""
    from prima.experiments.pools import local

    exploration = _exploration(within)
    began = perf_counter()
    for _ in exploration.explore(local(WORKERS)):
        pass
    check(exploration.complete, "it is not complete")
    return perf_counter() - began


def every_variant(within: int, most: int = 400) -> float:
    """Seconds of the runs of all these times, a millisecond apart, from at most so many of them."""
    from prima.experiments.pools import local

    exploration = _exploration(within)
    (home,) = exploration.base
    count = within + min(within, home) + 1
    times = range(home - min(within, home), home + within + 1, max(count // most, 1))
    variants = [exploration.variant((time,)) for time in times]
    began = perf_counter()
    with local(WORKERS)(exploration.stage) as runs:
        check(all(made for _, made in runs(variants)), "a run was not made")
    return (perf_counter() - began) * count / len(variants)
