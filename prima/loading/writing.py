"""Writes files as a whole or not at all, and removes leftovers of killed processes.

A file is written beside its destination under a temporary name, locked by the writing process.
The system releases the lock when the process ends, however it ends.
"""

from __future__ import annotations

import os
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import mkdtemp
from typing import IO

from prima.errors import UsageError

try:
    import fcntl
except ImportError:  # a system without such locks, where nothing is cleaned up
    fcntl = None  # type: ignore[assignment]

PARTS = ".prima-"
"""The prefix of temporary files and folders."""
LOCK = "lock"
"""The file in a folder that is locked as long as its process lives."""


@contextmanager
def whole(path: str | Path) -> Iterator[IO[bytes]]:
    """A file to write to, which replaces the old one when it is complete.

    A device, such as ``/dev/null``, is written to directly.

    Raises:
        UsageError: it cannot be written.
    """
    _check_name(path)
    try:
        with _opened(path) as stream:
            yield stream
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}.") from None


def make_folder(path: str | Path) -> None:
    """Make a folder, and those that it is in, unless it is there.

    Raises:
        UsageError: it cannot be made.
    """
    _check_name(path)
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise UsageError(f"{path}: a file is where a folder is needed. Name another.") from None
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}.") from None


def _check_name(path: str | Path) -> None:
    try:
        name = os.fsencode(path)
    except UnicodeEncodeError:
        name = b""
    if not name or b"\0" in name:
        raise UsageError(f'"{path}" cannot be written: it is not a file name.')


def write_whole(path: str | Path, content: str | bytes) -> None:
    """Write bytes, or a text as UTF-8, to a file, as a whole or not at all.

    Raises:
        UsageError: it cannot be written.
    """
    data = content.encode() if isinstance(content, str) else content
    with whole(path) as stream:
        stream.write(data)


@contextmanager
def _opened(path: str | Path) -> Iterator[IO[bytes]]:
    real = os.path.realpath(path)
    there = os.path.isfile(real)
    folder = os.path.dirname(real)
    if not _can_be_replaced(path) or (there and not os.access(folder, os.W_OK)):
        with open(path, "wb") as plain:
            yield plain
        return
    clean_up(folder)
    part, stream = _beside(real)
    try:
        with stream:  # so its lock is held until it is closed
            yield stream
        if there:
            os.chmod(part, stat.S_IMODE(os.stat(real).st_mode))
        os.replace(part, real)
    except BaseException:
        with suppress(OSError):
            os.unlink(part)
        raise


def _can_be_replaced(path: str | Path) -> bool:
    """Whether a path names a regular file, or one that is not there yet.

    A pipe such as ``/dev/stdout`` has a real path that names nothing, and a loop of links none.
    """
    there = os.path.exists(path) or os.path.lexists(os.path.realpath(path))
    names_folder = os.fspath(path).endswith((os.sep, "/"))
    return os.path.isfile(path) or not (there or names_folder)


def _beside(real: str) -> tuple[str, IO[bytes]]:
    """A new file in the same folder, locked, with the default permissions."""
    folder, name = os.path.split(real)
    short = os.fsdecode(os.fsencode(name)[:100])
    while True:
        part = os.path.join(folder, f"{PARTS}{os.getpid()}-{short}")
        with suppress(FileNotFoundError):
            os.unlink(part)  # of an earlier process with the same id
        stream = open(part, "xb")  # noqa: SIM115
        if locked(stream.fileno()) and os.path.exists(part):
            return part, stream
        stream.close()


@contextmanager
def parts_folder(folder: str) -> Iterator[str]:
    """A temporary folder inside another for transcripts being written there.

    Raises:
        UsageError: it cannot be made.
    """
    try:
        os.makedirs(folder, exist_ok=True)
        clean_up(folder)
        parts, lock = _new_folder(folder)
    except FileExistsError:
        raise UsageError(f"{folder}: this is a file; several transcripts need a folder.") from None
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written: {error.strerror}.") from None
    try:
        yield parts
    finally:
        shutil.rmtree(parts, ignore_errors=True)
        os.close(lock)


def _new_folder(folder: str) -> tuple[str, int]:
    while True:
        parts = mkdtemp(prefix=PARTS, dir=folder)
        with suppress(FileNotFoundError):
            lock = os.open(os.path.join(parts, LOCK), os.O_CREAT | os.O_RDWR, 0o600)
            if locked(lock) and os.path.exists(os.path.join(parts, LOCK)):
                return parts, lock
            os.close(lock)  # another process has just taken it for a leftover


def clean_up(folder: str) -> None:
    """Remove leftovers of killed processes from a folder."""
    if fcntl is None:
        return
    with suppress(OSError):
        for entry in os.scandir(folder or "."):
            if entry.name.startswith(PARTS) and not entry.is_symlink():
                _remove_if_left(entry.path, entry.is_dir())


def _remove_if_left(path: str, is_folder: bool) -> None:
    with suppress(OSError):
        held = os.open(os.path.join(path, LOCK) if is_folder else path, os.O_RDWR)
        try:
            if not locked(held):
                return
            if is_folder:
                shutil.rmtree(path, ignore_errors=True)
            else:
                os.unlink(path)
        finally:
            os.close(held)


def locked(file: int) -> bool:
    """Lock an open file; gives whether it was free."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True  # a file system without locks
    return True
