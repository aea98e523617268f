"""Between the event loop of a run and the threads of robots' libraries."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from functools import wraps
from threading import get_ident
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

P = ParamSpec("P")


class OfRun(Protocol):
    """Something that belongs to a run, once it is attached to one."""

    _loop: asyncio.AbstractEventLoop | None
    _thread: int | None


D = TypeVar("D", bound=OfRun)


def call_in(
    loop: asyncio.AbstractEventLoop | None, what: Callable[..., object], *given: object
) -> None:
    """Call something in a run's event loop, from any thread; dropped if the run is over."""
    if loop is not None:
        with suppress(RuntimeError):  # the loop is closed
            loop.call_soon_threadsafe(what, *given)


def settle(future: asyncio.Future[Any], outcome: object) -> None:
    """Resolve a future with its result or error, unless nothing waits for it any more."""
    if future.done():
        return
    if isinstance(outcome, BaseException):
        future.set_exception(outcome)
    else:
        future.set_result(outcome)


def in_run(method: Callable[Concatenate[D, P], None]) -> Callable[Concatenate[D, P], None]:
    """A method that any thread may call: the run's event loop carries it out."""

    @wraps(method)
    def called(self: D, /, *args: P.args, **kwargs: P.kwargs) -> None:
        if self._thread in (None, get_ident()):
            method(self, *args, **kwargs)
        else:
            call_in(self._loop, lambda: method(self, *args, **kwargs))

    return called
