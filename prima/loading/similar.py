"""Guesses which file a wrong name means."""

from __future__ import annotations

from itertools import islice
from os.path import isfile
from pathlib import Path

from prima.errors import Hint, MissingFile, Span, UsageError, meant
from prima.interpreter.events import near

MOST_BESIDE = 300
"""How many files of a folder are considered in a guess."""


def nearby(path: Path, name: str, *spans: Span, listed: dict[Path, list[Path]]) -> Hint:
    """A hint that suggests the file that a wrong name most likely means.

    ``path`` is where the file would be, ``name`` how a document writes that, in the ``spans``.
    """
    folder, slash, file = name.rpartition("/")
    other = alike(path, listed)
    if not other and slash and not path.parent.is_dir() and (beside := _folder_alike(path)):
        above, slash, _ = folder.rpartition("/")
        folder, slash, other = f"{above}{slash}{beside}", "/", file
    return meant(f"{folder}{slash}{other}" if other else "", *spans)


def _folder_alike(path: Path) -> str:
    """The folder with such a file that the wrong name of its folder most likely means."""
    try:
        beside = islice(path.parent.parent.iterdir(), MOST_BESIDE)
        return near(path.parent.name, [one.name for one in beside if isfile(one / path.name)])
    except (OSError, ValueError):
        return ""


def beside(folder: Path, name: str) -> str:
    """The file that a name means with slashes for its backslashes, or in the folder itself."""
    straight = name.replace("\\", "/")
    guesses = (straight, straight.rpartition("/")[2])
    return next((one for one in guesses if one != name and isfile(folder / one)), "")


def alike(path: Path, listed: dict[Path, list[Path]]) -> str:
    """The file in the same folder that a wrong name most likely means; its suffix counts little.

    ``listed`` caches each folder's files: a document may name very many.
    """
    folder = path.parent
    if folder not in listed:
        try:
            beside = islice(folder.iterdir(), MOST_BESIDE)
            listed[folder] = sorted(one for one in beside if not one.is_dir())
        except (OSError, ValueError):
            listed[folder] = []
    files = sorted(listed[folder], key=lambda one: one.suffix == path.suffix)  # the last one counts
    stems = {one.stem: one.name for one in files if one.name != path.name}
    return stems.get(near(path.stem, stems), "")


def in_words(error: UsageError) -> str:
    """The message of a wrong use, with the name of a file like one that is not there."""
    if not isinstance(error, MissingFile):
        return str(error)
    path = Path(error.args[0])
    similar = alike(path, {})
    return f'{error} Did you mean "{path.with_name(similar)}"?' if similar else str(error)
