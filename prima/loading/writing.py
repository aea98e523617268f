"""Files that are there as a whole or not at all, and what killed processes have left of them.

What is being written stands beside its place under a name of its own, locked by the process that
writes it. The system takes the lock off when the process ends, however it ends.
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
except ImportError:  # a system without such locks: nothing is cleaned up there
    fcntl = None  # type: ignore[assignment]

PARTS = ".prima-"
"""How the names of files and folders begin that hold what is being written."""
LOCK = "lock"
"""A folder's file that is locked as long as its process lives."""


@contextmanager
def whole(path: str | Path) -> Iterator[IO[bytes]]:
    """A file to write to, which has its name when all is written; until then the old one has it.

    What is no file, as ``/dev/null``, is written to as it is.

    Raises:
        UsageError: it cannot be written.
    """
    if "\0" in str(path):
        raise UsageError(f"{path}: cannot be written: it is no file's name.")
    try:
        with _opened(os.path.realpath(path)) as stream:
            yield stream
    except OSError as error:
        raise UsageError(f"{path}: cannot be written: {error.strerror}.") from None


def write_whole(path: str | Path, text: str) -> None:
    """Write a text as UTF-8 to a file, as a whole or not at all.

    Raises:
        UsageError: it cannot be written.
    """
    data = text.encode()
    with whole(path) as stream:
        stream.write(data)


@contextmanager
def _opened(real: str) -> Iterator[IO[bytes]]:
    there = os.path.exists(real)
    folder = os.path.dirname(real)
    if there and (not os.path.isfile(real) or not os.access(folder, os.W_OK)):
        with open(real, "wb") as plain:
            yield plain
        return
    clean_up(folder)
    part, stream = _beside(real)
    try:
        with stream:  # and so its lock is held until it is closed
            yield stream
        if there:
            os.chmod(part, stat.S_IMODE(os.stat(real).st_mode))
        os.replace(part, real)
    except BaseException:
        with suppress(OSError):
            os.unlink(part)
        raise


def _beside(real: str) -> tuple[str, IO[bytes]]:
    """A new file in the same folder, locked, with the rights that a new file has."""
    folder, name = os.path.split(real)
    short = os.fsdecode(os.fsencode(name)[:100])
    while True:
        part = os.path.join(folder, f"{PARTS}{os.getpid()}-{short}")
        with suppress(FileNotFoundError):
            os.unlink(part)  # of a process that had the same number
        stream = open(part, "xb")  # noqa: SIM115
        if _locked(stream.fileno()) and os.path.exists(part):
            return part, stream
        stream.close()


@contextmanager
def parts_folder(folder: str) -> Iterator[str]:
    """A new folder inside another for what is being written there; it is gone afterwards.

    Raises:
        OSError: there cannot be one.
    """
    os.makedirs(folder, exist_ok=True)
    clean_up(folder)
    parts, lock = _new_folder(folder)
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
            if _locked(lock) and os.path.exists(os.path.join(parts, LOCK)):
                return parts, lock
            os.close(lock)  # another process has just taken it for left over


def clean_up(folder: str) -> None:
    """Remove from a folder what processes were writing that have been killed."""
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
            if not _locked(held):
                return
            if is_folder:
                shutil.rmtree(path, ignore_errors=True)
            else:
                os.unlink(path)
        finally:
            os.close(held)


def _locked(file: int) -> bool:
    """Lock an open file; whether nobody else has it."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True  # a file system without locks
    return True
