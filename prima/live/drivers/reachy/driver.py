"""What Reachy Mini does for each Command: moves of its daemon, one after the other."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from importlib.util import find_spec
from typing import ClassVar

from prima.devices.goals import Begin
from prima.devices.settings import Does
from prima.errors import UsageError
from prima.live.driver import Refused, TaskDriver, Unreachable
from prima.live.drivers.reachy.link import Link
from prima.live.drivers.reachy.pose import LIMITS, NEAR, Pose, read_pose, read_step
from prima.messages import Data, Json

NEEDS = ("httpx", "websockets")
INSTALL = "pip install 'prima[reachy]'"
QUICKEST_S = 0.2
"""How long a movement takes at least."""
SETTLE_S = 1.0
"""How long parts may take to come to rest after a move."""
SAFE_S = 2.0

Step = dict[str, float]


class ReachyDriver(TaskDriver):
    """Turns the body, moves the head, and makes gestures with head and antennas.

    The daemon plays one move at a time, so that what begins while another one plays begins
    after it.
    """

    kind: ClassVar[str] = "reachy"
    own: ClassVar[frozenset[str]] = frozenset(
        {"turn", "move-head", "stop-moving", "set-speed-and-time"}
    )

    _link: Link | None = None
    _sent: Pose | None = None
    """Where all parts were sent last; None where that was not reached."""

    async def open(self) -> None:
        """Connect to the daemon, and wake the robot up if its motors are off.

        Raises:
            Unreachable: it is not there, or not in time, or a library is missing.
            UsageError: the robot's document has an address, a step or an option that is none.
        """
        self._check_document()
        missing = [name for name in NEEDS if find_spec(name) is None]
        if missing:
            raise Unreachable(f"The driver reachy needs the library {missing[0]}: {INSTALL}")
        await self._leave()
        link = Link(self.settings.address, self._gone)
        try:
            async with asyncio.timeout(self.settings.open / 1000):
                await self._connect(link)
        except TimeoutError:
            await link.close()
            raise Unreachable(
                f"Reachy Mini at {link.address} is not ready within"
                f" {self.settings.open / 1000:g} s."
            ) from None
        except BaseException:
            await link.close()
            raise
        self._link, self._sent = link, None

    async def _connect(self, link: Link) -> None:
        await link.connect()
        try:
            motors = await link.ask("GET", "/api/motors/status")
            if motors["mode"] != "enabled":
                await link.ask("POST", "/api/motors/set_mode/enabled")
                async with link.playing:
                    await link.play("play/wake_up")
        except (Refused, KeyError, TypeError) as error:
            raise Unreachable(f"Reachy Mini does not wake up: {error}") from error

    def _check_document(self) -> None:
        for name in self.settings.options:
            message = f'The driver reachy has no option "{name}"; remove it.'
            raise UsageError(f"{self.settings.place}: {message}")
        for does in self.settings.does:
            try:
                _check_way(does)
            except Refused as error:
                raise UsageError(f"{does.place}: {error}") from None

    def _gone(self, reason: str) -> None:
        self.lose(reason)

    async def perform(self, goal: Begin) -> Data:
        """Make the movements of a Command, one after the other.

        Raises:
            Refused: Reachy Mini cannot do it, or has not done it.
            Unreachable: the daemon is gone.
        """
        if self._link is None:
            raise Unreachable("Reachy Mini is not connected.")
        does = self.does(goal)
        recorded = does.by if does is not None and does.by != GOTO else ""
        steps = [] if recorded else self._steps(goal, does)
        if not recorded and not steps:
            return {}
        async with self._link.playing:
            sent, self._sent = self._sent, None  # unless the end is reached
            if recorded:
                await self._link.play(f"play/recorded-move-dataset/{recorded}")
            else:
                self._sent = await self._make(self._link, goal, steps, sent)
        return {}

    def values(self, goal: Begin) -> dict[str, Json]:
        """What a goal gives; for what it is toward, the direction from the origin, where the robot is."""
        values, place = super().values(goal), self.place(goal)
        if place is not None and "toward" in goal.command.args and (place.x or place.y):
            values["heading"] = math.degrees(math.atan2(place.y, place.x))
        return values

    def _steps(self, goal: Begin, does: Does | None) -> list[Step]:
        """The movements that a Command is made of."""
        if does is None:
            if goal.kind not in WAYS:
                raise Refused(
                    f"The robot's document does not say how Reachy Mini does {_called(goal)}."
                )
            return WAYS[goal.kind](goal)
        steps = [read_step(name, one) for name, one in does.filled(self.values(goal)).items()]
        if not steps:
            raise Refused(
                f"The robot's document does not say where {_called(goal)} leads: is its <place> missing?"
            )
        return steps

    async def _make(self, link: Link, goal: Begin, steps: list[Step], sent: Pose | None) -> Pose:
        """Make movements, from where the parts were sent if they are there: motors sag a little."""
        now = read_pose(await link.ask("GET", "/api/state/full"))
        at = sent if sent is not None and now.near(sent) else now
        changed: set[str] = set()
        for step in steps:
            to = at.moved(step)
            changed |= {"body" if name == "turn" else name for name in step} & LIMITS.keys()
            await link.play("goto", to.goto(step.get("time") or self._lasts(at, to)))
            self.report(goal)
            at = to
        await self._settle(link, at, changed)
        return at

    async def _settle(self, link: Link, to: Pose, changed: set[str]) -> None:
        """Wait for parts to be where they were sent: the daemon calls any move completed."""
        end = asyncio.get_running_loop().time() + SETTLE_S
        while True:
            now = read_pose(await link.ask("GET", "/api/state/full"))
            far = {name: much for name, much in now.off(to).items() if name in changed}
            part = max(far, key=far.__getitem__, default="")
            if not part or far[part] <= NEAR:
                return
            if asyncio.get_running_loop().time() > end:
                reached, sent = getattr(now, part), getattr(to, part)
                raise Refused(
                    f"Reachy Mini's {part} is at {reached:.0f} instead of {sent:.0f}: something"
                    " holds it, something else moves it, or its motors are off.",
                    LIMITS[part][1],
                )
            await asyncio.sleep(0.05)

    def _lasts(self, at: Pose, to: Pose) -> float:
        """How long (s) a movement takes at the speeds of the robot's document."""
        far = at.off(to)
        turning, moving = far.pop("body"), max(far.values())
        speeds = self.profile.turn_speed, self.profile.head_speed
        return max(turning / speeds[0], moving / speeds[1], QUICKEST_S)

    async def safe(self) -> None:
        """Stop every move; the motors keep their force, or the head would fall."""
        tasks = list(self._tasks.values())
        for task in tasks:
            task.cancel()
        try:
            async with asyncio.timeout(SAFE_S):
                await asyncio.gather(*tasks, return_exceptions=True)
                if self._link is not None:
                    await self._link.stop_all()
        except (Unreachable, Refused, TimeoutError):
            pass  # nobody is there to be stopped

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
        link, self._link = self._link, None
        if link is not None:
            await link.close()


GOTO = "goto"


def _check_way(does: Does) -> None:
    """Complain of a way to do something that is none."""
    if does.by == GOTO:
        for name, step in does.filled({}).items():
            read_step(name, step)
    elif "/" not in does.by.strip("/"):
        message = f'by="{does.by}" is neither "{GOTO}" nor a recorded move: DATASET/MOVE.'
        raise Refused(message)


def _called(goal: Begin) -> str:
    name = goal.command.args.get("name")
    return f'{goal.kind} "{name}"' if goal.kind == "gesture" and name else goal.kind


def _number(goal: Begin, name: str) -> float:
    value = goal.command.args.get(name)
    return float(value) if isinstance(value, int | float) else 0.0


def _head(goal: Begin) -> list[Step]:
    return [{"pan": _number(goal, "pan"), "tilt": _number(goal, "tilt")}]


def _turn(goal: Begin) -> list[Step]:
    return [{"turn": _number(goal, "angle")}]


def _drive(goal: Begin) -> list[Step]:
    if _number(goal, "speed"):
        raise Refused("Reachy Mini has no wheels; it only turns.", "locomotion")
    seconds = _number(goal, "time") / 1000
    return [{"turn": _number(goal, "turn-speed") * seconds, "time": seconds}]


def _stand(_: Begin) -> list[Step]:
    return []


WAYS: dict[str, Callable[[Begin], list[Step]]] = {
    "move-head": _head,
    "turn": _turn,
    "set-speed-and-time": _drive,
    "stop-moving": _stand,
}
"""What each Command is that the robot's document need not explain."""
