"""Directed graphs of nodes of any kind: what leads where, and cycles."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Iterator
from typing import TypeVar

Node = TypeVar("Node", bound=Hashable)


def led_to(starts: Iterable[Node], ways: Callable[[Node], Iterable[Node]]) -> set[Node]:
    """The nodes that some lead to, directly or not, themselves included.

    Args:
        starts: the nodes to begin with.
        ways: returns the successors of a node.
    """
    found = set(starts)
    waiting = [*found]
    while waiting:
        new = set(ways(waiting.pop())) - found
        found |= new
        waiting += new
    return found


def rings(starts: Iterable[Node], ways: Callable[[Node], Iterable[Node]]) -> Iterator[list[Node]]:
    """Sets of nodes that lead to each other: strong components, by Gabow's algorithm.

    None leads to one that comes later. The nodes of each are in the order in which they were found.

    Args:
        starts: the nodes to begin with.
        ways: returns the successors of a node.
    """
    path: list[Node] = []
    """The nodes that belong to no ring yet."""
    borders: list[int] = []
    """Where rings on the path may begin."""
    place: dict[Node, float] = {}
    """Where a node is on the path; infinity once it belongs to a ring."""
    open_nodes: list[tuple[Node, Iterator[Node]]] = []

    def enter(node: Node) -> None:
        place[node] = len(path)
        borders.append(len(path))
        path.append(node)
        open_nodes.append((node, iter(ways(node))))

    def entered(left: Iterator[Node]) -> bool:
        """Enter the next new node of some; gives whether there is one."""
        for to in left:
            if to not in place:
                enter(to)
                return True
            while borders[-1] > place[to]:
                borders.pop()
        return False

    for start in starts:
        if start not in place:
            enter(start)
        while open_nodes:
            node, left = open_nodes[-1]
            if entered(left):
                continue
            open_nodes.pop()
            if borders[-1] == place[node]:
                ring = path[borders.pop() :]
                del path[-len(ring) :]
                place.update(dict.fromkeys(ring, math.inf))
                yield ring
