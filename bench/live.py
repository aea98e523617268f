"""Live runs: how soon an order follows an event, how punctual instants are, what idling costs.

``python -m bench.live`` prints all of it.
"""

from __future__ import annotations

import asyncio
import os
import sys
import tempfile
from pathlib import Path
from statistics import median, quantiles
from time import perf_counter, process_time

from bench.fresh import check, note
from bench.workloads import memory as memory_now
from prima import api
from prima.devices.goals import Accepted, Begin, Done, Stopped
from prima.devices.loop import Loop
from prima.devices.settings import FOREVER, DriverSettings
from prima.errors import Place
from prima.live.clock import Clock
from prima.live.devices import LiveDevices
from prima.live.driver import Driver
from prima.live.journal import Journal
from prima.live.shell import Shell
from prima.live.visit import FOREVER_MS
from prima.messages import Occurred, Record
from prima.scheduler.policy import policy_named
from prima.sim.rehearsal import make_session
from prima.sim.services import Services

APPLICATION = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a{number}">
  <var name="seen" expr="0"/>
  <form id="wait">
    <on event="ring.{number}">
      <assign name="seen" expr="seen + 1"/><gesture name="nod"/><goto next="#wait"/>
    </on>
  </form>
</prima>
"""
EVENTS = 300
EVERY_S = 0.01
IDLE_S = 5.0
DAY_MS = 24 * 3_600_000
RING_MS = 10_000


class Instant(Driver):
    """Does everything at once, and notes the times of its orders."""

    kind = "instant"

    def start(self, goal: Begin) -> None:
        self.told(perf_counter())
        self.tell(Accepted(goal.key))
        self.tell(Done(goal.key))

    def cancel(self, key: str) -> None:
        self.tell(Stopped(key))

    def told(self, when: float) -> None:
        """An order has arrived."""


def staged(applications: int, folder: str) -> tuple[Loop, Instant]:
    """So many applications on a robot that does everything at once."""
    paths = []
    for number in range(applications):
        path = Path(folder) / f"a{number}.xml"
        path.write_text(APPLICATION.format(number=number))
        paths.append(str(path))
    cast = api.stage([], paths).cast
    devices = cast.robot.devices
    settings = DriverSettings(
        "instant", "", devices, 1000, 10**9, FOREVER, [], [], Place("robot.xml")
    )
    driver = Instant(settings, cast.robot, cast.world)
    live = LiveDevices(cast.robot, [driver], Services([]), [doc.id for doc in cast.documents])
    session = make_session(cast, policy_named("prima"), None, "none", None)
    return Loop(session, live, FOREVER_MS, bounded=False), driver


def event_to_order(applications: int = 10) -> float:
    """Milliseconds from an event's arrival to the order's departure, the median; 99th noted."""
    taken: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        loop, driver = staged(applications, folder)
        journal = Journal(os.path.join(folder, "visit.jsonl"))
        loop.journal = journal.write
        sent = [0.0]
        driver.told = lambda when: taken.append((when - sent[0]) * 1000)  # type: ignore[method-assign]

        async def ring(shell: Shell) -> None:
            for number in range(EVENTS):
                await asyncio.sleep(EVERY_S)
                sent[0] = perf_counter()
                driver.tell(Occurred(f"ring.{number % applications}", "user"))
            await asyncio.sleep(EVERY_S)
            shell.stop()

        async def run() -> None:
            shell = Shell(loop, Clock(), print, None)
            await asyncio.gather(shell.run(), ring(shell))

        asyncio.run(run())
        loop.session.close()
        journal.close()
    check(len(taken) == EVENTS, f"{len(taken)} orders of {EVENTS} events")
    note(f"99th percentile {quantiles(taken, n=100)[-1]:.2f} ms")
    return median(taken)


def lateness() -> float:
    """Milliseconds by which instants are late, the 99th percentile, while time goes on."""
    late: list[float] = []

    class Noting(Clock):
        async def wait(self, until: int | None, woken: asyncio.Event) -> None:
            await super().wait(until, woken)
            if until is not None and not woken.is_set():
                late.append(self.now() - until)

    scenario = "documents/scenarios/follow-during-navigation.xml"
    from prima.sim.rehearsal import Rehearsal

    loop = Rehearsal(api.load_scenario(scenario).cast, policy_named("prima"), isolate="none")
    shell = Shell(loop, Noting(4.0), print, None)
    asyncio.run(shell.run())
    loop.session.close()
    note(f"{len(late)} instants at 4 times real time, in ms of real time")
    return quantiles(late, n=100)[-1] / 4.0


def idle() -> float:
    """The share of a core (0 to 1) that a run takes while nothing happens."""
    with tempfile.TemporaryDirectory() as folder:
        loop, _ = staged(10, folder)
        used = [0.0]

        async def run() -> None:
            shell = Shell(loop, Clock(), print, None)
            running = asyncio.ensure_future(shell.run())
            await asyncio.sleep(0.5)
            began = process_time()
            await asyncio.sleep(IDLE_S)
            used[0] = process_time() - began
            shell.stop()
            await running

        asyncio.run(run())
        loop.session.close()
    return used[0] / IDLE_S


class Jumping(Clock):
    """A clock that is always at what is waited for."""

    time = 0

    def now(self) -> int:
        return self.time

    async def wait(self, until: int | None, woken: asyncio.Event) -> None:
        await asyncio.sleep(0)
        if until is not None and not woken.is_set():
            self.time = max(self.time, until)


def growth(hours: int = 24) -> float:
    """Memory after so many accelerated hours, with an event every 10 s, over that after one."""
    sizes: dict[int, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        loop, driver = staged(10, folder)
        journal = Journal(os.path.join(folder, "visit.jsonl"))
        loop.journal = journal.write
        loop.until = hours * 3_600_000
        next_ring = [RING_MS]
        driver.due = lambda: next_ring[0]  # type: ignore[method-assign]

        def sample(now: int) -> None:
            if now >= next_ring[0]:
                next_ring[0] += RING_MS
                driver.tell(Occurred(f"ring.{now // RING_MS % 10}", "user"))
                if now % 3_600_000 == 0:
                    sizes[now // 3_600_000] = memory_now()

        driver.sample = sample  # type: ignore[method-assign]
        shell = Shell(loop, Jumping(), print, None)
        asyncio.run(shell.run())
        loop.session.close()
        journal.close()
    check(len(sizes) >= hours - 1, f"{len(sizes)} hours of {hours}")
    return sizes[max(sizes)] / sizes[1]


def journal_cost(sync: bool = False) -> float:
    """Microseconds that it takes to append an instant of ten records."""
    path = "documents/scenarios/follow-during-navigation.xml"
    loaded = api.load_scenario(path)
    from prima.sim.rehearsal import Rehearsal

    rehearsal = Rehearsal(loaded.cast, policy_named("prima"), isolate="none")
    records: list[Record] = [one for made in rehearsal.run() for one in made]
    count = len(records) // 10 * (2 if sync else 20)
    with tempfile.TemporaryDirectory(dir=".") as folder:
        journal = Journal(os.path.join(folder, "visit.jsonl"), sync)
        began = perf_counter()
        for number in range(count):
            at = number * 10 % (len(records) - 10)
            journal.write(records[at : at + 10])
        taken = perf_counter() - began
        journal.close()
    return taken / count * 1e6


if __name__ == "__main__":
    rows = (
        ("event to order with ten applications, median (ms)", event_to_order),
        ("instants late, 99th percentile (ms)", lateness),
        ("a core while nothing happens (share)", idle),
        ("memory after 24 hours over that after one", growth),
        ("journal, an instant of ten records (µs)", journal_cost),
        ("the same with --sync (µs)", lambda: journal_cost(True)),
    )
    for what, figure in rows:
        sys.stdout.write(f"{what}: {figure():.3f}\n")
        sys.stdout.flush()
