"""Ways over the topological map."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

from prima.sim.scenario import Map, Point
from prima.sim.world import World, distance


class Routes:
    """Shortest ways between places; networkx is imported when the first one is asked for."""

    def __init__(self, plan: Map) -> None:
        self._map = plan
        self._graph: Any = None
        self._lengths: dict[str, dict[str, float]] = {}
        """How far it is from places to each place that has been asked for (m)."""

    def _built(self) -> Any:
        if self._graph is None:
            import networkx

            self._graph = networkx.Graph()
            self._graph.add_nodes_from(self._map.places)
            for a, b in self._map.ways:
                length = distance(self._map.places[a], self._map.places[b])
                self._graph.add_edge(a, b, weight=length)
        return self._graph

    def route(self, world: World, to: str) -> list[Point] | None:
        """Points to go through from where the robot is to a place, or None if there is no way."""
        import networkx

        graph, here, places = self._built(), world.position, self._map.places
        if to not in places:
            return None
        if to not in self._lengths:
            self._lengths[to] = networkx.single_source_dijkstra_path_length(graph, to)
        first = self._first(world.passable, here, to) or self._first(world.clear, here, to)
        if first is None:
            return None
        path = networkx.dijkstra_path(graph, first, to)
        return [places[name] for name in path]

    def _first(self, free: Callable[[Point, Point], bool], here: Point, to: str) -> str | None:
        """The place from which the way to another is shortest, of those that are free to go to.

        Whether one is free takes longest to tell: it is asked only of those that are nearer.
        """
        found, shortest = None, inf
        for name, length in sorted(self._lengths[to].items()):
            place = self._map.places[name]
            whole = distance(here, place) + length
            if whole < shortest - 1e-9 and free(here, place):
                found, shortest = name, whole
        return found
