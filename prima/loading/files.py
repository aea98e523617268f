"""Files: the bytes of documents, and the folder whose files an application may name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from os.path import exists, getsize, isfile
from typing import TYPE_CHECKING

from prima.errors import DocumentError, UsageError
from prima.markup.limits import LIMITS
from prima.markup.reader import too_large

if TYPE_CHECKING:
    from pathlib import Path


_texts: ContextVar[Mapping[Path, bytes] | None] = ContextVar("texts", default=None)
"""What counts in place of files on the disk, by resolved paths."""


@contextmanager
def in_place_of_files(texts: Mapping[Path, bytes]) -> Iterator[None]:
    """Let the bytes of documents that lie open in an editor count in place of their files.

    Args:
        texts: the bytes by resolved paths.
    """
    token = _texts.set(texts)
    try:
        yield
    finally:
        _texts.reset(token)


def path_of(path: str | Path) -> Path:
    """A path as one object; whatever reads a file by its name does without these modules."""
    from pathlib import Path

    return Path(path)


def _open_text(path: str | Path) -> bytes | None:
    """What counts in place of a file, if anything does."""
    texts = _texts.get()
    if not texts:
        return None
    try:
        return texts.get(path_of(path).resolve())
    except (OSError, ValueError, RuntimeError):
        return None


def read_file(path: str | Path) -> bytes:
    """Read a document's bytes, up to the limit.

    Raises:
        DocumentError: the file is larger than any document may be.
        UsageError: it cannot be read.
    """
    text = _open_text(path)
    if text is not None:
        if len(text) > LIMITS.bytes:
            raise too_large(str(path), len(text))
        return text
    try:
        if exists(path) and not isfile(path):
            raise UsageError(f"{path}: cannot be read: it is not a file.")
        with open(path, "rb") as stream:
            data = stream.read(LIMITS.bytes + 1)
            if len(data) > LIMITS.bytes:
                raise too_large(str(path), max(getsize(path), len(data)))
            return data
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}.") from None
    except ValueError:
        raise UsageError(f"{path!r} is not a file's name.") from None


@dataclass(frozen=True, slots=True)
class Folder:
    """The folder of a VoiceXML application, which may name its files and no others."""

    path: str

    def fetch(self, uri: str) -> bytes:
        """The bytes of a file.

        Raises:
            FetchError: there is no such file in the folder, or it is too large.
        """
        from prima.voicexml.document import FetchError

        target = self._inside(uri)
        try:
            return read_file(target)
        except UsageError as error:
            raise FetchError(str(error).removeprefix(f"{target}: ")) from None
        except DocumentError as error:
            raise FetchError(error.problems[0].message) from None

    def glance(self, uri: str, most: int) -> tuple[bytes, int]:
        """The first bytes of a file, and how many it has.

        Raises:
            FetchError: there is no such file in the folder.
        """
        from prima.voicexml.document import FetchError

        try:
            target = self._inside(uri)
            if not target.is_file():
                raise FetchError("there is no such file")
            with target.open("rb") as stream:
                return stream.read(most), target.stat().st_size
        except (OSError, ValueError) as error:
            raise FetchError(str(error)) from None

    def _inside(self, uri: str) -> Path:
        """Where a file of the folder is; nothing else is looked at."""
        from urllib.parse import unquote, urlsplit

        from prima.voicexml.document import FetchError

        parts = urlsplit(uri)
        if parts.scheme not in ("", "file"):
            raise FetchError(f"{parts.scheme}: is not fetched: no network is used")
        root = path_of(self.path).resolve()
        try:
            target = (root / unquote(parts.path).lstrip("/")).resolve()
        except (OSError, ValueError, RuntimeError) as error:  # a NUL, links that lead round
            raise FetchError(f"it names no file: {error}") from None
        if root != target and root not in target.parents:
            raise FetchError("it is outside the application's folder")
        return target
