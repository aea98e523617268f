"""A document as a tree of plain nodes that know where they stand."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from xml.parsers import expat

from prima.errors import Place

NAME = re.compile(r"<[^\s/>]+")
ATTRIBUTE = re.compile(r"""\s*([^\s=/>"']+)\s*=\s*("[^"]*"|'[^']*')""")


@dataclass(slots=True)
class Source:
    """The text of a document; places are found only when somebody asks for one."""

    file: str
    text: str
    places: list[tuple[int, int]] | None = None
    """The start of every element's start tag, as (line, offset in the text), in order."""

    def _find(self) -> list[tuple[int, int]]:
        if self.places is None:
            found: list[tuple[int, int]] = []
            data = self.text.encode()
            parser = expat.ParserCreate(encoding="utf-8")

            def start(_tag: str, _attributes: dict[str, str]) -> None:
                found.append((parser.CurrentLineNumber, parser.CurrentByteIndex))

            parser.StartElementHandler = start
            try:
                parser.Parse(data, True)
            except expat.ExpatError:
                pass  # expat knows fewer letters than XML has today: the rest is not placed
            self.places = _to_characters(self.text, data, found)
        return self.places

    def place(self, index: int, attribute: str = "", value: bool = False) -> Place:
        """Where element number ``index`` stands, or its attribute, or the attribute's value."""
        places = self._find()
        if index >= len(places):
            return Place(self.file)
        line, offset = places[index]
        if attribute:
            match = NAME.match(self.text, offset)
            while match := ATTRIBUTE.match(self.text, match.end() if match else offset):
                if match[1] == attribute:
                    return self.at(match.start(2) + 1 if value else match.start(1))
        return Place(self.file, line, offset - self.text.rfind("\n", 0, offset))

    def inside(self, place: Place, characters: int) -> Place:
        """The place some characters on, line ends counted."""
        lines = self.text.split("\n")
        start = sum(len(one) + 1 for one in lines[: place.line - 1]) + place.column - 1
        return self.at(min(start + characters, len(self.text)))

    def at(self, offset: int) -> Place:
        """The place of a character of the text."""
        line = self.text.count("\n", 0, offset) + 1
        return Place(self.file, line, offset - self.text.rfind("\n", 0, offset))


def _to_characters(text: str, data: bytes, found: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Byte offsets as character offsets; the same thing in plain ASCII."""
    if len(data) == len(text):
        return found
    result: list[tuple[int, int]] = []
    byte = character = 0
    for line, offset in found:
        character += len(data[byte:offset].decode())
        byte = offset
        result.append((line, character))
    return result


@dataclass(slots=True, eq=False)
class Node:
    """An element: its tag (with its table key), attributes, and children in order."""

    tag: str
    source: Source
    index: int
    attributes: dict[str, str]
    content: list[Node | str] = field(default_factory=list)
    key: str = ""
    namespace: str = ""

    @property
    def place(self) -> Place:
        """Where the element begins."""
        return self.source.place(self.index)

    def attribute_place(self, name: str, value: bool = True) -> Place:
        """Where an attribute stands, or its value does."""
        return self.source.place(self.index, name, value)

    @property
    def nodes(self) -> list[Node]:
        """The child elements."""
        return [item for item in self.content if not isinstance(item, str)]

    def all(self, *tags: str) -> list[Node]:
        """The child elements of these names."""
        return [node for node in self.nodes if node.tag in tags]

    def get(self, name: str, default: str = "") -> str:
        """An attribute's text."""
        return self.attributes.get(name, default)

    @property
    def text(self) -> str:
        """The element's own text, white space folded."""
        return " ".join("".join(item for item in self.content if isinstance(item, str)).split())
