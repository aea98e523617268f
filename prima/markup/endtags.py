"""Remedies for start and end tags that do not match."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from xml.parsers import expat

from prima.errors import Hint, Place, nearest_word, replaced
from prima.markup.tree import MARKUP, Source
from prima.markup.vocabulary import Vocabulary

MISMATCH = r"tag mismatch: (\S+) line (\d+) and (\S+)"
"""The parser's message for a mismatched closing tag: the opening one, its line, the closing one."""
UNCLOSED = r"Premature end of data in tag (\S+) line (\d+)"
"""The parser's message for a text that ends in an element: its name and line."""


def line_of(source: Source, number: int) -> str:
    """A line of the text, counted from 1; empty after the last one."""
    lines = source.text.split("\n")
    return lines[number - 1] if number <= len(lines) else ""


def offset_of(source: Source, place: Place) -> int:
    """The offset of a place."""
    before = source.text.split("\n")[: place.line - 1]
    return sum(len(line) + 1 for line in before) + place.column - 1


def remedy(source: Source, place: Place, message: str, vocabularies: Sequence[Vocabulary]) -> Hint:
    """The remedy for the parser's message about tags that do not match; nothing for others."""
    match = re.search(MISMATCH, message) or re.search(UNCLOSED, message)
    if match is None:
        return Hint()
    name, line, end = (*match.groups(), "")[:3]
    opened = _opened(source)
    if not opened or opened[-1].tag != name:  # the parsers disagree: a name that only one takes
        return Hint(_still_open(name, line, end))
    tags = _Tags(source, offset_of(source, place), opened, name, line, end, vocabularies)
    return tags.wrong_end() or tags.stray() or tags.empty() or tags.slash() or tags.missing()


def innermost(source: Source) -> tuple[int, str]:
    """The offset and name of the innermost element open where the text is not well-formed."""
    for one in _opened(source)[-1:]:
        return _offset(source, one.at), one.tag
    return 0, ""


def _offset(source: Source, count: int) -> int:
    """The offset after a number of bytes."""
    return len(source.text.encode()[:count].decode())


def _still_open(name: str, line: str, end: str) -> str:
    if not end:
        return f"The <{name}> of line {line} is never closed: write </{name}>."
    either = f"write </{name}>, or end its own tag with />"
    return f"The <{name}> of line {line} is still open here: {either}."


@dataclass(slots=True)
class _OpenElement:
    """An element that is open where the parser stopped, or a child of one."""

    tag: str
    at: int
    """Where it begins in the text, in bytes."""
    children: list[_OpenElement] = field(default_factory=list)


def _opened(source: Source) -> list[_OpenElement]:
    """The elements that are open where the text is not well-formed, the innermost last."""
    found: list[_OpenElement] = []
    parser = expat.ParserCreate(encoding="utf-8")

    def start(tag: str, _attributes: dict[str, str]) -> None:
        element = _OpenElement(tag, parser.CurrentByteIndex)
        if found:
            found[-1].children.append(element)
        found.append(element)

    def end(_tag: str) -> None:
        found.pop().children.clear()

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    with suppress(expat.ExpatError):
        parser.Parse(source.text.encode(), True)
    return found


@dataclass(slots=True)
class _Tags:
    """The tags around a place where an element is not closed."""

    source: Source
    at: int
    opened: list[_OpenElement]
    name: str
    """The name of the innermost open element."""
    line: str
    end: str
    """The name in the end tag at the place; empty at the end of the text."""
    vocabularies: Sequence[Vocabulary]

    def wrong_end(self) -> Hint:
        """The remedy for a misspelt end tag."""
        if not nearest_word(self.end, [self.name]) or self._ends_something():
            return Hint()
        begin = self.at + len("</")
        text = f"The <{self.name}> of line {self.line} is still open here"
        text += f": write </{self.name}> instead of </{self.end}>."
        span = self.source.span(begin, begin + len(self.end))
        return replaced(text, self.name, span, title=f"Change to </{self.name}>")

    def stray(self) -> Hint:
        """The remedy for an end tag that ends nothing."""
        found = MARKUP.match(self.source.text, self.at) if self.end else None
        if found is None or self._ends_something():
            return Hint()
        text = f"No <{self.end}> is open here: write <{self.end}> where it begins"
        text += f", or remove </{self.end}>."
        span = self.source.span(*found.span())
        return replaced(text, "", span, title=f"Remove </{self.end}>")

    def _ends_something(self) -> bool:
        here = self.source.text.startswith(f"</{self.end}", self.at)
        return not here or any(one.tag == self.end for one in self.opened)

    def empty(self) -> Hint:
        """The remedy for an unclosed tag of an empty element: it should close itself."""
        alike = [own.elements[key] for own, key in self._languages()]
        if not alike or any(one.children or one.text for one in alike):
            return Hint()
        text = f"The <{self.name}> of line {self.line} holds nothing: end its own tag with />."
        _, end = self._start_tag()
        span = self.source.span(end - 1, end)
        return replaced(text, "/>", span, title=f"End <{self.name}> with />")

    def slash(self) -> Hint:
        """The remedy for an end tag without its slash."""
        start, end = self._start_tag()
        outer = self.opened[-2].tag if len(self.opened) > 1 else ""
        bare = self.source.text[start:end] == f"<{self.name}>"
        if outer != self.name or not bare or self.name in self._allowed():
            return Hint()
        text = f"The <{self.name}> of line {self.line} is inside another one"
        text += f": write </{self.name}> if it should end that one."
        span = self.source.span(start, end)
        return replaced(text, f"</{self.name}>", span, title=f"Change to </{self.name}>")

    def missing(self) -> Hint:
        """The remedy for a missing end tag.

        It comes before the first child that the element may not have; if there is none,
        before the mismatched end tag, or at the end of the text.
        """
        allowed, tags = self._allowed(), self._tags()
        children = self.opened[-1].children
        strange = (one.at for one in children if one.tag in tags - allowed)
        at = self.at if self.end else len(self.source.text.rstrip())
        if (first := next(strange, None)) is not None:
            at = len(self.source.text[: _offset(self.source, first)].rstrip())
        tag = f"</{self.name}>"
        text = _still_open(self.name, self.line, self.end)
        return replaced(text, tag, self.source.span(at, at), title=f"Write {tag}")

    def _start_tag(self) -> tuple[int, int]:
        """Where the start tag of the innermost open element begins and ends."""
        start = _offset(self.source, self.opened[-1].at)
        found = MARKUP.match(self.source.text, start)
        return start, found.end() if found else start + 1

    def _languages(self) -> list[tuple[Vocabulary, str]]:
        """The languages with an element of this name, and its keys."""
        return [
            (own, key)
            for own in self.vocabularies
            for key, one in own.elements.items()
            if one.tag == self.name
        ]

    def _allowed(self) -> set[str]:
        """The elements that may be in the innermost open one."""
        return {tag for own, key in self._languages() for tag in own.children(key)}

    def _tags(self) -> set[str]:
        """The elements of the languages to which it may belong."""
        return {tag for own, _ in self._languages() for tag in own.tags}
