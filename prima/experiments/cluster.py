"""Runs on a Dask cluster (https://distributed.dask.org), or else on this machine."""

from __future__ import annotations

import logging
import os
import re
import sys
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from itertools import islice
from time import monotonic, perf_counter, sleep
from typing import TYPE_CHECKING, Any

from prima.errors import RunError, UsageError
from prima.errors.visible import escaped
from prima.experiments.pools import Pool, Runs, local
from prima.experiments.scenariotext import Variant
from prima.experiments.variants import Made, Stage
from prima.loading.files import check_text
from prima.pool import Died, cores
from prima.version import __version__

if TYPE_CHECKING:
    from distributed import Client, Future

SECONDS = 10
"""How long a scheduler and its first worker may take to answer."""
TASK_SECONDS = 0.5
"""How long a task should take, as each costs all sides together some 20 ms."""
FIRST_RUNS, MOST_RUNS = 4, 64
"""Runs per task: of the first tasks, and at most."""
TRIES = 5
"""How often workers are checked again if one of them ends meanwhile."""
AHEAD = 8
"""Tasks sent ahead for each worker."""
ADDRESS = re.compile(r"(tcp|tls|ws|wss)://[^\s/:]+(:\d{1,5})?")
PATIENCE = 300.0
"""Seconds without any worker after which a scheduler is given up."""
PATIENCE_SETTING = "PRIMA_CLUSTER_PATIENCE"
"""The environment variable that overrides it."""
MOST_PATIENCE = 86_400.0
FIRST_TOLD, TOLD_EVERY = 5.0, 60.0
"""The interval (s) at which a missing worker is reported."""
DIED = 1
"""The exit code of a run whose worker died each time; Dask does not report the signal."""


def pool_of(address: str | None, workers: int | None) -> Pool:
    """The workers of a scheduler at an address, or else processes of this machine.

    Raises:
        UsageError: it is not an address, or Dask is not installed.
    """
    if address is None:
        return local(workers or 0)
    check_text(address, "on")
    if workers is not None:
        raise UsageError("--workers is for this machine; a cluster has the workers it has.")
    if ADDRESS.fullmatch(address) is None:
        message = f'--on "{escaped(address)}": write the address of a scheduler of Dask'
        raise UsageError(f"{message}, as tcp://127.0.0.1:8786.")
    try:
        import distributed  # noqa: F401
    except ImportError:
        message = "a cluster needs Dask: pip install 'prima[cluster]'."
        raise UsageError(f"--on {address}: {message}") from None

    return partial(_staff, address)


def size_of(address: str | None, workers: int | None) -> int:
    """The number of processes of the same pool.

    Raises:
        UsageError: as for :func:`pool_of`, or nobody answers.
    """
    pool_of(address, workers)
    if address is None:
        return workers or cores()
    client = _connected(address)
    try:
        return len(client.nthreads())
    finally:
        client.close(timeout=1)


@contextmanager
def _staff(address: str, stage: Stage) -> Iterator[Runs]:
    """Connect, send the content of all runs to all workers, and make runs there.

    Raises:
        RunError: the scheduler, or all of its workers, are lost meanwhile.
        UsageError: nobody answers, the workers are of another version, or there is too much
            to send.
    """
    _patience()
    stage.pack()
    client = _connected(address)
    try:
        _check_soon(client, address)
        # A task, since the death of a worker with data that no task makes would end them all.
        sent = client.submit(_given, stage, pure=False)
        yield lambda variants: _runs(client, sent, variants)
    finally:
        client.close(timeout=1)


def _connected(address: str) -> Client:
    from distributed import Client

    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=SECONDS, set_as_default=False)
        client.wait_for_workers(1, timeout=SECONDS)
    except (OSError, ValueError):
        raise UsageError(
            f"--on {address}: no scheduler with a worker answers within {SECONDS} s."
            " Start them with: dask scheduler, and dask worker ADDRESS --nthreads 1."
        ) from None
    return client


def _check_soon(client: Client, address: str) -> None:
    """Check the workers, and check again if one of them ends meanwhile.

    Raises:
        RunError: no worker is left, or the scheduler is lost.
        UsageError: one has another version or several threads.
    """
    for _ in range(TRIES):
        try:
            client.wait_for_workers(1, timeout=SECONDS)
            return _check(client, address)
        except OSError:
            sleep(1)
    raise RunError(f"--on {address}: its scheduler or its workers end before they answer.")


def _check(client: Client, address: str) -> None:
    """Check that all workers have this version and make one run at a time.

    Raises:
        UsageError: they do not.
    """
    here = [__version__, list(sys.version_info[:2])]
    try:
        there = client.run(_versions)
    except ImportError:
        message = f"its workers do not have prima: pip install prima=={__version__} there."
        raise UsageError(f"--on {address}: {message}") from None
    for worker, version in there.items():
        if version != here:
            message = f"prima {version[0]} and Python {'.'.join(map(str, version[1]))}"
            wanted = f"here are {here[0]} and {'.'.join(map(str, sys.version_info[:2]))}"
            raise UsageError(f"--on {address}: the worker {worker} has {message}; {wanted}.")
    for worker, threads in client.nthreads().items():
        if threads != 1:
            message = f"the worker {worker} has {threads} threads, and can make one run at once"
            raise UsageError(f"--on {address}: {message}. Start it with --nthreads 1.")


def _versions() -> list[Any]:
    """A worker's versions and threads."""
    return [__version__, list(sys.version_info[:2])]


def _runs(
    client: Client, sent: Future, variants: Iterable[Variant]
) -> Iterator[tuple[Variant, Any]]:
    """Results in the order of the variants; a task whose workers died is repeated run by run."""
    from distributed import CancelledError

    try:
        yield from _lots(client, sent, iter(variants))
    except (CancelledError, OSError):
        raise RunError("the scheduler of Dask has gone.") from None


def _lots(
    client: Client, sent: Future, variants: Iterator[Variant]
) -> Iterator[tuple[Variant, Any]]:
    from distributed import KilledWorker

    size = FIRST_RUNS
    lots = iter(lambda: list(islice(variants, size)), [])
    most = AHEAD * max(len(client.nthreads()), 1)
    tasks: deque[tuple[list[Variant], Future]] = deque()
    while True:
        for lot in islice(lots, most - len(tasks)):
            tasks.append((lot, client.submit(_work, sent, lot, pure=False)))
        if not tasks:
            return
        lot, task = tasks.popleft()
        try:
            seconds, made = _result(client, task)
        except KilledWorker:
            yield from _one_by_one(client, sent, lot)
        else:
            size = min(max(round(len(lot) * TASK_SECONDS / max(seconds, 1e-6)), 1), MOST_RUNS)
            yield from zip(lot, made, strict=True)


def _one_by_one(
    client: Client, sent: Future, lot: Sequence[Variant]
) -> Iterator[tuple[Variant, Any]]:
    from distributed import KilledWorker

    for variant in lot:
        try:
            _, (made,) = _result(client, client.submit(_work, sent, [variant], pure=False))
        except KilledWorker:
            made = Died(DIED)
        yield variant, made


def _result(client: Client, task: Future) -> Any:
    """The result of a task, once there is a worker for it.

    Raises:
        RunError: there has been none for too long.
    """
    limit, since = _patience(), monotonic()
    tell_at = since + FIRST_TOLD
    while True:  # finished results may also be lost with their worker, and have to be made again
        with suppress(TimeoutError):
            return task.result(timeout=1)
        now = monotonic()
        if client.scheduler_info()["workers"]:
            since, tell_at = now, now + FIRST_TOLD
        elif now - since > limit:
            raise RunError(
                f"the scheduler of Dask has had no worker for {limit:g} s. Start some, and go on"
                " with --resume."
            )
        elif now > tell_at:
            tell_at = now + TOLD_EVERY
            message = (
                f"prima: the scheduler of Dask has no worker; waiting for one, {limit:g} s at most."
            )
            print(message, file=sys.stderr, flush=True)


def _patience() -> float:
    """How long (s) there may be no worker.

    Raises:
        UsageError: the setting is not a number above 0.
    """
    text = os.environ.get(PATIENCE_SETTING, "")
    try:
        seconds = float(text) if text else PATIENCE
    except ValueError:
        seconds = -1.0
    if not 0 < seconds <= MOST_PATIENCE:
        raise UsageError(f'{PATIENCE_SETTING}="{escaped(text)}": write seconds, as 300.')
    return seconds


def _given(stage: Stage) -> Stage:
    """Hold the content of all runs; called on a worker."""
    return stage


def _work(stage: Stage, lot: Sequence[Variant]) -> tuple[float, list[Made]]:
    """Make the runs of a task; returns how many seconds that took, and the results.

    Called on a worker.
    """
    began = perf_counter()
    made = [stage.run(one) for one in lot]
    return perf_counter() - began, made
