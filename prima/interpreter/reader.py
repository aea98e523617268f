"""Reads an application: bytes in, a document and its problems out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from prima.errors import Problem, few_guesses, in_order
from prima.interpreter.build import Builder
from prima.interpreter.checks import check_document
from prima.interpreter.elements import Document
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.markup.collecting import seldom_collected
from prima.markup.limits import LIMITS
from prima.markup.reader import read_tree

if TYPE_CHECKING:
    from prima.interpreter.grammars import Fetch

WHOLE = ("dead-end", "endless", "unknown-event", "unheard-event", "no-noinput")
"""Codes for what a document lacks as a whole, perhaps only because an element is unknown."""


MOST_KEPT, MOST_KEPT_BYTES = 64, 2_000_000
"""The maximum number of documents in the cache, and of bytes that they were read from."""


@dataclass(slots=True)
class _Read:
    """A file's content when last read, and the result."""

    data: bytes
    limits: tuple[int, ...]
    document: Document
    problems: tuple[Problem, ...]


_kept: dict[str, _Read] = {}
"""Documents by file name, the most recently read last."""


def read_document(
    file: str, data: bytes, fetch: Fetch | None = None
) -> tuple[Document, list[Problem]]:
    """Read an application and check it: schema first, then meaning.

    The same bytes of the same file give the same document, as documents are not modified; only
    the last content of a limited number of files is cached. One that names files is read anew.

    Args:
        file: the document's name, for places.
        data: its bytes.
        fetch: returns the bytes of a file that it names; by default it may name none.

    Raises:
        DocumentError: there is no document at all: it is not XML, or of another kind.
    """
    limits = (LIMITS.bytes, LIMITS.elements, LIMITS.attributes, LIMITS.depth)
    read = _kept.pop(file, None)
    if read is None or read.data != data or read.limits != limits:
        read = None  # frees the previous one's memory for this one
        with few_guesses(), seldom_collected():
            document, problems, outside = _read(file, data, fetch)
        if outside:
            return document, problems
        read = _Read(data, limits, document, tuple(problems))
    _keep(file, read)
    return read.document, list(read.problems)


def _keep(file: str, read: _Read) -> None:
    """Cache a document, dropping the least recently used."""
    if len(read.data) > MOST_KEPT_BYTES:
        return
    _kept[file] = read
    left = sum(len(one.data) for one in list(_kept.values()))
    for name in list(_kept):
        if len(_kept) <= MOST_KEPT and left <= MOST_KEPT_BYTES:
            break
        oldest = _kept.pop(name, None)
        left -= len(oldest.data) if oldest else 0


def _read(file: str, data: bytes, fetch: Fetch | None) -> tuple[Document, list[Problem], bool]:
    """The document, its problems, and whether it names files."""
    root, problems = read_tree(file, data, DIALOGUE)
    wrong = bool(problems)
    builder = Builder(root, fetch)
    document = builder.document()
    problems += builder.problems
    strange = [node for node in root.walk() if not node.key] if wrong else []
    named = {text[1:] for node in strange for text in node.attributes.values() if text[:1] == "#"}
    found = check_document(document)
    problems += [one for one in found if not (strange and _follows(one, named))]
    return document, in_order(problems), builder.outside


def _follows(problem: Problem, named: set[str]) -> bool:
    """Whether a problem most likely follows from unknown elements.

    ``named`` are the forms that these name.
    """
    if problem.code == "unreachable":
        return problem.get("form") in named
    return problem.code in WHOLE
