"""Places in a text as the Language Server Protocol counts them."""

from __future__ import annotations

import re
from bisect import bisect_right
from itertools import accumulate

from prima.errors import Span

LINE_END = re.compile(r"\r\n|\r|\n")
UTF8, UTF16, UTF32 = "utf-8", "utf-16", "utf-32"
"""Units of columns: bytes, UTF-16 units (supported by every editor), characters."""


def _width(letter: str, encoding: str) -> int:
    if encoding == UTF32:
        return 1
    if encoding == UTF8:
        return len(letter.encode(errors="replace"))
    return 2 if letter > "\uffff" else 1


class Lines:
    """A text with its lines: lines, columns and offsets (in characters) count from 0."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.starts = [0, *(match.end() for match in LINE_END.finditer(text))]
        self._ascii = text.isascii()
        self._wide: tuple[int, str, list[int], list[int]] = (-1, "", [], [])
        """For the line in which a column was looked up last: after which letters columns differ
        from characters, and by how many units so far."""

    def _end(self, line: int) -> int:
        """The end of a line, without its line break."""
        if line + 1 >= len(self.starts):
            return len(self.text)
        end = self.starts[line + 1] - 1
        return end - (self.text[end - 1 : end + 1] == "\r\n")

    def offset(self, line: int, column: int, encoding: str = UTF16) -> int:
        """The offset of a line and a column, limited to the ends of line and text."""
        if line < 0:
            return 0
        if line >= len(self.starts):
            return len(self.text)
        start, end = self.starts[line], self._end(line)
        text = self.text[start:end]
        if text.isascii():
            return start + min(max(column, 0), len(text))
        units = 0
        for index, letter in enumerate(text):
            units += _width(letter, encoding)
            if units > column:
                return start + index
        return end

    def position(self, offset: int, encoding: str = UTF16) -> tuple[int, int]:
        """The line and column of an offset."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect_right(self.starts, offset) - 1
        column = offset - self.starts[line]
        return line, column if self._ascii else column + self._more(line, column, encoding)

    def _more(self, line: int, column: int, encoding: str) -> int:
        """The number of units minus characters before a column of a line."""
        if self._wide[:2] != (line, encoding):
            text = self.text[self.starts[line] : self._end(line)]
            wide = [(at + 1, _width(one, encoding) - 1) for at, one in enumerate(text)
                    if not one.isascii()]  # fmt: skip
            self._wide = line, encoding, [at for at, _ in wide], [*accumulate(n for _, n in wide)]
        index = bisect_right(self._wide[2], column)
        return self._wide[3][index - 1] if index else 0

    def offsets(self, span: Span) -> tuple[int, int]:
        """The offsets at which a span starts and ends."""
        start = self.place(span.line, span.column)
        return start, self.place(span.end_line, span.end_column)

    def place(self, line: int, column: int) -> int:
        """The offset of a line and column that count characters from 1."""
        line = max(line, 1) - 1
        if line >= len(self.starts):
            return len(self.text)
        mark = line == 0 and self.text.startswith("\ufeff")  # columns do not count it
        return min(self.starts[line] + mark + max(column, 1) - 1, self._end(line))
