"""The preflight: each driver is opened, and each Command begun and really cancelled."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from time import monotonic

from prima.devices.goals import (
    LISTEN,
    SAY,
    Accepted,
    Begin,
    Broke,
    Done,
    Lost,
    News,
    Report,
    Stopped,
)
from prima.devices.profile import Profile, read_robot
from prima.devices.settings import Limits
from prima.errors import UsageError
from prima.language.commands import Argument, CommandType
from prima.live.devices import SAFE_S, LiveDevices
from prima.live.driver import Driver, Unreachable
from prima.live.shell import open_driver
from prima.live.visit import Chosen, Settings, make_drivers
from prima.loading import documents_folder
from prima.loading.files import read_file
from prima.messages import Command, Json
from prima.sim.map import Map, read_world
from prima.sim.services import Services

LASTING_MS = 300
"""How long a Command goes on before it is cancelled."""
UNBOUNDED_MS = 10_000
"""How long a driver may take where its document says nothing."""
SENTENCE = "This is a check of my voice."
TICK_S = 0.1
LATE_S = 0.05
"""By how much a tick of the clock may be late."""

Say = Callable[[str], object]


def check_robot(chosen: Chosen, settings: Settings, say: Say) -> int:
    """Try a robot, and say what came of it line by line.

    Returns:
        an exit code: 0 if all of it works, 2 if a driver is not set up, 3 if it does not work.

    Raises:
        DocumentError: a document is wrong.
        UsageError: there is no such driver.
    """
    robot = read_robot(chosen.robot, read_file(chosen.robot))
    world = chosen.world or str(documents_folder() / "worlds" / "room.xml")
    site = read_world(world, read_file(world))
    drivers = make_drivers(robot, site, settings.drivers)
    return asyncio.run(Preflight(robot, site, drivers, say).run())


class Preflight:
    """One check of a robot."""

    def __init__(self, robot: Profile, site: Map, drivers: list[Driver], say: Say) -> None:
        self._robot = robot
        self._site = site
        self._drivers = drivers
        self._say = say
        self._devices = LiveDevices(robot, drivers, Services([]), [])
        self._reports: dict[str, asyncio.Queue[Report]] = {}
        self._wrong = 0
        self._unusable = False
        """Whether a driver is not set up."""
        self._count = 0
        self._began = monotonic()

    async def run(self) -> int:
        """Try everything; the robot is made safe afterwards.

        Returns:
            an exit code: 2 if a driver is not set up, 3 if something else does not work.
        """
        try:
            await self._check_clock()
            opened = [driver for driver in self._drivers if await self._opens(driver)]
            if len(opened) == len(self._drivers):
                for command in self._commands():
                    await self._try(command)
                for driver in opened:
                    for problem in await driver.check():
                        self._tell(False, driver.kind, problem)
        finally:
            for driver in self._drivers:
                for end in (driver.safe, driver.close):
                    await self._end(driver, end)
        return 2 if self._unusable else 3 if self._wrong else 0

    async def _end(self, driver: Driver, end: Callable[[], object]) -> None:
        try:
            async with asyncio.timeout(SAFE_S):
                await end()  # type: ignore[misc]
        except Exception as error:
            name = getattr(end, "__name__", "")
            self._tell(False, driver.kind, f"{name} has failed: {error or type(error).__name__}")

    def _tell(self, right: bool, what: str, text: str) -> None:
        self._wrong += not right
        self._say(f"{'ok' if right else 'FAILS':5}  {what}: {text}")

    async def _check_clock(self) -> None:
        began = monotonic()
        await asyncio.sleep(TICK_S)
        late = monotonic() - began - TICK_S
        self._tell(late < LATE_S, "clock", f"a tick was {max(late, 0) * 1000:.0f} ms late")

    async def _opens(self, driver: Driver) -> bool:
        def told(report: Report | News) -> None:
            if isinstance(report, Lost):
                for queue in self._reports.values():
                    queue.put_nowait(report)
            elif isinstance(report, Report):
                waiting = self._reports.get(getattr(report, "key", ""))
                if waiting is not None:
                    waiting.put_nowait(report)

        driver.attach(told, self._now)
        began = monotonic()
        try:
            await open_driver(driver)
        except (Unreachable, UsageError) as error:
            self._unusable |= isinstance(error, UsageError)
            self._tell(False, driver.kind, str(error))
            return False
        taken = (monotonic() - began) * 1000
        self._tell(True, driver.kind, f"connected in {taken:.0f} ms")
        return True

    def _now(self) -> int:
        return int((monotonic() - self._began) * 1000)

    # Commands ---------------------------------------------------------------------------

    def _commands(self) -> list[tuple[str, Command, frozenset[str]]]:
        """What is tried: the goal's kind, the Command, and its devices."""
        tried: list[tuple[str, Command, frozenset[str]]] = []
        for row in self._robot.commands.values():
            if row.substitute or row.name in ("pause", "speak", "q-and-a"):
                continue
            for args in self._arguments(row):
                tried.append((row.name, Command(row.name, args), row.devices))
        if "speaker" in self._robot.devices:
            lang = next(iter(self._robot.voices), "en")
            command = Command("speak", {}, SENTENCE, lang=lang)
            tried.append((SAY, command, frozenset({"speaker"})))
        if "speech-recognition" in self._robot.devices:
            command = Command("q-and-a", {"timeout": 5000}, lang="en")
            tried.append((LISTEN, command, frozenset({"speech-recognition"})))
        return tried

    def _arguments(self, row: CommandType) -> list[dict[str, Json]]:
        """Small arguments for a Command; each gesture for the Command that makes them."""
        if row.name == "gesture":
            return [{"name": name} for name in self._robot.gestures]
        args: dict[str, Json] = {}
        chosen: set[str] = set()
        for name, argument in row.arguments.items():
            if argument.choice in chosen or not (argument.required or argument.choice):
                if argument.default is not None:
                    args[name] = argument.default
                continue
            value = self._value(name, argument)
            if value is not None:
                args[name] = value
                chosen |= {argument.choice} if argument.choice else set()
        return [args]

    def _value(self, name: str, argument: Argument) -> Json:
        """A small value for an argument: the nearest to nothing that moves."""
        if argument.default is not None:
            return argument.default
        if argument.kind == "duration":
            return 500
        if argument.kind == "number":
            wanted = {"speed": 0.05, "x": 0.2}.get(name, 10.0 if argument.choice else 0.0)
            return min(max(wanted, argument.low or wanted), argument.high or wanted)
        return next(iter(self._site.places), None) if argument.kind == "id" else None

    async def _try(self, tried: tuple[str, Command, frozenset[str]]) -> None:
        """Begin a Command, let it go on for a moment, and cancel it."""
        kind, command, devices = tried
        what = f"{kind} {command.args.get('name', '')}".strip()
        self._count += 1
        key = f"check/{self._count}"
        now = self._now()
        row = self._robot.commands.get(kind)
        tick = now + self._robot.loop if row is not None and row.feedback else None
        begin = Begin(key, kind, command, devices, 0, tick, self._robot.loop)
        driver = self._devices.route(begin)
        if driver is None:
            self._tell(
                False, what, f'no driver carries it out; name it in a <does command="{kind}">'
            )
            return
        limits = self._devices.limits(begin)
        self._reports[key] = asyncio.Queue()
        driver.sample(now)
        try:
            driver.start(begin)
            self._tell(*await self._watch(driver, key, what, limits))
        except Exception as error:
            self._tell(False, what, f"{driver.kind} has failed: {error}")
        finally:
            del self._reports[key]

    async def _watch(
        self, driver: Driver, key: str, what: str, limits: Limits
    ) -> tuple[bool, str, str]:
        """What comes of a Command that was begun."""
        began = monotonic()
        first = await self._report(key, limits.accept)
        accepted = (monotonic() - began) * 1000
        if first is None:
            driver.cancel(key)
            return False, what, f"{driver.kind} does not accept it within {limits.accept} ms"
        then = first
        if isinstance(first, Accepted):
            ended = await self._report(key, LASTING_MS, last=True)
            if ended is None:
                began = monotonic()
                driver.cancel(key)
                ended = await self._report(key, limits.cancel, last=True)
                if ended is None:
                    return False, what, f"{driver.kind} does not stop within {limits.cancel} ms"
            then = ended
        taken = (monotonic() - began) * 1000
        match then:
            case Broke():
                return False, what, f"{driver.kind}: {then.reason}"
            case Lost():
                return False, what, f"{driver.kind}: {then.reason}"
            case Done():
                return True, what, f"accepted in {accepted:.0f} ms, done in {taken:.0f} ms"
            case Stopped():
                return True, what, f"accepted in {accepted:.0f} ms, stopped in {taken:.0f} ms"
        return True, what, f"accepted in {accepted:.0f} ms"

    async def _report(self, key: str, limit: int | None, last: bool = False) -> Report | None:
        """The next report of a goal, or with ``last`` its end; None if none comes in time (ms)."""
        queue = self._reports[key]
        try:
            async with asyncio.timeout((limit or UNBOUNDED_MS) / 1000):
                while True:
                    report = await self._next(queue)
                    if not last or isinstance(report, Done | Stopped | Broke | Lost):
                        return report
        except TimeoutError:
            return None

    async def _next(self, queue: asyncio.Queue[Report]) -> Report:
        """The next report; simulated robots get on meanwhile."""
        while queue.empty():
            for driver in self._drivers:
                if driver.due() is not None:
                    driver.sample(self._now())
            await asyncio.sleep(0.005)
        return queue.get_nowait()
