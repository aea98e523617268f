"""The preflight check: each driver is opened, and each Command begun and actually cancelled."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, replace
from statistics import median
from time import monotonic
from typing import Any

from prima.devices.goals import LISTEN, SAY, Begin, Broke, Done, Lost, News, Report, Stopped
from prima.devices.profile import Profile, read_robot
from prima.errors import UsageError
from prima.language.commands import Argument, CommandType
from prima.live.carried import SPOKEN, lacking, limits_of, route
from prima.live.chosen import Chosen
from prima.live.deadlines import guarded, run, unbroken, within
from prima.live.devices import SAFE_S
from prima.live.driver import Driver, Unreachable, why
from prima.live.shell import open_driver
from prima.live.signals import heeding_signals
from prima.live.visit import LiveSettings, make_drivers
from prima.loading import documents_folder
from prima.loading.files import read_file
from prima.messages import Command, Json
from prima.sim.map import Map, read_world

LASTING_MS = 300
"""How long a Command goes on before it is cancelled."""
UNBOUNDED_MS = 10_000
"""How long a driver may take unless its document says otherwise."""
SENTENCE = "This is a check of my voice."
TICKS, TICK_S = 5, 0.02
"""The number of clock ticks to measure, and the length (s) of each."""
ENDS = (Done, Stopped, Broke, Lost)
INTERRUPTED = 130
"""The exit code after a signal."""
HEEDED_S = 0.15
"""Within this time after a cancel, a goal that ends well may simply have finished."""
SLOW_S = 1.0
"""A longer stopping time is reported."""
LINE = "{:5}  {:26}  {:10}  {:>9}  {:>9}  {}"
"""The format of a line: the result, the check, the driver, two times, and a remark."""
SMALL = {"speed": 0.05, "x": 0.2, "angle": 30.0, "pan": 20.0}
"""Arguments with a movement small enough to be harmless and long enough to be cancelled."""
LATE_S = 0.05
"""The maximum median lateness of the clock's ticks."""

Say = Callable[[str], object]


@dataclass(frozen=True, slots=True)
class CommandFinding:
    """The result of trying a Command: whether it works, why not, and its times as text."""

    right: bool
    text: str
    accepted: str = ""
    cancelled: str = ""
    done: bool = False
    """Whether it was over before it could be cancelled."""


def _ended(report: Report, accepted: str) -> CommandFinding:
    """The result of a Command that has ended by itself."""
    if isinstance(report, Broke | Lost):
        return CommandFinding(False, report.reason, accepted)
    if isinstance(report, Stopped):
        return CommandFinding(False, "it stops by itself", accepted)
    return CommandFinding(True, "over at once", accepted, done=True)


def _ms(seconds: float) -> str:
    return f"{seconds * 1000:.0f} ms"


def check_robot(chosen: Chosen, settings: LiveSettings, say: Say) -> int:
    """Try a robot, and print the results line by line.

    Returns:
        an exit code: 0 if everything works, 2 if a driver is not set up, 3 if something fails.

    Raises:
        DocumentError: a document is wrong.
        UsageError: there is no such driver.
    """
    robot = read_robot(chosen.robot, read_file(chosen.robot))
    world = chosen.world or str(documents_folder() / "worlds" / "room.xml")
    site = read_world(world, read_file(world))
    drivers = make_drivers(robot, site, settings.drivers)
    try:
        return run(_stoppable(Preflight(robot, site, drivers, say)))
    except KeyboardInterrupt as error:  # a driver blocked it
        say(str(error) or "The check was broken off.")
        return INTERRUPTED


async def _stoppable(preflight: Preflight) -> int:
    """Carry out a check; a signal ends it. The robot is made safe afterwards, whatever happens."""
    trying = asyncio.ensure_future(preflight.try_all())
    signals: list[bool] = []
    with heeding_signals(lambda: signals.append(trying.cancel())):
        try:
            await asyncio.wait([trying])
        finally:
            code = await preflight.end()
    if not (signals and trying.cancelled()):
        trying.result()
    return INTERRUPTED if signals else code


class Preflight:
    """One check of a robot."""

    def __init__(self, robot: Profile, site: Map, drivers: list[Driver], say: Say) -> None:
        self._robot = robot
        self._site = site
        self._drivers = drivers
        self._say = say
        self._reports: dict[str, asyncio.Queue[Report]] = {}
        self._wrong = 0
        self._opened: list[Driver] = []
        self._unusable = False
        """Whether a driver is not set up."""
        self._count = 0
        self._began = monotonic()

    async def try_all(self) -> None:
        """Try everything."""
        self._say(LINE.format("", "", "driver", "accepted", "cancelled", "").rstrip())
        await self._check_clock()
        for driver in self._drivers:
            if await self._opens(driver):
                self._opened.append(driver)
        self._tell_stops()
        for command in self._commands():
            await self._try(command)
        for driver in self._opened:
            found = await self._let(driver, driver.settings.open / 1000, driver.check)
            if not isinstance(found, dict | None):
                reason = f"check has failed: it returns {type(found).__name__}, not a dict"
                found = {"check": reason}
            for what, problem in (found or {}).items():
                self._tell(not problem, what, problem, driver.kind)

    async def end(self) -> int:
        """Make the robot safe, and close the connections.

        Returns:
            an exit code: 2 if a driver is not set up, 3 if something else does not work.
        """
        for ends in ("safe", "close"):
            ended = (self._let(one, SAFE_S, getattr(one, ends)) for one in self._drivers)
            await asyncio.gather(*ended)
        return 2 if self._unusable else 3 if self._wrong else 0

    async def _let(
        self, driver: Driver, seconds: float, what: Callable[[], Coroutine[Any, Any, Any]]
    ) -> Any:
        """What a driver returns; None if it fails, which is printed."""
        try:
            return await within(seconds, unbroken(what, self._say))
        except Exception as error:
            reason = f"{what.__name__} has failed: {why(error)}"
            self._tell(False, what.__name__, reason, driver.kind)
            return None

    def _tell(self, right: bool | None, what: str, text: str, *columns: str) -> None:
        """Print a line: whether it works (None for information), what, and how."""
        self._wrong += right is False
        result = "-" if right is None else "ok" if right else "FAILS"
        self._say(LINE.format(result, what, *columns, *[""] * (3 - len(columns)), text).rstrip())

    async def _check_clock(self) -> None:
        late = []
        for _ in range(TICKS):
            began = monotonic()
            await asyncio.sleep(TICK_S)
            late.append(monotonic() - began - TICK_S)
        usual = median(late)
        self._tell(usual < LATE_S, "clock", f"ticks were {_ms(max(usual, 0))} late")

    async def _opens(self, driver: Driver) -> bool:
        def attend(report: Report | News) -> None:
            if isinstance(report, Lost):
                for queue in self._reports.values():
                    queue.put_nowait(report)
            elif isinstance(report, Report):
                waiting = self._reports.get(getattr(report, "key", ""))
                if waiting is not None:
                    waiting.put_nowait(report)

        driver.attach(attend, self._now)
        began = monotonic()
        try:
            await open_driver(driver)
        except (Unreachable, UsageError) as error:
            self._unusable |= isinstance(error, UsageError)
            self._tell(False, "connection", str(error), driver.kind)
            return False
        self._tell(True, "connection", "", driver.kind, _ms(monotonic() - began))
        return True

    def _tell_stops(self) -> None:
        """Print how the emergency stop is connected; it is not pressed here."""
        stops = [
            (driver, senses.by)
            for driver in self._drivers
            for senses in driver.settings.senses
            if senses.what == "emergency"
        ]
        for driver, by in stops:
            self._tell(None, "emergency stop", f"by {by}; press it once in a run", driver.kind)
        if not stops:
            self._tell(None, "emergency stop", "the robot's document has none")

    def _now(self) -> int:
        return int((monotonic() - self._began) * 1000)

    # Commands ---------------------------------------------------------------------------

    def _commands(self) -> list[tuple[str, Command, frozenset[str]]]:
        """The checks: the goal's kind, the Command, and its devices."""
        tried: list[tuple[str, Command, frozenset[str]]] = []
        for row in self._robot.commands.values():
            if row.substitute or row.name in SPOKEN:
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
        """A small value for an argument: the smallest that moves the robot."""
        if argument.default is not None:
            return argument.default
        if argument.kind == "duration":
            return 500
        if argument.kind == "number":
            wanted = SMALL.get(name, 10.0 if argument.choice else 0.0)
            return min(max(wanted, argument.low or wanted), argument.high or wanted)
        places = [name for one in self._robot.drivers for name in one.places]
        return next(iter([*places, *self._site.places]), None) if argument.kind == "id" else None

    async def _try(self, tried: tuple[str, Command, frozenset[str]]) -> None:
        """Begin a Command, let it run for a moment, and cancel it."""
        kind, command, devices = tried
        what = f"{kind} {command.args.get('name', '')}".strip()
        self._count += 1
        key = f"check/{self._count}"
        now = self._now()
        row = self._robot.commands.get(kind)
        tick = now + self._robot.loop if row is not None and row.feedback else None
        begin = Begin(key, kind, command, devices, 0, tick, self._robot.loop)
        driver = route(self._drivers, begin)
        if driver is None:
            self._tell(False, what, lacking(self._drivers, begin))
        elif driver not in self._opened:
            self._tell(None, what, "not tried: its driver is not there", driver.kind)
        else:
            found = await self._carried_out(driver, begin, LASTING_MS)
            if found.done:  # too fast to be cancelled: try once more
                again = replace(begin, key=f"{key}/again")
                found = replace(await self._carried_out(driver, again, 0), accepted=found.accepted)
            self._tell(found.right, what, found.text, driver.kind, found.accepted, found.cancelled)

    async def _carried_out(self, driver: Driver, begin: Begin, lasts: int) -> CommandFinding:
        """Begin a Command, let it run for a while (ms), and cancel it."""
        self._reports[begin.key] = asyncio.Queue()
        try:
            return await guarded(self._watch(driver, begin, lasts))
        except Exception as error:
            return CommandFinding(False, f"the driver has failed: {why(error)}")
        finally:
            del self._reports[begin.key]

    async def _watch(self, driver: Driver, begin: Begin, lasts: int) -> CommandFinding:
        """Begin a Command, and cancel it; its result."""
        key, limits = begin.key, limits_of(self._drivers, begin, self._robot.voices)
        driver.sample(self._now())
        driver.start(begin)
        began = monotonic()
        first = await self._report(key, limits.accept)
        accepted = _ms(monotonic() - began)
        if first is None:
            driver.cancel(key)
            return CommandFinding(False, f"not accepted within {limits.accept} ms")
        if isinstance(first, ENDS):
            return _ended(first, accepted)
        if lasts and (then := await self._report(key, lasts, last=True)) is not None:
            return _ended(then, accepted)
        began = monotonic()
        driver.cancel(key)
        ended = await self._report(key, limits.cancel, last=True)
        taken = monotonic() - began
        if ended is None:
            text = f"does not stop within {limits.cancel or UNBOUNDED_MS} ms"
            return CommandFinding(False, text, accepted)
        if isinstance(ended, Lost):
            return CommandFinding(False, ended.reason, accepted)
        if isinstance(ended, Done) and taken > HEEDED_S:
            text = "goes on to its end although it is cancelled"
            return CommandFinding(False, text, accepted, _ms(taken))
        text = "stops late: does it heed a cancel?" if taken > SLOW_S else ""
        return CommandFinding(True, text, accepted, _ms(taken))

    async def _report(self, key: str, limit: int | None, last: bool = False) -> Report | None:
        """The next report of a goal, or with ``last`` its end; None if none comes in time (ms)."""
        queue = self._reports[key]
        try:
            async with asyncio.timeout((limit or UNBOUNDED_MS) / 1000):
                report = await self._next(queue)
                while last and not isinstance(report, ENDS):
                    report = await self._next(queue)
                return report
        except TimeoutError:
            return None

    async def _next(self, queue: asyncio.Queue[Report]) -> Report:
        """The next report; simulated robots advance meanwhile."""
        while queue.empty():
            for driver in self._drivers:
                if driver.due() is not None:
                    driver.sample(self._now())
            await asyncio.sleep(0.005)
        return queue.get_nowait()
