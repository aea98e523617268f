"""The work of drivers: what it may do to a run, and deadlines that hold even if it ignores them."""

from __future__ import annotations

import asyncio
import ctypes
from collections.abc import Callable, Collection, Coroutine
from inspect import CORO_CREATED, getcoroutinestate, isawaitable, iscoroutine
from typing import Any, TypeVar

from prima.errors import RunError

GRACE_S = 1.0
"""How long a cancelled task may take to end before it is abandoned."""

T = TypeVar("T")


class Escaped(Exception):
    """What a driver raised would have ended the program, or passed for a cancellation.

    Or what it returned cannot be awaited.
    """


class Late(TimeoutError):
    """A driver's work has taken longer than it may."""


async def guarded(work: Coroutine[Any, Any, T]) -> T:
    """The result of a driver's work, which neither ends the program nor cancels the run.

    Raises:
        Escaped: it raises what would do so, such as the ``SystemExit`` of a robot's library, or
            ``CancelledError`` though nobody has cancelled it; or it is not a coroutine.
        Exception: whatever else the work raises.
    """
    if not isawaitable(work):
        raise Escaped(f"a coroutine is needed, not {type(work).__name__}: write async def")
    try:
        return await work
    except asyncio.CancelledError:
        own = asyncio.current_task()
        if own is None or own.cancelling():
            raise
        raise Escaped("CancelledError, although nobody has cancelled it") from None
    except (Exception, KeyboardInterrupt, GeneratorExit):
        raise
    except BaseException as error:
        raise Escaped(f"{type(error).__name__}: {error}") from error


async def unbroken(
    work: Callable[[], Coroutine[Any, Any, T]], tell: Callable[[str], object]
) -> T | None:
    """The result of a driver's work; None if it blocked until signals broke it off, which is told.

    The robots of other drivers are still to be made safe.

    Raises:
        Exception: whatever the work raises.
    """
    try:
        return await guarded(work())
    except KeyboardInterrupt as error:
        tell(str(error) or "A driver was broken off.")
        return None


def unescaped(what: Callable[[], T]) -> T:
    """The result of a driver's plain method, which neither ends the program nor cancels the run.

    Raises:
        Escaped: it raises what would do so: nothing can cancel it.
        Exception: whatever else it raises.
    """
    try:
        return what()
    except (Exception, KeyboardInterrupt):
        raise
    except BaseException as error:
        raise Escaped(f"{type(error).__name__}: {error}".removesuffix(": ")) from error


async def within(seconds: float, work: Coroutine[Any, Any, T]) -> T:
    """The result of a driver's work, which is cancelled at its deadline.

    Raises:
        Late: the deadline has passed.
        Exception: whatever the work raises.
    """
    task = asyncio.ensure_future(guarded(work))
    try:
        await asyncio.wait([task], timeout=seconds)
        if not task.done():
            raise Late(f"no answer within {seconds:g} s")
        return task.result()
    finally:
        if iscoroutine(work) and getcoroutinestate(work) == CORO_CREATED:
            work.close()  # it was broken off before it began
        await leave([task])


def run(work: Coroutine[Any, Any, T]) -> T:
    """Run work in a separate event loop, which ends when the work does.

    Other tasks still running in it are then cancelled, and abandoned if they ignore that.

    Raises:
        RunError: another task ended the program, or cancelled this one.
    """

    async def alone() -> T:
        own = asyncio.current_task()
        try:
            return await work
        finally:
            await leave([one for one in asyncio.all_tasks() if one is not own])

    whole = alone()
    try:
        return asyncio.run(whole)
    except (SystemExit, asyncio.CancelledError) as error:
        said = f"{type(error).__name__}: {error}".removesuffix(": ")
        raise RunError(f"A driver has ended the run: {said}.") from error
    finally:  # Ctrl-C may come before the loop begins with them
        whole.close()
        work.close()


async def leave(tasks: Collection[asyncio.Task[Any]]) -> None:
    """Cancel running tasks; those that do not end soon are abandoned.

    The event loop waits for all tasks before it ends, so it is made to forget those.
    """
    left = [one for one in tasks if not one.done()]
    for task in left:
        task.cancel()
    if left:
        await asyncio.wait(left, timeout=GRACE_S)
    for task in left:
        if not task.done():
            asyncio._unregister_task(task)
            # Python must not destroy it: that would run its code again, which may never end.
            ctypes.pythonapi.Py_IncRef(ctypes.py_object(task))
