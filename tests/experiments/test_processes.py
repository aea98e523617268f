"""The processes of a batch: which code they run, interrupts, and those that are killed."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from prima.experiments.batch import run_batch
from prima.experiments.plan import BatchPlan, BatchRow, Job, Options
from prima.pool import Died
from tests import ROOT
from tests.helpers.batches import (
    HELLO,
    MODULE,
    POLICIES,
    SECONDS,
    begun,
    files,
    prima,
    until,
    write,
)


def test_the_processes_are_of_the_version_that_starts_them(stage: Path) -> None:
    """A checkout that one works in counts, and not a version that is installed beside it."""
    shutil.copytree(ROOT / "prima", "prima", ignore=shutil.ignore_patterns("__pycache__"))
    here = Path("prima/version.py")
    here.write_text(re.sub('__version__ = ".*"', '__version__ = "9.9"', here.read_text()))
    assert prima("b", "-o", "runs").returncode == 0
    assert json.loads(Path("runs/b/one.run.json").read_text())["key"]["prima"] == "9.9"


@pytest.mark.parametrize("most", [40, 60])
def test_a_system_that_has_no_more_processes(stage: Path, most: int) -> None:
    """Fewer files may be open than so many processes need: those that begin do the work."""
    command = f"ulimit -n {most}; {' '.join(MODULE)} a b --policy prima --policy fifo --workers 12"
    few = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=SECONDS, check=False
    )
    assert few.stdout == prima("a", "b", *POLICIES).stdout, few.stderr
    assert few.returncode == 3


def test_a_module_beside_the_scenarios_is_not_taken_for_one_of_python(stage: Path) -> None:
    for name in ("json", "random", "signal", "selectors"):
        write(f"{name}.py", "raise SystemExit('not this one')\n")
    code = "from prima.__main__ import main; main()"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, "run", "a/one.xml", "b"],
        capture_output=True, text=True, timeout=SECONDS, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_a_script_needs_no_guard(stage: Path) -> None:
    """The processes do not import the script that calls."""
    write("script.py", "import prima\nprint(prima.sweep('a/one.xml', workers=2).num_rows)\n")
    done = subprocess.run(
        [sys.executable, "script.py"], capture_output=True, text=True, timeout=SECONDS, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert (done.stdout, done.stderr) == ("1\n", "")


def test_how_the_death_of_a_process_is_told(stage: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fates: list[BatchRow | Died] = [Died(-9), Died(3), Died(11), BatchRow("b/one.xml", "prima")]

    def mock(
        _function: object, items: BatchPlan, *_: object
    ) -> Iterator[tuple[Job, BatchRow | Died]]:
        yield from zip(items, fates, strict=True)

    monkeypatch.setattr("prima.experiments.batch.spread", mock)
    rows = list(run_batch(BatchPlan(["a", "b/one.xml"]), Options()))
    assert [row.exit for row in rows] == [3, 3, 3, 0]
    assert [row.messages for row in rows[:3]] == [
        ["its process was killed by the signal SIGKILL; was there no memory left?"],
        ["its process ended with code 3."],
        ["its process ended with code 11."],
    ]


def children(parent: int) -> set[int]:
    """The processes below one, however deep."""
    return {one.pid for one in psutil.Process(parent).children(recursive=True)}


def alive(processes: set[int]) -> set[int]:
    states = {one.pid: one.info["status"] for one in psutil.process_iter(["status"])}
    return {
        one for one in processes if states.get(one, psutil.STATUS_ZOMBIE) != psutil.STATUS_ZOMBIE
    }


def test_ctrl_c_ends_all_at_once(stage: Path) -> None:
    made = begun(stage)
    below = children(made.pid)
    assert len(below) >= 3
    made.send_signal(signal.SIGINT)
    out, errors = made.communicate(timeout=10)
    assert (made.returncode, errors) == (130, "prima: interrupted\n")
    until(lambda: not alive(below))
    assert "b/one.xml" in out and "b/x.xml" not in out
    assert set(files("runs")) == {"b/one.jsonl", "b/one.run.json"}
    shown = subprocess.run([*MODULE[:-1], "show", "runs/b/one.jsonl"], capture_output=True)
    assert shown.returncode == 0 and b"Hello there." in shown.stdout


@pytest.mark.parametrize("name", ["SIGKILL", "SIGTERM"])
def test_a_batch_that_is_killed_leaves_nothing_behind_and_goes_on(stage: Path, name: str) -> None:
    made = begun(stage)
    below = children(made.pid)
    made.send_signal(getattr(signal, name))
    made.communicate(timeout=10)
    until(lambda: not alive(below))
    until(lambda: set(files("runs")) == {"b/one.jsonl", "b/one.run.json"})
    write("a/endless.xml", HELLO)
    words = ("b/one.xml", "b/x.xml", "b/y.xml", "b/five.xml")
    again = prima(*words, "-o", "runs", "--resume")
    assert again.stderr == "1 of 4 runs had been made before\n"
    fresh = prima(*words, "-o", "fresh")
    assert (again.stdout, again.returncode) == (fresh.stdout, fresh.returncode)
    assert files("runs") == files("fresh")


def test_a_worker_that_is_killed_is_told_and_the_others_go_on(stage: Path) -> None:
    made = begun(stage)
    first, second = (int(one.stem) for one in stage.glob("runs/.prima-*/*.jsonl"))
    os.kill(first, signal.SIGKILL)
    until(lambda: Path("runs/b/five.jsonl").exists())
    os.kill(second, signal.SIGKILL)
    out, errors = made.communicate(timeout=SECONDS)
    assert made.returncode == 3
    assert out.splitlines()[-1] == "runs: 4; fine: 2; exit code 3: 2"
    assert errors.count("its process was killed by the signal SIGKILL") == 2
