"""A node of ROS 2 that spins in a thread of its own; all of rclpy is called there."""

from __future__ import annotations

import asyncio
import threading
import time
import uuid
from collections.abc import Callable
from functools import partial
from typing import Any

from prima.devices.settings import Senses
from prima.errors import UsageError
from prima.live.driver import OpenRequests, Refused, Unreachable, Unusable
from prima.live.drivers.ros2.messages import fill, interface, paths, plain
from prima.live.mapped import OFTEN, SHARE
from prima.live.ros import Outcome, RosDriver, RosUse, Sent
from prima.live.threads import call_in, settle
from prima.messages import Json

SETUP = (
    "rclpy is not there ({}). It comes with ROS 2, not by pip: in this shell, first write"
    " `source /opt/ros/DISTRIBUTION/setup.bash`, and run prima with the same version of Python."
)
LOOK_S = 0.05
"""How often to check whether a server has appeared."""
REPORT_S = 0.2
"""The minimum interval at which a goal's feedback is passed on."""
JOIN_S = 2.0
DEPTH = 10
"""The queue size for a topic's messages."""


class RclpyLink:
    """One node, for as long as the robot is there.

    Args:
        domain: the ROS domain.
        longest: how long (s) finding all interfaces may take.
        heartbeat: how long (s) a server may take to answer whether it is there.
    """

    def __init__(self, domain: int, longest: float, heartbeat: float) -> None:
        self._domain = domain
        self._longest = longest
        self._heartbeat = heartbeat
        self._actions: dict[RosUse, Any] = {}
        """The clients of the interfaces used."""
        self._cancels: dict[RosUse, Any] = {}
        """For each action, the service that cancels goals."""
        self._services: dict[RosUse, Any] = {}
        self._topics: dict[RosUse, Any] = {}
        self._untyped: list[RosUse] = []
        """Services whose types the robot has yet to report."""
        self._pending = OpenRequests()
        self._loop = asyncio.get_running_loop()
        self._context: Any = None
        self._executor: Any = None
        self._node: Any = None
        self._thread: threading.Thread | None = None

    # Connecting -----------------------------------------------------------------------------

    async def connect(self, uses: list[RosUse], driver: RosDriver) -> None:
        """Make the node and its clients, and wait until all servers are available."""
        until = self._loop.time() + self._longest * SHARE
        await asyncio.to_thread(self._make_node)
        self._thread = threading.Thread(target=self._spin, name="ros2", daemon=True)
        self._thread.start()
        _check_fields(driver)
        for use in uses:
            await self._run(partial(self._add, use))
        for senses in driver.settings.senses:
            await self._run(partial(self._subscribe, senses, driver))
        while missing := await self._run(self._missing):
            if self._loop.time() > until:
                raise Unreachable(f"{self._not_there(missing)}.")
            await asyncio.sleep(LOOK_S)

    def _make_node(self) -> None:
        try:
            import rclpy
            from rclpy.executors import SingleThreadedExecutor
        except ImportError as error:
            raise Unusable(SETUP.format(error)) from None
        self._context = rclpy.Context()
        rclpy.init(args=[], context=self._context, domain_id=self._domain)
        name = f"prima_{uuid.uuid4().hex[:8]}"
        self._node = rclpy.create_node(name, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)

    def _spin(self) -> None:
        while self._context.ok():
            try:
                self._executor.spin()
            except Exception as error:  # from a callback, or because the context has ended
                if self._context.ok():
                    self._node.get_logger().error(f"prima: {type(error).__name__}: {error}")

    def _not_there(self, missing: list[RosUse]) -> str:
        names = ", ".join(str(use) for use in missing)
        verb = "are" if len(missing) > 1 else "is"
        remedy = "See `ros2 action list -t`, `ros2 service list -t` and `ros2 topic list -t`"
        return f"in the domain {self._domain}, {names} {verb} not there. {remedy}"

    def _missing(self) -> list[RosUse]:
        """The actions, services and topics that are not available yet."""
        self._add_untyped()
        gone = [use for use, one in self._actions.items() if not one.server_is_ready()]
        gone += [use for use, one in self._services.items() if not one.service_is_ready()]
        gone += [use for use, one in self._topics.items() if not one.get_subscription_count()]
        return gone + self._untyped

    def _add_untyped(self) -> None:
        """Add the services whose types the robot has reported by now."""
        if self._untyped:
            known = dict(self._node.get_service_names_and_types())
            found = [use for use in self._untyped if use.name in known]
            self._untyped = [use for use in self._untyped if use.name not in known]
            for use in found:
                client = self._node.create_client(interface(known[use.name][0]), use.name)
                self._services[use] = client

    def _add(self, use: RosUse) -> None:
        from action_msgs.srv import CancelGoal
        from rclpy.action import ActionClient

        node = self._node
        if not use.type:
            self._untyped.append(use)
        elif use.kind == "action":
            self._actions[use] = ActionClient(node, interface(use.type), use.name)
            name = f"{use.name}/_action/cancel_goal"
            self._cancels[use] = node.create_client(CancelGoal, name)
        elif use.kind == "service":
            self._services[use] = node.create_client(interface(use.type), use.name)
        else:
            self._topics[use] = node.create_publisher(interface(use.type), use.name, DEPTH)

    def _subscribe(self, senses: Senses, driver: RosDriver) -> None:
        from rclpy.qos import QoSProfile, ReliabilityPolicy

        often = senses.what in OFTEN
        reliable = ReliabilityPolicy.BEST_EFFORT if often else ReliabilityPolicy.RELIABLE
        quality = QoSProfile(depth=DEPTH, reliability=reliable)

        def take(message: Any) -> None:
            driver.sense_from_thread(senses, plain(message))

        self._node.create_subscription(interface(senses.type), senses.by, take, quality)

    # Using it -------------------------------------------------------------------------------

    async def send_goal(self, use: RosUse, values: dict[str, Json], on: Callable[[], None]) -> Sent:
        """Send a goal to an action; returns it once it has been accepted."""
        client = self._actions[use]
        goal = fill(interface(use.type).Goal(), values)
        feedback = _seldom(partial(self._loop.call_soon_threadsafe, on))
        handle = await self._answer(
            lambda: client.send_goal_async(goal, feedback_callback=feedback)
        )
        if not handle.accepted:
            raise Refused(f"{use} refuses the goal")
        end = asyncio.ensure_future(self._end(handle))
        end.add_done_callback(lambda one: one.cancelled() or one.exception())
        return Sent(end, lambda: self._do(handle.cancel_goal_async))

    async def _end(self, handle: Any) -> Outcome:
        answer = await self._answer(handle.get_result_async)
        return Outcome(answer.status, plain(answer.result))

    async def call(self, use: RosUse, values: dict[str, Json]) -> dict[str, Json]:
        """Call a service; returns its answer."""
        names = {one.name: client for one, client in self._services.items()}
        client = names[use.name]
        request = fill(client.srv_type.Request(), values)
        answer = plain(await self._answer(lambda: client.call_async(request)))
        return answer if isinstance(answer, dict) else {}

    def publish(self, use: RosUse, values: dict[str, Json]) -> None:
        """Publish a message."""
        message = fill(interface(use.type)(), values)
        self._do(partial(self._topics[use].publish, message))

    async def ping(self) -> None:
        """Ask all actions to cancel a goal that does not exist: live servers answer."""
        from action_msgs.srv import CancelGoal

        async def ask(use: RosUse, client: Any) -> None:
            request = CancelGoal.Request()
            request.goal_info.goal_id.uuid = list(uuid.uuid4().bytes)
            try:
                async with asyncio.timeout(self._heartbeat * SHARE):
                    await self._answer(lambda: client.call_async(request))
            except TimeoutError:
                raise Unreachable(f"{use} does not answer any more") from None

        await asyncio.gather(*(ask(*one) for one in self._cancels.items()))
        if missing := await self._run(self._missing):
            raise Unreachable(self._not_there(missing))

    def cancel_all(self) -> None:
        """Ask all actions to cancel all goals."""
        from action_msgs.srv import CancelGoal

        for client in self._cancels.values():
            self._do(partial(client.call_async, CancelGoal.Request()))

    # The thread -----------------------------------------------------------------------------

    def _do(self, function: Callable[[], Any]) -> None:
        """Call something in the node's thread, and do not wait."""
        if self._executor is not None and self._context.ok():
            self._executor.create_task(function)

    def _settle(self, future: asyncio.Future[Any], give: Callable[[], Any]) -> None:
        """Resolve a future with a result or the error of getting it, from any thread."""
        try:
            outcome = give()
        except BaseException as error:
            outcome = error
        call_in(self._loop, settle, future, outcome)

    async def _run(self, function: Callable[[], Any]) -> Any:
        """Call something in the node's thread."""
        future = self._pending.add_one()
        self._do(lambda: self._settle(future, function))
        return await future

    async def _answer(self, ask: Callable[[], Any]) -> Any:
        """Send a request to the robot in the node's thread, and wait for the answer."""
        future = self._pending.add_one()

        def begin() -> None:
            try:
                asked = ask()
            except BaseException as error:
                call_in(self._loop, settle, future, error)
            else:
                asked.add_done_callback(lambda one: self._settle(future, one.result))

        self._do(begin)
        return await future

    def fail(self, reason: str) -> None:
        """Give up requests that have not been answered."""
        self._pending.fail(reason)

    async def close(self) -> None:
        """Remove the node from the network, and end its thread."""
        await asyncio.to_thread(self._end_node)

    def _end_node(self) -> None:
        if self._executor is None:
            return
        self._executor.shutdown(timeout_sec=JOIN_S)
        self._context.try_shutdown()
        if self._thread is not None:
            self._thread.join(JOIN_S)
        self._node.destroy_node()
        self._executor = None


def _seldom(pass_on: Callable[[], object]) -> Callable[[Any], None]:
    """Throttles feedback."""
    last = 0.0

    def take(_: Any) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= REPORT_S:
            last = now
            pass_on()

    return take


def _check_fields(driver: RosDriver) -> None:
    """Check that the messages have the fields that the robot's document sets.

    Raises:
        UsageError: they do not.
        Unreachable: their types are not installed.
    """
    for does in driver.settings.does:
        message = interface(does.type)
        part = {"action": "Goal", "srv": "Request"}.get(does.type.split("/")[1])
        try:
            paths((getattr(message, part) if part else message)(), [one for one, _ in does.values])
        except Refused as error:
            raise UsageError(f"{does.place}: ros2: {error}.") from None
