"""Files: the bytes of documents, and the folder whose files an application may name."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from os.path import abspath, exists, getsize, isdir, isfile, join, normpath, relpath
from pathlib import Path
from typing import Protocol
from urllib.parse import unquote, urlsplit

from prima.errors import DocumentError, MissingFile, UsageError
from prima.markup.limits import LIMITS, too_large


class Files(Protocol):
    """Replacements of files on the disk."""

    @property
    def folder(self) -> str:
        """The base of relative paths; empty for the current folder."""

    def text(self, path: Path) -> bytes | None:
        """The content of a file by its absolute path, or None to read it from the disk."""

    def head(self, path: Path) -> tuple[bytes, int] | None:
        """The first ``HEADER_BYTES`` of a file and its size, or None."""


@dataclass(frozen=True, slots=True)
class GivenFiles:
    """Contents that replace files: documents of an editor, or of another machine."""

    texts: Mapping[Path, bytes]
    """By absolute paths."""
    heads: Mapping[Path, tuple[bytes, int]] = field(default_factory=dict)
    folder: str = ""

    def text(self, path: Path) -> bytes | None:
        """The content of a file; links on the disk are followed."""
        if not self.texts:
            return None
        text = self.texts.get(path)
        return self.texts.get(path.resolve()) if text is None else text

    def head(self, path: Path) -> tuple[bytes, int] | None:
        """The first bytes of a file and its size."""
        return self.heads.get(path)


_files: ContextVar[Files | None] = ContextVar("files", default=None)


_fetched: ContextVar[dict[Path, Path] | None] = ContextVar("fetched", default=None)


@contextmanager
def noting_fetched(folders: dict[Path, Path]) -> Iterator[None]:
    """Record the files that applications fetch, each with the folder of the first such application."""
    token = _fetched.set(folders)
    try:
        yield
    finally:
        _fetched.reset(token)


@contextmanager
def in_place_of_files(files: Files) -> Iterator[None]:
    """Use contents in place of files on the disk."""
    token = _files.set(files)
    try:
        yield
    finally:
        _files.reset(token)


def check_name(path: object) -> str:
    """A path as a text; refuses anything else: a number would be a file that is open.

    Raises:
        UsageError: it is neither a text nor a path.
    """
    name = os.fspath(path) if isinstance(path, os.PathLike) else path
    if not isinstance(name, str):
        raise UsageError(f"{path!r:.80} is not a file's name.")
    return name


def is_name(name: str) -> bool:
    """Whether a file can have this name: not with NUL, or with what the system cannot encode."""
    try:
        return b"\0" not in os.fsencode(name)
    except UnicodeEncodeError:
        return False


def check_folder(path: str | Path, remedy: str) -> None:
    """Refuse a folder where a file is needed.

    Raises:
        UsageError: it is a folder; the message ends with the remedy.
    """
    if isdir(path):
        raise UsageError(f"{path}: cannot be read: it is a folder. {remedy}")


def check_path(path: object, argument: str) -> str:
    """A path as a text; refuses anything else, such as bytes.

    Raises:
        UsageError: it is neither a text nor a path, and the argument is named; or no file can
            have this name.
    """
    name = os.fspath(path) if isinstance(path, os.PathLike) else path
    if not isinstance(name, str):
        raise UsageError(f"{argument}={path!r:.80}: write a path, as a text or a Path.")
    if not is_name(name):
        raise UsageError(f"{path!r} is not a file's name.")
    return name


def paths_of(given: str | Path | Iterable[str | Path], argument: str) -> list[str]:
    """Paths as texts; one that is given alone is one, and not its letters.

    Raises:
        UsageError: one is neither a text nor a path; the argument is named.
    """
    if isinstance(given, str | bytes) or not isinstance(given, Iterable):
        given = [given]
    return [str(check_path(path, argument)) for path in given]


def texts_of(given: str | Iterable[str], argument: str) -> list[str]:
    """Several texts; one that is given alone is one, and not its letters.

    Raises:
        UsageError: one is not a text, such as bytes; the argument is named.
    """
    several = not isinstance(given, str | bytes) and isinstance(given, Iterable)
    texts = list(given) if several else [given]
    for text in texts:
        check_text(text, argument)
    return [str(text) for text in texts]


def check_text(given: object, argument: str) -> None:
    """Refuse anything but a text, such as bytes.

    Raises:
        UsageError: it is not a text; the argument is named.
    """
    if not isinstance(given, str):
        raise UsageError(f"{argument}={given!r:.80}: write a text.")


def check_texts(given: object, argument: str) -> dict[str, str]:
    """Texts by texts, checked.

    Raises:
        UsageError: it is something else; the argument is named.
    """
    if not isinstance(given, Mapping):
        raise UsageError(f"{argument}={given!r:.80}: write a dict.")
    for one in (*given, *given.values()):
        check_text(one, argument)
    return dict(given)


def absolute(path: str | Path) -> Path:
    """An absolute path without following links; relative ones start at the documents' folder."""
    files = _files.get()
    return Path(abspath(join(files.folder if files else "", path)))


def relative(path: str, folder: str) -> str:
    """A file's path in a folder above it, with ``/``."""
    return Path(relpath(path, folder or ".")).as_posix()


def _open_text(path: str | Path) -> bytes | None:
    """The replacement of a file, if any."""
    files = _files.get()
    if files is None:
        return None
    try:
        return files.text(absolute(path))
    except (OSError, ValueError, RuntimeError):
        return None


def size_of(path: str | Path) -> int | None:
    """The size of a document in bytes; None if there is no such file, nor a replacement of it."""
    text = _open_text(path)
    if text is not None:
        return len(text)
    return getsize(path) if isfile(path) else None


def read_file(path: str | Path) -> bytes:
    """Read a document's bytes, up to the limit.

    Raises:
        DocumentError: the file is larger than any document may be.
        UsageError: it cannot be read.
    """
    path = check_name(path)
    text = _open_text(path)
    if text is not None:
        if len(text) > LIMITS.bytes:
            raise too_large(path, len(text))
        return text
    data = read_bytes(path, LIMITS.bytes + 1)
    if len(data) > LIMITS.bytes:
        raise too_large(path, max(getsize(path), len(data)))
    return data


@contextmanager
def readable(path: str | Path) -> Iterator[None]:
    """Turn the system's errors while a file is read into messages.

    Raises:
        UsageError: it cannot be read.
    """
    try:
        yield
    except FileNotFoundError:
        raise MissingFile(path) from None
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror or error}.") from None
    except ValueError:
        raise UsageError(f"{path!r} is not a file's name.") from None


def read_bytes(path: str | Path, most: int = -1) -> bytes:
    """Read a file on the disk, or its beginning.

    Raises:
        UsageError: it cannot be read.
    """
    with readable(path):
        check_folder(path, "Name a file in it.")
        if exists(path) and not isfile(path):
            raise UsageError(f"{path}: cannot be read: it is not a file.")
        with open(path, "rb") as stream:
            return stream.read(most)


def at_once(path: str, flags: int) -> int:
    """An opener for ``open`` that does not wait for somebody who writes to a named pipe."""
    nonblock = getattr(os, "O_NONBLOCK", 0)  # Windows has none
    file = os.open(path, flags | nonblock)
    if nonblock:
        os.set_blocking(file, True)
    return file


def read_head(path: Path) -> tuple[bytes, int]:
    """The first ``HEADER_BYTES`` of a file, and its size.

    Raises:
        OSError: there is no such file.
    """
    from prima.voicexml.recordings import HEADER_BYTES

    if not path.is_file():
        raise FileNotFoundError("there is no such file")
    with path.open("rb") as stream:
        return stream.read(HEADER_BYTES), path.stat().st_size


@dataclass(frozen=True, slots=True)
class Folder:
    """The folder of a VoiceXML application, which may name only files in it."""

    path: str

    def fetch(self, uri: str) -> bytes:
        """The bytes of a file.

        Raises:
            FetchError: there is no such file in the folder, or it is too large.
        """
        from prima.voicexml.document import FetchError

        target = self._inside(uri)
        if (fetched := _fetched.get()) is not None:
            fetched.setdefault(target, absolute(self.path))
        try:
            return read_file(target)
        except UsageError as error:
            raise FetchError(str(error).removeprefix(f"{target}: ")) from None
        except DocumentError as error:
            raise FetchError(error.problems[0].message) from None

    def glance(self, uri: str) -> tuple[bytes, int]:
        """The first ``HEADER_BYTES`` of a file, and its size.

        Raises:
            FetchError: there is no such file in the folder.
        """
        from prima.voicexml.document import FetchError

        try:
            target = self._inside(uri)
            files = _files.get()
            return (files and files.head(target)) or read_head(target)
        except (OSError, ValueError) as error:
            raise FetchError(str(error)) from None

    def _inside(self, uri: str) -> Path:
        """The path of a file in the folder; others are refused."""
        from prima.voicexml.document import FetchError

        parts = urlsplit(uri)
        if parts.scheme not in ("", "http", "https"):
            raise FetchError(f"{parts.scheme}: is not fetched: only http:, https: and service: are")
        if parts.scheme or parts.netloc:
            raise FetchError(f"{parts.scheme or parts.netloc}: is not fetched: no network is used")
        root = absolute(self.path)
        target = Path(normpath(root / unquote(parts.path).lstrip("/")))
        try:
            inside = target.resolve().is_relative_to(root.resolve())
        except (OSError, ValueError, RuntimeError) as error:  # a NUL, cyclic links
            raise FetchError(f"it names no file: {error}") from None
        if not inside or not target.is_relative_to(root):
            raise FetchError("it is outside the application's folder")
        return target
