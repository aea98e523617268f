"""How much of its documents a test has reached: forms, items, handlers, links, conditions.

A *point* is something that a run can reach: an element, or one outcome of a condition.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from prima.markup.tree import Node
from prima.testing.tracing import Mark, ReachedElements

FORMS = frozenset({"form", "menu"})
ITEMS = frozenset({"block", "field", "initial", "object", "record", "subdialog", "transfer", "iu"})
HOLDERS = FORMS | {"iu"}
HANDLERS = frozenset({"on", "catch", "error", "help", "noinput", "nomatch"})
OTHERS = frozenset({"filled", "link", "choice"})
TELLING = ("id", "name", "event", "next")
"""Attributes that distinguish an element from others with its name."""
WIDEST = 60
"""Characters of an attribute that a point shows."""


@dataclass(frozen=True, slots=True)
class CoveragePoint:
    """Something that a run can reach: its line, kind, description, and the point around it."""

    line: int
    kind: str
    what: str
    inside: int | None
    """The number of the point around it, if any."""
    last: int
    """The last line of its content."""


@dataclass(slots=True)
class DocumentCoverage:
    """A document's points, and the numbers of those that were reached."""

    points: list[CoveragePoint]
    reached: set[int] = field(default_factory=set)

    @property
    def percent(self) -> float:
        """The percentage that was reached; a document without points is covered."""
        return 100 * len(self.reached) / len(self.points) if self.points else 100.0

    @property
    def missing(self) -> list[CoveragePoint]:
        """The points that were not reached."""
        return [one for number, one in enumerate(self.points) if number not in self.reached]

    def outermost(self) -> list[CoveragePoint]:
        """The points that were not reached, without those inside them."""
        return [one for one in self.missing if one.inside is None or one.inside in self.reached]


Coverage = dict[str, DocumentCoverage]
"""By the paths of the documents."""


def covered(documents: Mapping[str, ReachedElements]) -> Coverage:
    """The coverage of one run."""
    found: Coverage = {}
    for file, one in documents.items():
        held: list[tuple[CoveragePoint, bool]] = list(_points(one.root, one.marks))
        name = os.path.normpath(file)
        reached = {number for number, (_, is_reached) in enumerate(held) if is_reached}
        found[name] = DocumentCoverage([point for point, _ in held], reached)
    return found


def merge(all_of_it: Coverage, more: Coverage) -> None:
    """Add the coverage of another run."""
    for name, one in more.items():
        held = all_of_it.setdefault(name, DocumentCoverage(one.points))
        if held.points == one.points:  # otherwise the file has changed
            held.reached |= one.reached


def total(coverage: Coverage) -> float:
    """The percentage over all documents."""
    points = sum(len(one.points) for one in coverage.values())
    reached = sum(len(one.reached) for one in coverage.values())
    return 100 * reached / points if points else 100.0


# Points ----------------------------------------------------------------------------


def _points(root: Node, marks: set[Mark]) -> Iterator[tuple[CoveragePoint, bool]]:
    """All points of a document in order, and whether each was reached."""
    count = 0
    stack: list[tuple[Node, str, int | None]] = [(root, "", None)]
    while stack:
        node, parent, inside = stack.pop()
        for kind, what, line, reached in _of(node, parent, marks):
            last = max(one.place.line for one in node.walk()) if kind == "in" else line
            yield CoveragePoint(line, kind, what, inside, last), reached
            inside = count if kind == "in" else inside
            count += 1
        stack += [(child, node.tag, inside) for child in reversed(node.nodes)]


def _of(node: Node, parent: str, marks: set[Mark]) -> Iterator[tuple[str, str, int, bool]]:
    """The points of an element: kind, description, line, and whether it was reached."""
    index, line, shown = node.index, node.place.line, _shown(node)
    item = node.tag in ITEMS and parent in HOLDERS
    if item or node.tag in FORMS | HANDLERS | OTHERS:
        yield "in", shown, line, (index, "in") in marks
    if node.tag == "watch":
        yield "in", shown, line, (index, "true") in marks
    elif node.tag == "if":
        yield from _branches(node, marks)
    elif "cond" in node.attributes and node.tag != "elseif":
        for way in ("true", "false"):
            yield way, f"{shown} cond {way}", line, (index, way) in marks


def _branches(node: Node, marks: set[Mark]) -> Iterator[tuple[str, str, int, bool]]:
    """Each branch of an if, and the case that none is taken."""
    parts = [node, *node.all("elseif")]
    for part in parts:
        yield "true", _shown(part), part.place.line, (part.index, "true") in marks
    otherwise = node.all("else")
    line = otherwise[0].place.line if otherwise else node.place.line
    what = "<else>" if otherwise else f"{_shown(node)} without else"
    yield "else", what, line, (parts[-1].index, "false") in marks


def _shown(node: Node) -> str:
    """A start tag, abbreviated."""
    names = ("cond",) if node.tag in ("if", "elseif") else TELLING
    attribute = next((f' {name}="{node.get(name)}"' for name in names if node.get(name)), "")
    return f"<{node.tag}{attribute[:WIDEST]}>"


# Output ----------------------------------------------------------------------------


def missing_words(one: DocumentCoverage) -> str:
    """The lines that were not reached, such as ``12-20, 31 false``."""
    found: dict[str, None] = {}
    for point in one.outermost():
        if point.kind == "in":
            lines = f"{point.line}-{point.last}" if point.last > point.line else str(point.line)
        else:
            lines = f"{point.line} {point.kind}"
        found[lines] = None
    return ", ".join(found)


def format_coverage(coverage: Coverage) -> str:
    """Coverage as a table: a row for each document, and one for all."""
    wide = max([8, *(len(name) for name in coverage)])
    lines = [f"{'Document':<{wide}}  Points  Reached  Cover  Missing lines"]
    for name, one in sorted(coverage.items()):
        row = f"{name:<{wide}}  {len(one.points):>6}  {len(one.reached):>7}"
        lines.append(f"{row}  {_percent(one.percent):>5}  {missing_words(one)}".rstrip())
    points = sum(len(one.points) for one in coverage.values())
    reached = sum(len(one.reached) for one in coverage.values())
    lines.append(
        f"{'all':<{wide}}  {points:>6}  {reached:>7}  {_percent(total(coverage)):>5}".rstrip()
    )
    return "\n".join(lines) + "\n"


def _percent(number: float) -> str:
    """A percentage, rounded down so that 100% means everything."""
    return f"{int(number)}%"


def coverage_data(coverage: Coverage) -> dict[str, Any]:
    """Coverage as data for JSON."""
    return {
        "percent": round(total(coverage), 2),
        "documents": [
            {
                "document": name,
                "points": len(one.points),
                "reached": len(one.reached),
                "percent": round(one.percent, 2),
                "missing": [
                    {"line": point.line, "kind": point.kind, "what": point.what}
                    for point in one.missing
                ],
            }
            for name, one in sorted(coverage.items())
        ],
    }
