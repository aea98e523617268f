"""The one clock of a live run."""

from __future__ import annotations

import asyncio
import time


def elapsed() -> float:
    """Seconds by a clock that nobody sets, and that goes on while the machine is suspended.

    Only Linux has one; elsewhere the time of a suspension may be missing.
    """
    boottime = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if boottime is None else time.clock_gettime(boottime)


class Clock:
    """Milliseconds of the run, from :func:`elapsed`: setting the machine's time has no effect.

    Args:
        speed: how many times as fast as real time the run goes.
        start: the run's time (ms) at which the clock begins.
    """

    def __init__(self, speed: float = 1.0, start: int = 0) -> None:
        self.speed = speed
        self._start = start
        self._began = elapsed()

    def begin(self) -> None:
        """Let the run's time begin now."""
        self._began = elapsed()

    def now(self) -> int:
        """The run's time (ms)."""
        return self._start + int((elapsed() - self._began) * 1000 * self.speed)

    async def wait(self, until: int | None, woken: asyncio.Event) -> None:
        """Wait until a time (ms; None for no limit), or until the run is woken."""
        if until is None:
            await woken.wait()
            return
        left = (until - self._start) / 1000 / self.speed - (elapsed() - self._began)
        if left <= 0:
            await asyncio.sleep(0)  # let drivers report
            return
        try:
            async with asyncio.timeout(left):
                await woken.wait()
        except TimeoutError:
            return
