"""The common part of drivers for robots whose document maps Commands to the robot's interface."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Iterable
from typing import ClassVar, Final

from prima.devices import voice
from prima.devices.goals import LISTEN, SAY, At, Begin
from prima.devices.settings import DEGREES, Does, Senses
from prima.live.driver import Refused, TaskDriver, speaks
from prima.live.reports import SenseReports
from prima.live.threads import call_in
from prima.messages import Json

FLUSH_S: Final = 0.05
"""How long sensor values are collected before the newest is reported."""
SAFE_S: Final = 2.0
"""How long to wait until goals have stopped in an emergency, or at the end."""
SHARE: Final = 0.9
"""The share of the opening time, or of a heartbeat, after which missing answers are reported."""
OFTEN: Final = frozenset({"sensor", "pose", "human"})
"""Kinds of which only the newest value is reported; for others each message counts."""


class MappedDriver(TaskDriver):
    """A driver that carries out Commands by its ``does``, and reports by its ``senses``."""

    mapped: ClassVar[bool] = True
    own: ClassVar[frozenset[str]] = frozenset({LISTEN})

    gone: bool = True
    """Whether there is no connection."""
    _at: At | None = None
    _reports: SenseReports | None = None
    _flush: asyncio.TimerHandle | None = None

    # Goals ----------------------------------------------------------------------------------

    def lasts(self, goal: Begin) -> float | None:
        """How long (s) a goal takes if the robot does not report its end; None if unknown."""
        command, profile = goal.command, self.profile
        if goal.kind == SAY:
            rates = profile.voices
            return voice.duration(speaks(goal), command.lang or "en", rates) / 1000
        if "time" in command.args:
            return float(str(command.args["time"])) / 1000
        turn = self._turn(goal)
        if turn is not None:
            return abs(turn) / profile.turn_speed
        gesture = profile.gestures.get(str(command.args.get("name", "")))
        known = gesture or profile.lasts(goal.kind)
        return known / 1000 if known else None

    def values(self, goal: Begin) -> dict[str, Json]:
        """Add values that robots need: times in seconds, radians, and quaternions."""
        values = super().values(goal)
        if self._at is not None:
            values.setdefault("heading", self._at.heading)
        turn = self._turn(goal)
        if turn is not None:
            heading = self._at.heading if self._at is not None else 0.0
            values |= {"turn": turn, "heading": heading + turn}
            values.setdefault("turn-speed", math.copysign(self.profile.turn_speed, turn))
        if "tilt" in values:  # some robots count downward
            values["down"] = -values["tilt"]
        lasts = self.lasts(goal)
        if lasts is not None:
            values["seconds"] = lasts
        for name in DEGREES:
            if isinstance(values.get(name), int | float):
                values[f"{name}-radians"] = math.radians(values[name])
        half = values.get("heading-radians", 0.0) / 2
        return values | {"heading-z": math.sin(half), "heading-w": math.cos(half)}

    def _turn(self, goal: Begin) -> float | None:
        """The degrees by which a goal turns the body to the left, if it does."""
        if goal.kind not in ("turn", "turn-and-speak", "set-direction"):
            return None
        args, at, place = goal.command.args, self._at, self.place(goal)
        if "angle" in args:
            return float(str(args["angle"]))
        if at is None:
            raise Refused("the robot's place is unknown: no <senses as='pose'> has reported it")
        heading = float(str(args.get("heading", at.heading)))
        if place is not None:
            heading = math.degrees(math.atan2(place.y - at.y, place.x - at.x))
        return (heading - at.heading + 180) % 360 - 180

    async def way(self, goal: Begin) -> Does:
        """How a goal is carried out; without a ``does`` listening just goes on: the ear is open.

        Raises:
            Refused: the robot's document does not say.
        """
        does = self.does(goal)
        if does is not None:
            return does
        if goal.kind == LISTEN:
            self.accept(goal)
            await asyncio.get_running_loop().create_future()
        raise Refused(f'the robot\'s document has no <does command="{goal.kind}">')

    # The connection -------------------------------------------------------------------------

    def lose(self, reason: str) -> None:
        """Report, once, that the connection is lost."""
        if not self.gone:
            self.gone = True
            super().lose(reason)

    async def close(self) -> None:
        """Cancel running goals, and disconnect."""
        await self.end_goals(SAFE_S)
        await self.leave()

    async def leave(self) -> None:
        """End the connection, if there is one."""
        raise NotImplementedError

    async def end_all(self, stops: Iterable[Awaitable[object]]) -> None:
        """Cancel all goals, and wait for them and for calls that stop the robot."""
        async with asyncio.timeout(SAFE_S):
            await asyncio.gather(self.end_goals(SAFE_S), *stops, return_exceptions=True)

    # Senses -----------------------------------------------------------------------------------

    def sense_from_thread(self, senses: Senses, message: Json) -> None:
        """Take a message of the robot, from any thread."""
        call_in(self._loop, self.sense, senses, message)

    def sense(self, senses: Senses, message: Json) -> None:
        """Take a message of the robot. Frequent values are reported at regular times."""
        self._reports = self._reports or SenseReports()
        self._reports.take(senses, message)
        if senses.what not in OFTEN:
            self._tell_sensed()
        elif self._flush is None:
            loop = asyncio.get_running_loop()
            self._flush = loop.call_later(FLUSH_S, self._tell_sensed)

    def _tell_sensed(self) -> None:
        if self._flush is not None:
            self._flush.cancel()
            self._flush = None
        for news in self._reports.drain() if self._reports is not None else ():
            if isinstance(news, At):
                self._at = news
            self.tell(news)
