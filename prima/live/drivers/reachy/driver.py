"""How Reachy Mini carries out Commands: as moves of its daemon, one after the other."""

from __future__ import annotations

import asyncio
import math
from importlib.util import find_spec
from typing import Any, ClassVar

from prima.devices.goals import At, Begin
from prima.devices.profile import Profile
from prima.devices.settings import Does, DriverSettings
from prima.devices.settings import Pose as Place
from prima.errors import UsageError
from prima.live.driver import Refused, TaskDriver, Unreachable, Unusable
from prima.live.drivers.reachy.link import ReachyLink, read_address
from prima.live.drivers.reachy.pose import LIMITS, NEAR, HeadPose, read_pose, read_step, wrapped
from prima.live.drivers.reachy.ways import WAYS, Step, number
from prima.live.reports import SenseReports
from prima.messages import Data
from prima.sim.map import Map

NEEDS = ("httpx", "websockets")
INSTALL = "pip install 'prima[reachy]'"
QUICKEST_S = 0.2
"""The minimum duration of a movement."""
SETTLE_S = 1.0
"""How long parts may take to come to rest after a move."""
SENSE_S = 0.2
"""How often the daemon is asked for its sensor values."""
STATES = ("/api/state/", "/api/media/tracking/")
"""The prefixes of addresses at which the daemon reports its state."""
SAFE_S = 2.0
"""How long it may take to stop everything."""
GOTO = "goto"
"""The value of ``by`` if the document itself specifies the steps of a movement."""


class ReachyDriver(TaskDriver):
    """Turns the body, moves the head, and makes gestures with head and antennas.

    The daemon plays one move at a time, so a goal that begins while a move plays starts
    after it.
    """

    kind: ClassVar[str] = "reachy"
    mapped: ClassVar[bool] = True
    own: ClassVar[frozenset[str]] = frozenset(
        {"turn", "move-head", "point-by-hand", "stop-moving", "set-speed-and-time"}
    )

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        super().__init__(settings, profile, site)
        self._link: ReachyLink | None = None
        self._sent: HeadPose | None = None
        """Where all parts were last sent; None if that was not reached."""
        self._sensing: asyncio.Task[None] | None = None
        self._address = address_of(settings)
        self._stands = stands(settings, site)
        check_ways(settings)

    async def open(self) -> None:
        """Connect to the daemon, and wake the robot up if its motors are off.

        Raises:
            Unreachable: it does not answer, or a library is missing.
        """
        missing = [name for name in NEEDS if find_spec(name) is None]
        if missing:
            raise Unusable(f"The library {missing[0]} is missing: {INSTALL}")
        await self._leave()
        self._sent = None
        self._link = ReachyLink(self._address, self.lose)
        try:
            await self._wake(self._link)
            if self.settings.senses:
                reports = SenseReports()
                await self._sense(self._link, reports)
                self._sensing = asyncio.create_task(self._sense_on(self._link, reports))
        except BaseException:
            await self._leave()
            raise

    async def _sense(self, link: ReachyLink, reports: SenseReports) -> None:
        """Ask the daemon for its sensor values, and report changes.

        Raises:
            Unusable: the daemon has no such value.
        """
        answers: dict[str, Any] = {}
        for senses in self.settings.senses:
            try:
                if senses.by not in answers:
                    answers[senses.by] = await link.ask("GET", senses.by)
            except Refused as error:
                raise Unusable(f'<senses by="{senses.by}">: {error}') from None
            if answers[senses.by] is not None:  # it has no such sensor, or no value yet
                reports.take(senses, answers[senses.by])
        for news in reports.drain():
            self.tell(news)

    async def _sense_on(self, link: ReachyLink, reports: SenseReports) -> None:
        """Ask repeatedly as long as the daemon answers."""
        while True:
            await asyncio.sleep(SENSE_S)
            try:
                await self._sense(link, reports)
            except (Unreachable, Unusable) as error:
                self.lose(str(error))
                return

    async def _wake(self, link: ReachyLink) -> None:
        await link.connect()
        try:
            motors = await link.ask("GET", "/api/motors/status")
            if motors["mode"] != "enabled":
                await link.ask("POST", "/api/motors/set_mode/enabled")
                async with link.playing:
                    await link.play("play/wake_up")
            self._tell_direction(await self._look(link))
        except (Refused, KeyError, TypeError) as error:
            raise Unreachable(f"Reachy Mini does not wake up: {error}") from error

    async def perform(self, goal: Begin) -> Data:
        """Make the movements of a Command, one after the other.

        Raises:
            Refused: Reachy Mini cannot do it, or has not done it.
            Unreachable: the daemon is gone.
        """
        link = self._link
        if link is None:
            raise Unreachable("Reachy Mini is not connected.")
        if goal.kind == "stop-moving":
            return {}  # earlier movements of the body have been cancelled
        does = self.does(goal)
        async with link.playing:
            sent, self._sent = self._sent, None  # unless the end is reached
            if does is not None and does.by != GOTO:
                await link.play(f"play/recorded-move-dataset/{does.by}")
            else:
                self._sent = await self._make(link, goal, does, sent)
        return {}

    async def _make(
        self, link: ReachyLink, goal: Begin, does: Does | None, sent: HeadPose | None
    ) -> HeadPose:
        """Make movements, from where the parts were sent if they are there: motors sag a little."""
        now = await self._look(link)
        at = sent if sent is not None and now.near(sent) else now
        changed: set[str] = set()
        for step in self._steps(goal, does, at):
            to = at.moved(step)
            changed |= {"body" if name == "turn" else name for name in step} & LIMITS.keys()
            await link.play("goto", to.goto(step.get("time") or self._lasts(at, to)))
            self.report(goal)
            at = to
        await self._settle(link, at, changed)
        self._tell_direction(at)
        return at

    def _steps(self, goal: Begin, does: Does | None, at: HeadPose) -> list[Step]:
        """The movements that make up a Command."""
        direction = self._direction(goal)
        if does is None:
            if goal.kind not in WAYS:
                raise Refused(f"The robot's document does not say how it does {goal.kind}.")
            return WAYS[goal.kind](goal, at, direction)
        values = self.values(goal)
        if direction is not None:
            values["heading"] = direction
        return [read_step(name, one) for name, one in does.filled(values).items()]

    def _direction(self, goal: Begin) -> float | None:
        """The direction of a goal (degrees to the left of the body's 0), if it has one."""
        args = goal.command.args
        if "heading" in args:
            return wrapped(number(goal, "heading") - self._stands.heading)
        if "toward" not in args:
            return None
        place, here = self.place(goal), self._stands
        if place is None:
            name = args["toward"]
            raise Refused(f'Where is "{name}"? Write <place name="{name}" x="..." y="..."/>.')
        if (place.x, place.y) == (here.x, here.y):
            raise Refused(f'The robot stands at "{args["toward"]}" itself.')
        angle = math.degrees(math.atan2(place.y - here.y, place.x - here.x))
        return wrapped(angle - here.heading)

    async def _look(self, link: ReachyLink) -> HeadPose:
        return read_pose(await link.ask("GET", "/api/state/full"))

    def _tell_direction(self, at: HeadPose) -> None:
        """Report where the robot looks, if its document says where it stands."""
        here = self._stands
        if "at" in self.settings.options:
            self.tell(At(here.x, here.y, wrapped(here.heading + at.body)))

    async def _settle(self, link: ReachyLink, to: HeadPose, changed: set[str]) -> None:
        """Wait for parts to be where they were sent: the daemon reports any move as completed."""
        end = asyncio.get_running_loop().time() + SETTLE_S
        while True:
            now = await self._look(link)
            far = {name: much for name, much in now.off(to).items() if name in changed}
            part = max(far, key=far.__getitem__, default="")
            if not part or far[part] <= NEAR:
                return
            if asyncio.get_running_loop().time() > end:
                reached, sent = getattr(now, part), getattr(to, part)
                raise Refused(
                    f"Reachy Mini's {part} is at {reached:.0f} instead of {sent:.0f}: it does not go"
                    " there as the other parts are, something holds or moves it, or its motors are"
                    " off.",
                    LIMITS[part][1],
                )
            await asyncio.sleep(0.05)

    def _lasts(self, at: HeadPose, to: HeadPose) -> float:
        """How long (s) a movement takes at the speeds of the robot's document."""
        far = at.off(to)
        turning, moving = far.pop("body"), max(far.values())
        speeds = self.profile.turn_speed, self.profile.head_speed
        return max(turning / speeds[0], moving / speeds[1], QUICKEST_S)

    async def safe(self) -> None:
        """Stop every move; the motors keep their force, or the head would fall."""
        try:
            async with asyncio.timeout(SAFE_S):
                await self.end_goals()
                if self._link is not None:
                    await self._link.stop_all()
        except (Unreachable, Refused, TimeoutError):
            pass  # there is nothing to stop

    async def ping(self) -> None:
        """Ask the daemon whether its robot runs.

        Raises:
            Unreachable: it does not.
        """
        if self._link is None:
            raise Unreachable("Reachy Mini is not connected.")
        await self._link.check()

    async def close(self) -> None:
        """End what runs, and the connection; the robot stays as it is."""
        await super().close()
        await self._leave()

    async def _leave(self) -> None:
        sensing, self._sensing = self._sensing, None
        if sensing is not None and sensing is not asyncio.current_task():
            sensing.cancel()
        link, self._link = self._link, None
        if link is not None:
            await link.close()


def address_of(settings: DriverSettings) -> str:
    """The daemon's address.

    Raises:
        UsageError: the address is invalid.
    """
    try:
        return read_address(settings.address)
    except ValueError as error:
        raise UsageError(f"{settings.place}: {error}") from None


def stands(settings: DriverSettings, site: Map) -> Place:
    """Where the robot stands: at the place that the option ``at`` names, or at the map's origin.

    Raises:
        UsageError: there is no such place, or no such option.
    """
    settings.check_options("at")
    name = settings.options.get("at")
    if name is None:
        return Place(0.0, 0.0, 0.0)
    if name in settings.places:
        return settings.places[name]
    point = site.point(name)
    if point is None:
        raise UsageError(f'{settings.place}: There is no place "{name}", where the robot stands.')
    return Place(*point, site.headings.get(name, 0.0))


def check_ways(settings: DriverSettings) -> None:
    """Look at how Commands and gestures are carried out, and at what is to be sensed.

    Raises:
        UsageError: that cannot be done.
    """
    for senses in settings.senses:
        message = ""
        if not senses.by.startswith(STATES):
            message = f'by="{senses.by}" is not an address of the daemon: write "/api/state/doa".'
        elif senses.what == "event" and not senses.when:
            message = 'An event needs when="...": the daemon is asked again and again.'
        elif senses.what == "heard":
            message = "The daemon does not tell what users say; another driver does."
        if message:
            raise UsageError(f"{senses.place}: {message}")
    for does in settings.does:
        try:
            _check_way(does)
        except Refused as error:
            raise UsageError(f"{does.place}: {error}") from None


def _check_way(does: Does) -> None:
    if does.by == GOTO:
        for name, step in does.filled({}).items():
            HeadPose().moved(read_step(name, step))
    elif "/" not in does.by.strip("/"):
        raise Refused(f'by="{does.by}" is neither "{GOTO}" nor a recorded move, DATASET/MOVE.')
