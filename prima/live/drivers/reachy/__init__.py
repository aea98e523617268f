"""Reachy Mini of Pollen Robotics, by its daemon's REST and WebSocket interface."""

from prima.live.drivers.reachy.driver import ReachyDriver

__all__ = ["DRIVER"]

DRIVER = ReachyDriver
