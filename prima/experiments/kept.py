"""Files as they were first read, for runs elsewhere."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from prima.errors import UsageError
from prima.loading.files import GivenFiles, read_head
from prima.markup.limits import LIMITS
from prima.voicexml.recordings import length_ms

MOST_SENT = 64_000_000
"""Maximum size of the documents sent to a cluster (bytes)."""
MOST_FILES = 1_000
"""Maximum number of files from folders of VoiceXML applications sent to a cluster."""


class Kept:
    """Keeps the content of every file that is read while it is in place."""

    def __init__(self) -> None:
        self.folder = os.getcwd()
        self.texts: dict[Path, bytes] = {}
        self.heads: dict[Path, tuple[bytes, int]] = {}

    def text(self, path: Path) -> bytes | None:
        """The content of a file as it was first read."""
        if path not in self.texts:
            try:
                with path.open("rb") as stream:
                    self.texts[path] = stream.read(LIMITS.bytes + 1)
            except OSError:
                return None
        return self.texts[path]

    def head(self, path: Path) -> tuple[bytes, int] | None:
        """The first bytes of a file and its size, as they were first read."""
        if path not in self.heads:
            try:
                self.heads[path] = read_head(path)
            except OSError:
                return None
        return self.heads[path]

    def keep(self, folder: str) -> None:
        """Keep all files of a folder; for sounds only their headers.

        A link that leads out of the folder is skipped: an application may not read it.

        Raises:
            UsageError: they are too many or too large.
        """
        held, root = sum(map(len, self.texts.values())), Path(self.folder, folder)
        for path in sorted(root.rglob("*")):
            inside = path.is_file() and path.resolve().is_relative_to(root.resolve())
            if inside and (head := self.head(path)):
                if length_ms(*head) is None:
                    held += len(self.text(path) or b"")
                if held > MOST_SENT or len(self.heads) > MOST_FILES:
                    raise UsageError(
                        f"{folder}: a cluster needs the files that an application may name,"
                        f" and its folder has more than {MOST_SENT // 1_000_000} MB of them,"
                        f" or more than {MOST_FILES:,}. Keep it in a folder of its own."
                    )

    @contextmanager
    def beside(self, files: Mapping[Path, bytes]) -> Iterator[None]:
        """Treat files that are yet to be written as if they existed."""
        added = {path.absolute(): data for path, data in files.items()}
        self.texts |= added
        try:
            yield
        finally:
            for path in added:
                del self.texts[path]

    def contents(self) -> GivenFiles:
        """The files that were read, for another process."""
        return GivenFiles(self.texts, self.heads, self.folder)
