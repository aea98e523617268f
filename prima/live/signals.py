"""Signals that end a live run: they do so in its event loop, and the robot is made safe."""

from __future__ import annotations

import asyncio
import signal
import sysconfig
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from types import FrameType
from typing import Any

BLOCKED_S = 1.0
"""How long the event loop may take to handle a signal; after that the next one aborts it."""
NAMES = ("SIGINT", "SIGTERM", "SIGHUP")
"""Ctrl-C, a request to end, and a terminal that is closed."""


@contextmanager
def heeding_signals(stop: Callable[[], object]) -> Iterator[None]:
    """Let the first signal call ``stop`` in the running event loop, if this is the main thread.

    A driver that blocks keeps the loop from doing so. A second signal aborts it.

    Raises:
        KeyboardInterrupt: the loop was aborted; the message says where it was.
    """
    running = asyncio.get_running_loop()
    stops = False
    unheeded: float | None = None

    def heed() -> None:
        nonlocal stops, unheeded
        unheeded = None
        if not stops:  # once: making the robot safe must not be interrupted
            stops = True
            stop()

    def hear(_: int, frame: FrameType | None) -> None:
        nonlocal stops, unheeded
        now = monotonic()
        if unheeded is None:
            unheeded = now
            running.call_soon_threadsafe(heed)
        elif now - unheeded > BLOCKED_S:
            stops = True
            stop()
            raise KeyboardInterrupt(_told(frame))

    running.set_exception_handler(_tell_defects)
    with handling_signals(hear):
        yield


def _tell_defects(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Report what a task failed with that nobody awaits, but not what has ended the loop."""
    if not isinstance(context.get("exception"), KeyboardInterrupt | SystemExit):
        loop.default_exception_handler(context)


@contextmanager
def handling_signals(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Let signals that end a run call a handler, if this is the main thread."""
    before = {}
    for name in NAMES:
        number = getattr(signal, name, None)
        if number is None or (name == "SIGHUP" and signal.getsignal(number) is signal.SIG_IGN):
            continue  # not on this system; or the run is to outlive its terminal (nohup)
        with suppress(ValueError):
            before[number] = signal.signal(number, handler)
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


def _told(frame: FrameType | None) -> str:
    """The location of the blocking code: the innermost frame outside the standard library."""
    library = (sysconfig.get_path("stdlib"), "<")
    while frame is not None and frame.f_code.co_filename.startswith(library):
        frame = frame.f_back
    where = f" {frame.f_code.co_filename}:{frame.f_lineno}" if frame is not None else ""
    return f"The run was broken off: it was blocked at{where}. Drivers must wait with await."
