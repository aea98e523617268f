"""Grammars that are inline in a document, or in files that it names."""

from __future__ import annotations

from collections.abc import Callable
from posixpath import dirname, join
from typing import TYPE_CHECKING

from prima.errors import Problem
from prima.errors.diagnoses.values import BAD_VALUE, EXCLUSIVE
from prima.grammar.dialogue import DialogueGrammarReader
from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.grammar import Grammar
    from prima.grammar.dialogue import Note

FOR_KEYS = BAD_VALUE.says(
    '"{name}" is a grammar of keys; a robot has none.', 'Name a grammar with mode="voice".'
)
NO_FILE = BAD_VALUE.says("src names no file.", 'Write one such as src="names.grxml".')
A_TYPE = BAD_VALUE.says(
    "src names a file, not a built-in type.", 'Write the type at the field: type="boolean".'
)
FILE_AND_CONTENT = EXCLUSIVE.says("<grammar> has both src and content.", "Keep one of them.")
FILE_AND_ROOT = EXCLUSIVE.says(
    "root is a rule of this document, and src names a file.", 'Write src="{file}#RULE".'
)
Fetch = Callable[[str], bytes]
"""Returns the bytes of a file that a document names, by its path from the document's folder."""


def grammar_of(
    node: Node, lang: str, fetch: Fetch | None, note: Note, found: list[Problem]
) -> Grammar | None:
    """The grammar of an element; None if its file cannot be used, as ``found`` reports."""
    if "src" not in node.attributes:
        return DialogueGrammarReader(note, node).grammar()
    if _contradicts(note, node):
        return None
    from prima.grammar import GrammarError, load  # few documents name files

    try:
        grammar = load(node, base=_base(node), lang=lang, fetch=fetch, lenient=True)
    except GrammarError as error:
        found += [_placed(node, one) for one in error.problems]
        return None
    found += [_placed(node, one) for one in grammar.warnings()]
    if grammar.mode == "dtmf":
        note(FOR_KEYS, node, "src", name=node.get("src"))
        return None
    return grammar


def _contradicts(note: Note, node: Node) -> bool:
    """Whether an element's src is not a file's name, or contradicts its content or root."""
    src = node.get("src").strip()
    if not src or src.startswith("#"):
        note(NO_FILE, node, "src")
    elif src.startswith("builtin:"):
        note(A_TYPE, node, "src")
    elif node.nodes or node.text:
        note(FILE_AND_CONTENT, node, "src")
    elif "root" in node.attributes:
        note(FILE_AND_ROOT, node, "root", file=src.partition("#")[0])
    else:
        return False
    return True


def _base(node: Node) -> str:
    return node.source.file.rpartition("/")[2]


def _placed(node: Node, problem: Problem) -> Problem:
    """A problem with its place relative to the document."""
    if problem.place.file == node.source.file:
        return problem
    file = join(dirname(node.source.file), problem.place.file)
    return problem._replace(place=problem.place._replace(file=file))
