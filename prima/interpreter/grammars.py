"""Grammars that a document holds, or names by their files."""

from __future__ import annotations

from collections.abc import Callable
from posixpath import dirname, join
from typing import TYPE_CHECKING

from prima.errors import Problem
from prima.grammar import GrammarError, load
from prima.grammar.dialogue import read_grammar
from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.grammar import Grammar
    from prima.grammar.dialogue import Note

Fetch = Callable[[str], bytes]
"""Gives the bytes of a file that a document names, by its path from the document's folder."""


def grammar_of(
    node: Node, lang: str, fetch: Fetch | None, note: Note, found: list[Problem]
) -> Grammar | None:
    """The grammar of an element; None where its file cannot be used, which is in ``found``."""
    if "src" not in node.attributes:
        return read_grammar(note, node)
    if _contradicts(note, node):
        return None
    try:
        grammar = load(node, base=_base(node), lang=lang, fetch=fetch, lenient=True)
    except GrammarError as error:
        found += [_placed(node, one) for one in error.problems]
        return None
    found += [_placed(node, one) for one in grammar.warnings()]
    if grammar.mode == "dtmf":
        message = f'"{node.get("src")}" is a grammar of keys; a robot has none.'
        note(node, "bad-value", message, 'Name a grammar with mode="voice".', "src")
        return None
    return grammar


def _contradicts(note: Note, node: Node) -> bool:
    """Whether an element that names a file says more than the file's name."""
    src = node.get("src").strip()
    if not src or src.startswith("#"):
        message = "src names no file."
        note(node, "bad-value", message, 'Write one such as src="names.grxml".', "src")
    elif src.startswith("builtin:"):
        message = "src names a file, and no built-in type."
        note(node, "bad-value", message, 'Write the type at the field: type="boolean".', "src")
    elif node.nodes or node.text:
        message = "<grammar> has both src and content."
        note(node, "exclusive", message, "Keep one of them.", "src")
    elif "root" in node.attributes:
        message = "root is a rule of this document, and src names a file."
        note(node, "exclusive", message, f'Write src="{src.partition("#")[0]}#RULE".', "root")
    else:
        return False
    return True


def _base(node: Node) -> str:
    return node.source.file.rpartition("/")[2]


def _placed(node: Node, problem: Problem) -> Problem:
    """A problem at its place as seen from where the document is."""
    if problem.place.file == node.source.file:
        return problem
    file = join(dirname(node.source.file), problem.place.file)
    return problem._replace(place=problem.place._replace(file=file))
