"""Ways over the topological map."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from math import inf

from prima.sim.scenario import Map, Point
from prima.sim.world import World, distance


class Routes:
    """Shortest ways between places, each looked for once (Dijkstra).

    No graph library: importing one takes longer than the demo's whole run.
    """

    def __init__(self, plan: Map) -> None:
        self._map = plan
        self._ways: dict[str, dict[str, float]] = {name: {} for name in plan.places}
        for a, b in plan.ways:
            self._ways[a][b] = self._ways[b][a] = distance(plan.places[a], plan.places[b])
        self._leads: dict[str, dict[str, tuple[float, str]]] = {}
        """By places that have been asked for: how far it is from others (m), and by which."""

    def route(self, world: World, to: str) -> list[Point] | None:
        """Points to go through from where the robot is to a place, or None if there is no way."""
        here, places = world.position, self._map.places
        if to not in places:
            return None
        if to not in self._leads:
            self._leads[to] = self._lead_to(to)
        first = self._first(world.passable, here, to) or self._first(world.clear, here, to)
        if first is None:
            return None
        path = [first]
        while path[-1] != to:
            path.append(self._leads[to][path[-1]][1])
        return [places[name] for name in path]

    def _lead_to(self, to: str) -> dict[str, tuple[float, str]]:
        """How far it is to a place from all those that have a way to it, and which comes next."""
        found: dict[str, tuple[float, str]] = {}
        waiting = [(0.0, to, to)]
        while waiting:
            length, name, towards = heappop(waiting)
            if name not in found:
                found[name] = length, towards
                for other, way in self._ways[name].items():
                    heappush(waiting, (length + way, other, name))
        return found

    def _first(self, free: Callable[[Point, Point], bool], here: Point, to: str) -> str | None:
        """The place from which the way to another is shortest, of those that are free to go to.

        Whether one is free takes longest to tell: it is asked only of those that are nearer.
        """
        found, shortest = None, inf
        for name, (length, _) in sorted(self._leads[to].items()):
            place = self._map.places[name]
            whole = distance(here, place) + length
            if whole < shortest - 1e-9 and free(here, place):
                found, shortest = name, whole
        return found
