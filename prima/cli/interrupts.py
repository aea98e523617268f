"""Ctrl-C, SIGTERM and a closed terminal: their exception comes later where it would be lost, or break something."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

SOON_S = 0.01
PHYSICS = "pymunk"
"""A library whose objects crash the process later if they are left half made or half freed."""

PYTHONS: dict[int, Callable[[int, FrameType | None], Any] | signal.Handlers] = {
    signal.SIGINT: signal.default_int_handler,
    signal.SIGTERM: signal.SIG_DFL,
}
"""The signals that interrupt a command, with Python's own handlers."""
if hasattr(signal, "SIGHUP"):  # not on Windows
    PYTHONS[signal.SIGHUP] = signal.SIG_DFL


@contextmanager
def interruptible() -> Iterator[None]:
    """Handle the signals in this module's way, unless the caller ignores them or does so already."""
    hook, sys.unraisablehook = sys.unraisablehook, interrupt_again
    for number, handler in PYTHONS.items():
        if signal.getsignal(number) is handler:
            with suppress(ValueError):  # not the main thread: it gets no signals
                signal.signal(number, interrupt)
    try:
        yield
    finally:
        sys.unraisablehook = hook
        leave_to_python()


def leave_to_python() -> None:
    """Let Python handle the signals, as event loops expect it."""
    for number, handler in PYTHONS.items():
        if signal.getsignal(number) is interrupt:
            signal.signal(number, handler)


@contextmanager
def fatal() -> Iterator[None]:
    """Let the signals end the process at once: a thread that waits for input keeps an exception waiting."""
    handled = [number for number in PYTHONS if signal.getsignal(number) is interrupt]
    for number in handled:
        signal.signal(number, signal.SIG_DFL)
    try:
        yield
    finally:
        for number in handled:
            signal.signal(number, interrupt)


def interrupt(_: int, frame: FrameType | None) -> None:
    """Break off what runs, unless that is physics: then soon."""
    while frame is not None:
        if str(frame.f_globals.get("__name__")).startswith(PHYSICS):
            _soon()
            return
        frame = frame.f_back
    raise KeyboardInterrupt


def interrupt_again(lost: sys.UnraisableHookArgs) -> None:
    """Repeat a Ctrl-C whose exception was raised where exceptions are swallowed.

    Such places are callbacks of a library in C, and code that Python runs to free an object.
    """
    if not isinstance(lost.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(lost)
        return
    _soon()


def _soon() -> None:
    from threading import Timer

    heard = (number for number in PYTHONS if signal.getsignal(number) is interrupt)
    number = next(heard, signal.SIGINT)  # which a shell's background job ignores
    started = False
    while not started:
        with suppress(KeyboardInterrupt):  # the timer was quicker than its start: lost here, too
            Timer(SOON_S, os.kill, (os.getpid(), number)).start()
            started = True
