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
"""Formats and their uses, by names that are also suffixes and modules of this package."""


@dataclass(frozen=True, slots=True)
class Exported:
    """The size of an export, and why it may be incomplete."""

    tiers: int
    marks: int
    """Intervals and points."""
    seconds: float
    cut: str = ""
    """The error in the line at which the transcript breaks off, if any."""
    early: str = ""
    """A message that the transcript ends before its run did, if so."""


def checked(name: str, languages: Mapping[str, str]) -> dict[str, str]:
    """The languages, checked with the format; see :func:`prima.api.export`.

    Raises:
        UsageError: the format is unknown, its library is missing, it has no languages,
            or a tag is malformed.
    """
    if name not in FORMATS:
        hint = did_you_mean(name, FORMATS) or f"Name {one_of(FORMATS)}."
        raise UsageError(f'Unknown format "{name}". {hint}')
    if name == "mcap" and find_spec("mcap") is None:
        raise UsageError("mcap needs another library: pip install 'prima[export]'.")
    if languages and name != "eaf":
        raise UsageError(f"--lang works only with --to eaf, not with {name}.")
    for tag in languages.values():
        if not TAG.fullmatch(tag):
            raise UsageError(f'"{tag}" is not a language tag: write one such as en or pt-BR.')
    return dict(languages)


def write(
    name: str,
    made: Timeline,
    records: Iterable[Record],
    languages: dict[str, str],
    version: str,
    out: IO[bytes],
) -> None:
    """Write a timeline in a format; ``records`` are the transcript's, read once more."""
    if name == "mcap":
        from prima.exports import mcap

        mcap.write(made, records, version, out)
        return
    pieces: Iterator[str] = import_module(f"prima.exports.{name}").write(made, languages)
    for piece in pieces:
        out.write(piece.encode("utf-8", "replace"))


__all__ = ["FORMATS", "Exported", "Timeline", "checked", "timeline", "write"]
