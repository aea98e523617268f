"""Pictures: an application as a finite state machine, a run as trees and streams, a world as a map.

print(picture("follow.xml", "svg"))
print(picture("mediated.jsonl", "mermaid", what="streams"))
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from prima.errors import DocumentError, UsageError, argument, did_you_mean, has_errors, one_of
from prima.graph.model import Graph
from prima.graph.run import NEVER

if TYPE_CHECKING:
    from prima.api import Transcript

FORMATS = ("svg", "dot", "mermaid", "json")
SUFFIXES = {".svg": "svg", ".dot": "dot", ".gv": "dot", ".mmd": "mermaid", ".mermaid": "mermaid"}
SUFFIXES |= {".json": "json"}
"""Formats by suffix."""
WHATS = ("states", "tree", "streams", "map")
MOST_BOXES = 300
"""Maximum number of boxes in SVG; other formats have no limit."""
OTHERS = {
    "grammar": "this is a grammar; a graph is of an application, a transcript or a world.",
    "robot": "this is a robot; a graph is of an application, a transcript or a world.",
    "world": "this is a world, which has no states. Write --what map.",
    "scenario": "this is a scenario. Draw its applications, or run it and draw the transcript:"
    " prima run {path} -o FILE.jsonl",
}
"""Messages about documents without states, by their root tags."""


def picture(
    path: str | Path,
    to: str = "svg",
    what: str = "",
    row: int | None = None,
    read: list[Transcript] | None = None,
) -> str:
    """Draw an application, a transcript or a world; the file's content determines which.

    Args:
        path: an application in PRIMA's language or VoiceXML, a transcript, or a world.
        to: ``svg``, ``dot``, ``mermaid`` or ``json``.
        what: ``states`` of an application; ``tree`` or ``streams`` of a transcript;
            ``map`` of a world. By default the states, the tree, or the map.
        row: draw the tree as of this row of the transcript's table; by default the whole
            run.
        read: the transcript read is appended to this; an incomplete one is drawn as far
            as it goes.

    Raises:
        UsageError: the file cannot be read or does not fit, or the format is unknown.
        DocumentError: the application or the world has errors.
    """
    from prima.loading.files import check_name, check_text, read_file

    path = check_name(path)
    check_text(to, "to")
    check_text(what, "what")
    for name, word, known in (("to", to, FORMATS), ("what", what or "states", WHATS)):
        if word not in known:
            hint = did_you_mean(word, known) or f"Write {one_of(known)}."
            raise UsageError(f'Unknown {name} "{word}". {hint}')
    if _is_transcript(path):
        return _run_picture(path, to, what, row, read)
    if what in ("tree", "streams") or row is not None:
        option = f"--what {what}" if what in ("tree", "streams") else "--row"
        remedy = "prima run SCENARIO -o FILE.jsonl writes one."
        raise UsageError(f"{path}: {option} needs a transcript; {remedy}")
    if what != "states" and _root(path, read_file(path)) == "world":
        return world_map(path, to)
    if what == "map":
        raise UsageError(f"{path}: --what map needs a world.")
    return _shown(states(path), to, path)


def _run_picture(
    path: str | Path, to: str, what: str, row: int | None, read: list[Transcript] | None
) -> str:
    """Draw a transcript; see :func:`picture`."""
    from prima import api

    if what in ("states", "map"):
        message = f"this is a transcript, which has no {what}. Write --what tree or streams."
        raise UsageError(f"{path}: {message}")
    if what == "streams" and row is not None:
        raise UsageError("--row works only with --what tree.")
    transcript = api.read(path, partial=True)
    if read is not None:
        read.append(transcript)
    return streams(transcript, to) if what == "streams" else tree(transcript, row, to)


def _root(path: str | Path, data: bytes) -> str:
    """The root tag of a document of PRIMA, or ``grammar``; empty for VoiceXML."""
    from prima.loading import is_grammar, is_voicexml
    from prima.markup.reader import parse

    if is_voicexml(data):
        return ""
    return "grammar" if is_grammar(data) else parse(str(path), data).tag


def world_map(path: str | Path, to: str = "svg") -> str:
    """Draw the map of a world; DOT and Mermaid show only places and ways.

    Raises:
        UsageError: the file cannot be read, or the map is too large.
        DocumentError: the world has errors.
    """
    from prima.graph import worldmap
    from prima.loading.files import read_file
    from prima.sim.map import read_world

    world = read_world(str(path), read_file(path))
    marks = len(world.places) + len(world.things) + len(world.corners)
    if to == "svg" and marks > MOST_BOXES:
        message = f"{marks} places, things and corners are too many: one map holds {MOST_BOXES}."
        raise UsageError(f"{path}: {message} Write --to dot or json.")
    made = {"dot": worldmap.dot, "mermaid": worldmap.mermaid, "json": worldmap.data}
    return made.get(to, worldmap.draw)(world)


def states(path: str | Path) -> Graph:
    """The states of an application and the transitions between them.

    Raises:
        UsageError: the file cannot be read, or is not an application.
        DocumentError: the application has errors.
    """
    from prima.interpreter.elements import Document
    from prima.loading import read_application
    from prima.loading.files import read_file

    data = read_file(path)
    if message := OTHERS.get(_root(path, data)):
        raise UsageError(f"{path}: {message.format(path=argument(path))}")
    document, problems = read_application(str(path), data)
    if has_errors(problems):
        raise DocumentError(problem for problem in problems if problem.severity == "error")
    if isinstance(document, Document):
        from prima.graph import dialogue

        graph = dialogue.states(document)
    else:
        from prima.graph import voicexml
        from prima.voicexml.document import VoiceDocument

        assert isinstance(document, VoiceDocument)
        graph = voicexml.states(document)
    graph.description = _describe(graph)
    return graph


def _is_transcript(path: str | Path) -> bool:
    """Whether a file begins as a transcript does, and not as XML."""
    from prima.loading.files import read_bytes

    begin = read_bytes(path, 200).removeprefix(b"\xef\xbb\xbf").lstrip()
    if not begin:
        raise UsageError(f"{path}: the file is empty.")
    return begin[:1] == b"{"


def tree(transcript: Transcript, row: int | None = None, to: str = "svg") -> str:
    """Draw the Atomic Behaviors of a run, or those in working memory at a row of its table.

    Raises:
        UsageError: there is no such row, a record lacks a field of its phase, or the tree is
            too large.
    """
    from prima.graph import run

    until = NEVER if row is None else transcript.row(row).time
    graph = run.trees(transcript.run(), until)
    graph.description = _describe(graph)
    return _shown(graph, to, transcript.name)


def streams(transcript: Transcript, to: str = "svg") -> str:
    """Draw the history of a run's Communication Streams.

    Raises:
        UsageError: a record lacks a field of its phase, or there are too many streams.
    """
    from prima.graph import gantt, run, text

    history = run.streams(transcript.run())
    if to == "svg" and len(history.streams) > MOST_BOXES:
        message = f"{len(history.streams)} streams are too many: one picture holds {MOST_BOXES}."
        raise UsageError(f"{transcript.name}: {message} Write --to json or mermaid.")
    made = {"dot": text.dot_streams, "mermaid": text.mermaid_streams, "json": text.data_streams}
    return made.get(to, gantt.draw)(history)


def _describe(graph: Graph) -> str:
    """A description of the picture as text, for accessibility."""
    sentences = []
    for node in list(graph.nodes.values())[:40]:
        edges = graph.out(node.key)[:8]
        marks = f" ({', '.join(node.marks)})" if node.marks else ""
        to = "leads to" if not node.group else "is followed by"
        inside = [graph.nodes[edge.target].title for edge in edges if edge.target]
        does = [f"{to} {', '.join(inside)}"] if inside else []
        does += [edge.words for edge in edges if not edge.target]
        sentences.append(f"{node.title}{marks} {'; '.join(does)}".rstrip() + ".")
    more = len(graph.nodes) - len(sentences)
    return " ".join(sentences) + (f" And {more} more." if more > 0 else "")


def _shown(graph: Graph, to: str, path: str | Path) -> str:
    from prima.graph import text

    if to != "svg":
        return {"dot": text.dot, "mermaid": text.mermaid, "json": text.data}[to](graph)
    if len(graph.nodes) > MOST_BOXES:
        remedy = "Write --to dot, and draw it with a program for large graphs"
        remedy += "." if graph.across else ", or choose a moment with --row."
        message = f"{len(graph.nodes)} boxes are too many: one picture holds {MOST_BOXES}."
        raise UsageError(f"{path}: {message} {remedy}")
    from prima.graph import cards, treepicture

    return cards.draw(graph) if graph.across else treepicture.draw(graph)


__all__ = ["FORMATS", "WHATS", "Graph", "picture", "states", "streams", "tree", "world_map"]
