"""The shell of a live run: one event loop, one clock, and the tasks of drivers.

It waits until something is due or has come in, then lets the :class:`~prima.devices.loop.Loop`
carry out what a rehearsal would carry out at once. What arrives in one turn forms one instant (V3).
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from functools import partial
from typing import Any

from prima.devices.goals import Back
from prima.devices.loop import Loop
from prima.errors import UsageError, brief
from prima.live.clock import Clock
from prima.live.deadlines import guarded, unbroken, within
from prima.live.devices import SAFE_S, LiveDevices
from prima.live.driver import Driver, Unreachable, Unusable, why

FIRST_S, LONGEST_S = 0.5, 30.0
"""The delays before trying to reach a lost robot again: the first, and the longest."""
REASON = 300
"""Characters of a reason above which its middle is left out in messages: a record has more."""
LATE_MS = 250
"""An instant that is later than this is reported."""


class Shell:
    """Runs a loop in real time, or ``clock.speed`` times as fast.

    Args:
        loop: the run; its devices may be simulated.
        clock: its time.
        warn: called with messages for the operator.
        late: how late (ms) an instant may be before ``warn`` is called; None for never.
    """

    def __init__(
        self, loop: Loop, clock: Clock, warn: Callable[[str], None], late: int | None = LATE_MS
    ) -> None:
        self.loop = loop
        self.clock = clock
        self.latest = 0
        """The maximum lateness (ms) of all instants."""
        self._warn = warn
        self._late = late
        self._woken = asyncio.Event()
        self._tasks: set[asyncio.Task[None]] = set()
        self._stopped = False
        self._lost: set[Driver] = set()
        self.opened = False
        """Whether every driver has reached its robot."""
        self._opening: list[asyncio.Task[None]] = []

    @property
    def _drivers(self) -> list[Driver]:
        devices = self.loop.devices
        return list(devices.drivers) if isinstance(devices, LiveDevices) else []

    def stop(self) -> None:
        """End the run as soon as possible: no more instants are carried out."""
        self._stopped = True
        self._woken.set()
        for task in self._opening:
            task.cancel()

    async def run(self) -> None:
        """Carry out the run to its end; the robot is then made safe, whatever has happened.

        Raises:
            Unreachable: a driver cannot reach its robot at the start.
            UsageError: a driver is not set up.
        """
        try:
            await self._open()
            self.opened = True
            self.clock.begin()
            await self._go()
        finally:
            await self._close()

    async def _go(self) -> None:
        loop = self.loop
        while not self._stopped:
            self._woken.clear()
            await asyncio.sleep(0)  # drivers report first, above all after a standstill
            if not self._advance():
                return
            due = loop.due()
            if due is None and not self._drivers:  # no more reports can come
                loop.finish(loop.until)
                return
            due = loop.until if due is None else min(due, loop.until)
            await self.clock.wait(due, self._woken)
            if self.clock.now() >= loop.until and self._advance():
                loop.finish(loop.until)
                return

    def _advance(self) -> bool:
        """Carry out everything that is due; False when the run is over."""
        loop, late = self.loop, 0
        while not self._stopped:
            now, due = min(self.clock.now(), loop.until), loop.due()
            if due is not None:
                late = max(late, now - due)
            if loop.advance(now) is None:
                break
        self._note_late(late)
        if loop.outcome or loop.over:
            loop.finish(loop.now)
            return False
        return True

    def _note_late(self, late: int) -> None:
        if self._late is not None and late > max(self.latest, self._late):
            speed = self.clock.speed
            real = "" if speed == 1 else f" ({late / speed / 1000:.2g} s of real time)"
            self._warn(f"An instant was carried out {late / 1000:g} s late{real}.")
        self.latest = max(self.latest, late)

    # Drivers ----------------------------------------------------------------------------

    async def _open(self) -> None:
        devices = self.loop.devices
        if not isinstance(devices, LiveDevices):
            return
        devices.now, devices.wake = self.clock.now, self._woken.set
        devices.spawn, devices.lost = self._spawn, self._lose
        for driver in self._drivers:
            driver.attach(partial(devices.tell, driver), self.clock.now)
        await self._open_all()
        for driver in self._drivers:
            self._spawn(self._watch(driver))

    async def _open_all(self) -> None:
        """Open all drivers at once; if one fails, none stays half open."""
        tasks = self._opening = [asyncio.ensure_future(open_driver(one)) for one in self._drivers]
        try:
            if tasks:
                await asyncio.wait(tasks, return_when=asyncio.FIRST_EXCEPTION)
        finally:
            for task in tasks:
                task.cancel()
            ended = await asyncio.gather(*tasks, return_exceptions=True)
            self._opening = []
        for problem in ended:
            if isinstance(problem, Exception):
                raise problem

    async def _close(self) -> None:
        """Make all robots safe at once, whatever still runs; then close the connections."""
        if isinstance(self.loop.devices, LiveDevices):
            self.loop.devices.lost = lambda *_: None  # nobody is looked for any more
        tasks = list(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*(self._end(driver, driver.safe) for driver in self._drivers))
        if tasks:
            await asyncio.wait(tasks, timeout=SAFE_S)
        await asyncio.gather(*(self._end(driver, driver.close) for driver in self._drivers))

    async def _end(self, driver: Driver, end: Callable[[], Coroutine[Any, Any, None]]) -> None:
        """Let a driver end something; warn if it fails."""
        try:
            await within(SAFE_S, unbroken(end, self._warn))
        except Exception as error:
            self._warn(f"{driver.kind}: {end.__name__} has failed: {why(error)}.")

    def _spawn(self, what: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(what)
        self._tasks.add(task)
        task.add_done_callback(self._note_end)

    def _note_end(self, task: asyncio.Task[None]) -> None:
        """A driver that fails in the background does not end the run."""
        self._tasks.discard(task)
        if not task.cancelled() and (error := task.exception()):
            self._warn(f"A driver has failed: {why(error)}.")

    def _lose(self, driver: Driver, reason: str) -> None:
        """A driver has lost its robot: try repeatedly to reach it."""
        if driver in self._lost:
            return
        self._lost.add(driver)
        known = f" ({brief(reason, REASON)})" if reason else ""
        self._warn(f"{driver.kind}: the robot is lost{known}; it is looked for.")
        self._spawn(self._end(driver, driver.safe))
        self._spawn(self._find(driver))

    async def _find(self, driver: Driver) -> None:
        wait, told = FIRST_S, ""
        while True:
            await asyncio.sleep(wait)
            wait = min(wait * 2, LONGEST_S)
            try:
                await open_driver(driver)
            except (Unreachable, UsageError) as error:
                if str(error) != told:
                    told = str(error)
                    self._warn(f"{driver.kind}: the robot is not back: {brief(told, REASON)}")
                continue
            self._lost.discard(driver)
            await self._end(driver, driver.safe)  # it was not stopped meanwhile
            if driver in self._lost:
                return  # once more: it is looked for again
            self._warn(f"{driver.kind}: the robot is back.")
            driver.tell(Back(driver.settings.devices))
            return

    async def _watch(self, driver: Driver) -> None:
        """Check at each heartbeat that the robot is still there."""
        seconds = driver.settings.heartbeat / 1000
        while True:
            await asyncio.sleep(seconds)
            if driver in self._lost:
                continue
            try:
                await within(seconds, driver.ping())
            except TimeoutError:
                driver.lose("the robot does not answer")
            except Exception as error:
                driver.lose(why(error))


async def open_driver(driver: Driver) -> None:
    """Connect a driver with its robot, in the time that its document allows.

    Raises:
        Unreachable: it cannot be reached, does not answer in time, or the driver fails.
        UsageError: the driver is not set up.
    """
    settings = driver.settings
    where = f" at {settings.address}" if settings.address else ""
    try:
        await within(settings.open / 1000, _opened(driver))
    except TimeoutError:
        reason = f"no answer within {settings.open / 1000:g} s"
        raise Unreachable(f"{settings.place}: {driver.kind}{where}: {reason}.") from None
    except Unreachable as error:
        raise Unreachable(f"{settings.place}: {driver.kind}{where}: {error}") from None
    except Unusable as error:
        raise Unusable(f"{settings.place}: {driver.kind}{where}: {error}") from None
    except UsageError:
        raise
    except Exception as error:
        reason = f"the driver has failed: {why(error)}"
        raise Unreachable(f"{settings.place}: {driver.kind}{where}: {reason}") from error


async def _opened(driver: Driver) -> None:
    await guarded(driver.open())
    await guarded(driver.ping())
