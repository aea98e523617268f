"""The content of a picture, independent of format: boxes, and arrows between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from prima.digraphs import led_to
from prima.errors import UsageError
from prima.errors.visible import visible

LONGEST = 300
"""Maximum length of a text in a picture."""
MOST_EDGES = 4000
MOST_LABELS = 12
"""Maximum number of labels of one arrow."""

INWARD = ("go", "stay", "call", "guess", "back", "child")
"""Kinds of edges that lead to a node; the others lead out of the picture."""
OUTWARD = {
    "exit": "ends the application",
    "return": "returns",
    "computed": "to a computed target",
    "outside": "goes to",
    "missing": "goes to a missing target:",
}
"""Kinds of edges without a target node, with their texts."""


@dataclass(slots=True)
class GraphNode:
    """A box: a state of an application, or an Atomic Behavior.

    ``key`` is never shown. ``kind`` is ``state``, ``any`` (what holds in all states)
    or how an AB is: ``running``, ``waiting``, ``linked``, ``done``, ``cancelled``, ``failed``.
    """

    key: str
    title: str
    kind: str = "state"
    marks: list[str] = field(default_factory=list)
    """Special properties, each in one or two words."""
    notes: list[str] = field(default_factory=list)
    source: str = ""
    """FILE:LINE, if known."""
    group: str = ""
    """Its group: an AB's stream."""
    shade: int = 0
    start: bool = False
    reached: bool = True
    """Whether it may be reached from the start."""


@dataclass(slots=True)
class Edge:
    """An arrow; several reasons to go the same way are one arrow with several labels.

    ``kind`` is one of :data:`INWARD`, or with an empty ``target`` of :data:`OUTWARD`;
    then ``where`` says more.
    """

    source: str
    target: str
    kind: str
    labels: list[str] = field(default_factory=list)
    where: str = ""

    @property
    def words(self) -> str:
        """The text of an edge without a target node."""
        return f"{OUTWARD[self.kind]} {self.where}".strip()


@dataclass(slots=True)
class Graph:
    """A picture's content; ``description`` is for screen readers."""

    title: str
    description: str = ""
    nodes: dict[str, GraphNode] = field(default_factory=dict)
    across: bool = True
    """Whether it runs from left to right; else from top to bottom."""

    def node(self, key: str, title: str, kind: str = "state", start: bool = False) -> GraphNode:
        """Add a node, or return the existing one."""
        if key not in self.nodes:
            self.nodes[key] = GraphNode(key, clean(title), kind, start=start)
        return self.nodes[key]

    def edge(self, source: str, target: str, kind: str, label: str = "", where: str = "") -> None:
        """Add an edge with a label, or the label to an existing edge.

        Raises:
            UsageError: there are too many edges.
        """
        where, label = clean(where), clean(label)
        edge = self._known.get((source, target, kind, where))
        if edge is None:
            if len(self._known) == MOST_EDGES:
                raise UsageError(
                    f"{self.title} have more than {MOST_EDGES} ways between them: too many for a"
                    " picture. Divide the application."
                )
            edge = self._known[source, target, kind, where] = Edge(source, target, kind, [], where)
            self._out.setdefault(source, []).append(edge)
        if label and label not in edge.labels:
            if len(edge.labels) < MOST_LABELS:
                edge.labels.append(label)
            else:
                edge.labels[-1] = "and more"

    def groups(self) -> dict[str, list[GraphNode]]:
        """The nodes by their groups, in their order."""
        found: dict[str, list[GraphNode]] = {}
        for node in self.nodes.values():
            found.setdefault(node.group, []).append(node)
        return found

    def drop(self, edge: Edge) -> None:
        """Remove an edge."""
        del self._known[edge.source, edge.target, edge.kind, edge.where]
        self._out[edge.source].remove(edge)

    _known: dict[tuple[str, str, str, str], Edge] = field(default_factory=dict)
    _out: dict[str, list[Edge]] = field(default_factory=dict)

    @property
    def edges(self) -> list[Edge]:
        """All edges, in the order in which they were found."""
        return list(self._known.values())

    def out(self, source: str) -> list[Edge]:
        """The edges that begin at a node."""
        return self._out.get(source, [])


def clean(text: object) -> str:
    """One line of text of limited length that every format can hold."""
    return short(visible(" ".join(str(text)[: 4 * LONGEST].split())), LONGEST)


def short(text: str, letters: int) -> str:
    """A text, cut if longer."""
    return text if len(text) <= letters else text[: letters - 1].rstrip() + "…"


def reach(graph: Graph, starts: Iterable[str], kinds: tuple[str, ...] = INWARD) -> set[str]:
    """All nodes reachable by edges of some kinds, including the start nodes."""

    def targets(key: str) -> Iterator[str]:
        return (one.target for one in graph.out(key) if one.kind in kinds and one.target)

    return led_to((key for key in starts if key in graph.nodes), targets)


def settle(graph: Graph, everywhere: dict[str, list[str]]) -> None:
    """Mark unreachable nodes, and add the edges of returns.

    Args:
        graph: the states of an application.
        everywhere: the nodes of what holds in all states of a document, each with those states.
    """
    found = _reachable(graph, everywhere)
    loose = any(edge.kind == "computed" and edge.source in found for edge in graph.edges)
    for node in graph.nodes.values():
        if node.key not in found and loose:
            node.marks.append("only if computed")
        elif node.key not in found:
            node.reached = False
            node.marks.append("never reached")
    _returns(graph)


def _reachable(graph: Graph, everywhere: dict[str, list[str]]) -> set[str]:
    """The nodes reachable from the start, also through what holds in a reachable state."""
    now = {node.key for node in graph.nodes.values() if node.start}
    found: set[str] = set()
    while now != found:
        found = now
        now = found | reach(graph, found)
        now |= {key for key, states in everywhere.items() if now.intersection(states)}
    return found


def _returns(graph: Graph) -> None:
    """Add edges to the states to which returns lead: those that have called the returning one."""
    callers = _callers(graph)
    returns = [edge for edge in graph.edges if edge.kind == "return" and edge.source in callers]
    for edge in returns:
        for key in callers[edge.source]:
            for label in edge.labels or [""]:
                graph.edge(edge.source, key, "back", label)
        graph.drop(edge)


def _callers(graph: Graph) -> dict[str, list[str]]:
    """For each state that calls lead to, the calling states."""
    calls: dict[str, list[str]] = {}
    for edge in graph.edges:
        if edge.kind == "call":
            calls.setdefault(edge.target, []).append(edge.source)
    callers: dict[str, list[str]] = {}
    for target, sources in calls.items():
        for key in reach(graph, [target], ("go", "guess")):
            held = callers.setdefault(key, [])
            held += [source for source in sources if source not in held]
    return callers
