"""Finding scenarios in folders."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path

from prima.errors import DocumentError, UsageError, did_you_mean
from prima.loading.files import read_file
from prima.markup.reader import parse
from prima.markup.sniff import root_of
from prima.markup.toml import NotToml, parse_toml
from prima.testing.golden import golden_of

SCENARIO = re.compile(rb"<(?:[\w.-]+:)?scenario\s[^<]*urn:prima:scenario:")
"""The beginning of a scenario's root element."""
GLANCE = 65_536
"""Bytes of a file that are searched."""
SKIPPED = frozenset({"node_modules", "__pycache__", "venv", "build", "dist"})
"""Folders that are not searched; nor are those whose names begin with a dot."""


def is_scenario(path: str | Path) -> bool:
    """Whether a file begins as a scenario; false if it is unreadable."""
    if not os.path.isfile(path):
        return False  # reading a device might never end
    try:
        with open(path, "rb") as stream:
            data = stream.read(GLANCE)
    except (OSError, ValueError):
        return False
    return SCENARIO.match(root_of(data)) is not None


def find(paths: Iterable[str]) -> list[str]:
    """The scenarios named, and those in folders named; each once, in order.

    Raises:
        UsageError: a path does not exist, or a folder contains no scenario.
    """
    found: dict[str, None] = {}
    for path in paths:
        if not os.path.exists(path):
            raise UsageError(f"{path}: no such file or folder.")
        if not os.path.isdir(path):
            found[path] = None
            continue
        ignored = IgnoreList.of(path)
        inside = list(_inside(path, ignored))
        if not inside:
            but = f" {ignored.file} excludes some." if ignored.used else ""
            raise UsageError(
                f"{path}: contains no scenarios (XML files whose root element is <scenario>).{but}"
            )
        found.update(dict.fromkeys(inside))
    return list({os.path.realpath(path): path for path in reversed(found)}.values())[::-1]


class IgnoreList:
    """Patterns of paths that a project excludes from its tests, in its pyproject.toml.

    ``file`` is that file; ``used`` is true once anything has been excluded.
    """

    def __init__(self, file: str = "", patterns: Iterable[str] = ()) -> None:
        self.file = file
        self.used = False
        self._root = os.path.realpath(os.path.dirname(file) or ".")
        self._patterns = [_glob(_from(self._root, pattern)) for pattern in patterns]

    @classmethod
    def of(cls, folder: str) -> IgnoreList:
        """The list of the nearest pyproject.toml, in a folder or above it.

        Raises:
            UsageError: the file cannot be read, or its [tool.prima] is wrong.
        """
        here = Path(os.path.realpath(folder))
        for place in (here, *here.parents):
            file = place / "pyproject.toml"
            if file.is_file():
                return cls(os.path.relpath(file), _patterns(file))
        return cls()

    def __call__(self, path: str) -> bool:
        """Whether a file or folder is excluded."""
        if not self._patterns:
            return False
        inside = _from(self._root, os.path.realpath(path))
        left = any(fnmatchcase(inside, pattern) for pattern in self._patterns)
        self.used = self.used or left
        return left


def _from(folder: str, path: str) -> str:
    """A path from a folder on, with ``/``; a relative one begins there."""
    return os.path.relpath(os.path.join(folder, path), folder).replace(os.sep, "/")


def _glob(path: str) -> str:
    """A pattern for :mod:`fnmatch` in which only ``*`` matches other letters."""
    return re.sub(r"[?[]", r"[\g<0>]", path)


def _patterns(file: Path) -> list[str]:
    """``ignore`` of [tool.prima].

    Raises:
        UsageError: it cannot be read, or is not a list of strings.
    """
    shown = os.path.relpath(file)
    try:
        tools = parse_toml(shown, read_file(file))[1].get("tool", {})
    except NotToml as error:
        raise UsageError(str(error)) from None
    settings = tools.get("prima", {}) if isinstance(tools, dict) else tools
    if not isinstance(settings, dict):
        raise UsageError(f"{shown}: tool.prima must be a table: write [tool.prima].")
    for name in settings:
        if name != "ignore":
            hint = did_you_mean(name, ["ignore"]) or "Its only setting is ignore."
            raise UsageError(f'{shown}: [tool.prima] has no "{name}". {hint}')
    patterns = settings.get("ignore", [])
    if not isinstance(patterns, list) or not all(isinstance(one, str) for one in patterns):
        raise UsageError(f'{shown}: ignore must be a list of paths: write ignore = ["drafts"].')
    return patterns


def _inside(folder: str, ignored: IgnoreList) -> Iterator[str]:
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".")
            and name not in SKIPPED
            and not ignored(os.path.join(place, name))
        )
        for name in sorted(files):
            path = os.path.normpath(os.path.join(place, name))
            if name.endswith(".xml") and is_scenario(path) and not ignored(path):
                yield path


def expects(path: Path) -> bool:
    """Whether a scenario has expectations: elements, or a table beside it.

    An unreadable one counts as a test, which fails.
    """
    if golden_of(path).is_file():
        return True
    try:
        root = parse(str(path), read_file(path))
    except (DocumentError, UsageError):
        return True
    return bool(root.all("expect", "never", "in-order"))
