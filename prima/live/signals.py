"""Ctrl-C and SIGTERM in a live run: they end it in its event loop, where the robot can be made safe."""

from __future__ import annotations

import asyncio
import signal
import sysconfig
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from types import FrameType

BLOCKED_S = 1.0
"""How long the event loop may take to heed a signal; after that the next signal breaks it off."""


@contextmanager
def heeding_signals(stop: Callable[[], object]) -> Iterator[None]:
    """Let the first signal call ``stop`` in the running event loop, if this is the main thread.

    A driver that blocks keeps the loop from that. A second signal breaks it off.

    Raises:
        KeyboardInterrupt: the loop was broken off; the message says where it was.
    """
    running = asyncio.get_running_loop()
    stops = False
    unheeded: float | None = None

    def heed() -> None:
        nonlocal stops, unheeded
        unheeded = None
        if not stops:  # once: what makes the robot safe then is not to be stopped
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
            raise KeyboardInterrupt(_told(frame))

    before = {}
    for name in (signal.SIGINT, signal.SIGTERM):
        with suppress(ValueError):
            before[name] = signal.signal(name, hear)
    try:
        yield
    finally:
        for name, handler in before.items():
            signal.signal(name, handler)


def _told(frame: FrameType | None) -> str:
    """What to say of the code that blocks: the innermost that is not of the standard library."""
    library = (sysconfig.get_path("stdlib"), "<")
    while frame is not None and frame.f_code.co_filename.startswith(library):
        frame = frame.f_back
    where = f" {frame.f_code.co_filename}:{frame.f_lineno}" if frame is not None else ""
    return f"The run was broken off: it was blocked at{where}. Drivers must wait with await."
