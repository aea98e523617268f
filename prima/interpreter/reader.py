"""Reading an application: bytes in, a document and all that is wrong with it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from prima.errors import Problem, few_guesses, in_order
from prima.interpreter.build import Builder
from prima.interpreter.elements import Document
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.markup.collecting import seldom_collected
from prima.markup.limits import LIMITS
from prima.markup.reader import read_tree

if TYPE_CHECKING:
    from prima.interpreter.grammars import Fetch

WHOLE = ("dead-end", "endless", "unknown-event", "unheard-event", "no-noinput")
"""Codes of what a whole document lacks, which may be in an element that is not understood."""


MOST_KEPT, MOST_KEPT_BYTES = 64, 2_000_000
"""How many documents are kept that have been read, and how many bytes they were read from."""


@dataclass(slots=True)
class _Read:
    """What a file was when it was last read, and what was read."""

    data: bytes
    limits: tuple[int, ...]
    document: Document
    problems: tuple[Problem, ...]


_kept: dict[str, _Read] = {}
"""Documents by their files' names, the one that was read last at the end."""


def read_document(
    file: str, data: bytes, fetch: Fetch | None = None
) -> tuple[Document, list[Problem]]:
    """Read an application and check it: schema first, then meaning.

    The same bytes of the same file give the same document, as nothing changes one; only what
    each file was last is kept, and of not too many files. One that names files is read anew.

    Args:
        file: the document's name, for places.
        data: its bytes.
        fetch: gives the bytes of a file that it names; without it there are none.

    Raises:
        DocumentError: no document at all can be given: it is not XML, or not
            such a document.
    """
    limits = (LIMITS.bytes, LIMITS.elements, LIMITS.attributes, LIMITS.depth)
    read = _kept.pop(file, None)
    if read is None or read.data != data or read.limits != limits:
        read = None  # the memory of the one before is free for this one
        with few_guesses(), seldom_collected():
            document, problems, outside = _read(file, data, fetch)
        if outside:
            return document, problems
        read = _Read(data, limits, document, tuple(problems))
    _keep(file, read)
    return read.document, list(read.problems)


def _keep(file: str, read: _Read) -> None:
    """Keep a document, and drop those least recently asked for."""
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
    """The document, what is wrong with it, and whether it names files."""
    from prima.interpreter.checks import check_document

    root, problems = read_tree(file, data, DIALOGUE)
    told = bool(problems)
    builder = Builder(root, fetch)
    document = builder.document()
    problems += builder.problems
    strange = [node for node in root.walk() if not node.key] if told else []
    named = {text[1:] for node in strange for text in node.attributes.values() if text[:1] == "#"}
    found = check_document(document)
    problems += [one for one in found if not (strange and _follows(one, named))]
    return document, in_order(problems), builder.outside


def _follows(problem: Problem, named: set[str]) -> bool:
    """Whether a problem most likely follows from elements that are not understood.

    ``named`` are the forms that these name.
    """
    if problem.code == "unreachable":
        return problem.get("form") in named
    return problem.code in WHOLE
