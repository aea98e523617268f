"""Finds the tags of a text that is being written and need not be well-formed."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from dataclasses import dataclass, field
from functools import cached_property

from prima.lsp.text import Lines
from prima.markup.limits import LIMITS
from prima.markup.vocabulary import Element, Vocabulary

PIECE = re.compile(
    r"<!--(?:.*?-->|.*)|<!\[CDATA\[(?:.*?\]\]>|.*)|<\?(?:.*?\?>|.*)|<![^>]*>?"
    r"|</(?P<end>[^\s<>/]*)[^<>]*>?|<(?P<start>[^\s<>/\"'=!?]*)",
    re.DOTALL,
)
"""A piece of markup; an unfinished one extends to the end of the text."""
ATTRIBUTE = re.compile(
    r"(?P<name>[^\s=<>/\"']+)(?P<is>\s*=\s*(?:\"(?P<double>[^\"<]*)(?P<d>\"?)"
    r"|'(?P<single>[^'<]*)(?P<s>'?))?)?"
)
"""An attribute; its value ends at the quote, or before the next tag if the quote is missing."""
NAMELESS = re.compile(r"""=\s*(?:"[^"<]*"|'[^'<]*')""")
"""A value whose name is missing."""


@dataclass(slots=True, eq=False)
class Attr:
    """An attribute: the positions of its name and value, and the value as written.

    ``first`` is -1 if there is no value.
    """

    name: str
    start: int
    end: int
    value: str
    first: int
    last: int
    closed: bool


@dataclass(slots=True, eq=False)
class ScannedTag:
    """An element as written: its start tag is ``start`` to ``end``, all of it to ``until``."""

    name: str
    start: int
    end: int
    attributes: list[Attr]
    parent: ScannedTag | None
    empty: bool = True
    finished: bool = True
    """Whether the start tag has its ``>``."""
    close: tuple[int, int] | None = None
    """The position of the name in the end tag."""
    content: int = -1
    """Where the content ends."""
    until: int = -1
    children: list[ScannedTag] = field(default_factory=list)
    namespaces: dict[str, str] = field(default_factory=dict)
    namespace: str = ""
    vocabulary: Vocabulary | None = None
    key: str = ""

    @property
    def local(self) -> str:
        """The name without its prefix."""
        return self.name.rpartition(":")[2]

    @property
    def prefix(self) -> str:
        """The prefix with its colon, or nothing."""
        return self.name[: self.name.find(":") + 1]

    @property
    def name_end(self) -> int:
        """Where the name ends in the start tag."""
        return self.start + 1 + len(self.name)

    @property
    def element(self) -> Element | None:
        """Its declaration."""
        return self.vocabulary.elements.get(self.key) if self.vocabulary else None

    def get(self, name: str) -> str:
        """An attribute's value as written."""
        attr = self.attr(name)
        return attr.value if attr else ""

    def attr(self, name: str) -> Attr | None:
        """An attribute."""
        return next((one for one in self.attributes if one.name == name), None)

    def inside(self, *keys: str) -> ScannedTag | None:
        """The nearest element of these keys around this one, itself included."""
        tag: ScannedTag | None = self
        while tag is not None and tag.key not in keys:
            tag = tag.parent
        return tag


class _Open:
    """The open elements, and the number of each name."""

    def __init__(self) -> None:
        self.tags: list[ScannedTag] = []
        self.names: Counter[str] = Counter()

    def add(self, tag: ScannedTag) -> None:
        """An element begins."""
        self.tags.append(tag)
        self.names[tag.name] += 1

    def pop(self) -> ScannedTag:
        """The innermost one ends."""
        tag = self.tags.pop()
        self.names[tag.name] -= 1
        return tag


class ScannedText:
    """A text and its tags in document order."""

    def __init__(self, text: str, lines: Lines | None = None, most: int = 0) -> None:
        self.text = text
        self.lines = lines or Lines(text)
        self.most = most or LIMITS.elements
        """Maximum number of tags."""
        self.tags: list[ScannedTag] = []
        self.ends: list[tuple[int, int, str]] = []
        """The positions of names in end tags."""
        self.asides: list[tuple[int, int]] = []
        """Comments, instructions and declarations."""
        self._scan()

    @property
    def root(self) -> ScannedTag | None:
        """The first element that is named."""
        return next((tag for tag in self.tags if tag.name), None)

    @cached_property
    def forms(self) -> dict[str, list[ScannedTag]]:
        """The forms, by their ids as written."""
        found: dict[str, list[ScannedTag]] = {}
        for tag in self.tags:
            if tag.key == "form":
                found.setdefault(tag.get("id"), []).append(tag)
        return found

    @cached_property
    def _starts(self) -> list[int]:
        """Where each tag begins."""
        return [tag.start for tag in self.tags]

    def begun(self, offset: int) -> ScannedTag | None:
        """The last element that begins at an offset or before it."""
        index = bisect_right(self._starts, offset)
        return self.tags[index - 1] if index else None

    def _scan(self) -> None:
        text, position = self.text, 0
        open_ = _Open()
        while match := PIECE.search(text, position):
            position = match.end()
            if match["end"] is not None:
                self.ends.append((*match.span("end"), match["end"]))
                self._close(open_, match)
            elif match["start"] is not None:
                tag = ScannedTag(match["start"], match.start(), match.end(), [], None)
                tag.parent = open_.tags[-1] if open_.tags else None
                position = self._attributes(tag)
                self.tags.append(tag)
                if tag.parent:
                    tag.parent.children.append(tag)
                if tag.name and not tag.empty:
                    open_.add(tag)
                if len(self.tags) >= self.most:
                    break
            elif not match[0].startswith("<![CDATA["):
                self.asides.append(match.span())
        for tag in open_.tags:
            tag.content = tag.until = len(text)

    def _attributes(self, tag: ScannedTag) -> int:
        """Read the rest of a start tag; return where it ends."""
        text, position = self.text, tag.end
        while True:
            while position < len(text) and text[position].isspace():
                position += 1
            if text.startswith("/>", position):
                position += 2
                break
            if text.startswith(">", position):
                position += 1
                tag.empty = False
                break
            match = ATTRIBUTE.match(text, position)
            if match is not None:
                group = "double" if match["double"] is not None else "single"
                first, last = match.span(group)
                closed = bool(match["d"] or match["s"])
                value = match[group] or ""
                tag.attributes.append(
                    Attr(match["name"], *match.span("name"), value, first, last, closed)
                )
                position = match.end()
            elif position >= len(text) or text[position] == "<":
                tag.finished = False
                break
            else:
                position = _after_stray(text, position)
        tag.end = tag.until = tag.content = position
        return position

    @staticmethod
    def _close(open_: _Open, match: re.Match[str]) -> None:
        """Close an element, and those open inside it."""
        if not open_.names[match["end"]]:
            return
        while True:
            tag = open_.pop()
            tag.content = match.start()
            if tag.name == match["end"]:
                tag.until, tag.close = match.end(), match.span("end")
                return
            tag.until = match.start()

    def tag_at(self, offset: int) -> ScannedTag | None:
        """The element whose start tag contains an offset after its ``<``."""
        tag = self.begun(offset - 1)
        if tag is None or not (offset < tag.end or (offset == tag.end and not tag.finished)):
            return None
        return tag

    def around(self, offset: int) -> ScannedTag | None:
        """The innermost element whose content contains an offset."""
        tag = self.begun(offset)
        while tag is not None and (tag.empty or not tag.end <= offset <= tag.content):
            tag = tag.parent
        return tag

    def aside(self, offset: int) -> bool:
        """Whether an offset is in a comment or an instruction."""
        return any(start < offset < end for start, end in self.asides)


def _after_stray(text: str, position: int) -> int:
    """Where a value without a name ends, or any other character that begins no attribute."""
    value = NAMELESS.match(text, position)
    return value.end() if value else position + 1
