"""ECMAScript code as a syntax tree, by tree-sitter.

The tree tells what code is made of; whether it is ECMAScript at all the engine decides
(:mod:`prima.script.syntax`). A tree with faults in it still has the names of what is sound.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache

import tree_sitter_javascript
from tree_sitter import Language, Node, Parser, Tree

__all__ = ["MOST_CODE", "Code", "Node", "parse_expression", "parse_script"]

MOST_CODE = 1_000_000
"""Characters of code beyond which none is parsed."""
MOST_LOOKING = 100_000_000
"""Bound of the work in looking for the ends of regular expressions: the parser may read on from
each stroke to the end of its line."""
ASTRAL = re.compile("[\U00010000-\U0010ffff]")
LETTER = "\u2135"
"""A letter of 16 bits that is parsed in place of a longer one, so that offsets count characters."""


@lru_cache(maxsize=1)
def _language() -> Language:
    return Language(tree_sitter_javascript.language())


class Code:
    """A piece of code and its syntax tree."""

    __slots__ = ("_before", "_width", "root", "text")

    def __init__(self, text: str, tree: Tree, before: int, width: int) -> None:
        self.text = text
        self.root = tree.root_node
        self._before = before
        """Characters of ours before it."""
        self._width = width
        """Bytes of a character."""

    def start(self, node: Node) -> int:
        """The offset in the text at which a node starts."""
        return node.start_byte // self._width - self._before

    def end(self, node: Node) -> int:
        """The offset in the text at which a node ends."""
        return node.end_byte // self._width - self._before

    def of(self, node: Node) -> str:
        """The text of a node."""
        return self.text[self.start(node) : self.end(node)]

    @property
    def sound(self) -> bool:
        """Whether the tree has no faults but semicolons that the parser did not see to be optional."""
        if not self.root.has_error:
            return True
        return not any(
            node.is_error or (node.is_missing and node.type != ";") for node in self.walk()
        )

    def walk(self) -> Iterator[Node]:
        """All nodes, each before what it holds, in the order of the text."""
        waiting = [self.root]
        while waiting:
            node = waiting.pop()
            yield node
            waiting += reversed(node.children)


def parse_script(code: str) -> Code | None:
    """A script's tree; None for code that is too long to be parsed."""
    return _parse(code, code, 0)


def parse_expression(code: str) -> Code | None:
    """The tree of code that is one expression; where it is not, that of a script.

    None for code that is too long to be parsed.
    """
    found = _parse(code, f"({code}\n)", 1)
    if found is None or inner(found) is not None:
        return found
    return parse_script(code)


def inner(code: Code) -> Node | None:
    """The expression in the brackets around it; None where code is not one sound expression."""
    root = code.root
    if root.has_error or root.child_count != 1:
        return None
    statement = root.children[0]
    if statement.type != "expression_statement" or statement.child_count != 1:
        return None
    bracket = statement.children[0]
    if bracket.type != "parenthesized_expression" or bracket.end_byte != root.end_byte:
        return None
    held = bracket.children[1:-1]
    return held[0] if len(held) == 1 else None


def _parse(code: str, parsed: str, before: int) -> Code | None:
    if len(code) > MOST_CODE or _looking(code) > MOST_LOOKING:
        return None
    if parsed.isascii():
        return Code(code, Parser(_language()).parse(parsed.encode()), before, 1)
    data = ASTRAL.sub(LETTER, parsed).encode("utf-16-le", "surrogatepass")
    return Code(code, Parser(_language()).parse(data, encoding="utf16le"), before, 2)


def _looking(code: str) -> int:
    """How many characters may be read in looking for the ends of regular expressions."""
    if len(code) < 10_000:
        return 0
    return sum(line.count("/") * len(line) for line in code.split("\n"))
