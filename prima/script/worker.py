"""A process that evaluates untrusted code, from its caller's side: started, called, lost.

A script that escapes the engine's limits ends its process (:mod:`prima.script.host`), and every
later call fails with :class:`EngineLost`: the application with that code ends, and no other.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import subprocess
import sys
import threading
from collections import deque
from typing import Any, Protocol

from prima.script import host, wire
from prima.script.evaluation import EngineLost, ScriptError

MOST_IDLE = 4
"""Maximum number of idle processes kept for reuse."""
MANY = 8
"""Number of processes in use from which unused ones are collected."""
PASSED_ON = ("LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "SYSTEMROOT")
"""Environment variables without which some Pythons do not start."""
CALL_SECONDS = 35e-6
"""The overhead of a call, on both sides."""
ENDING_SECONDS = 5.0
"""How long a process may take to end after closing its pipe."""


class Handle:
    """A value that stays in the process of its engine; dropped there when it is dropped here."""

    __slots__ = ("_dropped", "number")

    def __init__(self, number: int, dropped: deque[int]) -> None:
        self.number = number
        self._dropped = dropped

    def __del__(self) -> None:
        self._dropped.append(self.number)


class Meter(Protocol):
    """The caller: the time that its code sees (ms since 1970), and the seconds it has taken."""

    now: int
    spent: float


class Nobody:
    """A meter for calls that take no time worth counting."""

    now, spent = 0, 0.0


class Worker:
    """A process with engines; its methods may be called from any thread, one at a time.

    Raises:
        EngineLost: it cannot be started.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._owner = os.getpid()
        self._dropped: deque[int] = deque()
        self.why = ""
        """Why it has ended; empty while it runs."""
        self.use = 0
        """How often it has been returned."""

        program = [sys.executable, "-I", "-S", host.__file__, json.dumps(sys.path)]
        try:
            self._process = subprocess.Popen(
                program,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                bufsize=0,
                env={name: os.environ[name] for name in PASSED_ON if name in os.environ},
                process_group=0,  # Ctrl-C is for the run, which then ends this as well
            )
        except OSError as error:
            raise EngineLost(f"its engine cannot be started: {error}") from None
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._requests = self._process.stdin.fileno()
        self._replies = self._process.stdout.fileno()

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    @property
    def lost(self) -> bool:
        """Whether it has ended, or belongs to the process that this one was forked from."""
        return bool(self.why) or self._owner != os.getpid()

    @property
    def alive(self) -> bool:
        """Whether it can be called, according to the system."""
        return not self.lost and self._process.poll() is None

    def call(self, target: int, method: str, arguments: list[Any], meter: Meter) -> Any:
        """Call a method there, and give what it gives: data, or the handle of a value.

        Raises:
            ScriptError: the code failed, or went past a limit of the engine.
            EngineLost: the process has ended, now or before.
        """
        with self._lock:
            if self.lost:
                raise EngineLost(self.why or "its engine belongs to another process")
            dropped, queue = [], self._dropped
            while queue:
                dropped.append(queue.popleft())
            try:
                request = [dropped, target, method, arguments, meter.now, meter.spent]
                wire.send(self._requests, request, wire.LONGEST_REQUEST)
                kind, result, spent = wire.receive(self._replies, wire.LONGEST_REPLY)
                meter.spent = spent + CALL_SECONDS
            except (wire.TooMuch, wire.WireBroken) as error:
                queue.extend(dropped)
                raise (
                    self._end() if isinstance(error, wire.WireBroken) else ScriptError(str(error))
                ) from None
            except BaseException:
                self.close()  # the reply is outstanding: the next call would take it for its own
                raise
        if kind == "value":
            return Handle(result, queue)
        if kind == "error":
            message, places, line, column = result
            raise ScriptError(message, [(one, two) for one, two in places], (line, column))
        if kind == "defect":
            raise RuntimeError(result)
        return result

    def _end(self) -> EngineLost:
        """Find out why the process has ended."""
        try:
            code = self._process.wait(ENDING_SECONDS)
        except subprocess.TimeoutExpired:
            code = 0
        self.why = _reason(code)
        self.close()
        return EngineLost(self.why)

    def close(self) -> None:
        """End the process."""
        self.why = self.why or "its engine was ended"
        if self._owner == os.getpid():
            self._process.kill()
            self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()

    def __del__(self) -> None:
        if not self.why and hasattr(self, "_process"):
            self.close()


def _reason(code: int) -> str:
    if code == -signal.SIGPROF:
        return f"it took more than {host.KILL_SECONDS:g} s of processor time and did not stop"
    if code == host.OUT_OF_MEMORY:
        return f"it used more than {host.MEMORY_BYTES // 1024**2} MB"
    return "its engine crashed, or was ended from outside"


_idle: list[Worker] = []
"""Idle processes."""
_started: set[Worker] = set()
"""Hired processes that have not ended, as far as is known. They are held here, so that those of an
unclosed run are returned when it is collected, not collected with it."""


def hire() -> Worker:
    """A process for exclusive use, to be returned by :func:`dismiss`.

    Raises:
        EngineLost: none can be started.
    """
    _started.intersection_update([one for one in _started if one.alive])
    if not _idle and len(_started) >= MANY:
        gc.collect()  # unclosed runs return theirs
    while _idle:
        worker = _idle.pop()
        if _reset(worker):  # it may have ended meanwhile
            return worker
    worker = Worker()
    _started.add(worker)
    return worker


def _reset(worker: Worker) -> bool:
    """Reset a process; gives whether it can be used."""
    try:
        worker.call(0, "reset", [], Nobody())
    except EngineLost:
        return False
    return True


def dismiss(worker: Worker) -> None:
    """Return a process for reuse: the objects in it are dropped."""
    if worker.lost:
        return
    worker.use += 1
    if not _reset(worker):
        return
    if len(_idle) < MOST_IDLE:
        _idle.append(worker)
    else:
        worker.close()
