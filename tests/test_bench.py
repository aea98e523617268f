"""The benchmarks do the work that they time; nothing here looks at the time."""

from __future__ import annotations

import pytest

from bench import workloads
from bench.run import JOBS

pytest.importorskip("resource")


@pytest.mark.parametrize("states", [2, 5])
@pytest.mark.parametrize("guards", [False, True])
def test_the_ring_counts_every_event(states: int, guards: bool) -> None:
    assert workloads.rate("prima", states, 20, guards) > 0


def test_the_other_workloads_check_their_results() -> None:
    assert workloads.load("prima", 10) > 0
    assert workloads.many("prima", 2)[0] > 0
    assert workloads.decisions(3, 10) > 0
    assert workloads.simulate(1) > 0


@pytest.mark.parametrize("system", ["sismic", "transitions"])
def test_the_peers_do_the_same_work(system: str) -> None:
    pytest.importorskip(system)
    assert workloads.rate(system, 3, 20, True) > 0
    assert workloads.load(system, 3) > 0


@pytest.mark.parametrize("what", ["bare", "help", "validate", "run"])
def test_processes_end_well(what: str) -> None:
    assert workloads.process(what) > 0


def test_every_job_names_a_workload() -> None:
    assert all(callable(getattr(workloads, function)) for function, _ in JOBS.values())
