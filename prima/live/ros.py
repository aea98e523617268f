"""The common part of drivers for ROS robots: actions, services and topics, over any link."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from contextlib import nullcontext, suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, Final, Protocol

from prima.devices.goals import SAY, Begin
from prima.devices.settings import Does, DriverSettings
from prima.errors import UsageError
from prima.live.driver import Refused, Unreachable
from prima.live.mapped import MappedDriver
from prima.messages import Data, Json

KINDS: Final = {"action": "action", "srv": "service", "msg": "topic"}
"""The kinds of interfaces, by the middle part of their types."""
PERIOD_S: Final = 0.1
"""How often a message that moves the body is published."""
SUCCEEDED, CANCELED = 4, 5
"""States of a goal, of ``action_msgs/msg/GoalStatus``."""
AGAIN_S: Final = 0.5
"""The delay before a cancel is repeated: a bridge forgets one that comes early."""
REASONS: Final = ("error_msg", "error_string", "message", "reason")
"""The fields of results that say why they failed."""


@dataclass(frozen=True, slots=True)
class RosUse:
    """An action, service or topic that Commands are mapped to."""

    kind: str
    name: str
    type: str

    def __str__(self) -> str:
        return f"the {self.kind} {self.name}" + (f" ({self.type})" if self.type else "")


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an action's goal has ended."""

    status: int
    result: dict[str, Json]


@dataclass(slots=True)
class Sent:
    """A goal that an action server has accepted."""

    end: asyncio.Future[Outcome]
    cancel: Callable[[], None]
    """Ask the server to cancel it."""


class RosLink(Protocol):
    """A connection with ROS. If it fails, requests without an answer raise Unreachable."""

    async def connect(self, uses: list[RosUse], driver: RosDriver) -> None:
        """Connect, subscribe to what is sensed, and check that everything is available."""

    async def send_goal(self, use: RosUse, values: dict[str, Json], on: Callable[[], None]) -> Sent:
        """Send a goal to an action; returns it once it has been accepted."""

    async def call(self, use: RosUse, values: dict[str, Json]) -> dict[str, Json]:
        """Call a service; returns its answer."""

    def publish(self, use: RosUse, values: dict[str, Json]) -> None:
        """Publish a message."""

    async def ping(self) -> None:
        """Check that everything is still available."""

    def cancel_all(self) -> None:
        """Ask all actions to cancel all goals."""

    def fail(self, reason: str) -> None:
        """Give up what has not been answered."""

    async def close(self) -> None:
        """End the connection."""


def use_of(does: Does, kind: str) -> RosUse:
    """The interface that a ``does`` uses.

    Raises:
        UsageError: it does not say what that is.
    """
    by_type = _kind(does.type)
    use = RosUse(does.kind or by_type, does.by, does.type)
    if use.name and by_type and use.kind == by_type:
        return use
    message = "A <does> of a ROS robot needs by and type."
    if use.name and use.type:
        message = f'"{use.type}" is not a type of {use.kind or "interface"}s.'
    remedy = 'Write for example by="/spin" type="nav2_msgs/action/Spin".'
    raise UsageError(f"{does.place}: {kind}: {message} {remedy}")


def _kind(type_: str) -> str:
    """The kind of interface that a type is for; empty if it is not a type."""
    parts = type_.split("/")
    return KINDS.get(parts[1], "") if len(parts) == 3 and all(parts) else ""


def uses(settings: DriverSettings) -> list[RosUse]:
    """The interfaces that a robot's document uses, once each.

    Raises:
        UsageError: it does not say what that is, or has options.
    """
    settings.check_options()
    for senses in settings.senses:
        if _kind(senses.type) != "topic":
            message = f'<senses by="{senses.by}"> needs the type of the topic.'
            remedy = 'Write for example type="std_msgs/msg/Bool".'
            raise UsageError(f"{senses.place}: {settings.kind}: {message} {remedy}")
    made = {use_of(does, settings.kind): None for does in settings.does}
    stops = {RosUse("service", does.stop, ""): None for does in settings.does if does.stop}
    return list(made | stops)


class RosDriver(MappedDriver):
    """A robot with ROS 2."""

    confirms = True
    _link: RosLink | None = None

    def make_link(self) -> RosLink:
        """A new connection, not yet opened."""
        raise NotImplementedError

    @property
    def link(self) -> RosLink:
        """The connection.

        Raises:
            Unreachable: there is none.
        """
        if self._link is None or self.gone:
            raise Unreachable("there is no connection")
        return self._link

    async def open(self) -> None:
        """Connect, and wait until everything that the document maps to is available."""
        await self.leave()
        link = self.make_link()
        try:
            await link.connect(uses(self.settings), self)
        except BaseException:
            await link.close()
            raise
        self._link, self.gone = link, False

    def has(self, link: RosLink) -> bool:
        """Whether this is the connection that is used."""
        return self._link is link

    async def leave(self) -> None:
        """End the connection, if there is one."""
        link, self._link, self.gone = self._link, None, True
        if link is not None:
            link.fail("the connection was closed")
            await link.close()

    async def ping(self) -> None:
        """Check that all servers are available."""
        await self.link.ping()

    def lose(self, reason: str) -> None:
        """Give up what has not been answered."""
        super().lose(reason)
        if self._link is not None:
            self._link.fail(reason)

    async def safe(self) -> None:
        """Cancel all goals, including others'; publish a zero velocity; call what stops the robot.

        It is tried even over a link that seems to be lost: perhaps only answers are.
        """
        if (link := self._link) is None:
            return
        stops = sorted({does.stop for does in self.settings.does if does.stop})
        with suppress(Exception) if self.gone else nullcontext():
            link.cancel_all()
            self._halt(link)
            await self.end_all([link.call(RosUse("service", name, ""), {}) for name in stops])

    def stand(self) -> None:
        """Publish a zero velocity, and do what ``stop-moving`` does."""
        if self._link is not None and not self.gone:
            self._halt(self._link)

    def _halt(self, link: RosLink) -> None:
        """Publish a zero velocity."""
        for does in self.settings.does:
            if self._moves(does):
                link.publish(use_of(does, self.kind), {})

    def _moves(self, does: Does) -> bool:
        """Whether a message moves the body, so that one without values stops it."""
        row = self.profile.commands.get(does.command)
        devices = row.devices if row is not None else frozenset()
        return "locomotion" in devices and use_of(does, self.kind).kind == "topic"

    # Goals ----------------------------------------------------------------------------------

    async def perform(self, goal: Begin) -> Data:
        """Carry out a goal by the action, service or topic that it is mapped to."""
        does = await self.way(goal)
        use = use_of(does, self.kind)
        values = does.filled(self.values(goal))
        if use.kind == "action":
            await self._act(goal, use, values)
        elif use.kind == "service":
            await self._ask(goal, does, use, values)
        else:
            await self._publish(goal, does, use, values)
        return {}

    async def _act(self, goal: Begin, use: RosUse, values: dict[str, Json]) -> None:
        on = partial(self.report, goal)
        sending = asyncio.ensure_future(self.link.send_goal(use, values, on))
        try:
            sent = await asyncio.shield(sending)
            self.accept(goal)
            outcome = await asyncio.shield(sent.end)
        except asyncio.CancelledError:
            await _stop(sending)
            raise
        if outcome.status != SUCCEEDED:
            raise Refused(_why(use, outcome))

    async def _ask(self, goal: Begin, does: Does, use: RosUse, values: dict[str, Json]) -> None:
        link = self.link
        calling = asyncio.ensure_future(link.call(use, values))
        self.accept(goal)
        try:
            answer = await asyncio.shield(calling)
        except asyncio.CancelledError:
            await self._call_stop(does)
            await asyncio.wait([calling])
            calling.exception()
            raise
        if answer.get("success") is False:
            raise Refused(_reason(answer) or f"{use} answers that it has failed")

    async def _call_stop(self, does: Does) -> None:
        if does.stop:
            try:
                await self.link.call(RosUse("service", does.stop, ""), {})
            except (Refused, Unreachable):
                pass  # what it should stop continues, and is waited for

    async def _publish(self, goal: Begin, does: Does, use: RosUse, values: dict[str, Json]) -> None:
        link, lasts, moves = self.link, self.lasts(goal), self._moves(does)
        self.accept(goal)
        link.publish(use, values)
        if goal.tick is not None:
            lasts = math.inf
        if lasts is None:
            return
        try:
            await self._go_on(goal, lasts, partial(link.publish, use, values) if moves else None)
        except asyncio.CancelledError:
            if goal.kind == SAY and does.stop:
                await self._call_stop(does)
            elif not moves:
                link.publish(use, {})
            raise
        finally:
            if moves:
                link.publish(use, {})

    async def _go_on(self, goal: Begin, lasts: float, again: Callable[[], Any] | None) -> None:
        """Keep publishing a message for a time (s)."""
        loop = asyncio.get_running_loop()
        until = loop.time() + lasts
        while (left := until - loop.time()) > 0:
            await asyncio.sleep(min(left, PERIOD_S))
            if again is not None and left > PERIOD_S:
                again()
            self.report(goal)


async def _stop(sending: asyncio.Future[Sent]) -> None:
    """Cancel a goal, and wait until the server has ended it; one that was refused is over."""
    try:
        sent = await sending
        while not sent.end.done():
            sent.cancel()
            await asyncio.wait([sent.end], timeout=AGAIN_S)
        await sent.end
    except (Refused, Unreachable):
        pass


def _why(use: RosUse, outcome: Outcome) -> str:
    if outcome.status == CANCELED:
        return f"{use} was cancelled by somebody else"
    return _reason(outcome.result) or f"{use} has given it up"


def _reason(answer: dict[str, Json]) -> str:
    said = (str(answer.get(name) or "") for name in REASONS)
    return next((one for one in said if one), "")
