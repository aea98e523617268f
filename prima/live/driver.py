"""Drivers carry out goals on a robot, and report what its sensors say.

Drivers do not know the rules of mediation. :class:`Driver` is the plain interface;
:class:`TaskDriver` suits most robots: it runs one coroutine for each goal.
All methods are called in the event loop of the run; a thread may call :meth:`Driver.tell`,
:meth:`Driver.post` and :meth:`Driver.lose`.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from math import isnan
from numbers import Real
from threading import get_ident
from typing import Any, ClassVar

from prima.devices.goals import (
    RECORD,
    SAY,
    Accepted,
    Begin,
    Broke,
    Done,
    Lost,
    News,
    Progress,
    Report,
    Stopped,
)
from prima.devices.profile import Profile
from prima.devices.settings import Does, DriverSettings, Pose
from prima.errors import RunError, UsageError
from prima.grammar.answers import Answers
from prima.live.deadlines import Escaped, Late, guarded
from prima.live.recordings import Recordings
from prima.live.threads import call_in, in_run
from prima.live.wellformed import WRONG, well_formed
from prima.messages import Data, Json, Record
from prima.sim.map import Map

Tell = Callable[[Report | News], None]


class Unreachable(RunError):
    """The robot, or the program that drives it, cannot be reached."""


class Unusable(UsageError):
    """The driver is not set up: a library is missing, or its address is invalid."""


class Refused(Exception):
    """A goal is not reached: the robot refuses it or has failed.

    Args:
        reason: why, for people.
        device: the device that failed; by default the goal's first.
    """

    def __init__(self, reason: str, device: str = "") -> None:
        super().__init__(reason)
        self.device = device


def why(error: BaseException) -> str:
    """Why a driver has failed: its own words, or an error that it did not mean with its type."""
    said, kind = str(error), type(error).__name__
    meant = isinstance(error, Refused | RunError | UsageError | Escaped | Late)
    return (said if meant else f"{kind}: {said}") if said else kind


class OpenRequests(set[asyncio.Future[Any]]):
    """Requests to a robot that have not been answered."""

    def add_one(self) -> asyncio.Future[Any]:
        """The future of a request, in the event loop in which this is called."""
        future: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self.add(future)
        future.add_done_callback(self.discard)
        return future

    def fail(self, reason: str) -> None:
        """Give them up: the robot cannot be reached."""
        for future in list(self):
            if not future.done():
                future.set_exception(Unreachable(reason))
                future.exception()


class Driver:
    """One connection to a robot. Times are ms.

    Args:
        settings: its ``driver`` element.
        profile: the robot.
        site: the map of the place where the robot is.
    """

    kind: ClassVar[str] = ""
    """Its name in robots' documents."""
    mapped: ClassVar[bool] = False
    """Whether Commands need a ``does`` to be carried out."""
    own: ClassVar[frozenset[str]] = frozenset()
    """The Commands (and ``say``, ``listen``) that it carries out without one."""

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        self.settings = settings
        self.profile = profile
        self.site = site
        self.now: Callable[[], int] = lambda: 0
        """The run's time (ms)."""
        self.recordings = Recordings()
        """Where it stores recordings."""
        self._tell: Tell = lambda _: None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: int | None = None

    # What a driver implements -----------------------------------------------------------

    async def open(self) -> None:
        """Connect to the robot; called again after the connection was lost.

        Raises:
            Unreachable: it cannot be reached; the message says what to do.
            Unusable: with this setup of the driver it never can be.
        """

    def start(self, goal: Begin) -> None:
        """Begin a goal. Reports follow, now or later: accepted, then one of its ends."""
        raise NotImplementedError

    def cancel(self, key: str) -> None:
        """End a goal as soon as possible; :class:`Stopped` follows when it has ended."""
        raise NotImplementedError

    def again(self, key: str) -> None:
        """A feedback Command makes another loop: its goal simply goes on."""

    def stand(self) -> None:
        """Stop the wheels if the body rolls on after a Command (rule F5)."""

    def hears(self, takes: Sequence[Answers]) -> None:
        """Called with what the listening questions and links accept, each time that it changes.

        A recogniser makes its grammar from it. Others can ignore it.
        """

    async def safe(self) -> None:
        """Stop everything at once. May be called more than once, and after a loss."""

    async def ping(self) -> None:
        """Ask whether the robot is still there, within the heartbeat.

        Raises:
            Unreachable: it is not.
        """

    async def check(self) -> dict[str, str]:
        """Check what only this driver can check before a run, such as whether the microphone works.

        Returns:
            the checks, each with a sentence on what does not work, or an empty one.
        """
        return {}

    async def close(self) -> None:
        """Close the connection; the run is over."""

    def due(self) -> int | None:
        """When it next has something to report (ms of the run), for simulated robots."""
        return None

    def sample(self, now: int) -> None:
        """Report what has to be known at this instant, such as the robot's pose. Must not block."""

    def observe(self, now: int, records: list[Record]) -> None:
        """Observe the records of an instant."""

    # What a driver uses -----------------------------------------------------------------

    def attach(self, tell: Tell, now: Callable[[], int] = lambda: 0) -> None:
        """Connect it with a run and its clock (ms), in whose event loop this is called."""
        self._tell, self.now = tell, now
        self._loop, self._thread = asyncio.get_running_loop(), get_ident()

    @in_run
    def tell(self, report: Report | News) -> None:
        """Report to the run; if no record can hold it, the robot is lost."""
        try:
            checked = well_formed(report)
        except WRONG as error:
            self.lose(f"a report of the driver is wrong ({type(report).__name__}): {error}")
            return
        if checked is not None:
            self._tell(checked)

    def post(self, report: Report | News) -> None:
        """Report to the run from another thread. After the run's end it is dropped."""
        call_in(self._loop, self.tell, report)

    def lose(self, reason: str) -> None:
        """Report a lost connection: running goals fail, and :meth:`open` is called again."""
        self.tell(Lost(self.settings.devices, reason))

    def does(self, goal: Begin) -> Does | None:
        """How a goal is carried out according to the robot's document."""
        gesture = str(goal.command.args.get("name", "")) if goal.kind == "gesture" else ""
        return self.settings.how(goal.kind, gesture)

    def values(self, goal: Begin) -> dict[str, Json]:
        """The values that a goal provides for arguments: see ``set`` in the robot's document."""
        command = goal.command
        values: dict[str, Json] = {**command.args, "lang": command.lang or "en"}
        if command.text is not None:
            values["text"] = command.text.strip()
        if pose := self.place(goal):
            values |= {"x": pose.x, "y": pose.y, "heading": pose.heading}
        return values

    def place(self, goal: Begin) -> Pose | None:
        """The place that a goal names, on the robot's own map; None if it names none.

        The robot's document says where a place is there; otherwise the site's map does.
        """
        args = goal.command.args
        name = str(args.get("to", args.get("toward", "")))
        point = self.site.point(name)
        known = Pose(*point, self.site.headings.get(name, 0.0)) if point is not None else None
        return self.settings.places.get(name, known)


class TaskDriver(Driver):
    """A driver that runs one coroutine for each goal.

    A goal is done when :meth:`perform` returns, fails when it raises, and has stopped when it
    has ended after being cancelled: stop the robot where :class:`asyncio.CancelledError` arrives.
    """

    confirms: ClassVar[bool] = False
    """Whether :meth:`perform` calls :meth:`accept` itself, when the robot has accepted a goal."""

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        super().__init__(settings, profile, site)
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._said: dict[str, int] = {}
        """How many characters of their texts goals have said, as far as :meth:`perform` reports."""

    async def perform(self, goal: Begin) -> Data:
        """Carry out a goal to its end; returns the data that the device reports then.

        Raises:
            Refused: the robot does not do it.
            Unreachable: the robot cannot be reached any more.
        """
        raise NotImplementedError(f"{type(self).__name__} has no method perform")

    def has_said(self, goal: Begin, characters: int) -> None:
        """Note how much of a goal's text has been said, to report if it is cancelled (X2)."""
        self._said[goal.key] = characters

    def accept(self, goal: Begin) -> None:
        """Report that the robot has begun a goal."""
        self.tell(Accepted(goal.key))

    def report(self, goal: Begin) -> None:
        """Report that the robot is still working at a goal."""
        self.tell(Progress(goal.key))

    def start(self, goal: Begin) -> None:
        """Begin the coroutine of a goal."""
        task = self._tasks[goal.key] = asyncio.ensure_future(self._run(goal))
        task.add_done_callback(lambda _: self._never_run(goal.key))
        if not self.confirms:
            self.accept(goal)

    def cancel(self, key: str) -> None:
        """Cancel the coroutine of a goal; one that is over has already reported its end."""
        if task := self._tasks.get(key):
            task.cancel()

    @in_run
    def lose(self, reason: str) -> None:
        """Report a lost connection; running goals do not go on when it is back."""
        super().lose(reason)
        own = asyncio.current_task()
        for task in self._tasks.values():
            if task is not own:
                task.cancel()

    async def close(self) -> None:
        """Cancel running goals, and wait for them to end."""
        await self.end_goals()

    async def end_goals(self, longest: float | None = None) -> None:
        """Cancel all goals, and wait (s) until they have ended."""
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        if tasks:
            await asyncio.wait(tasks, timeout=longest)

    def _never_run(self, key: str) -> None:
        """Report the end of a goal that was cancelled before its coroutine first ran."""
        if self._tasks.pop(key, None) is not None:
            self.tell(Stopped(key))

    async def _run(self, goal: Begin) -> None:
        try:
            report: Report = Done(goal.key, await guarded(self.perform(goal)))
        except asyncio.CancelledError:
            report = Stopped(goal.key, said=self._said.get(goal.key))
        except Unreachable as error:
            self.lose(str(error))
            return
        except Exception as error:
            device = getattr(error, "device", "") or goal.device
            lacks = goal.kind == RECORD and isinstance(error, Refused)
            report = Broke(goal.key, device, why(error), lacks)
        finally:
            self._tasks.pop(goal.key, None)
            self._said.pop(goal.key, None)
        self.tell(report)


def due_of(driver: Driver) -> int | None:
    """When a driver next has something to report.

    Raises:
        TypeError, ValueError: what it returns is not a time.
    """
    due = driver.due()
    given: Any = due
    if given is not None and not isinstance(given, Real):
        raise TypeError(f"due returns {type(given).__name__}, not a time")
    if given is not None and isnan(given):
        raise ValueError("due returns NaN, not a time")
    return due


def speaks(goal: Begin) -> str:
    """The text that a goal has to say, stripped of surrounding spaces; empty for other goals."""
    return (goal.command.text or "").strip() if goal.kind == SAY else ""
