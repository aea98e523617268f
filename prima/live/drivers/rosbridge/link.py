"""A connection with a rosbridge; roslibpy has a thread of its own for it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from functools import partial
from typing import Any, Final
from urllib.parse import urlsplit

from prima.devices.settings import Senses
from prima.live.driver import OpenRequests, Refused, Unreachable, Unusable
from prima.live.mapped import OFTEN, SHARE
from prima.live.ros import Outcome, RosDriver, RosUse, Sent
from prima.live.threads import call_in, settle
from prima.messages import Json

INSTALL: Final = "the library roslibpy is not there ({}). Write: pip install 'prima[rosbridge]'."
LAUNCH: Final = (
    "Start the bridge: ros2 launch rosbridge_server rosbridge_websocket_launch.xml"
    " send_action_goals_in_new_thread:=true."
)
BLOCKED: Final = (
    "the bridge does not answer while a goal goes on, so nothing can be cancelled either;"
    " start it with send_action_goals_in_new_thread:=true"
)
LOOK_S: Final = 0.2
"""How often to check whether a server has appeared."""
THROTTLE_MS: Final = 100
"""The minimum interval between values of a sensor."""
LISTS: Final = {
    "action": ("/rosapi/action_servers", "action_servers"),
    "service": ("/rosapi/services", "services"),
}
"""The services that list what is available, and the fields of their answers."""


class RosbridgeLink:
    """One connection until it is lost.

    Args:
        url: the bridge's.
        longest: how long (s) connecting and finding all interfaces may take.
        heartbeat: how long (s) the bridge may take to answer whether it is there.
    """

    def __init__(self, url: str, longest: float, heartbeat: float) -> None:
        self._url = url
        self._longest = longest
        self._heartbeat = heartbeat
        self._loop = asyncio.get_running_loop()
        self._pending = OpenRequests()
        self._goals: dict[str, Any] = {}
        """The clients of actions with running goals, by the goals' names."""
        self._uses: list[RosUse] = []
        self._topics: dict[RosUse, Any] = {}
        self._ros: Any = None

    # Connecting -----------------------------------------------------------------------------

    async def connect(self, uses: list[RosUse], driver: RosDriver) -> None:
        """Connect, subscribe, and wait until all servers are available."""
        until = self._loop.time() + self._longest * SHARE
        try:
            import roslibpy
        except ImportError as error:
            raise Unusable(INSTALL.format(error)) from None
        logging.getLogger("roslibpy").setLevel(logging.CRITICAL)  # we report what matters
        self._uses = uses
        await self._knock(until)
        self._ros = await asyncio.to_thread(self._join, until)
        # roslibpy calls this in its own thread.
        self._ros.on("close", lambda *_: call_in(self._loop, self._lose, driver))
        for use in uses:
            if use.kind == "topic":
                self._topics[use] = topic = roslibpy.Topic(self._ros, use.name, use.type)
                topic.advertise()
        for senses in driver.settings.senses:
            self._subscribe(senses, driver)
        await self._await_all(until)

    async def _knock(self, until: float) -> None:
        """Check that something listens at the address: roslibpy does not report it."""
        parts = urlsplit(self._url)
        try:
            async with asyncio.timeout_at(until):
                _, writer = await asyncio.open_connection(parts.hostname, parts.port)
        except (OSError, TimeoutError) as error:
            why = f" ({error.strerror or error})" if isinstance(error, OSError) else ""
            raise Unreachable(f"nobody answers at {self._url}{why}. {LAUNCH}") from None
        writer.close()

    def _join(self, until: float) -> Any:
        from roslibpy import Ros
        from roslibpy.comm import select_factory
        from roslibpy.core import RosTimeoutError

        select_factory(None).set_max_retries(0)  # the run connects again by itself
        ros = Ros(self._url)  # takes a second the first time
        try:
            ros.run(timeout=max(until - self._loop.time(), 0.1))
        except RosTimeoutError:
            raise Unreachable(f"{self._url} does not answer as a rosbridge. {LAUNCH}") from None
        return ros

    def _lose(self, driver: RosDriver) -> None:
        reason = "the connection with the bridge is lost"
        self.fail(reason)
        if driver.has(self):
            driver.lose(reason)

    def _subscribe(self, senses: Senses, driver: RosDriver) -> None:
        from roslibpy import Topic

        rate = THROTTLE_MS if senses.what in OFTEN else 0
        topic = Topic(self._ros, senses.by, senses.type, throttle_rate=rate)
        topic.subscribe(lambda message: driver.sense_from_thread(senses, dict(message)))

    async def _await_all(self, until: float) -> None:
        missing: list[RosUse] = []
        try:
            async with asyncio.timeout_at(until):
                while missing := await self._missing():
                    await asyncio.sleep(LOOK_S)
        except (TimeoutError, Refused):
            if missing:
                raise Unreachable(f"{_not_there(missing)}.") from None
            reason = "does not tell what is there: the node rosapi is needed beside it"
            raise Unreachable(f"{self._url} {reason}. {LAUNCH}") from None

    async def _missing(self) -> list[RosUse]:
        """The actions and services that are not available."""
        there: dict[str, set[str]] = {}
        for kind, (name, part) in LISTS.items():
            answer = await self.call(RosUse("service", name, ""), {})
            there[kind] = set(answer.get(part, []))
        return [use for use in self._uses if use.kind in there and use.name not in there[use.kind]]

    # Using it -------------------------------------------------------------------------------

    async def send_goal(self, use: RosUse, values: dict[str, Json], on: Callable[[], None]) -> Sent:
        """Send a goal to an action. The protocol does not report whether it was accepted."""
        from roslibpy import ActionClient, Goal

        client = ActionClient(self._ros, use.name, use.type)
        end = self._pending.add_one()
        over = partial(self._from_thread, end)
        key = client.send_goal(Goal(values), over, lambda *_: call_in(self._loop, on), over)
        self._goals[key] = client
        end.add_done_callback(lambda one: self._goals.pop(key, None))
        return Sent(end, partial(client.cancel_goal, key))

    def _from_thread(self, end: asyncio.Future[Outcome], answer: Any) -> None:
        status = getattr(answer["status"], "value", answer["status"])
        values = answer["values"]
        result = dict(values) if isinstance(values, dict) else {"message": str(values)}
        call_in(self._loop, settle, end, Outcome(status, result))

    async def call(self, use: RosUse, values: dict[str, Json]) -> dict[str, Json]:
        """Call a service; returns its answer."""
        from roslibpy import Service, ServiceRequest

        future = self._pending.add_one()

        def answer(values: Any) -> None:
            call_in(self._loop, settle, future, dict(values))

        def refuse(reason: Any) -> None:
            call_in(self._loop, settle, future, Refused(str(reason)))

        Service(self._ros, use.name, use.type).call(ServiceRequest(values), answer, refuse)
        return dict(await future)

    def publish(self, use: RosUse, values: dict[str, Json]) -> None:
        """Publish a message."""
        from roslibpy import Message

        if self._ros.is_connected:
            self._topics[use].publish(Message(values))

    async def ping(self) -> None:
        """Ask what is available."""
        try:
            async with asyncio.timeout(self._heartbeat * SHARE):
                missing = await self._missing()
        except TimeoutError:
            reason = BLOCKED if self._goals else "the bridge does not answer any more"
            raise Unreachable(reason) from None
        except Refused as error:
            raise Unreachable(str(error)) from None
        if missing:
            raise Unreachable(_not_there(missing))

    def cancel_all(self) -> None:
        """Ask to cancel the goals that were sent by this connection; others cannot be named."""
        for key, client in list(self._goals.items()):
            client.cancel_goal(key)

    def fail(self, reason: str) -> None:
        """Give up requests that have not been answered."""
        self._pending.fail(reason)

    async def close(self) -> None:
        """End the connection."""
        ros, self._ros = self._ros, None
        if ros is not None and ros.is_connected:
            await asyncio.to_thread(ros.close)


def _not_there(missing: list[RosUse]) -> str:
    names = ", ".join(str(use) for use in missing)
    return f"{names} {'are' if len(missing) > 1 else 'is'} not there"
