"""The parts of a document, and the files that it names."""

from __future__ import annotations

from dataclasses import dataclass, field
from os.path import isfile
from pathlib import Path

from prima.lsp.scan import ScannedTag, ScannedText
from prima.lsp.workspace import Workspace

NAMING = ("id", "name", "event", "src", "command", "sensor", "type", "item")
SHOWN = {
    "prima": "module",
    "vxml": "module",
    "scenario": "module",
    "world": "module",
    "robot": "module",
    "form": "class",
    "menu": "class",
    **dict.fromkeys(("field", "block", "subdialog", "initial", "record", "transfer"), "method"),
    **dict.fromkeys(("object", "iu-items"), "method"),
    **dict.fromkeys(("on", "noinput", "nomatch", "help", "error", "catch"), "event"),
    **dict.fromkeys(("link", "watch", "filled", "choice"), "event"),
    "var": "variable",
    "rule": "function",
    "script": "function",
    **dict.fromkeys(("place", "thing", "corner", "area", "person"), "object"),
    **dict.fromkeys(("application", "service", "device", "adds", "gesture"), "object"),
    **dict.fromkeys(("when", "answer"), "event"),
}
"""Elements in the outline, with their kinds of symbols."""


@dataclass(slots=True)
class OutlineElement:
    """An element in the outline."""

    name: str
    detail: str
    sort: str
    start: int
    end: int
    name_start: int
    name_end: int
    parts: list[OutlineElement] = field(default_factory=list)


def outline(page: ScannedText) -> list[OutlineElement]:
    """The outline of a document."""
    top: list[OutlineElement] = []
    made: dict[int, list[OutlineElement]] = {}
    for tag in page.tags:
        parts = made.get(id(tag.parent), top) if tag.parent else top
        made[id(tag)] = parts
        if tag.key in SHOWN and tag.element is not None:
            part = _part(tag)
            parts.append(part)
            made[id(tag)] = part.parts
    return top


def _part(tag: ScannedTag) -> OutlineElement:
    attr = next((one for name in NAMING if (one := tag.attr(name)) and one.value), None)
    if attr is not None:
        name, detail, start, end = attr.value, tag.name, attr.first, attr.last
    else:
        first = next((one for one in tag.attributes if one.first >= 0), None)
        name = f"{tag.name} {first.name}={first.value[:40]}" if first else tag.name
        detail, start, end = "", tag.start + 1, tag.name_end
    return OutlineElement(
        " ".join(name.split())[:80] or tag.name,
        detail,
        SHOWN[tag.key],
        tag.start,
        max(tag.until, tag.end),
        start,
        end,
    )


def links(workspace: Workspace, path: Path) -> list[tuple[Path, int, int]]:
    """The existing files that a document names, with the positions of their names."""
    named = workspace.named(path)
    return [one for one in named if isfile(one[0]) or one[0] in workspace.open]
