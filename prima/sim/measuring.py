"""The readings of the simulated body's own sensors."""

from __future__ import annotations

from math import dist

from prima.messages import Json
from prima.sim.world import STANDING, World

ITS_OWN = frozenset({"human", "position", "moving"})
"""The sensors that it measures itself, by the first part of their names."""


class OwnSensors:
    """Measures the robot's position and motion, and where the person is."""

    def __init__(self, world: World) -> None:
        self.told_of: frozenset[str] | None = None
        """Sensors that are in use, by the first part of their names; None for all of them."""
        self._world = world
        self._around: tuple[object, ...] = ()
        """Robot, camera and person at the last measurement, and the robot's motion."""

    def measure(self) -> dict[str, Json]:
        """The sensor values, if anything around the robot has changed.

        The first call returns all of them; later ones only those in use.
        """
        looked_at = ITS_OWN if self.told_of is None or not self._around else self.told_of
        world = self._world
        if "human" in looked_at:
            world.sees_person()  # it may attend to another now
        camera = (world.heading, world.pan, world.blind)
        around = (world.position, *camera, world.person, world.drive)
        if around == self._around or looked_at.isdisjoint(ITS_OWN):
            return {}
        self._around = around
        now: dict[str, Json] = {}
        if "human" in looked_at:
            person = world.person
            now["human.visible"] = world.sees_person()
            now["human.distance"] = (
                None if person is None else round(dist(world.position, person), 1)
            )
        if "position" in looked_at:
            pose = world.pose()
            now["position.x"] = round(pose["x"], 1)
            now["position.y"] = round(pose["y"], 1)
            now["position.heading"] = round(pose["heading"]) % 360
        if "moving" in looked_at:
            now["moving"] = world.drive != STANDING
        return now
