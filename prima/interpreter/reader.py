"""Reading an application: bytes in, a document and all that is wrong with it out."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import Problem
from prima.interpreter.build import Builder
from prima.interpreter.elements import Document
from prima.interpreter.vocabulary import DIALOGUE
from prima.markup.reader import read_tree
from prima.markup.tree import Node

WHOLE = ("dead-end", "endless", "unknown-event", "unheard-event", "no-noinput")
"""Codes of what a whole document lacks, which may stand in an element that is not understood."""


def read_document(file: str, data: bytes) -> tuple[Document, list[Problem]]:
    """Read an application and check it: schema first, then meaning.

    Raises:
        DocumentError: no document at all can be given: it is not XML, or not
            such a document.
    """
    from prima.interpreter.checks import check_document

    root, problems = read_tree(file, data, DIALOGUE)
    builder = Builder(root)
    document = builder.document()
    problems += builder.problems
    strange = list(_strange(root))
    named = {text[1:] for node in strange for text in node.attributes.values() if text[:1] == "#"}
    found = check_document(document)
    problems += [one for one in found if not (strange and _follows(one, named))]
    return document, sorted(set(problems))


def _strange(root: Node) -> Iterator[Node]:
    """The elements that are not understood, with all that they hold."""
    stack = [(root, False)]
    while stack:
        node, strange = stack.pop()
        strange = strange or not node.key
        if strange:
            yield node
        stack += [(child, strange) for child in node.nodes]


def _follows(problem: Problem, named: set[str]) -> bool:
    """Whether a problem most likely follows from elements that are not understood.

    ``named`` are the forms that these name.
    """
    if problem.code == "unreachable":
        return problem.message.partition('"')[2].partition('"')[0] in named
    return problem.code in WHOLE
