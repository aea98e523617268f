"""Live runs without waiting: a clock that jumps, and a scenario's user at a driver."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from heapq import heappop, heappush
from itertools import count
from random import Random
from typing import Any

from prima.devices.conductor import Conductor
from prima.devices.goals import News, RecordingBounds, Report, Speaks
from prima.devices.loop import Loop
from prima.devices.settings import FOREVER, DriverSettings
from prima.errors import Place
from prima.grammar.answers import Answers
from prima.grammar.phrases import phrases
from prima.live.clock import Clock
from prima.live.devices import LiveDevices
from prima.live.driver import Driver, Tell
from prima.live.drivers.sim import SimDriver
from prima.live.shell import Shell
from prima.live.visit import FOREVER_MS
from prima.messages import Inbound, Order, Record, Sensed
from prima.scheduler.policy import policy_named
from prima.sim.devices import Cast, sensors_watched, watches
from prima.sim.entrances import Entrances
from prima.sim.people import People
from prima.sim.rehearsal import make_session
from prima.sim.services import Services
from prima.sim.telephone import Telephone
from prima.transcript.lines import finished


class Jumping(Clock):
    """A clock that is always at what is waited for; it ends a run in which nothing is due."""

    def __init__(self, start: int = 0) -> None:
        super().__init__(1.0, start)
        self.time = start
        self.ended: Callable[[], None] = lambda: None

    def now(self) -> int:
        return self.time

    async def wait(self, until: int | None, woken: asyncio.Event) -> None:
        for _ in range(5):  # drivers' tasks get on
            await asyncio.sleep(0)
        if woken.is_set():
            return
        if until is None or until >= FOREVER_MS:
            self.ended()
        else:
            self.time = max(self.time, until)


class Creeping(Jumping):
    """A clock that also goes on between two statements, as a real one does; it wakes late.

    Drivers' reports come as much later, in the order in which they were made.
    """

    def __init__(self, seed: int = 0, longest: int = 3) -> None:
        super().__init__()
        self._dice = Random(seed)
        self._longest = longest
        self._agenda: list[tuple[int, int, Callable[[], object]]] = []
        self._serial = count()

    def now(self) -> int:
        self.time += self._dice.randint(0, self._longest)
        return self.time

    def at(self, time: int, what: Callable[[], object]) -> None:
        """Call something at a time, by which the run is woken."""
        heappush(self._agenda, (time, next(self._serial), what))

    def delay(self, driver: Driver) -> None:
        """Let a driver's reports come later."""
        attach, latest = driver.attach, 0

        def attached(tell: Tell, now: Callable[[], int]) -> None:
            def later(told: Report | News) -> None:
                nonlocal latest
                latest = max(latest, self.time + self._dice.randint(0, self._longest))
                self.at(latest, partial(tell, told))

            attach(later, now)

        driver.attach = attached  # type: ignore[method-assign, assignment]

    async def wait(self, until: int | None, woken: asyncio.Event) -> None:
        for _ in range(5):
            await asyncio.sleep(0)
        if woken.is_set():
            return
        due = FOREVER_MS if until is None else until
        if not self._agenda or due < self._agenda[0][0]:
            late = 0 if due >= FOREVER_MS else self._dice.randint(0, self._longest)
            await super().wait(due + late, woken)
            return
        self.time = max(self.time, self._agenda[0][0])
        while self._agenda and self._agenda[0][0] <= self.time:
            heappop(self._agenda)[2]()


class Outside:
    """A scenario's services and telephone."""

    def __init__(self, cast: Cast) -> None:
        self._services = Services(cast.scenario.services)
        self._telephone = Telephone(cast.scenario.transfers)

    def due(self) -> int | None:
        times = (self._services.due(), self._telephone.due())
        return min((time for time in times if time is not None), default=None)

    def collect(self, now: int) -> list[Inbound]:
        return [*self._services.collect(now), *self._telephone.collect(now)]

    def order(self, now: int, order: Order) -> None:
        (self._telephone if "transfer" in order.data else self._services).order(now, order)


class Hearing:
    """What a scenario's user needs of a robot, told as a driver tells it."""

    def __init__(self, driver: ScenarioDriver, conductor: Conductor) -> None:
        self._driver = driver
        self._conductor = conductor
        self.profile = driver.profile
        self.conductor = self
        self.ear = self

    @property
    def body(self) -> Any:
        return self._driver.body

    def speech_begins(self, now: int) -> None:
        self._driver.tell(Speaks(True))

    def speech_ends(self) -> None:
        """What was heard tells of it."""

    @property
    def deaf(self) -> bool:
        return self._conductor.ear.deaf or "speech-recognition" in self.body.broken

    def listen_on(self, now: int) -> None:
        self._driver.tell(Speaks(False))

    def recording(self) -> RecordingBounds | None:
        return self._conductor.ear.recording()

    def longest_answer(self) -> int:
        return self._conductor.longest_answer()

    def marks_passed(self, began: int) -> dict[str, Any]:
        return {}

    def broke(self, now: int, device: str, hangs: bool) -> list[Inbound]:
        self._driver.report(self.body.broke(device, hangs))
        if hangs:
            for task in self._conductor.tasks.values():
                if device in task.order.devices:
                    self._conductor.ear.deafen(task.id)
        return []


class ScenarioDriver(SimDriver):
    """The simulated robot with the user of a scenario."""

    def __init__(self, cast: Cast, stopping: str = "0s", since: int = -1) -> None:
        at = cast.scenario.robot_at
        options = {"stopping": stopping, **({"at": at} if at else {})}
        place = Place("robot.xml")
        devices = cast.robot.devices
        settings = DriverSettings(
            "sim", "", devices, 1000, 10**9, FOREVER, [], [], place, options=options
        )
        super().__init__(settings, cast.robot, cast.world)
        self.cast = cast
        self._since = since
        """What the user does by then is left out."""
        self._sensed: dict[str, Any] = {}
        """The sensors' values as told."""
        self.heard: list[tuple[int, list[str]]] = []
        """What is listened for, and since when (ms)."""
        self.hearing: Callable[[], Conductor] = lambda: Conductor(cast.robot, dict)

    async def open(self) -> None:
        await super().open()
        scenario = self.cast.scenario
        if scenario.robot_heading is not None:
            self.world.turn_body(scenario.robot_heading * 3.141592653589793 / 180)
        self.world.people.clear()
        for one in scenario.persons:
            self.world.put(one.name, one.point or self.site.point(one.at))
        whens = [
            when
            for when in scenario.whens
            if when.trigger != "at" or when.what.ms(1) + when.after.ms(1) > self._since
        ]
        self.people = People(
            replace(scenario, whens=whens),
            self.world,
            Hearing(self, self.hearing()),  # type: ignore[arg-type]
        )

    def hears(self, takes: Sequence[Answers]) -> None:
        said = {phrase for one in takes for phrase in phrases(one)}
        self.heard.append((self.world.time, sorted(said)))

    def report(self, reports: list[Any]) -> None:
        self._report(reports)

    def due(self) -> int | None:
        times = (super().due(), self.people.due())
        return min((time for time in times if time is not None), default=None)

    def sample(self, now: int) -> None:
        tell = self._tell
        held: list[Any] = []

        def later(told: Any) -> None:
            (held.append if isinstance(told, Sensed) else tell)(told)

        self._tell = later  # what sensors say comes last
        super().sample(now)
        for value in self.people.collect(now):
            tell(value)  # type: ignore[arg-type]
        self.people.follow()
        self._tell = tell
        for value in held:
            tell(value)
        if self.people.sensors != self._sensed:  # each report wakes the run
            self._sensed = dict(self.people.sensors)
            tell(Sensed(self._sensed))

    def observe(self, now: int, records: list[Record]) -> None:
        self.people.observe(now, records)


def live_loop(cast: Cast, policy: str = "prima", stopping: str = "0s", start: int = -1) -> Loop:
    """A scenario on a live robot that is simulated, with its user, not yet begun."""
    scenario, chosen = cast.scenario, policy_named(policy)
    driver = ScenarioDriver(cast, stopping, start)
    devices = LiveDevices(
        cast.robot,
        [driver],
        Outside(cast),
        [doc.id for doc, _ in zip(cast.documents, scenario.applications, strict=False)],
        Entrances(cast.offers),
        watches(cast.documents),
        sensors_watched(cast.documents),
        chosen.exclusive,
        start,
    )
    driver.hearing = lambda: devices.conductor
    session = make_session(cast, chosen, None, "none", None)
    devices.listening = session.listening
    return Loop(session, devices, scenario.until)


def carried_out(loop: Loop, start: int = 0, clock: Jumping | None = None) -> list[Record]:
    """The records of a run on its devices, times in s."""
    records: list[Record] = []
    loop.journal = lambda made: records.extend(made)
    clock = clock or Jumping(start)
    shell = Shell(loop, clock, print, None)
    clock.ended = shell.stop
    try:
        asyncio.run(shell.run())
    finally:
        loop.session.close()
    return [finished(record) for record in records]


def in_ms(records: list[Record]) -> list[Record]:
    """Records with times in ms, as the invariants take them."""
    return [{**record, "time": round(record["time"] * 1000)} for record in records]
