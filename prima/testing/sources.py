"""The source lines of files."""

from __future__ import annotations

from prima.errors import DocumentError, UsageError
from prima.loading.files import read_file
from prima.markup.encodings import decode


class SourceLines:
    """The source lines of files; each file is read once."""

    def __init__(self) -> None:
        self._held: dict[str, list[str]] = {}

    def __call__(self, file: str) -> list[str]:
        """A file's lines; none if it cannot be read."""
        if file not in self._held:
            try:
                self._held[file] = decode(file, read_file(file)).split("\n")
            except (DocumentError, UsageError):
                self._held[file] = []
        return self._held[file]

    def line(self, file: str, number: int) -> str:
        """A line of a file, counted from 1; empty if there is none."""
        lines = self(file)
        return lines[number - 1] if 0 < number <= len(lines) else ""
