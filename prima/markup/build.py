"""Parses well-formed text to nodes with expat: fast, and without messages."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from xml.parsers import expat

from prima.markup.limits import LIMITS
from prima.markup.tree import Node, Source

MAX_NAME = 1_000
PREFIXES = {
    "http://www.w3.org/XML/1998/namespace": "xml:",
    "http://www.w3.org/2001/XMLSchema-instance": "xsi:",
}
"""Namespaces of attributes with predefined prefixes."""


class LimitReached(Exception):
    """A limit is reached at a node; ``what`` is ``depth``, ``elements``, ``attributes`` or ``name``."""

    def __init__(self, node: Node, what: str) -> None:
        super().__init__(what)
        self.node = node
        self.what = what


class Unclear(Exception):
    """The text has a DOCTYPE, or is not well-formed: a parser with messages is needed.

    ``line`` and ``column`` count from 1.
    """

    def __init__(self, line: int = 1, column: int = 1) -> None:
        super().__init__(line, column)
        self.line = line
        self.column = column


def attribute_name(name: str) -> str:
    """An attribute's name as documents write it, from expat's ``URI}NAME``."""
    namespace, mark, local = name.rpartition("}")
    if not mark:
        return name
    prefix = PREFIXES.get(namespace)
    return prefix + local if prefix else f"{{{namespace}}}{local}"


Start = Callable[[str, dict[str, str]], None]
"""A handler of start tags: the element's name and its attributes."""


def _starter(source: Source, opened: list[Node]) -> Start:
    """A handler that makes nodes of start tags; ``opened`` are the open elements.

    It is called for every element; local variables of this function make it fast.
    """
    names: dict[str, tuple[str, str]] = {}
    plain: set[str] = set()  # attributes without a namespace
    most, widest, deepest = LIMITS.elements, LIMITS.attributes, LIMITS.depth + 1
    count = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        known = names.get(tag)
        if known is None:
            namespace, _, name = tag.rpartition("}")
            known = names[tag] = (name, namespace)
            if len(tag) > MAX_NAME:
                raise LimitReached(Node(name, source, count, attributes), "name")
        if not plain.issuperset(attributes):
            attributes = {attribute_name(key): text for key, text in attributes.items()}
            plain.update(key for key in attributes if ":" not in key and "}" not in key)
        node = Node(known[0], source, count, attributes, "", known[1])
        opened[-1].add(node)
        opened.append(node)
        count += 1
        if len(attributes) > widest:
            raise LimitReached(node, "attributes")
        if count > most:
            raise LimitReached(node, "elements")
        if len(opened) > deepest:
            raise LimitReached(node, "depth")

    return start


def _unclear(*_: Any) -> None:
    raise Unclear


def build(source: Source, doctype: bool = False) -> Node:
    """The root element of a document's text; ``doctype`` says whether it may have a DOCTYPE.

    Raises:
        LimitReached: it exceeds a limit.
        Unclear: it is not well-formed, or has a DOCTYPE that is not allowed.
    """
    if "\0" in source.text:  # from which expat would guess another encoding
        raise Unclear
    data = source.text.encode()
    top = Node("", source, -1, {})
    opened = [top]
    parser = expat.ParserCreate("utf-8", "}")
    parser.buffer_text = True
    parser.buffer_size = max(len(data), 1)
    parser.StartElementHandler = _starter(source, opened)
    parser.EndElementHandler = lambda _: opened.pop()
    parser.CharacterDataHandler = lambda text: opened[-1].add(text)
    if not doctype:
        parser.StartDoctypeDeclHandler = _unclear
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise Unclear(error.lineno, error.offset + 1) from None
    return top.nodes[0]
