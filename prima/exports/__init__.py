"""Transcripts in the formats of other tools: ELAN, Praat, WebVTT, Foxglove and tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import IO

from prima.errors import UsageError, did_you_mean, one_of
from prima.exports.tiers import timeline
from prima.exports.timeline import TAG, Timeline
from prima.messages import Record

FORMATS = {
    "eaf": "ELAN",
    "textgrid": "Praat",
    "vtt": "WebVTT captions",
    "mcap": "Foxglove",
    "csv": "spreadsheets and statistics",
}
"""The formats by their names, which are also the files' suffixes, and for what they are;
each is a module of this package with a function ``write``."""


@dataclass(frozen=True, slots=True)
class Exported:
    """What an export has written."""

    tiers: int
    marks: int
    """Intervals and points."""
    seconds: float
    cut: str = ""
    """What is wrong with the line at which the transcript breaks off, if it does."""
    early: str = ""
    """That the transcript ends before its run did, between two lines."""


def installed(library: str) -> bool:
    """Whether a library is there, found out without loading it."""
    try:
        return find_spec(library) is not None
    except ValueError:
        return False


def checked(name: str, languages: Mapping[str, str]) -> dict[str, str]:
    """The languages, if they and the format are right; see :func:`prima.api.export`.

    Raises:
        UsageError: there is no such format, its library is missing, it names no languages,
            or a tag is none.
    """
    if name not in FORMATS:
        hint = did_you_mean(name, FORMATS) or f"Name {one_of(FORMATS)}."
        raise UsageError(f'There is no format "{name}". {hint}')
    if name == "mcap" and not installed("mcap"):
        raise UsageError("mcap needs one more library: pip install 'prima[export]'.")
    if languages and name != "eaf":
        raise UsageError(f"Languages go with eaf; {name} does not name them: leave them out.")
    for tag in languages.values():
        if not TAG.fullmatch(tag):
            raise UsageError(f'"{tag}" is no language tag: write one as en or pt-BR.')
    return dict(languages)


def write(
    name: str,
    made: Timeline,
    records: Iterable[Record],
    languages: dict[str, str],
    version: str,
    out: IO[bytes],
) -> None:
    """Write a timeline in a format; ``records`` are the transcript's once more."""
    if name == "mcap":
        from prima.exports import mcap

        mcap.write(made, records, version, out)
        return
    pieces: Iterator[str] = import_module(f"prima.exports.{name}").write(made, languages)
    for piece in pieces:
        out.write(piece.encode("utf-8", "replace"))


__all__ = ["FORMATS", "Exported", "Timeline", "checked", "timeline", "write"]
