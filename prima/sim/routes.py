"""Ways over the topological map."""

from __future__ import annotations

from typing import Any

from prima.sim.scenario import Map, Point
from prima.sim.world import World, distance


class Routes:
    """Shortest ways between places; networkx is imported when the first one is asked for."""

    def __init__(self, plan: Map) -> None:
        self._map = plan
        self._graph: Any = None

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
        lengths = networkx.single_source_dijkstra_path_length(graph, to)
        best: tuple[float, str] | None = None
        reached = [name for name in sorted(lengths) if world.passable(here, places[name])]
        for name in reached or sorted(lengths):
            if reached or world.clear(here, places[name]):
                whole = distance(here, places[name]) + lengths[name]
                if best is None or whole < best[0] - 1e-9:
                    best = (whole, name)
        if best is None:
            return None
        path = networkx.dijkstra_path(graph, best[1], to)
        return [places[name] for name in path]
