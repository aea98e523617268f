"""Runs on a cluster: a scheduler of Dask and workers as processes of this machine."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("distributed")

from types import SimpleNamespace

import prima as package
from prima.errors import RunError, UsageError
from prima.experiments.cluster import pool_of
from prima.experiments.scenariotext import Variant
from prima.experiments.sweep import Sweep, SweepQuestion
from prima.experiments.variants import Made, Stage
from prima.pool import Died
from tests import ROOT
from tests.helpers import command
from tests.helpers.batches import files, until
from tests.helpers.here import prima
from tests.helpers.sweeps import write_visit

ENVIRONMENT = {
    **os.environ,
    "PYTHONPATH": str(ROOT),
    "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
}
ALONE = ("--nthreads", "1", "--no-nanny")
VARY = ("--vary", "touch=0s..8s/50ms", "--policy", "prima", "--policy", "fifo")


def begin(*words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "dask", *words],
        env=ENVIRONMENT, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
        start_new_session=True,
    )  # fmt: skip


def listens(process: subprocess.Popen[str], what: str) -> str:
    """The address that a process prints; what it prints afterwards is thrown away."""
    assert process.stderr is not None
    for line in process.stderr:
        found = re.search(rf"{what}.*?(tcp://[0-9.:]+)", line)
        if found:
            threading.Thread(target=process.stderr.read, daemon=True).start()
            return found[1]
    raise AssertionError(f"no {what}")


class Cluster:
    """A scheduler and its workers."""

    def __init__(self) -> None:
        self.processes = [
            begin("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        ]
        self.address = listens(self.processes[0], "Scheduler at:")

    def worker(self, *words: str) -> subprocess.Popen[str]:
        one = begin("worker", self.address, "--no-dashboard", *(words or ALONE))
        self.processes.append(one)
        listens(one, "Registered to:")
        return one

    def end(self) -> None:
        """End them at once, with the processes that they have begun: nobody waits for their results."""
        for one in reversed(self.processes):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(one.pid, signal.SIGKILL)
            one.wait()


@pytest.fixture
def dask() -> Iterator[Cluster]:
    made = Cluster()
    yield made
    made.end()


@pytest.fixture(autouse=True)
def visit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_visit(tmp_path)
    return tmp_path


def test_a_cluster_makes_the_same_files(dask: Cluster) -> None:
    """Byte for byte; the workers are elsewhere, and read no file of this folder."""
    here = Path.cwd()
    os.chdir("/")
    try:
        dask.worker()
        dask.worker()
    finally:
        os.chdir(here)
    for folder in ("local", "there"):
        Path(folder).mkdir()
    assert prima("sweep", "visit.xml", *VARY, "-o", "local/t.csv").returncode == 0
    done = command.prima("sweep", "visit.xml", *VARY, "-o", "there/t.csv", "--on", dask.address)
    assert done.returncode == 0, done.stderr
    assert files("there") == files("local")
    local = prima("explore", "visit.xml", "-o", "local/e")
    there = command.prima("explore", "visit.xml", "-o", "there/e", "--on", dask.address)
    assert there.stdout == local.stdout, there.stderr
    assert files("there") == files("local")
    table = package.sweep("visit.xml", {"touch": "1s|2s"}, on=dask.address)
    assert table.equals(package.sweep("visit.xml", {"touch": "1s|2s"}))


def test_a_worker_killed_in_the_middle_loses_nothing(dask: Cluster) -> None:
    killed = dask.worker()
    dask.worker()
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", "sweep", "visit.xml", "-o", "t.csv", "--on", dask.address,
         "--vary", "touch=0s..8s/10ms"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    until(lambda: Path("t.csv").exists() and Path("t.csv").read_bytes().count(b"\n") > 50)
    assert made.poll() is None
    killed.send_signal(signal.SIGKILL)
    out, err = made.communicate(timeout=120)
    assert made.returncode == 0, err
    assert out.startswith("t.csv: 801 runs, ")
    Path("local").mkdir()
    prima("sweep", "visit.xml", "--vary", "touch=0s..8s/10ms", "-o", "local/t.csv")
    assert Path("local/t.csv").read_bytes() == Path("t.csv").read_bytes()


def test_a_cluster_whose_workers_have_all_gone(dask: Cluster, monkeypatch: Any) -> None:
    """It says so, ends after a while, and goes on with --resume as soon as there is one."""
    monkeypatch.setenv("PRIMA_CLUSTER_PATIENCE", "9")
    words = ["sweep", "visit.xml", "-o", "t.csv", "--on", dask.address, *VARY]
    only = dask.worker()
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", *words],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    until(lambda: Path("t.csv").exists() and Path("t.csv").read_bytes().count(b"\n") > 20)
    only.send_signal(signal.SIGKILL)
    out, err = made.communicate(timeout=90)
    assert (made.returncode, out) == (3, ""), err
    assert err.count("has no worker; waiting for one, 9 s at most") == 1
    assert "has had no worker for 9 s. Start some, and go on with --resume." in err
    assert Path("t.csv").read_bytes().count(b"\n") > 20
    dask.worker()
    done = command.prima(*words, "--resume")
    assert done.returncode == 0, done.stderr
    Path("local").mkdir()
    prima("sweep", "visit.xml", *VARY, "-o", "local/t.csv")
    assert Path("local/t.csv").read_bytes() == Path("t.csv").read_bytes()


def test_a_patience_that_is_none(dask: Cluster, monkeypatch: Any) -> None:
    for wrong in ("soon", "0", "-1", "nan", "inf"):
        monkeypatch.setenv("PRIMA_CLUSTER_PATIENCE", wrong)
        done = prima("sweep", "visit.xml", "--on", dask.address)
        assert done.returncode == 2 and "write seconds, as 300" in done.stderr, done.stderr


class Deadly(Stage):
    """Makes runs, of which one kills its process."""

    def run(self, variant: Variant) -> Made:
        if variant.number == 3:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().run(variant)


def test_a_worker_that_dies_each_time_costs_that_run(dask: Cluster) -> None:
    for _ in range(2):
        dask.worker("--nthreads", "1")  # with a nanny, which starts another
    sweep = Sweep(SweepQuestion(("visit.xml",), {"touch": "0s..1s/100ms"}))
    deadly = Deadly.of(["visit.xml"], ["touch"], sweep.stage.settings)
    results: list[Any] = []
    with pool_of(dask.address, None)(deadly) as runs:
        results = [made for _, made in runs(sweep)]
    assert [number for number, made in enumerate(results) if isinstance(made, Died)] == [3]
    assert results[4] == sweep.stage.run(list(sweep)[4])
    row = sweep.row(list(sweep)[3], results[3], "")
    assert "its process ended with code 1" in row


def test_a_worker_that_ends_while_it_is_asked(
    dask: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    dask.worker()
    calls: list[str] = []

    def ending(client: Any, address: str) -> None:
        calls.append(address)
        if len(calls) < 2 or dask.address != address:
            raise OSError("closed")

    monkeypatch.setattr("prima.experiments.cluster._check", ending)
    assert package.sweep("visit.xml", on=dask.address).num_rows == 1
    assert len(calls) == 2
    dask.address = ""
    monkeypatch.setattr("prima.experiments.cluster.TRIES", 1)
    with pytest.raises(RunError, match="its scheduler or its workers end before they answer"):
        package.sweep("visit.xml", on=calls[0])


def test_a_plan_counts_the_cluster_s_workers(dask: Cluster) -> None:
    for _ in range(3):
        dask.worker()
    done = command.prima("sweep", "visit.xml", *VARY, "--plan", "--on", dask.address)
    assert "322 runs: about" in done.stdout and "with 3 processes" in done.stdout, done.stderr


def test_nobody_answers(tmp_path: Path) -> None:
    earlier = tmp_path / "t.csv"
    earlier.write_text("An earlier table.")
    began = time.monotonic()
    done = command.prima("sweep", "visit.xml", "--on", "tcp://127.0.0.1:9", "-o", str(earlier))
    assert (done.returncode, done.stdout) == (2, "")
    assert earlier.read_text() == "An earlier table."
    assert "no scheduler" in done.stderr and "dask scheduler" in done.stderr, done.stderr
    assert time.monotonic() - began < 40
    for wrong in ("127.0.0.1:8786", "http://x", "tcp://", "tcp://x:port", "tcp://x:1/\x1b[2J"):
        done = prima("sweep", "visit.xml", "--on", wrong)
        assert done.returncode == 2 and "write the address" in done.stderr, done.stderr
        assert "\x1b" not in done.stderr
    done = prima("sweep", "visit.xml", "--on", "tcp://127.0.0.1:9", "-j", "2")
    assert done.returncode == 2 and "--workers is for this machine" in done.stderr


def test_workers_of_another_kind(dask: Cluster, monkeypatch: pytest.MonkeyPatch) -> None:
    dask.worker("--nthreads", "2")
    with pytest.raises(UsageError, match=r"has 2 threads.*Start it with --nthreads 1"):
        package.sweep("visit.xml", on=dask.address)
    monkeypatch.setattr("prima.experiments.cluster.__version__", "9.9")
    with pytest.raises(UsageError, match=r"has prima .*; here are 9.9 and"):
        package.sweep("visit.xml", on=dask.address)


def test_the_page_s_program(dask: Cluster, visit: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the workers of this machine in place of those of SLURM."""
    page = (ROOT / "docs" / "experiments.md").read_text(encoding="utf-8")
    code = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)[1]
    asked: list[Any] = []

    def begun(**settings: object) -> Any:
        asked.append(settings)
        return SimpleNamespace(scheduler_address=dask.address, scale=scale)

    def scale(jobs: int) -> None:
        asked.append(jobs)
        dask.worker()

    monkeypatch.setitem(sys.modules, "dask_jobqueue", SimpleNamespace(SLURMCluster=begun))
    Path("study.toml").write_text('scenarios = ["visit.xml"]\n[vary]\ntouch = "1s|2s"\n')
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(code, "experiments.md", "exec"), names)
    assert asked[0]["cores"] == asked[0]["processes"] and asked[1] == 10
    assert names["table"].num_rows == 2 and Path("study.parquet").is_file()
