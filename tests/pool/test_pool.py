"""Processes that work on items: each is done in its turn, and one that dies takes its own along."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from prima import pool
from prima.errors import RunError
from prima.pool import Died, spread, staff


def square(number: int) -> int:
    return number * number


def fate(number: int) -> int:
    """Some do not come to their end."""
    if number == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 5:
        os._exit(3)
    return number * number


def late(number: int) -> int:
    time.sleep(0.3 if number == 0 else 0)
    return number


def broken() -> None:
    os._exit(7)


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_one_that_dies_takes_only_its_own_along(workers: int) -> None:
    made = list(spread(fate, range(8), workers))
    assert made == [(n, {2: Died(-signal.SIGKILL), 5: Died(3)}.get(n, n * n)) for n in range(8)]


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_items_given_ahead_survive_the_one_before_them(workers: int) -> None:
    with staff(fate, workers, ahead=2) as results:
        for _ in range(2):
            made = list(results(range(8)))
            lost = {2: Died(-signal.SIGKILL), 5: Died(3)}
            assert made == [(n, lost.get(n, n * n)) for n in range(8)]


def echo(text: str) -> str:
    return text * 2


def test_large_items_and_results_do_not_wait_for_each_other() -> None:
    """Both sides would write to a full pipe, and nobody read."""
    items = ["a" * 2_000_000, "b", "c" * 2_000_000, "d" * 2_000_000, "e"]
    with staff(echo, 1, ahead=1) as results:
        assert list(results(items)) == [(one, one * 2) for one in items]


def slow(done: Path, number: int) -> int:
    time.sleep(0.05)
    with done.open("a") as file:
        file.write(".")
    return number


@pytest.mark.parametrize(("ahead", "most"), [(0, 2), (1, 4)])
def test_a_process_is_given_as_many_items_as_asked_for(
    ahead: int, most: int, tmp_path: Path
) -> None:
    done = tmp_path / "done"
    done.touch()
    given: list[int] = []

    def items() -> Iterator[int]:
        for number in range(20):
            given.append(number + 1 - done.stat().st_size)
            yield number

    with staff(partial(slow, done), 2, ahead=ahead) as results:
        assert list(results(items())) == [(number, number) for number in range(20)]
    assert max(given) == most, "so many are taken and not done"


def test_items_are_taken_as_they_are_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "AHEAD", 10)
    taken = 0
    most = 0

    def items() -> Iterator[int]:
        nonlocal taken
        for number in range(200):
            taken += 1
            yield number

    for due, (_, made) in enumerate(spread(late, items(), 2)):
        assert made == due
        most = max(most, taken - due)
    assert (taken, most <= 11) == (200, True)


def test_processes_that_cannot_begin_are_told() -> None:
    with pytest.raises(RunError, match="ended before it began to work, with code 7"):
        list(spread(square, range(3), 2, broken))


SPAWNS = r"""
import os, re, signal
from multiprocessing import util
from prima.pool.processes import warm_up

def waits():
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())

def spawn(path, args, fds, real=util.spawnv_passfds):
    name = re.search(r"multiprocessing\.\w+", str(args)).group()
    print(name, waits(), os.environ.get("PYTHONSAFEPATH"))
    return real(path, args, fds)

util.spawnv_passfds = spawn
warm_up()
print(waits(), os.environ.get("PYTHONSAFEPATH"))
"""


def test_no_process_begins_that_an_interrupt_could_end_before_it_takes_care() -> None:
    done = subprocess.run([sys.executable, "-c", SPAWNS], capture_output=True, text=True)
    begun = ["multiprocessing.resource_tracker", "multiprocessing.forkserver"]
    expected = [*(f"{name} True 1" for name in begun), "False None"]
    assert done.stdout.splitlines() == expected, done.stderr


def test_a_partial_of_a_function_may_be_spread() -> None:
    assert [made for _, made in spread(partial(pow, 2), range(4), 2)] == [1, 2, 4, 8]
