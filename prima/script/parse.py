"""ECMAScript code as a syntax tree, by tree-sitter.

The tree shows the structure of code; whether it is valid ECMAScript is decided by the engine
(:mod:`prima.script.syntax`). A tree with faults still has the names in its sound parts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Literal

import tree_sitter_javascript
from tree_sitter import Language, Parser, Tree
from tree_sitter import Node as Node  # for those who walk the tree

MOST_CODE = 300_000
"""Maximum length of code that is parsed."""
DEEPEST = 1_000
"""Maximum nesting of brackets in code that is parsed: the parser is recursive."""
CHUNK = 1_024
"""Bytes passed to the parser at once."""
MOST_READ = 8
"""How often the parser may read code on average: in code with many faults it rereads the same
pieces in search of the ends of texts, comments and regular expressions."""
MOST_STEPS = 0.1
"""Hundreds of steps that the parser may take per byte; code without faults takes half as many."""
SHORT = 100
"""Bytes of code up to which work is not counted: counting takes as long as parsing."""
LINE_END = re.compile("[\\n\\r\u2028\u2029]")
BRACKET = re.compile(r"[()\[\]{}]")
CLOSING = {"(": ")", "[": "]", "{": "}", "${": "}"}
"""The brackets that open, each with the one that closes it."""
ESCAPE = re.compile(r"\\u(?:([0-9A-Fa-f]{4})|\{0*([0-9A-Fa-f]{1,5})\})")
ASTRAL = re.compile("[\U00010000-\U0010ffff]")
LETTER = "\u2135"
"""A 16-bit letter that replaces longer ones for the parser, so that offsets count characters."""


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
        """The number of characters that precede the code."""
        self._width = width
        """Bytes per character."""

    def start(self, node: Node) -> int:
        """The offset in the text at which a node starts."""
        return node.start_byte // self._width - self._before

    def end(self, node: Node) -> int:
        """The offset in the text at which a node ends."""
        return node.end_byte // self._width - self._before

    def of(self, node: Node) -> str:
        """The text of a node."""
        return self.text[self.start(node) : self.end(node)]

    def name(self, node: Node) -> str:
        """The name that a node is, whatever letters of it are written as ``\\u0061``."""
        text = self.of(node)
        if "\\" not in text:
            return text
        return ESCAPE.sub(lambda found: chr(int(found[1] or found[2], 16)), text)

    @property
    def sound(self) -> bool:
        """Whether the tree has no faults except semicolons that may be left out.

        Those at the end of a line, of a block or of the code (ECMAScript 5.1, 7.9).
        """
        end, missing = 0, False
        for node in self.walk() if self.root.has_error else ():
            if node.is_error or (node.is_missing and node.type != ";"):
                return False
            if node.child_count or node.type == "comment":
                continue
            behind = self.text[end : self.start(node)]
            if missing and node.type != "}" and not LINE_END.search(behind):
                return False
            missing = node.is_missing
            end = end if missing else self.end(node)
        return True

    def walk(self) -> Iterator[Node]:
        """All nodes in the order of the text, parents first."""
        return (node for node, _ in self.walk_inside())

    def walk_inside(self) -> Iterator[tuple[Node, Node | None]]:
        """All nodes in the order of the text, each with its parent.

        ``Node.parent`` takes a time that grows with the depth, as it begins at the root.
        """
        waiting: list[tuple[Node, Node | None]] = [(self.root, None)]
        while waiting:
            node, parent = waiting.pop()
            yield node, parent
            waiting += [(child, node) for child in reversed(node.children)]


def parse_script(code: str) -> Code | None:
    """A script's tree; None for code that is too long to be parsed."""
    return _parse(code, code, 0)


def parse_expression(code: str) -> Code | None:
    """The tree of code as one expression, or else as a script.

    None for code that is too long to be parsed.
    """
    found = parse_bracketed(code)
    if found is None or inner(found) is not None:
        return found
    return parse_script(code)


@lru_cache(maxsize=2)
def parse_bracketed(code: str) -> Code | None:
    """The tree of any code in brackets; the last one is cached."""
    return _parse(code, f"({code}\n)", 1)


def lone_bracket(code: str) -> tuple[str, int] | None:
    """The first bracket of a script that closes nothing, or else the last one that is not closed.

    With its offset; None if there is none.
    """
    tree = parse_script(code)
    if tree is None:
        return None
    opened: list[tuple[str, int]] = []
    for node in tree.walk():
        if node.is_missing or node.child_count:
            continue
        if node.type in CLOSING:
            opened.append((node.type, tree.start(node)))
        elif node.type in CLOSING.values():
            if not opened or CLOSING[opened[-1][0]] != node.type:
                return node.type, tree.start(node)
            opened.pop()
    return opened[-1] if opened else None


def spliced(code: str, edits: Iterable[tuple[int, int, str]]) -> str:
    """Code with edits in order: start, end and new text."""
    pieces, at = [], 0
    for start, end, text in edits:
        pieces += [code[at:start], text]
        at = end
    return "".join([*pieces, code[at:]])


def inner(code: Code) -> Node | None:
    """The expression inside the brackets; None if the code is not one sound expression."""
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
    if len(code) > MOST_CODE or _depth(code) > DEEPEST:
        return None
    if parsed.isascii():
        tree = _Reading(parsed.encode()).tree("utf8")
        return None if tree is None else Code(code, tree, before, 1)
    data = ASTRAL.sub(LETTER, parsed).encode("utf-16-le", "surrogatepass")
    tree = _Reading(data).tree("utf16le")
    return None if tree is None else Code(code, tree, before, 2)


class _Reading:
    """Passes code to the parser, and counts its work, which is the same for the same code."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.reads = MOST_READ * (len(data) // CHUNK + 8)
        self.steps = MOST_STEPS * len(data) + 100
        """The number of steps left."""

    def tree(self, encoding: Literal["utf8", "utf16le"]) -> Tree | None:
        """The tree of the code; None if it takes too much work."""
        parser = Parser(_language())
        if len(self.data) <= SHORT:
            return parser.parse(self.data, encoding=encoding)
        try:
            made = parser.parse(self._read, encoding=encoding, progress_callback=self._stops)
        except ValueError:  # it was stopped
            return None
        return made if self.reads >= 0 else None

    def _read(self, at: int, _point: object) -> bytes:
        self.reads -= 1
        return self.data[at : at + CHUNK] if self.reads >= 0 else b""

    def _stops(self, _at: int, _error: bool) -> bool:
        self.steps -= 1
        return self.steps < 0 or self.reads < 0


def _depth(code: str) -> int:
    """The maximum nesting of brackets, including those in texts and comments."""
    if len(code) <= DEEPEST:
        return 0
    depth = deepest = 0
    for bracket in BRACKET.findall(code):
        depth = depth + 1 if bracket in "([{" else max(depth - 1, 0)
        deepest = max(deepest, depth)
    return deepest
