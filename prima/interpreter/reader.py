"""Reading an application: bytes in, a document and all that is wrong with it out."""

from __future__ import annotations

from prima.errors import Problem
from prima.interpreter.build import Builder
from prima.interpreter.elements import Document
from prima.interpreter.vocabulary import DIALOGUE
from prima.markup.reader import read_tree


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
    problems += check_document(document)
    return document, sorted(set(problems))
