"""A robot with ROS 2 in a process of its own: it says on its standard output what it does.

Its actions are those of test_msgs: ``/go`` goes on for nested_different_pkg.sec seconds and gives
up where x is negative; ``/count`` refuses more than 100.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from typing import Any

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from std_msgs.msg import Bool, Float32, String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci, NestedMessage
from test_msgs.srv import BasicTypes

STEP_S = 0.02


def tell(what: str, **more: object) -> None:
    sys.stdout.write(json.dumps({"what": what, "at": time.monotonic(), **more}) + "\n")
    sys.stdout.flush()


class Robot(Node):
    def __init__(self) -> None:
        super().__init__("robot")
        group = ReentrantCallbackGroup()
        common: dict[str, Any] = {"callback_group": group}
        self.silent = threading.Event()
        self.moves = False
        self.stubborn = False
        ActionServer(
            self,
            NestedMessage,
            "/go",
            self.go,
            goal_callback=lambda goal: GoalResponse.ACCEPT,
            cancel_callback=self.cancel,
            **common,
        )
        ActionServer(
            self,
            Fibonacci,
            "/count",
            self.count,
            goal_callback=lambda goal: (
                GoalResponse.REJECT if goal.order > 100 else GoalResponse.ACCEPT
            ),
            cancel_callback=self.cancel,
            **common,
        )
        self.create_service(BasicTypes, "/say", self.say, **common)
        self.create_service(Trigger, "/be_silent", self.be_silent, **common)
        self.create_subscription(Twist, "/cmd_vel", self.drive, 10, **common)
        self.create_subscription(String, "/tell", self.obey, 10, **common)
        self.odometry = self.create_publisher(Odometry, "/odom", qos_profile_sensor_data)
        self.battery = self.create_publisher(Float32, "/battery", qos_profile_sensor_data)
        self.heard = self.create_publisher(String, "/heard", 10)
        self.touch = self.create_publisher(Bool, "/touch", 10)
        self.stop = self.create_publisher(Bool, "/emergency", 10)
        tell("ready")

    def cancel(self, goal: Any) -> CancelResponse:
        return CancelResponse.REJECT if self.stubborn else CancelResponse.ACCEPT

    def go(self, handle: Any) -> Any:
        goal = handle.request
        x, y = goal.nested_field.float64_value, goal.nested_field.float32_value
        tell("goes", x=x, y=y)
        until = time.monotonic() + goal.nested_different_pkg.sec
        while time.monotonic() < until:
            if handle.is_cancel_requested:
                handle.canceled()
                tell("go canceled", status="CANCELED")
                return NestedMessage.Result()
            handle.publish_feedback(NestedMessage.Feedback())
            time.sleep(STEP_S)
        if x < 0:
            handle.abort()
        else:
            handle.succeed()
        tell("go over")
        return NestedMessage.Result()

    def count(self, handle: Any) -> Any:
        tell("counts", to=handle.request.order)
        handle.succeed()
        return Fibonacci.Result(sequence=[0, 1])

    def say(self, request: Any, response: Any) -> Any:
        self.silent.clear()  # before anyone hears of it: the next request may follow at once
        tell("says", text=request.string_value)
        cut = self.silent.wait(0.05 * len(request.string_value))
        tell("says no more", cut=cut)
        response.bool_value = not cut
        return response

    def be_silent(self, _: Any, response: Any) -> Any:
        self.silent.set()
        response.success = True
        return response

    def drive(self, message: Any) -> None:
        turns = message.angular.z
        if (turns != 0) != self.moves:
            self.moves = turns != 0
            tell("turns" if self.moves else "stands", speed=turns)

    def obey(self, message: Any) -> None:
        word, _, rest = message.data.partition(" ")
        if word == "odom":
            odometry = Odometry()
            odometry.pose.pose.position.x = float(rest)
            odometry.pose.pose.orientation.z = odometry.pose.pose.orientation.w = 0.5**0.5
            self.odometry.publish(odometry)
        elif word == "battery":
            self.battery.publish(Float32(data=float(rest)))
        elif word == "heard":
            self.heard.publish(String(data=rest))
        elif word in ("touch", "emergency"):
            publisher = self.touch if word == "touch" else self.stop
            publisher.publish(Bool(data=rest == "on"))
        elif word == "stubborn":
            self.stubborn = True


def main() -> None:
    rclpy.init(args=sys.argv[:1])
    robot = Robot()
    executor = MultiThreadedExecutor(8)
    executor.add_node(robot)

    def read() -> None:
        for line in sys.stdin:
            robot.obey(String(data=line.strip()))
        rclpy.try_shutdown()

    threading.Thread(target=read, daemon=True).start()
    try:
        executor.spin()
    except (ExternalShutdownException, KeyboardInterrupt):
        pass


if __name__ == "__main__":
    main()
