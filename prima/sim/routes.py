"""Ways over the topological map."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import dist, inf
from typing import TYPE_CHECKING

from prima.sim.map import EPSILON, Map
from prima.sim.plan import Point
from prima.sim.world import World

if TYPE_CHECKING:
    from networkx import Graph

SHORTEST = 0.001
"""The length (m) of a way between places on the same spot: at 0, each would lead to the other."""


class Routes:
    """Shortest ways between places, each computed once."""

    def __init__(self, plan: Map) -> None:
        self._map = plan
        self._leads: dict[str, dict[str, tuple[float, str]]] = {}
        """By destination: the distance from other places (m), and the next place."""

    @cached_property
    def _graph(self) -> Graph[str]:
        """The places, and the ways between them with their lengths (m)."""
        from networkx import Graph  # few runs need a way, and importing takes a tenth of a second

        graph: Graph[str] = Graph()
        graph.add_nodes_from(self._map.places)
        for a, b in self._map.ways:
            length = dist(self._map.places[a], self._map.places[b])
            graph.add_edge(a, b, weight=max(length, SHORTEST))
        return graph

    def route(self, world: World, to: str) -> list[Point] | None:
        """The points from the robot's position to a place, or None if there is no way."""
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
        """The distance to a place from all places with a way to it, and the next place on it.

        Of ways of equal length, the one through the place first in the alphabet.
        """
        from networkx import single_source_dijkstra_path_length

        graph = self._graph
        lengths = single_source_dijkstra_path_length(graph, to)
        nexts = {
            name: [one for one in graph[name] if lengths[one] + graph[name][one]["weight"] < most]
            for name, most in ((name, length + EPSILON) for name, length in lengths.items())
        }
        return {
            name: (float(length), min(nexts[name], default=to)) for name, length in lengths.items()
        }

    def _first(self, free: Callable[[Point, Point], bool], here: Point, to: str) -> str | None:
        """The place with the shortest way to another, among those that can be reached freely.

        Checking that takes longest, so the best are checked first.
        """
        places = self._map.places
        leads = self._leads[to].items()
        shortest, found = inf, list[str]()
        for whole, name in sorted((dist(here, places[one]) + lead[0], one) for one, lead in leads):
            if whole > shortest + EPSILON:
                break
            if free(here, places[name]):
                shortest = min(shortest, whole)
                found.append(name)
        return min(found, default=None)
