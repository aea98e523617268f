"""Finding scenarios in folders."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from prima.errors import DocumentError, UsageError
from prima.loading import VOICEXML_ROOT, read_file
from prima.markup.reader import parse
from prima.testing.golden import golden_of

SCENARIO = re.compile(
    VOICEXML_ROOT.pattern.replace(b"vxml[\\s>/]", b"scenario\\s[^<]*urn:prima:scenario:"), re.DOTALL
)
"""All before a document's root element, and the beginning of a scenario's."""
GLANCE = 65_536
"""Bytes of a file that are looked at."""
PASSED_BY = frozenset({"node_modules", "__pycache__", "venv", "build", "dist"})
"""Folders in which nobody keeps scenarios; nor in those whose names begin with a dot."""


def is_scenario(path: str | Path) -> bool:
    """Whether a file is a scenario, as far as its beginning tells; no error if it is unreadable."""
    try:
        with open(path, "rb") as stream:
            data = stream.read(GLANCE)
    except (OSError, ValueError):
        return False
    if b"\0" in data[:4]:  # UTF-16
        data = data.replace(b"\0", b"")
    return SCENARIO.match(data) is not None


def find(paths: Iterable[str]) -> list[str]:
    """The scenarios that are named, and those in folders that are; each once, in order.

    Raises:
        UsageError: a path is not there, a folder holds no scenario, a file is none.
    """
    found: dict[str, None] = {}
    for path in paths:
        if not os.path.exists(path):
            raise UsageError(f"{path}: cannot be read: there is no such file or folder.")
        if not os.path.isdir(path):
            found[path] = None
            continue
        inside = list(_inside(path))
        if not inside:
            raise UsageError(
                f"{path}: holds no scenarios: XML files whose root element is <scenario>."
            )
        found.update(dict.fromkeys(inside))
    return list({os.path.realpath(path): path for path in reversed(found)}.values())[::-1]


def _inside(folder: str) -> Iterator[str]:
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(
            name for name in folders if not name.startswith(".") and name not in PASSED_BY
        )
        for name in sorted(files):
            path = os.path.normpath(os.path.join(place, name))
            if name.endswith(".xml") and is_scenario(path):
                yield path


def expects(path: Path) -> bool:
    """Whether a scenario expects more than that it runs: elements, or a table beside it.

    One that cannot be read is a test that fails.
    """
    if golden_of(path).is_file():
        return True
    try:
        root = parse(str(path), read_file(path))
    except (DocumentError, UsageError):
        return True
    return bool(root.all("expect", "never", "in-order"))
