"""The problems that ``prima validate`` reports, for documents being written."""

from __future__ import annotations

import re
from pathlib import Path

from prima import loading
from prima.digraphs import led_to
from prima.errors import DocumentError, Problem, UsageError, nearest_word
from prima.loading.files import GivenFiles, in_place_of_files
from prima.lsp.scan import ScannedText
from prima.lsp.tables import BY_NAMESPACE, BY_ROOT
from prima.lsp.text import Lines
from prima.lsp.workspace import Workspace

TAG = re.compile(r"</?[^\s<>/]*")
NEAR = ("urn:", "http://www.w3.org/2001/")
"""How namespaces begin that may be misspelt ones."""
WORD = re.compile(r"[^\s=<>/\"'(){}\[\];,+*!&|?]+")


def is_ours(page: ScannedText) -> bool:
    """Whether a text is, or will be, a document of PRIMA or VoiceXML."""
    root = page.root
    known = root is not None and root.local in BY_ROOT
    namespace = root.namespace if root is not None else ""
    if not namespace:  # perhaps the root's tag is broken, or what is before it
        return known or any(one in page.text for one in BY_NAMESPACE)
    return (
        namespace in BY_NAMESPACE
        or "prima" in namespace
        or (root is not None and root.local in ("prima", "vxml"))
        or (known and namespace.startswith(NEAR) and bool(nearest_word(namespace, BY_NAMESPACE)))
    )


def check(workspace: Workspace, path: Path) -> dict[Path, list[Problem]]:
    """All problems found by validating a document, by file.

    The texts of open documents replace their files.
    """
    text = workspace.text(path)
    if text is None or not is_ours(text.top):
        return {path: []}
    unsaved = {name: document.data() for name, document in workspace.open.items()}
    with in_place_of_files(GivenFiles(unsaved)):
        try:
            problems = loading.validate([path])
        except DocumentError as error:
            problems = error.problems
        except UsageError:
            problems = []
    found: dict[Path, list[Problem]] = {path: []}
    for problem in problems:
        found.setdefault(_resolved(path, problem.place.file), []).append(problem)
    return found


def files_read(workspace: Workspace, path: Path) -> set[Path]:
    """The files that are read to check a document: itself, those that it names, and so on."""
    return led_to([path], lambda one: {target for target, *_ in workspace.named(one)})


def _resolved(path: Path, file: str) -> Path:
    try:
        return (path.parent / file).resolve()
    except (OSError, ValueError, RuntimeError):
        return path


def spot(lines: Lines, problem: Problem) -> tuple[int, int]:
    """Where a problem begins and ends in a text."""
    text = lines.text
    start = lines.place(problem.place.line, problem.place.column)
    before, here = text[start - 1 : start], text[start : start + 1]
    in_code = problem.code in ("undeclared-variable", "bad-expression")
    if here != "<" and before in ('"', "'") and not in_code:
        end = text.find(before, start)
        stop = text.find("<", start)
        if end >= 0 and not 0 <= stop < end:
            return start, end
    match = (TAG if here == "<" else WORD).match(text, start)
    end = match.end() if match else start
    if end == start and here not in ("", "\n", "\r"):
        end = start + 1
    return start, end
