"""A document as a tree of plain nodes with their places."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice

from prima.errors import Place, Span

MARKUP = re.compile(
    r"""<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<[!/](?:[^>"']++|"[^"]*+"|'[^']*+')*>"""
    r"""|(?P<start><)(?:[^>"']++|"[^"]*+"|'[^']*+')*>""",
    re.DOTALL,
)
"""A piece of markup of a well-formed document; a start tag has its group."""
NAME = re.compile(r"<[^\s/>]+")
ATTRIBUTE = re.compile(r"""\s*([^\s=/>"']+)\s*=\s*("[^"]*"|'[^']*')""")
PIECE = re.compile(
    r"<!--.*?-->|<\?.*?\?>|<!\[CDATA\[(?P<kept>.*?)\]\]>|&[^;]*;|(?P<plain>[^<&]+)|.", re.DOTALL
)
"""A piece of text as written: it means no character, one, or several unchanged ones."""

WORD = re.compile(r"[\w.\-]+")
"""A word of a value, such as a name."""


@dataclass(slots=True)
class Source:
    """The text of a well-formed document; places are computed on demand."""

    file: str
    text: str
    tags: list[int] = field(default_factory=list)
    """Where the elements' start tags begin in the text, in order, as far as one was asked for."""
    lines: list[int] | None = None
    """Where every line begins."""
    _attributes: tuple[int, dict[str, tuple[int, int]]] = (-1, {})
    """The element whose attributes were located last: where each begins, and its value."""
    _words: tuple[int, int, dict[str, int]] = (-1, -1, {})
    """The value in which words were located last: where it and each word begins and ends."""
    _closes: dict[int, int] | None = None
    _written: _Written | None = None
    """The text or value in which a character was located last: problems often come in groups."""

    def tag(self, index: int) -> int:
        """Where the start tag of element number ``index`` begins in the text."""
        known = len(self.tags)
        if index >= known:
            found = MARKUP.finditer(self.text, self.tags[-1] + 1 if known else 0)
            starts = (one.start() for one in found if one["start"])
            self.tags += islice(starts, max(index + 1 - known, known))
        return self.tags[index]

    @property
    def closes(self) -> dict[int, int]:
        """Where the name in each element's end tag begins, for elements with an end tag."""
        if self._closes is None:
            self._closes = dict(self._end_tags())
        return self._closes

    def _end_tags(self) -> Iterator[tuple[int, int]]:
        opened: list[int] = []
        count = 0
        for match in MARKUP.finditer(self.text):
            if match["start"]:
                if not match[0].endswith("/>"):
                    opened.append(count)
                count += 1
            elif match[0].startswith("</") and opened:
                yield opened.pop(), match.start() + 2

    def span(self, start: int, end: int) -> Span:
        """A piece of the text between two of its characters, the second one excluded."""
        first, last = self.at(start), self.at(end)
        return Span(first.line, first.column, last.line, last.column)

    def place(self, index: int, attribute: str = "", value: bool = False) -> Place:
        """The place of element number ``index``, of its attribute, or of the attribute's value."""
        return self.at(self.offset(index, attribute, value))

    def offset(self, index: int, attribute: str = "", value: bool = False) -> int:
        """The same as an offset in the text; the element's own if it has no such attribute."""
        start = self.tag(index)
        if not attribute:
            return start
        if self._attributes[0] != index:
            self._attributes = index, dict(self._attributes_of(start))
        name, text = self._attributes[1].get(attribute, (start, start))
        return text if value else name

    def words(self, first: int) -> tuple[int, dict[str, int]]:
        """The end of the value that begins at ``first``, and where each word in it begins."""
        if self._words[0] != first:
            last = self.text.find(self.text[first - 1], first)
            found: dict[str, int] = {}
            for match in WORD.finditer(self.text, first, last):
                found.setdefault(match[0], match.start())
            self._words = first, last, found
        return self._words[1:]

    def _attributes_of(self, start: int) -> Iterator[tuple[str, tuple[int, int]]]:
        """The attributes of a start tag: where each begins, and where its value does."""
        match = NAME.match(self.text, start)
        while match and (match := ATTRIBUTE.match(self.text, match.end())):
            yield match[1], (match.start(1), match.start(2) + 1)

    def inside(self, index: int, attribute: str, characters: int) -> Place:
        """The position of a character of an attribute's value or, without one, of the text."""
        if self._written is None or self._written.of != (index, attribute):
            offset = self.offset(index, attribute, value=True)
            if not attribute:
                match = MARKUP.match(self.text, offset)
                offset = match.end() if match else offset
            self._written = _Written((index, attribute), self.text, offset)
        return self.at(self._written.offset(max(characters, 0)))

    def at(self, offset: int) -> Place:
        """The place of a character of the text."""
        if self.lines is None:
            self.lines = [0, *(match.end() for match in re.finditer("\n", self.text))]
        line = bisect_right(self.lines, offset)
        return Place(self.file, line, offset - self.lines[line - 1] + 1)


class _Written:
    """A text as written, read as far as needed."""

    def __init__(self, of: tuple[int, str], text: str, offset: int) -> None:
        self.of = of
        self._text = text
        self._given = [0]
        """The number of characters before each piece."""
        self._offsets = [offset]
        """The offset of each piece's first character; the last one is that of the unread text."""
        self._end = offset

    def offset(self, characters: int) -> int:
        """The offset of a character in the document's text, or of the end."""
        while self._given[-1] <= characters and (piece := PIECE.match(self._text, self._end)):
            self._take(piece)
        at = bisect_right(self._given, characters) - 1
        if at == len(self._given) - 1:
            return self._end
        gives = self._given[at + 1] - self._given[at]
        return self._offsets[at] + (characters - self._given[at] if gives > 1 else 0)

    def _take(self, piece: re.Match[str]) -> None:
        """Read another piece."""
        kind = piece.lastgroup
        gives = len(piece[kind]) if kind else 0 if piece[0][:2] in ("<!", "<?") else 1
        self._end = piece.end()
        if gives:
            self._offsets[-1] = piece.start(kind or 0)
            self._given.append(self._given[-1] + gives)
            self._offsets.append(self._end)


class Inner(Source):
    """The text of an element as a document of its own; places are those in the outer document."""

    __slots__ = ("before", "node")

    def __init__(self, node: Node) -> None:
        text = node.own_text
        self.before = len(text) - len(text.lstrip())
        super().__init__(node.source.file, f"{text.strip()}\n")
        self.node = node

    def at(self, offset: int) -> Place:
        """The place of a character of the text."""
        return self.node.source.inside(self.node.index, "", self.before + offset)


@dataclass(slots=True, eq=False)
class Node:
    """An element: its tag (with its table key), attributes, and children in order."""

    tag: str
    source: Source
    index: int
    attributes: dict[str, str]
    key: str = ""
    namespace: str = ""
    held: list[Node | str] | Node | str | None = None
    """Its content; most elements hold nothing, or one thing, and need no list."""

    def add(self, item: Node | str) -> None:
        """Append an element or text to its content."""
        held = self.held
        if held is None:
            self.held = item
        elif isinstance(held, list):
            held.append(item)
        else:
            self.held = [held, item]

    @property
    def content(self) -> Sequence[Node | str]:
        """The elements and texts in it, in order."""
        held = self.held
        if held is None:
            return ()
        return held if isinstance(held, list) else (held,)

    @property
    def place(self) -> Place:
        """Where the element begins."""
        return self.source.place(self.index)

    def attribute_place(self, name: str, value: bool = True) -> Place:
        """The place of an attribute's value, or its name; the element's, if it lacks the attribute."""
        return self.source.place(self.index, name, value)

    def code_place(self, attribute: str, line: int, column: int) -> Place:
        """The place of a line and column of the code in an attribute, or in the text if ``""``.

        XML folds an attribute's line ends and reads references such as ``&lt;`` and
        ``&#10;`` as one character, so the code's lines need not be the file's.
        """
        text = self.attributes.get(attribute) if attribute else self.own_text
        if text is None:
            return self.place
        before = text.split("\n", line)[: line - 1] if line > 1 else ()
        characters = sum(len(one) + 1 for one in before) + max(column, 1) - 1
        return self.source.inside(self.index, attribute, min(characters, len(text)))

    def text_place(self, words: str) -> Place:
        """The place of the first of some words in the element, or else of the element."""
        first = next(iter(words.split()), "")
        written = re.compile(rf"(?<=[\s>]){re.escape(first)}(?=[\s<])")
        begin = MARKUP.match(self.source.text, self.source.tag(self.index))
        found = written.search(self.source.text, begin.end() - 1) if begin and first else None
        return self.source.at(found.start()) if found else self.place

    def place_behind(self, words: str) -> Place | None:
        """The place of the first of some words right after the element, if it is certain."""
        source, start = self.source, self.source.tag(self.index)
        tag = MARKUP.match(source.text, source.closes.get(self.index, start + 2) - 2)
        word = re.compile(rf">\s*({re.escape(next(iter(words.split()), ''))})")
        found = word.search(source.text, tag.end() - 1) if tag else None
        return source.at(found.start(1)) if found else None

    @property
    def nodes(self) -> list[Node]:
        """The child elements."""
        return [item for item in self.content if not isinstance(item, str)]

    def all(self, *tags: str) -> list[Node]:
        """The child elements of these names."""
        return [item for item in self.content if not isinstance(item, str) and item.tag in tags]

    def walk(self) -> Iterator[Node]:
        """The element and all its descendants, in document order."""
        stack = [self]
        while stack:
            node = stack.pop()
            yield node
            held = node.held
            if isinstance(held, Node):
                stack.append(held)
            elif isinstance(held, list):
                stack += reversed(node.nodes)

    def get(self, name: str, default: str = "") -> str:
        """An attribute's text."""
        return self.attributes.get(name, default)

    @property
    def own_text(self) -> str:
        """The element's own text, unchanged."""
        return "".join(item for item in self.content if isinstance(item, str))

    @property
    def text(self) -> str:
        """The element's own text, white space folded."""
        return " ".join(self.own_text.split())
