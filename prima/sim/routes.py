"""Ways over the topological map."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING

from prima.sim.map import Map, Point
from prima.sim.world import World, distance

if TYPE_CHECKING:
    from networkx import Graph

SHORTEST = 0.001
"""The length (m) of a way between places on one spot: without one, each would lead to the other."""


class Routes:
    """Shortest ways between places, each looked for once."""

    def __init__(self, plan: Map) -> None:
        self._map = plan
        self._leads: dict[str, dict[str, tuple[float, str]]] = {}
        """By places that have been asked for: how far it is from others (m), and by which."""

    @cached_property
    def _graph(self) -> Graph[str]:
        """The places, and the ways between them with their lengths (m)."""
        from networkx import Graph  # few runs ask for a way, and it takes a tenth of a second

        graph: Graph[str] = Graph()
        graph.add_nodes_from(self._map.places)
        for a, b in self._map.ways:
            length = distance(self._map.places[a], self._map.places[b])
            graph.add_edge(a, b, weight=max(length, SHORTEST))
        return graph

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
        """How far it is to a place from all those that have a way to it, and which comes next.

        Of ways of one length, that by the place first in the alphabet.
        """
        from networkx import dijkstra_predecessor_and_distance

        nexts, lengths = dijkstra_predecessor_and_distance(self._graph, to)
        return {
            name: (float(length), min(nexts[name], default=to)) for name, length in lengths.items()
        }

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
