"""Spreads work over processes; results come in order, and a dead process loses only its item."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from prima.errors import RunError
from prima.pool.processes import context, starting, work

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

AHEAD = 4096
"""Maximum number of results that wait for an earlier one."""
SMALL = 4096
"""Maximum size (bytes) of an item that waits in a pipe: it never fills the pipe."""
DYING_SECONDS = 5.0
"""How long a process may take to end after closing its pipe."""

Item = TypeVar("Item")
Made = TypeVar("Made")


@dataclass(frozen=True, slots=True)
class Died:
    """Replaces the result of an item whose process ended before it was done."""

    code: int
    """The exit code, or the negative number of the signal."""


def cores() -> int:
    """The number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def spread(
    function: Callable[[Item], Made],
    items: Iterable[Item],
    workers: int,
    begin: Callable[[], object] | None = None,
    leave: Callable[[], object] | None = None,
) -> Generator[tuple[Item, Made | Died], None, None]:
    """Apply a function to items in other processes; yield results in the order of the items.

    Items are taken one by one as processes become free, at most ``AHEAD`` beyond the next
    result, which bounds memory. Closing the iterator, or an exception such as an interrupt,
    ends the processes at once. They also end if this process dies.

    Args:
        function: a module's function, or a partial of one; it should not raise.
        items: its arguments.
        workers: the number of processes.
        begin: called first in each process.
        leave: called last in a process whose parent has died.

    Raises:
        RunError: no process can be started.
    """
    with staff(function, workers, begin, leave) as results:
        yield from results(items)


@contextmanager
def staff(
    function: Callable[[Item], Made],
    workers: int,
    begin: Callable[[], object] | None = None,
    leave: Callable[[], object] | None = None,
    ahead: int = 0,
) -> Iterator[Callable[[Iterable[Item]], Iterator[tuple[Item, Made | Died]]]]:
    """Processes for several lots of items; gives what makes the results of one lot, as `spread`.

    The results of a lot are taken to their end before those of the next.

    Args:
        function, workers, begin, leave: as for :func:`spread`.
        ahead: how many items a process is given beyond its current one, so that it need not wait
            for the next: for items that take about the same time.
    """
    crew = _Crew(function, begin, leave, workers, ahead)
    try:
        yield crew.results
    finally:
        crew.end()


@dataclass(slots=True, eq=False)
class _Worker:
    """A process, its pipe, and the numbers of its items."""

    process: Any
    pipe: Connection
    numbers: deque[int] = field(default_factory=deque)
    """The items that it has been given, its current one first."""
    ready: bool = False
    """Whether it has begun; if not, its end is not its item's fault."""
    full: bool = False
    """Whether nothing can be added to its items."""


class _Crew(Generic[Item, Made]):
    """The processes of one :func:`spread`."""

    def __init__(
        self,
        function: Callable[[Item], Made],
        begin: Callable[[], object] | None,
        leave: Callable[[], object] | None,
        most: int,
        ahead: int,
    ) -> None:
        self.context = context()
        self.task = (function, begin, leave)
        self.most = most
        self.ahead = ahead
        self.workers: list[_Worker] = []
        self.held: dict[int, Item] = {}
        """The items whose results have not been yielded."""
        self.back: deque[int] = deque()
        """Items to be given next, such as those whose process has ended before it began them."""

    def results(self, items: Iterable[Item]) -> Iterator[tuple[Item, Made | Died]]:
        """See :func:`spread`."""
        from multiprocessing.connection import wait

        source = enumerate(items)
        done: dict[int, Made | Died] = {}
        due, more = 0, True
        while more or self.held:
            more = self._hand_out(source) if more or self.back else False
            while due in done:  # keeps all busy while the caller looks at results
                yield self.held.pop(due), done.pop(due)
                due += 1
            busy = {one.pipe: one for one in self.workers if one.numbers}
            for pipe in wait(list(busy)) if busy else ():
                done.update(self._take(busy[pipe]))  # type: ignore[index]

    def _hand_out(self, source: Iterator[tuple[int, Item]]) -> bool:
        """Give items to processes while there is room; whether there may be more of them."""
        while (self.back or len(self.held) < AHEAD) and (worker := self._free()):
            if not self.back:
                taken = next(source, None)
                if taken is None:
                    return False
                self.held[taken[0]] = taken[1]
                self.back.append(taken[0])
            self._give(worker, self.back.popleft())
        return True

    def _free(self) -> _Worker | None:
        """The process that may be given an item and has the fewest; starts one if all are busy.

        Raises:
            RunError: there is none, and none can be started.
        """
        room = [one for one in self.workers if len(one.numbers) <= self.ahead and not one.full]
        free = min(room, key=lambda one: len(one.numbers), default=None)
        if (free is None or free.numbers) and len(self.workers) < self.most:
            try:
                free = self._start()
            except (EOFError, OSError) as error:
                if not self.workers:
                    why = getattr(error, "strerror", None) or "there are too many"
                    raise RunError(f"cannot start a process: {why}.") from None
                self.most = len(self.workers)  # go on with fewer
            else:
                self.workers.append(free)
        return free

    def _give(self, worker: _Worker, number: int) -> None:
        """Give an item to a process; only a small one may wait in its pipe behind another."""
        from multiprocessing.reduction import ForkingPickler

        data = ForkingPickler.dumps(self.held[number])
        if worker.numbers and len(data) > SMALL:
            worker.full = True
            self.back.appendleft(number)
            return
        try:
            worker.pipe.send_bytes(data)
        except OSError:  # it has died
            self.back.appendleft(number)
            worker.full = True
            if not worker.numbers:
                self._bury(worker)
        else:
            worker.numbers.append(number)

    def _take(self, worker: _Worker) -> dict[int, Made | Died]:
        """A process's result, or how it ended; nothing if it reports only that it has begun."""
        try:
            made: Made = worker.pipe.recv()
        except (EOFError, OSError):
            self._bury(worker)
            number, *others = worker.numbers
            self.back.extend(others)
            return {number: Died(_code(worker))}
        if not worker.ready:
            worker.ready = True
            return {}
        worker.full = False
        return {worker.numbers.popleft(): made}

    def _bury(self, worker: _Worker) -> None:
        """Forget a process that has ended.

        Raises:
            RunError: it ended before it began to work.
        """
        self.workers.remove(worker)
        worker.pipe.close()
        if not worker.ready:
            raise _no_start(worker) from None

    def _start(self) -> _Worker:
        here, there = self.context.Pipe()
        try:
            process = self.context.Process(target=work, args=(*self.task, there), daemon=True)
            with starting():
                process.start()
        except (EOFError, OSError):
            here.close()
            raise
        finally:
            there.close()
        return _Worker(process, here)

    def end(self) -> None:
        """Kill all processes."""
        for worker in self.workers:
            worker.process.kill()
        for worker in self.workers:
            worker.process.join(DYING_SECONDS)
            worker.pipe.close()


def _code(worker: _Worker) -> int:
    worker.process.join(DYING_SECONDS)
    code = worker.process.exitcode
    return 0 if code is None else int(code)


def _no_start(worker: _Worker) -> RunError:
    return RunError(f"a process ended before it began to work, with code {_code(worker)}.")
