"""The areas of a place that offer applications: which are entered and left."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from prima.messages import ApplicationLoaded, ApplicationUnloaded
from prima.sim.map import Area, Point

THRESHOLD = 0.5
"""How far (m) outside an area the robot has left it."""


Crossing = ApplicationLoaded | ApplicationUnloaded
"""The application of an area that the robot has come into, or has left."""


class Entrances:
    """Areas with the ids of the applications that they offer, and which the robot is in."""

    def __init__(self, offers: Sequence[tuple[Area, str]]) -> None:
        self.offers = offers
        self._inside: set[str] = set()
        self._crossed: Point | None = None
        """Where the robot was when areas were compared with its place last."""

    @property
    def unseen(self) -> bool:
        """Whether there are areas that were not compared with the robot's place yet."""
        return self._crossed is None and bool(self.offers)

    def enter(self, applications: Collection[str]) -> None:
        """Take the robot to be in the areas of these applications."""
        self._inside = {area.id for area, name in self.offers if name in applications}

    def cross(self, here: Point) -> list[Crossing]:
        """Load what an area offers that the robot has come into, and unload what it has left."""
        if here is self._crossed or not self.offers:
            return []
        self._crossed = here
        crossed: list[Crossing] = []
        for area, name in self.offers:
            inside = area.id in self._inside
            if not inside and area.holds(here):
                self._inside.add(area.id)
                crossed.append(ApplicationLoaded(name, area.title))
            elif inside and not area.holds(here, THRESHOLD):
                self._inside.discard(area.id)
                crossed.append(ApplicationUnloaded(name, area.title))
        return crossed
