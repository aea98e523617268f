"""Finding what a name means, who uses it, and giving it another name."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from prima.language.values import read_value
from prima.lsp.names import Mark, mark_at
from prima.lsp.workspace import Found, Workspace

RENAMED = {
    "form": "id",
    "rule": "id",
    "variable": "variable",
    "place": "id",
    "thing": "id",
    "gesture": "id",
    "application": "id",
}
"""Names that can be changed everywhere, with the simple type that a new one must be of."""


class Refused(Exception):
    """A new name cannot be given; the message says why."""


@dataclass(frozen=True, slots=True)
class Spot:
    """A piece of a document."""

    path: Path
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Edit:
    """A piece of a document and what shall stand there."""

    path: Path
    start: int
    end: int
    text: str


def _link_at(workspace: Workspace, path: Path, offset: int) -> tuple[Path, int, int] | None:
    return next((one for one in workspace.named(path) if one[1] <= offset <= one[2]), None)


def mark_of(workspace: Workspace, path: Path, offset: int) -> Mark | None:
    """The name at an offset."""
    text = workspace.text(path)
    return mark_at(text.marks, offset) if text is not None else None


def definitions(workspace: Workspace, path: Path, offset: int) -> list[Spot]:
    """Where what stands at an offset is given its name; the beginning of a file that is named."""
    mark = mark_of(workspace, path, offset)
    if mark is not None:
        given = workspace.given(path, mark)
        if not given and mark.kind == ("event",):
            given = _begun(workspace, path, mark)
        return [Spot(found.path, found.mark.start, found.mark.end) for found in given]
    link = _link_at(workspace, path, offset)
    if link is not None and workspace.text(link[0]) is not None:
        return [Spot(link[0], 0, 0)]
    return []


def _begun(workspace: Workspace, path: Path, mark: Mark) -> list[Found]:
    """What raises an event, or gives the name in it: ``touch.head`` is the sensor head's."""
    known = workspace.known(path, ("event",), anywhere=False)
    found = [one for one in known if one.mark.name.startswith(f"{mark.name}.")]
    begin, _, last = mark.name.rpartition(".")
    kind = {"touch": "sensor", "reply": "service", "error.service": "service"}.get(begin)
    kind = "device" if begin == "error.device" else kind
    if kind and not found:
        found = [one for one in workspace.known(path, (kind,), False) if one.mark.name == last]
    return found


def references(
    workspace: Workspace, path: Path, offset: int, declaration: bool = True
) -> list[Spot]:
    """Where what stands at an offset is named; of a file, in all documents of the workspace."""
    mark = mark_of(workspace, path, offset)
    if mark is not None:
        return [
            Spot(found.path, found.mark.start, found.mark.end)
            for found in workspace.uses(path, mark)
            if declaration or not found.mark.defines
        ]
    link = _link_at(workspace, path, offset)
    if link is not None:
        return [Spot(*one) for one in workspace.naming(link[0])]
    text = workspace.text(path)
    root = text.page.root if text is not None else None
    if root is not None and root.start <= offset <= root.name_end:
        return [Spot(*one) for one in workspace.naming(path)]
    return []


def renamable(workspace: Workspace, path: Path, offset: int) -> Spot | None:
    """What of the text at an offset can be given another name."""
    mark = mark_of(workspace, path, offset)
    if mark is not None:
        given = any(found.mark.defines for found in workspace.uses(path, mark))
        if given and not RENAMED.keys().isdisjoint(mark.kind):
            return Spot(path, mark.start, mark.end)
        return None
    link = _link_at(workspace, path, offset)
    if link is not None and workspace.text(link[0]) is not None:
        return Spot(path, link[1], link[2])
    return None


def rename(
    workspace: Workspace, path: Path, offset: int, new: str
) -> tuple[list[Edit], tuple[Path, Path] | None]:
    """Give what stands at an offset another name: the edits, and a file to be moved.

    Raises:
        Refused: it cannot be called so.
    """
    if renamable(workspace, path, offset) is None:
        return [], None
    mark = mark_of(workspace, path, offset)
    if mark is None:
        return _move(workspace, path, offset, new)
    kind = next(kind for kind in mark.kind if kind in RENAMED)
    try:
        read_value(RENAMED[kind], new)
    except ValueError as error:
        raise Refused(f'"{new}" {error}') from None
    uses = workspace.uses(path, mark)
    if new != mark.name and _is_taken(workspace, [one for one in uses if one.mark.defines], new):
        raise Refused(f'There is a {kind} "{new}" already.')
    edits = [Edit(one.path, one.mark.start, one.mark.end, new) for one in uses]
    return sorted(set(edits), key=lambda edit: (edit.path, edit.start)), None


def _is_taken(workspace: Workspace, given: list[Found], new: str) -> bool:
    """Whether something else has a name already where one of some definitions stands."""
    places = {(one.path, one.mark.scope, kind) for one in given for kind in one.mark.kind}
    for path in {one.path for one in given}:
        text = workspace.text(path)
        for one in text.marks if text is not None else ():
            taken = one.defines and one.name == new
            if taken and any((path, one.scope, kind) in places for kind in one.kind):
                return True
    return False


def _move(
    workspace: Workspace, path: Path, offset: int, new: str
) -> tuple[list[Edit], tuple[Path, Path] | None]:
    link = _link_at(workspace, path, offset)
    target = workspace.target(path, new)
    if link is None or target is None:
        raise Refused(f'"{new}" is not a file\'s name.')
    if target == link[0]:
        return [], None
    if target.exists() or target in workspace.open:
        raise Refused(f'There is a file "{new}" already.')
    return moved(workspace, link[0], target), (link[0], target)


def moved(workspace: Workspace, old: Path, new: Path) -> list[Edit]:
    """What documents must say once a file is called otherwise or stands elsewhere."""
    edits = []
    for path, start, end in workspace.naming(old):
        if path != old:
            edits.append(Edit(path, start, end, _relative(new, path.parent)))
    if new.parent != old.parent:
        for target, start, end in workspace.named(old):
            there = old if target == old else target
            edits.append(Edit(old, start, end, _relative(there, new.parent)))
    return edits


def _relative(path: Path, folder: Path) -> str:
    try:
        name = os.path.relpath(path, folder).replace(os.sep, "/")
    except ValueError:  # another drive
        name = path.as_posix()
    return name.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
