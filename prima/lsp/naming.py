"""Definitions, references and renaming."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from os.path import exists
from pathlib import Path

from prima.errors import with_article
from prima.language.values import read_value
from prima.loading.applications import named_after
from prima.lsp.meanings import EVENTS_OF
from prima.lsp.names import FoundName, Mark, NameSpot, dialect, mark_at
from prima.lsp.paths import name_for
from prima.lsp.workspace import Workspace
from prima.script.globals import RESERVED

RENAMED = {
    "form": "id",
    "rule": "id",
    "variable": "variable",
    "place": "id",
    "thing": "id",
    "gesture": "id",
    "application": "id",
}
"""Kinds of names that can be renamed, with the simple types of new names."""


class RenameError(Exception):
    """A renaming is impossible; the message says why."""


@dataclass(frozen=True, slots=True)
class NameEdit:
    """A piece of a document and its replacement."""

    path: Path
    start: int
    end: int
    text: str


def _link_at(workspace: Workspace, path: Path, offset: int) -> tuple[Path, int, int] | None:
    return next((one for one in workspace.named(path) if one[1] <= offset <= one[2]), None)


def definitions(workspace: Workspace, path: Path, offset: int) -> list[NameSpot]:
    """The definitions of the name at an offset, or the beginning of the file named there."""
    mark = mark_at(workspace.marks(path), offset)
    if mark is not None:
        given = workspace.given(path, mark)
        if not given and mark.kind == ("event",):
            given = _begun(workspace, path, mark)
        return [found.spot for found in given]
    link = _link_at(workspace, path, offset)
    if link is not None and workspace.text(link[0]) is not None:
        return [NameSpot(link[0], 0, 0)]
    return []


def _begun(workspace: Workspace, path: Path, mark: Mark) -> list[FoundName]:
    """The definition of an event, or of the name in it: ``touch.head`` belongs to a sensor."""
    known = workspace.known(path, ("event",), anywhere=False)
    found = [one for one in known if one.mark.name.startswith(f"{mark.name}.")]
    begin, _, last = mark.name.rpartition(".")
    kind = EVENTS_OF.get(begin)
    if kind and not found:
        found = [one for one in workspace.known(path, (kind,), False) if one.mark.name == last]
    return found


def references(
    workspace: Workspace, path: Path, offset: int, declaration: bool = True
) -> list[NameSpot]:
    """All references to the name at an offset; of a file, in the whole workspace."""
    mark = mark_at(workspace.marks(path), offset)
    if mark is not None:
        return [
            found.spot
            for found in workspace.uses(path, mark)
            if declaration or not found.mark.defines
        ]
    link = _link_at(workspace, path, offset)
    if link is not None:
        return workspace.naming(link[0])
    text = workspace.text(path)
    root = text.page.root if text is not None else None
    if root is not None and root.start <= offset <= root.name_end:
        return workspace.naming(path)
    return []


def renamable(workspace: Workspace, path: Path, offset: int) -> NameSpot | None:
    """The piece of text at an offset that can be renamed."""
    mark = mark_at(workspace.marks(path), offset)
    if mark is not None:
        given = any(found.mark.defines for found in workspace.uses(path, mark))
        if given and not RENAMED.keys().isdisjoint(mark.kind):
            return NameSpot(path, mark.start, mark.end)
        return None
    link = _link_at(workspace, path, offset)
    if link is not None and workspace.text(link[0]) is not None:
        return NameSpot(path, link[1], link[2])
    return None


def rename(
    workspace: Workspace, path: Path, offset: int, new: str
) -> tuple[list[NameEdit], tuple[Path, Path] | None]:
    """Rename the name at an offset: the edits, and a file to move.

    Raises:
        RenameError: the new name is impossible.
    """
    if renamable(workspace, path, offset) is None:
        return [], None
    mark = mark_at(workspace.marks(path), offset)
    if mark is None:
        return _move(workspace, path, offset, new)
    kind = next(kind for kind in mark.kind if kind in RENAMED)
    _check_new(kind, new)
    uses = workspace.uses(path, mark)
    if new != mark.name and _is_taken(workspace, uses, new):
        raise RenameError(f'There is {with_article(kind)} "{new}" already.')
    edits = [
        NameEdit(one.path, one.mark.start, one.mark.end, _replacement(one.mark, new))
        for one in uses
    ]
    return sorted(set(edits), key=lambda edit: (edit.path, edit.start)), None


def _replacement(mark: Mark, new: str) -> str:
    """The text in place of a name; the property in ``{x}`` keeps its name."""
    if not mark.short:
        return new
    return f"{mark.name}$: {new}" if mark.shadow else f"{mark.name}: {new}"


def _check_new(kind: str, new: str) -> None:
    """Refuse a new name that nothing of a kind may have.

    Raises:
        RenameError: it is such a name.
    """
    try:
        read_value(RENAMED[kind], new)
    except ValueError as error:
        raise RenameError(f'"{new}" {error}') from None
    if kind == "variable" and "." in new:
        raise RenameError(f'"{new}" has a dot.')
    if kind == "variable" and new in RESERVED:
        raise RenameError(f'"{new}" is a word of ECMAScript\'s own. Choose another name.')


def _is_taken(workspace: Workspace, uses: list[FoundName], new: str) -> bool:
    """Whether a name is already taken where some uses are, or used where they define it."""
    if any(one.mark.use is not None and one.mark.use.would_be_local(new) for one in uses):
        return True
    named = [
        FoundName(path, mark)
        for path in {one.path for one in uses}
        for mark in workspace.marks(path)
        if mark.name == new
    ]
    given, taken = _defined(uses), _defined(named)
    return bool(given & (taken | _sought(named)) or taken & _sought(uses))


def _defined(names: Iterable[FoundName]) -> set[tuple[Path, int, str]]:
    """Where names are defined: the file, the scope and the kind."""
    defining = (one for one in names if one.mark.defines)
    return {(one.path, one.mark.scope, kind) for one in defining for kind in one.mark.kind}


def _sought(names: Iterable[FoundName]) -> set[tuple[Path, int, str]]:
    """Where names are looked for before the scope that has them."""
    return {
        (one.path, scope, kind)
        for one in names
        for scope in one.mark.nearer
        for kind in one.mark.kind
    }


def _move(
    workspace: Workspace, path: Path, offset: int, new: str
) -> tuple[list[NameEdit], tuple[Path, Path] | None]:
    link = _link_at(workspace, path, offset)
    target = workspace.target(path, new)
    if link is None or target is None:
        raise RenameError(f'"{new}" is not a file\'s name.')
    if target == link[0]:
        return [], None
    if exists(target) or target in workspace.open:
        raise RenameError(f'A file "{new}" already exists.')
    return moved(workspace, {link[0]: target}), (link[0], target)


def moved(workspace: Workspace, moves: Mapping[Path, Path]) -> list[NameEdit]:
    """The edits of documents that name files, or move, once files are renamed or moved together.

    A folder moves with all its files.
    """
    edits = [edit for old, new in moves.items() for edit in _called(workspace, old, new)]
    for path in sorted({*workspace.files(), *moves}):
        folder = _after(path, moves).parent
        for target, start, end in workspace.named(path):
            written = _written(workspace, path, _after(target, moves), folder)
            if written != _written(workspace, path, target, path.parent):
                edits.append(NameEdit(path, start, end, written))
    return edits


def _after(path: Path, moves: Mapping[Path, Path]) -> Path:
    """Where a file is after some moves."""
    for place in (path, *path.parents):
        if place in moves:
            return moves[place] / path.relative_to(place)
    return path


def _called(workspace: Workspace, old: Path, new: Path) -> Iterator[NameEdit]:
    """The edits of scenarios that call a VoiceXML application by its file's name."""
    before, after = named_after(old), named_after(new)
    if before == after or not _is_first(workspace, old):
        return
    for path in workspace.related(old):
        called = [
            one
            for one in workspace.marks(path)
            if one.kind == ("application",) and one.name == before
        ]
        if not any(one.defines for one in called):
            yield from (NameEdit(path, one.start, one.end, after) for one in called)


def _is_first(workspace: Workspace, path: Path) -> bool:
    """Whether it may be the first document of a VoiceXML application, not only a page of one."""
    text = workspace.text(path)
    if text is None or dialect(text.top) != "voicexml":
        return False
    return not all(workspace.has_uris(one.path) for one in workspace.naming(path))


def _written(workspace: Workspace, document: Path, path: Path, folder: Path) -> str:
    """A file's name as a document has it that is, or will be, in a folder."""
    try:
        return name_for(path, folder, workspace.has_uris(document))
    except ValueError:  # another drive
        return path.as_posix()
