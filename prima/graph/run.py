"""Pictures of a transcript: the trees of Atomic Behaviors, and the streams' history."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from prima.graph.model import Graph, GraphNode, clean
from prima.transcript.colours import NOBODY, colours
from prima.transcript.record import Entry
from prima.transcript.row import describe
from prima.transcript.run import Run
from prima.transcript.run import until as run_until
from prima.transcript.spans import BehaviorSpan, StreamPiece, StreamSpan, base

NEVER = float("inf")


# Trees of Atomic Behaviors --------------------------------------------------------------------


def trees(run: Run, until: float = NEVER) -> Graph:
    """The Atomic Behaviors with their parents, grouped by stream.

    Args:
        run: the run.
        until: a time in seconds: show working memory after that instant; by default show all
            ABs of the run.
    """
    whole = until == NEVER
    title = "Atomic Behaviors of the run" if whole else f"Working memory at {until:.2f} s"
    graph = Graph(title, across=False)
    colour = colours(run.apps)
    there = run if whole else run_until(run, until)
    asked = {name: one for name, one in there.behaviors.items() if one.requested}
    parents = _all_parents(asked)
    kept = [one for one in asked.values() if whole or one.state in ("running", "waiting")]
    for one in kept:
        _node(graph, one, _state(one, asked, parents[one.name]), colour, whole)
    for one in kept:
        _edges(graph, one, [name for name in parents[one.name] if name in graph.nodes])
    return graph


def _all_parents(asked: Mapping[str, BehaviorSpan]) -> dict[str, list[str]]:
    """The ABs after which each AB runs, also those that the mediator put in before it."""
    parents = {name: _parents(one.asked) for name, one in asked.items()}
    for name, one in asked.items():
        if one.asked.before in parents:
            parents[one.asked.before].append(name)
    return parents


def _edges(graph: Graph, one: BehaviorSpan, parents: list[str]) -> None:
    """Draw the arrows to an AB: from its parents, or else from its unit."""
    for parent in parents:
        graph.edge(parent, one.name, "child")
    unit = base(one.asked.unit)
    if unit in graph.nodes and not parents:
        graph.edge(unit, one.name, "call")


def _node(
    graph: Graph, one: BehaviorSpan, state: str, colour: Mapping[str, int], whole: bool
) -> None:
    """Draw an AB."""
    node = graph.node(one.name, one.name)
    node.shade = colour.get(one.asked.app, NOBODY)
    node.group = clean(one.asked.tree)
    node.source = clean(one.asked.source)
    node.kind = state
    span = "not started" if one.began is None else f"{one.began:.2f} to {one.last:.2f} s"
    node.notes = [_words(one.asked), *([span] if whole else [])]
    node.marks = _marks(one.asked, node)


def _state(one: BehaviorSpan, asked: Mapping[str, BehaviorSpan], parents: list[str]) -> str:
    """The state of an AB; a waiting one is linked while a parent has not ended."""
    if one.state != "waiting":
        return one.state
    held = [asked[parent].state for parent in parents if parent in asked]
    return "linked" if "running" in held or "waiting" in held else "waiting"


def _parents(request: Entry) -> list[str]:
    """The ABs after which an AB was requested."""
    return [base(str(name)) for name in request.parents or [request.parent] if name]


def _words(request: Entry) -> str:
    command = request.command
    if command == "iu":
        return "the unit"
    return clean(describe(command, request.text, request.args, request.extra))


def _marks(request: Entry, node: GraphNode) -> list[str]:
    marks = {
        node.kind: node.kind != "done",
        "reaction": request.reactive,
        "leaves the user": request.leaves,
        "in loops": request.feedback,
        f"unit {clean(request.unit)}": bool(request.unit),
    }
    return [mark for mark, there in marks.items() if there]


# Streams ----------------------------------------------------------------------------------------


def in_words(piece: StreamPiece) -> str:
    """A piece of a stream, in words."""
    by = f" by {piece.by}" if piece.by else ""
    rule = f" ({piece.rule})" if piece.rule else ""
    return {"runs": "active", "away": "suspended", "broken": "broken"}[piece.kind] + by + rule


@dataclass(slots=True)
class History:
    """All streams of a run in the order in which they begin; ``end`` in seconds."""

    title: str
    streams: list[StreamSpan]
    end: float
    shades: dict[str, int]


def streams(run: Run) -> History:
    """The history of all Communication Streams of a run."""
    shades = {clean(app): shade for app, shade in colours(run.apps).items()}
    made = [_cleaned(stream) for stream in run.streams.values()]
    return History("Communication Streams of the run", made, run.end, shades)


def _cleaned(stream: StreamSpan) -> StreamSpan:
    """A stream with names that a picture can hold."""
    pieces = [replace(one, by=clean(one.by), rule=clean(one.rule)) for one in stream.pieces]
    return replace(stream, name=clean(stream.name), app=clean(stream.app), pieces=pieces)
