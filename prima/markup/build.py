"""Well-formed text as nodes, by expat: fast, and with no message of its own."""

from __future__ import annotations

from typing import Any
from xml.parsers import expat

from prima.markup.limits import LIMITS
from prima.markup.tree import Node, Source

MAX_NAME = 1_000
PREFIXES = {
    "http://www.w3.org/XML/1998/namespace": "xml:",
    "http://www.w3.org/2001/XMLSchema-instance": "xsi:",
}
"""Namespaces of attributes that documents write with these prefixes."""


class TooMuch(Exception):
    """A limit is reached at a node; ``what`` is ``depth``, ``elements``, ``attributes`` or ``name``."""

    def __init__(self, node: Node, what: str) -> None:
        super().__init__(what)
        self.node = node
        self.what = what


class Unclear(Exception):
    """What needs a parser that explains itself: a DOCTYPE, or text that is not well-formed.

    ``line`` and ``column`` count from 1.
    """

    def __init__(self, line: int = 1, column: int = 1) -> None:
        super().__init__(line, column)
        self.line = line
        self.column = column


def attribute_name(name: str) -> str:
    """An attribute's name as documents write it, of expat's ``URI}NAME``."""
    namespace, mark, local = name.rpartition("}")
    if not mark:
        return name
    prefix = PREFIXES.get(namespace)
    return prefix + local if prefix else f"{{{namespace}}}{local}"


class _Builder:
    """Takes expat's calls."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.count = 0
        self.top: list[Node | str] = []
        self.open = [self.top]
        """The contents of the elements that are open."""
        self.names: dict[str, tuple[str, str]] = {}
        self.plain: set[str] = set()
        """Names of attributes that are of no namespace."""
        self.most = LIMITS.elements
        self.widest = LIMITS.attributes
        self.deepest = LIMITS.depth

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        known = self.names.get(tag)
        if known is None:
            namespace, _, name = tag.rpartition("}")
            known = self.names[tag] = (name, namespace)
        if not self.plain.issuperset(attributes):
            attributes = {attribute_name(key): text for key, text in attributes.items()}
            self.plain.update(key for key in attributes if ":" not in key and "}" not in key)
        content: list[Node | str] = []
        node = Node(known[0], self.source, self.count, attributes, content, "", known[1])
        opened = self.open
        opened[-1].append(node)
        opened.append(content)
        self.count += 1
        if len(tag) > MAX_NAME:
            raise TooMuch(node, "name")
        if len(attributes) > self.widest:
            raise TooMuch(node, "attributes")
        if self.count > self.most:
            raise TooMuch(node, "elements")
        if len(opened) > self.deepest + 1:
            raise TooMuch(node, "depth")

    def end(self, _tag: str) -> None:
        self.open.pop()

    def text(self, data: str) -> None:
        self.open[-1].append(data)

    def unclear(self, *_: Any) -> None:
        raise Unclear


def build(source: Source, doctype: bool = False) -> Node:
    """The root element of a document's text; ``doctype`` says whether it may have a DOCTYPE.

    Raises:
        TooMuch: it is beyond a limit.
        Unclear: it is not well-formed, or has a DOCTYPE that it may not have.
    """
    if "\0" in source.text:  # by which expat would guess another encoding
        raise Unclear
    data = source.text.encode()
    builder = _Builder(source)
    parser = expat.ParserCreate("utf-8", "}")
    parser.buffer_text = True
    parser.buffer_size = max(len(data), 1)
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.text
    if not doctype:
        parser.StartDoctypeDeclHandler = builder.unclear
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise Unclear(error.lineno, error.offset + 1) from None
    root = builder.top[0]
    assert isinstance(root, Node)
    return root
