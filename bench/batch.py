"""One batch on two workers beside two independent batches of one worker, half of the runs each.

``python -m bench.batch [--rounds N]`` prints the ratio of their throughputs. Both make the same
runs, and their files are compared byte for byte.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from time import perf_counter

ROOT = Path(__file__).parent.parent
HALVES = ("one", "two")
"""Folders with the same scenarios, so that both halves are the same work."""
POLICIES = ("prima", "fifo")


def ratio(rounds: int = 3) -> float:
    """The throughput of ``--workers 2`` divided by that of two processes started together.

    Each round takes both, in turns the one and the other first; the median of the rounds counts.

    Args:
        rounds: how many rounds, of 116 runs in each of the two ways.
    """
    found = []
    with tempfile.TemporaryDirectory() as folder:
        stage = Path(folder)
        for half in HALVES:
            shutil.copytree(ROOT / "documents", stage / half)
        for number in range(rounds):
            seconds = {}
            for which in ("together", "apart") if number % 2 else ("apart", "together"):
                parts = [HALVES] if which == "together" else [(half,) for half in HALVES]
                seconds[which] = _seconds(stage, which, parts, 3 - len(parts))
            found.append(seconds["apart"] / seconds["together"])
            _compare(stage / "together", stage / "apart")
    return median(found)


def _seconds(stage: Path, output: str, parts: Sequence[tuple[str, ...]], workers: int) -> float:
    """How long batches take that are started together, each with its own folders."""
    shutil.rmtree(stage / output, ignore_errors=True)
    policies = [word for policy in POLICIES for word in ("--policy", policy)]
    began = perf_counter()
    running = [
        subprocess.Popen(
            [
                *(sys.executable, "-m", "prima", "run"),
                *(f"{half}/scenarios" for half in part),
                *(*policies, "--workers", str(workers), "-o", output),
            ],
            cwd=stage,
            stdout=subprocess.DEVNULL,
        )
        for part in parts
    ]
    codes = [one.wait() for one in running]
    seconds = perf_counter() - began
    assert codes == [0] * len(parts), codes
    return seconds


def _compare(one: Path, other: Path) -> None:
    """See that two folders hold the same files."""
    first, second = (_files(folder) for folder in (one, other))
    assert first and first == second, sorted(set(first) ^ set(second))


def _files(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def main() -> None:
    """Measure, and print the ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    rounds = parser.parse_args().rounds
    print(f"{ratio(rounds):.3f} of two independent processes")


if __name__ == "__main__":
    main()
