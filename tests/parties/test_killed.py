"""A run that is killed at any moment goes on: 200 times, by SIGKILL."""

from __future__ import annotations

import json
import random
import signal
import time
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from tests.parties.forked import LONGEST_S, Command

ROOT = Path(__file__).parents[2]
TOUR = Path(__file__).parent / "killed.xml"
ROBOT = ROOT / "documents" / "robots" / "simulated.xml"
RUNS, KILLS = 8, 25


def killed_after(seconds: float, journal: Path, *words: str) -> bool:
    """Let a run write to its journal, and kill it then; false if it had ended."""
    before = journal.stat().st_size if journal.exists() else 0
    running = Command(journal.with_suffix(".txt"), "live", *words)
    began = time.monotonic()
    while running.process.is_alive() and time.monotonic() - began < LONGEST_S:
        if journal.exists() and journal.stat().st_size > before:
            break
        time.sleep(0.005)
    time.sleep(seconds)
    running.process.kill()
    code, told = running.end()
    assert code in (0, -signal.SIGKILL), told
    return code != 0


def records_of(journal: Path) -> list[dict[str, Any]]:
    return [json.loads(text) for text in journal.read_text().splitlines()]


@pytest.mark.parametrize("seed", range(RUNS))
def test_a_killed_run_goes_on(seed: int, tmp_path: Path) -> None:
    chance, journal = random.Random(seed), tmp_path / "visit.jsonl"
    said = journal.with_suffix(".txt")
    words = ["--robot", str(ROBOT), "--ea", str(TOUR), "-o", str(journal), "--speed", "10"]
    for _ in range(KILLS):
        if not killed_after(chance.uniform(0, 0.2), journal, *words):
            break  # on a busy machine it may have come to its end
        words = ["--resume", str(journal), "--speed", "10"]
    else:
        code, told = Command(said, "live", "--resume", str(journal), "--speed", "100").end()
        assert code == 0, told
    records = records_of(journal)
    assert records[-1]["phase"] == "over"
    code, told = Command(said, "replay", str(journal)).end()
    assert code == 0, told
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
