"""Paths and URIs of documents, and the search for documents in folders."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator
from html import escape, unescape
from pathlib import Path
from urllib.parse import quote, unquote, urlsplit

MOST_FILES = 2_000
"""Maximum number of documents of a workspace."""
SUFFIXES = (".xml", ".vxml", ".grxml")
SKIPPED = frozenset(["node_modules", "__pycache__", "build", "dist", "target"])


def path_of(uri: str) -> Path | None:
    """The file of a URI; an untitled document gets a path of its own."""
    try:
        parts = urlsplit(uri)
    except ValueError:
        return None
    if parts.scheme == "untitled":
        return Path("/untitled", unquote(parts.path).strip("/") or "document")
    if parts.scheme != "file" or "\0" in unquote(parts.path):
        return None
    name = unquote(parts.path)
    if os.name == "nt":
        name = name.lstrip("/")
    try:
        return Path(name).resolve()
    except (OSError, ValueError, RuntimeError):
        return None


def uri_of(path: Path) -> str:
    """The URI of a file."""
    return path.as_uri() if path.is_absolute() else quote(str(path))


def file_named(folder: Path, value: str, is_uri: bool) -> Path | None:
    """The file that an attribute of a document in a folder names, by a URI or plainly."""
    name = unescape(value).strip()
    if is_uri:
        name = unquote(name.partition("#")[0].partition("?")[0])
    try:
        scheme = urlsplit(name).scheme if is_uri else ""
        return (folder / name).resolve() if name and not scheme and "\0" not in name else None
    except (OSError, ValueError, RuntimeError):
        return None


def name_for(path: Path, folder: Path, is_uri: bool) -> str:
    """A file's name, relative to a folder, as an attribute has it.

    Raises:
        ValueError: it is on another drive.
    """
    name = os.path.relpath(path, folder).replace(os.sep, "/")
    if is_uri:
        name = "".join(quote(one) if one in "%?#" else one for one in name)
    return escape(name).replace("&#x27;", "&apos;")


def walk(roots: Iterable[Path], most: int) -> Iterator[Path]:
    """Documents in folders, up to the limits, without hidden folders and build output."""
    waiting = deque(str(root) for root in roots)
    folders = files = 0
    while waiting and folders < most:
        folders += 1
        entries = _entries(waiting.popleft())
        waiting += [entry.path for entry in entries if _is_searched(entry)]
        found = [Path(entry.path).resolve() for entry in entries if _is_document(entry)]
        yield from found[: MOST_FILES - files]
        files += len(found)
        if files > MOST_FILES:
            return


def _entries(folder: str) -> list[os.DirEntry[str]]:
    """The entries of a folder by name; none if it cannot be read."""
    try:
        return sorted(os.scandir(folder), key=lambda entry: entry.name)
    except (OSError, ValueError):
        return []


def _is_searched(entry: os.DirEntry[str]) -> bool:
    hidden = entry.name.startswith(".") or entry.name in SKIPPED
    try:
        return not hidden and entry.is_dir(follow_symlinks=False)
    except OSError:
        return False


def _is_document(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.name.lower().endswith(SUFFIXES) and entry.is_file()
    except OSError:
        return False
