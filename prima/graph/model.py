"""What a picture shows, before anything is drawn: boxes, and arrows between them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from prima.errors import UsageError
from prima.errors.visible import visible

LONGEST = 300
"""Letters of one text in a picture."""
MOST_EDGES = 4000
MOST_LABELS = 12
"""Reasons to go the same way that are told."""

INWARD = ("go", "stay", "call", "guess", "back", "child")
"""Kinds of edges that lead to a node; the others lead out of the picture."""
OUTWARD = {
    "exit": "ends the application",
    "return": "returns",
    "computed": "to a computed target",
    "outside": "goes to",
    "missing": "goes to what is not there:",
}
"""Kinds of edges that lead to no node, with the words for them."""


@dataclass(slots=True)
class Node:
    """A box: a state of an application, or an Atomic Behavior.

    ``key`` is never shown. ``kind`` is ``state``, ``any`` (what holds in all states)
    or how an AB is: ``running``, ``waiting``, ``linked``, ``done``, ``cancelled``, ``failed``.
    """

    key: str
    title: str
    kind: str = "state"
    marks: list[str] = field(default_factory=list)
    """What is special about it, each in one or two words."""
    notes: list[str] = field(default_factory=list)
    source: str = ""
    """FILE:LINE, where it is known."""
    group: str = ""
    """The group that it belongs to: an AB's stream."""
    shade: int = 0
    start: bool = False
    reached: bool = True
    """Whether a way from the start leads there, as far as one can tell."""


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
        """Where an edge leads that leads to no node."""
        return f"{OUTWARD[self.kind]} {self.where}".strip()


@dataclass(slots=True)
class Graph:
    """A picture's content; ``told`` is its description for who cannot see it."""

    title: str
    told: str = ""
    nodes: dict[str, Node] = field(default_factory=dict)
    across: bool = True
    """Whether it runs from left to right; else from top to bottom."""

    def node(self, key: str, title: str, kind: str = "state", start: bool = False) -> Node:
        """Add a node, or give the one that is there already."""
        if key not in self.nodes:
            self.nodes[key] = Node(key, clean(title), kind, start=start)
        return self.nodes[key]

    def edge(self, source: str, target: str, kind: str, label: str = "", where: str = "") -> None:
        """Add a reason to go from a node to another, or out of the picture.

        Raises:
            UsageError: there are more arrows than any picture can show.
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

    def drop(self, edge: Edge) -> None:
        """Take an edge out again."""
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
    """One line of text that every format can hold, not without end."""
    return short(visible(" ".join(str(text)[: 4 * LONGEST].split())), LONGEST)


def short(text: str, letters: int) -> str:
    """A text cut to some letters."""
    return text if len(text) <= letters else text[: letters - 1].rstrip() + "…"


def reach(graph: Graph, starts: Iterable[str], kinds: tuple[str, ...] = INWARD) -> set[str]:
    """All nodes to which edges of some kinds lead from others, those included."""
    found = {key for key in starts if key in graph.nodes}
    open_ends = list(found)
    while open_ends:
        for edge in graph.out(open_ends.pop()):
            if edge.kind in kinds and edge.target and edge.target not in found:
                found.add(edge.target)
                open_ends.append(edge.target)
    return found


def settle(graph: Graph, everywhere: dict[str, list[str]]) -> None:
    """Find what no way leads to, and where returns lead.

    Args:
        graph: the states of an application.
        everywhere: the nodes of what holds in all states of a document, each with those states.
    """
    starts = [node.key for node in graph.nodes.values() if node.start]
    found: set[str] = set()
    while True:
        now = reach(graph, [*starts, *found])
        now |= {key for key, states in everywhere.items() if now.intersection(states)}
        if now == found:
            break
        found = now
    loose = any(edge.kind == "computed" and edge.source in found for edge in graph.edges)
    for node in graph.nodes.values():
        if node.key not in found and loose:
            node.marks.append("only if computed")
        elif node.key not in found:
            node.reached = False
            node.marks.append("never reached")
    _returns(graph)


def _returns(graph: Graph) -> None:
    """Say to which states a return leads: those that have called a state that leads there."""
    callers: dict[str, list[str]] = {}
    calls: dict[str, list[str]] = {}
    for edge in graph.edges:
        if edge.kind == "call":
            calls.setdefault(edge.target, []).append(edge.source)
    for target, sources in calls.items():
        for key in reach(graph, [target], ("go", "guess")):
            held = callers.setdefault(key, [])
            held += [source for source in sources if source not in held]
    for edge in graph.edges:
        if edge.kind == "return":
            for key in callers.get(edge.source, []):
                for label in edge.labels or [""]:
                    graph.edge(edge.source, key, "back", label)
            if edge.source in callers:
                graph.drop(edge)
