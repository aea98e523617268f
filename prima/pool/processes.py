"""Starts the processes of a pool, and works there."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

PRELOADED = ["prima.api", "prima.sim.rehearsal", "prima.transcript.measures"]
"""Modules imported once, by the process from which the others are forked."""


def context() -> Any:
    """How processes are made: forked from one with nothing but imports, or spawned.

    This process is never forked: threads and engines may be running in it.
    """
    from multiprocessing import get_all_start_methods, get_context

    if "forkserver" not in get_all_start_methods():
        return get_context("spawn")
    made = get_context("forkserver")
    made.set_forkserver_preload(PRELOADED)
    return made


def warm_up() -> None:
    """Start importing what all processes need, while the caller does something else."""
    if context().get_start_method() == "forkserver":
        from multiprocessing.forkserver import ensure_running

        with starting():
            ensure_running()


@contextmanager
def starting() -> Iterator[None]:
    """Start processes with this one's module paths that ignore Ctrl-C.

    They import neither from the current folder nor the script that runs here: nothing of it is
    needed, and one without ``if __name__ == "__main__"`` would start processes from them, too.
    Only this process handles an interrupt, and ends the others; one that comes meanwhile is
    delayed.
    """
    paths = os.pathsep.join(os.path.abspath(path) for path in sys.path)
    settings = {"PYTHONSAFEPATH": "1", "PYTHONPATH": paths}
    before = {name: os.environ.get(name) for name in settings}
    os.environ.update(settings)
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    waiting = _mask(signal.SIG_BLOCK, ())
    try:
        _track()
        _mask(signal.SIG_BLOCK, {signal.SIGINT})
        yield
    finally:
        sys.modules["__main__"] = script
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        _mask(signal.SIG_SETMASK, waiting)


def _track() -> None:
    """Start Python's resource tracker first.

    Starting it lets interrupts through again, which must wait for the other processes.
    """
    if hasattr(signal, "pthread_sigmask"):
        from multiprocessing.resource_tracker import ensure_running

        ensure_running()


def _mask(how: int, signals: Iterable[int]) -> Iterable[int]:
    """Change the blocked signals, if the system can; return those blocked before."""
    return signal.pthread_sigmask(how, signals) if hasattr(signal, "pthread_sigmask") else ()


def work(
    function: Callable[[Any], Any],
    begin: Callable[[], object] | None,
    leave: Callable[[], object] | None,
    pipe: Connection,
) -> None:
    """Work on items as they come; runs in its own process."""
    import threading

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow, args=(leave,), daemon=True).start()
    if begin is not None:
        begin()
    try:
        pipe.send(None)
        while True:
            pipe.send(function(pipe.recv()))
    except (EOFError, OSError):
        return  # the parent has gone


def _follow(leave: Callable[[], object] | None) -> None:
    """End when the parent ends, since nobody would read the results."""
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None:
        parent.join()
        if leave is not None:
            leave()
        os._exit(1)
