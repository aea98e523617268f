"""The driver of robots with ROS 2, by the rclpy of the robot's own installation."""

from __future__ import annotations

import os

from prima.errors import UsageError
from prima.live.drivers.ros2.link import RclpyLink
from prima.live.ros import RosDriver, RosLink

DOMAINS = 233
"""How many domains ROS has."""


class Ros2Driver(RosDriver):
    """A robot on the same network, in a ROS domain.

    Its address is the domain's number; without one it is that of the environment, or 0.
    """

    kind = "ros2"

    def make_link(self) -> RosLink:
        """A node in the robot's domain."""
        settings = self.settings
        address = settings.address or os.environ.get("ROS_DOMAIN_ID") or "0"
        if not address.isdecimal() or int(address) >= DOMAINS:
            message = f'"{address}" is not the number of a ROS domain.'
            remedy = f"Write a number from 0 to {DOMAINS - 1} as the address, or none."
            raise UsageError(f"{settings.place}: ros2: {message} {remedy}")
        return RclpyLink(int(address), settings.open / 1000, settings.heartbeat / 1000)


DRIVER = Ros2Driver
