"""Edits of a document's text: values of attributes and texts of elements."""

from __future__ import annotations

import re
from collections.abc import Iterable
from html import escape
from typing import NamedTuple

from prima.markup.tree import MARKUP, NAME, Node

DECLARATION = re.compile(r"\A<\?xml[^>]*\?>")
SPACES = {ord(space): f"&#{ord(space)};" for space in "\t\n\r"}


class TextEdit(NamedTuple):
    """Characters of a document's text, from one offset to another, and their replacement."""

    start: int
    end: int
    text: str


def quoted(value: str) -> str:
    """An attribute's value in quotes; its tabs and line breaks stay what they are (XML, 3.3.3)."""
    return f'"{escape(value).translate(SPACES)}"'


def set_attribute(node: Node, name: str, value: str) -> TextEdit:
    """Set an attribute; an empty value removes it."""
    text = node.source.text
    if name not in node.attributes:
        tag = NAME.match(text, node.source.tag(node.index))
        assert tag is not None  # a node has a start tag
        return TextEdit(tag.end(), tag.end(), f" {name}={quoted(value)}" if value else "")
    begin = node.source.offset(node.index, name)
    inside = node.source.offset(node.index, name, value=True)
    end = text.index(text[inside - 1], inside) + 1
    return TextEdit(begin, end, f"{name}={quoted(value)}" if value else "")


def set_text(node: Node, value: str) -> TextEdit:
    """Set the text of an element that contains only text; an empty one removes the element.

    Raises:
        ValueError: it contains elements.
    """
    if node.nodes:
        raise ValueError(f"<{node.tag}> holds elements, so its text cannot be varied.")
    text, begin = node.source.text, node.source.tag(node.index)
    start = MARKUP.match(text, begin)
    assert start is not None
    close = node.source.closes.get(node.index)
    if not value:
        return TextEdit(begin, start.end() if close is None else text.index(">", close) + 1, "")
    if close is None:
        return TextEdit(start.end() - 2, start.end(), f">{escape(value, quote=False)}</{node.tag}>")
    return TextEdit(start.end(), close - 2, escape(value, quote=False))


def edited(text: str, edits: Iterable[TextEdit]) -> bytes:
    """A document's text with edits, in UTF-8.

    Edits inside an element that another edit removes are dropped. The XML declaration is removed,
    as it may name another encoding.
    """
    whole: list[TextEdit] = []
    for edit in sorted(edits):
        if not (whole and whole[-1].start < edit.start < whole[-1].end):
            whole.append(edit)
    for edit in reversed(whole):
        text = text[: edit.start] + edit.text + text[edit.end :]
    return DECLARATION.sub("", text).encode()
