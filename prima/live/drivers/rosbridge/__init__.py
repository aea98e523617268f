"""The driver of robots with ROS 2 behind a rosbridge, by its WebSocket protocol."""

from __future__ import annotations

from urllib.parse import urlsplit

from prima.errors import UsageError
from prima.live.drivers.rosbridge.link import RosbridgeLink
from prima.live.ros import RosDriver, RosLink

PORT = 9090


class RosbridgeDriver(RosDriver):
    """A robot behind a rosbridge, whose address is ``ws://HOST:9090``, or ``wss://HOST``."""

    kind = "rosbridge"

    def make_link(self) -> RosLink:
        """A connection with the bridge."""
        settings = self.settings
        address = settings.address or "127.0.0.1"
        address = address if "://" in address else f"ws://{address}"
        try:
            parts = urlsplit(address)
            host, port = parts.hostname, parts.port
        except ValueError:
            host, port = None, None
        if not host or " " in host or parts.scheme not in ("ws", "wss"):
            message = f'"{settings.address}" is not the address of a rosbridge.'
            remedy = 'Write for example address="ws://robot.local:9090".'
            raise UsageError(f"{settings.place}: rosbridge: {message} {remedy}")
        port = port or (443 if parts.scheme == "wss" else PORT)
        url = f"{parts.scheme}://{host}:{port}{parts.path}"
        return RosbridgeLink(url, settings.open / 1000, settings.heartbeat / 1000)


DRIVER = RosbridgeDriver
