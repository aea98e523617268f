"""The areas that offer applications: which ones the robot enters and leaves."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import dist, inf

from prima.messages import ApplicationLoaded, ApplicationUnloaded
from prima.sim.map import EPSILON, Area
from prima.sim.plan import Point

THRESHOLD = 0.5
"""The robot has left an area when it is this far (m) outside."""


Crossing = ApplicationLoaded | ApplicationUnloaded
"""The application of an area that the robot has entered or left."""


class Entrances:
    """Areas with the ids of the applications that they offer, and those that the robot is in."""

    def __init__(self, offers: Sequence[tuple[Area, str]]) -> None:
        self.offers = offers
        self._inside: set[str] = set()
        self._compared: tuple[Point, float] | None = None
        """Where the robot was when the areas were last compared with its place, and how far (m)
        it has to go from there to get into or out of one."""

    @property
    def unseen(self) -> bool:
        """Whether there are areas not yet compared with the robot's place."""
        return self._compared is None and bool(self.offers)

    def enter(self, applications: Collection[str]) -> None:
        """Assume that the robot is in the areas of these applications."""
        self._inside = {area.id for area, name in self.offers if name in applications}

    def cross(self, here: Point) -> list[Crossing]:
        """Load the applications of areas that the robot has entered; unload those it has left."""
        if self._compared is not None:
            at, far = self._compared
            if dist(at, here) < far:
                return []
        before, now, nearest = self._inside, set[str](), inf
        for area, _ in self.offers:
            beyond = area.beyond(here, THRESHOLD if area.id in before else 0.0)
            if beyond <= 0.0:
                now.add(area.id)
            nearest = min(nearest, abs(beyond))
        self._compared, self._inside = (here, nearest - EPSILON), now
        return self._crossings(before, now) if before != now else []

    def _crossings(self, before: set[str], now: set[str]) -> list[Crossing]:
        """What to load and unload; an application that several areas offer stays in all of them."""
        had = {name for area, name in self.offers if area.id in before}
        has = {name for area, name in self.offers if area.id in now}
        crossed: dict[str, Crossing] = {}
        for area, name in self.offers:
            if name not in had and area.id in now:
                crossed.setdefault(name, ApplicationLoaded(name, area.title))
            elif name not in has and area.id in before:
                crossed.setdefault(name, ApplicationUnloaded(name, area.title))
        return list(crossed.values())
