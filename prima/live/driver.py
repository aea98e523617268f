"""Drivers: what carries goals out on a robot, and tells what its sensors say.

A driver knows no rule of mediation. :class:`Driver` is the plain interface;
:class:`TaskDriver` is what most robots need: one coroutine for each goal.
All methods are called in the event loop of the run; a thread reports with
:meth:`Driver.post`.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from typing import ClassVar

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
from prima.devices.settings import Does, DriverLimits, DriverSettings, Pose
from prima.errors import RunError, UsageError
from prima.grammar.answers import Answers
from prima.live.recordings import Recordings
from prima.live.wellformed import WRONG, well_formed
from prima.messages import Data, Json, Record
from prima.sim.map import Map

Tell = Callable[[Report | News], None]


class Unreachable(RunError):
    """The robot, or the program that drives it, is not there."""


class Unusable(UsageError):
    """The driver is not set up: a library is missing, or its address is none."""


class Refused(Exception):
    """A goal is not reached: the robot refuses it, or has failed at it.

    Args:
        reason: why, for people.
        device: the device that failed; by default the goal's first.
    """

    def __init__(self, reason: str, device: str = "") -> None:
        super().__init__(reason)
        self.device = device


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
    """Whether a Command needs a ``does`` to be carried out."""
    own: ClassVar[frozenset[str]] = frozenset()
    """The Commands (and ``say``, ``listen``) that it carries out without one."""
    progress: ClassVar[DriverLimits] = DriverLimits()
    """How long it takes at most by its own nature, where the document says nothing."""

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        self.settings = settings
        self.profile = profile
        self.site = site
        self.now: Callable[[], int] = lambda: 0
        """The run's time (ms)."""
        self.recordings = Recordings()
        """Where it keeps what it records."""
        self._tell: Tell = lambda _: None
        self._loop: asyncio.AbstractEventLoop | None = None

    # What a driver implements -----------------------------------------------------------

    async def open(self) -> None:
        """Connect to the robot; called again after the connection was lost.

        Raises:
            Unreachable: it is not there; the message says what to do.
            Unusable: it can never be there as the driver is set up.
        """

    def start(self, goal: Begin) -> None:
        """Begin a goal. Reports of it follow, now or later: accepted, then one of its ends."""
        raise NotImplementedError

    def cancel(self, key: str) -> None:
        """End a goal as soon as possible; :class:`Stopped` follows when it has ended."""
        raise NotImplementedError

    def again(self, key: str) -> None:
        """A feedback Command makes another loop: its goal simply goes on."""

    def stand(self) -> None:
        """Stop the wheels where the body rolls on after a Command (rule F5)."""

    def hears(self, takes: Sequence[Answers]) -> None:
        """What the questions and links that listen take from now on; told each time it changes.

        A recogniser makes its grammar of it. Others need not heed it.
        """

    async def safe(self) -> None:
        """Stop everything at once, whatever runs. Called more than once, and after a loss."""

    async def ping(self) -> None:
        """Ask whether the robot is still there, within the heartbeat.

        Raises:
            Unreachable: it is not.
        """

    async def check(self) -> dict[str, str]:
        """Try what only this driver can try before a run, as whether the microphone hears anything.

        Returns:
            what was tried, each with a sentence of what does not work, or nothing.
        """
        return {}

    async def close(self) -> None:
        """Give back the connection; the run is over."""

    def due(self) -> int | None:
        """When it has something to tell by itself (ms of the run): a simulated robot's clock."""
        return None

    def sample(self, now: int) -> None:
        """Tell what has to be known at this instant, as where the robot is. Must not block."""

    def observe(self, now: int, records: list[Record]) -> None:
        """See what the run has made of an instant."""

    # What a driver uses -----------------------------------------------------------------

    def attach(self, tell: Tell, now: Callable[[], int] = lambda: 0) -> None:
        """Connect it with a run and its clock (ms), in whose event loop this is called."""
        self._tell, self.now = tell, now
        self._loop = asyncio.get_running_loop()

    def tell(self, report: Report | News) -> None:
        """Tell the run something, from its event loop; if no record can hold it, the robot is lost."""
        try:
            told = well_formed(report)
        except WRONG as error:
            self.lose(f"what the driver tells is wrong ({type(report).__name__}): {error}")
            return
        if told is not None:
            self._tell(told)

    def post(self, report: Report | News) -> None:
        """Tell the run something, from another thread. After the run's end it is dropped."""
        loop = self._loop
        if loop is not None and not loop.is_closed():
            loop.call_soon_threadsafe(self.tell, report)

    def lose(self, reason: str) -> None:
        """Tell that the connection is gone: what runs fails, and :meth:`open` is called again."""
        self.tell(Lost(self.settings.devices, reason))

    def does(self, goal: Begin) -> Does | None:
        """How a goal is carried out, by the robot's document."""
        gesture = str(goal.command.args.get("name", "")) if goal.kind == "gesture" else ""
        return self.settings.how(goal.kind, gesture)

    def values(self, goal: Begin) -> dict[str, Json]:
        """What a goal gives to be put into arguments: see ``set`` in the robot's document."""
        command = goal.command
        values: dict[str, Json] = {**command.args, "lang": command.lang or "en"}
        if command.text is not None:
            values["text"] = command.text.strip()
        if pose := self.place(goal):
            values |= {"x": pose.x, "y": pose.y, "heading": pose.heading}
        return values

    def place(self, goal: Begin) -> Pose | None:
        """The place that a goal names, on the robot's own map; None if it names none.

        The robot's document says where a place is there; else it is where the site's map has it.
        """
        args = goal.command.args
        name = str(args.get("to", args.get("toward", "")))
        point = self.site.point(name)
        known = Pose(*point, self.site.headings.get(name, 0.0)) if point is not None else None
        return self.settings.places.get(name, known)


class TaskDriver(Driver):
    """A driver that has one coroutine for each goal.

    A goal is done when :meth:`perform` returns, fails when it raises, and has stopped when it
    has ended after being cancelled: stop the robot where :class:`asyncio.CancelledError` arrives.
    """

    confirms: ClassVar[bool] = False
    """Whether :meth:`perform` calls :meth:`accept` itself, when the robot has accepted a goal."""

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        super().__init__(settings, profile, site)
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._said: dict[str, int] = {}
        """How many characters of their texts goals have said, as far as :meth:`perform` tells."""

    async def perform(self, goal: Begin) -> Data:
        """Carry out a goal to its end; gives what the device tells then.

        Raises:
            Refused: the robot does not do it.
            Unreachable: it is not there any more.
        """
        raise NotImplementedError

    def has_said(self, goal: Begin, characters: int) -> None:
        """So much of a goal's text has been said: the run is told when it is cancelled (X2)."""
        self._said[goal.key] = characters

    def accept(self, goal: Begin) -> None:
        """The robot has begun a goal."""
        self.tell(Accepted(goal.key))

    def report(self, goal: Begin) -> None:
        """The robot is on with a goal."""
        self.tell(Progress(goal.key))

    def start(self, goal: Begin) -> None:
        """Begin the coroutine of a goal."""
        task = self._tasks[goal.key] = asyncio.ensure_future(self._run(goal))
        task.add_done_callback(lambda _: self._never_run(goal.key))
        if not self.confirms:
            self.accept(goal)

    def cancel(self, key: str) -> None:
        """Cancel the coroutine of a goal; one that is over has told its end already."""
        if task := self._tasks.get(key):
            task.cancel()

    async def close(self) -> None:
        """Cancel what still runs, and wait for it to end."""
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def _never_run(self, key: str) -> None:
        """Tell the end of a goal that was cancelled before its coroutine had its first turn."""
        if self._tasks.pop(key, None) is not None:
            self.tell(Stopped(key))

    async def _run(self, goal: Begin) -> None:
        try:
            report: Report = Done(goal.key, await self.perform(goal))
        except asyncio.CancelledError:
            report = Stopped(goal.key, said=self._said.get(goal.key))
        except Unreachable as error:
            self.lose(str(error))
            return
        except SystemExit as error:  # a robot's library wants to end the program
            device = min(goal.devices, default="none")
            report = Broke(goal.key, device, f"the driver has failed: SystemExit: {error}")
        except Exception as error:
            device = getattr(error, "device", "") or min(goal.devices, default="none")
            lacks = goal.kind == RECORD and isinstance(error, Refused)
            report = Broke(goal.key, device, str(error) or type(error).__name__, lacks)
        finally:
            self._tasks.pop(goal.key, None)
            self._said.pop(goal.key, None)
        self.tell(report)


def speaks(goal: Begin) -> str:
    """The text that a goal has to say, with spaces at its ends cut off; nothing for others."""
    return (goal.command.text or "").strip() if goal.kind == SAY else ""
