"""Deadlines that hold even if a driver does not heed that it is cancelled."""

from __future__ import annotations

import asyncio
import ctypes
from collections.abc import Collection, Coroutine
from typing import Any, TypeVar

GRACE_S = 1.0
"""How long what is cancelled may take to end; after that it is left behind."""

T = TypeVar("T")


async def within(seconds: float, work: Coroutine[Any, Any, T]) -> T:
    """What a driver's work gives; it is cancelled at its deadline.

    Raises:
        TimeoutError: the deadline has come.
        Exception: what the work raises.
    """
    task = asyncio.ensure_future(work)
    try:
        await asyncio.wait([task], timeout=seconds)
        if not task.done():
            raise TimeoutError
        return task.result()
    finally:
        await leave([task])


def run(work: Coroutine[Any, Any, T]) -> T:
    """Run work in an event loop of its own, which ends when the work does.

    Whatever else still runs in it then is cancelled, and left behind if it does not heed that.
    """

    async def alone() -> T:
        own = asyncio.current_task()
        try:
            return await work
        finally:
            await leave([one for one in asyncio.all_tasks() if one is not own])

    return asyncio.run(alone())


async def leave(tasks: Collection[asyncio.Task[Any]]) -> None:
    """Cancel what still runs; what does not end soon is nobody's any more.

    The event loop, which waits for all tasks before it ends, forgets those.
    """
    left = [one for one in tasks if not one.done()]
    for task in left:
        task.cancel()
    if left:
        await asyncio.wait(left, timeout=GRACE_S)
    for task in left:
        if not task.done():
            asyncio._unregister_task(task)
            _keep_for_ever(task)


def _keep_for_ever(task: asyncio.Task[Any]) -> None:
    """Let Python never destroy a task: that would run its code again, which may never end."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(task))
