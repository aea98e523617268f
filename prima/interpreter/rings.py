"""Cycles in graphs."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import Generic, TypeVar

Node = TypeVar("Node", bound=Hashable)


def rings(starts: Iterable[Node], ways: Callable[[Node], Iterable[Node]]) -> Iterator[list[Node]]:
    """Sets of nodes that lead to each other (Tarjan's strongly connected components).

    None leads to one that comes later.

    Args:
        starts: the nodes to begin with.
        ways: returns the successors of a node.
    """
    search = _RingSearch(ways)
    for start in starts:
        yield from search.rings(start)


class _RingSearch(Generic[Node]):
    """Tarjan's algorithm, without recursion."""

    def __init__(self, ways: Callable[[Node], Iterable[Node]]) -> None:
        self._ways = ways
        self._number: dict[Node, int] = {}
        self._lowest: dict[Node, int] = {}
        self._kept: list[Node] = []
        self._done: set[Node] = set()

    def rings(self, start: Node) -> Iterator[list[Node]]:
        """The rings reached from a node that have not been returned before."""
        path = [] if start in self._number else [self._enter(start)]
        while path:
            name, left = path[-1]
            for to in left:
                if to not in self._number:
                    path.append(self._enter(to))
                    break
                if to not in self._done:
                    self._lower(name, self._number[to])
            else:
                path.pop()
                if path:
                    self._lower(path[-1][0], self._lowest[name])
                yield from self._ring(name)

    def _enter(self, name: Node) -> tuple[Node, Iterator[Node]]:
        self._number[name] = self._lowest[name] = len(self._number)
        self._kept.append(name)
        return name, iter(self._ways(name))

    def _lower(self, name: Node, number: int) -> None:
        self._lowest[name] = min(self._lowest[name], number)

    def _ring(self, name: Node) -> Iterator[list[Node]]:
        """The ring that a node closes, if it is the first of one."""
        if self._lowest[name] == self._number[name]:
            ring = [self._kept.pop()]
            while ring[-1] != name:
                ring.append(self._kept.pop())
            self._done.update(ring)
            yield ring
