"""A run that is killed at any moment goes on: 200 times, by SIGKILL."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
TOUR = Path(__file__).parent / "killed.xml"
ROBOT = ROOT / "documents" / "robots" / "simulated.xml"
RUNS, KILLS = 8, 25
LONGEST_S = 60


def prima(*words: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "prima", *words]
    return subprocess.Popen(
        command,
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
    )


def killed_after(seconds: float, journal: Path, *words: str) -> bool:
    """Let a run write to its journal, and kill it then; false if it had ended."""
    before = journal.stat().st_size if journal.exists() else 0
    running = prima("live", *words)
    began = time.monotonic()
    while running.poll() is None and time.monotonic() - began < LONGEST_S:
        if journal.exists() and journal.stat().st_size > before:
            break
        time.sleep(0.005)
    time.sleep(seconds)
    running.kill()
    _, told = running.communicate()
    assert b"defect" not in told, told.decode()
    return running.returncode == -9


def records_of(journal: Path) -> list[dict[str, Any]]:
    return [json.loads(text) for text in journal.read_text().splitlines()]


@pytest.mark.parametrize("seed", range(0, RUNS, 2))
def test_a_killed_run_goes_on(seed: int, tmp_path: Path) -> None:
    with ThreadPoolExecutor(2) as pool:  # a run mostly waits
        list(pool.map(partial(goes_on, tmp_path), (seed, seed + 1)))


def goes_on(folder: Path, seed: int) -> None:
    chance, journal = random.Random(seed), folder / f"visit-{seed}.jsonl"
    words = ["--robot", str(ROBOT), "--ea", str(TOUR), "-o", str(journal), "--speed", "5"]
    for _ in range(KILLS):
        if not killed_after(chance.uniform(0, 0.4), journal, *words):
            break  # on a busy machine it may have come to its end
        words = ["--resume", str(journal), "--speed", "5"]
    else:
        last = prima("live", "--resume", str(journal), "--speed", "100")
        _, told = last.communicate(timeout=LONGEST_S)
        assert last.returncode == 0, told.decode()
    records = records_of(journal)
    assert records[-1]["phase"] == "over"
    again = prima("replay", str(journal))
    _, told = again.communicate(timeout=LONGEST_S)
    assert again.returncode == 0, told.decode()
    check_said(records)


def check_said(records: list[dict[str, Any]]) -> None:
    """Everything is said, and nothing twice but what was cut."""
    starts = Counter(r["behavior"] for r in records if r["phase"] == "start" and "text" in r)
    halted = Counter(
        r["behavior"] for r in records if r["phase"] == "cancel" and r["outcome"] == "halted"
    )
    ends = [r["text"] for r in records if r["phase"] == "end" and "text" in r]
    assert all(times == 1 + halted[name] for name, times in starts.items())
    rounds = [text for text in ends if text.startswith("Round")]
    assert rounds == [f"Round {number} begins." for number in range(1, 13)]
    assert ends[-1] == "That was all."
