"""Views of transcripts, and explanations of codes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from os.path import exists, isfile, samefile
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

from prima.api.transcripts import Transcript, check_transcripts, ends_early, read, records_of
from prima.errors import UsageError, did_you_mean
from prima.messages import Record
from prima.version import __version__

if TYPE_CHECKING:
    from prima.exports import Exported
    from prima.transcript.diff import Difference

# Modules that only some functions need are imported there, so that short commands start quickly.


def export(
    transcript: Transcript | str | Path,
    to: str,
    output: str | Path | IO[bytes],
    languages: Mapping[str, str] | None = None,
) -> Exported:
    """Write a transcript in another tool's format (docs/exports.md).

    Args:
        transcript: a transcript, or the path of one, which is read in pieces up to its first
            unreadable line.
        to: the format's name, such as ``eaf``; docs/exports.md lists all.
        output: the path of the file to write, or a binary stream.
        languages: language tags (BCP 47) by application; the empty name means the
            user and all other applications.

    Raises:
        UsageError: a format, tag or application is unknown, or a file is unreadable or
            unwritable.
    """
    from prima.exports import Exported, checked, timeline, write
    from prima.loading.files import check_name, check_text, check_texts

    check_text(to, "to")
    path = None if _is_stream(output) else check_name(output)
    tags = checked(to, check_texts({} if languages is None else languages, "languages"))
    held = _in_memory(transcript)
    name = held.name if held else check_name(transcript)
    cut = [held.cut] if held and held.cut else []

    def records(cuts: list[str]) -> Iterable[Record]:
        return records_of(name, cuts) if held is None else held.kept()

    made = timeline(name, records(cut))
    made.check_names(tags)
    made.parts()  # may raise, before a file is overwritten
    stream = cast("IO[bytes]", output)
    with nullcontext(stream) if path is None else _output(path, name) as stream:
        write(to, made, records([]), tags, __version__, stream)
    early = ends_early(name, made.end / 1000) if made.head and not made.over and not cut else ""
    return Exported(len(made.tiers), made.marks, made.end / 1000, " ".join(cut), early)


def _is_stream(output: object) -> bool:
    """Whether an output is a stream, and not a path.

    Raises:
        UsageError: it is a stream that takes no bytes, or is closed.
    """
    if not hasattr(output, "write"):
        return False
    if hasattr(output, "encoding"):
        raise UsageError('output takes bytes: open the file with mode "wb".')
    if getattr(output, "closed", False):
        raise UsageError("output is closed: export to it while it is open.")
    if hasattr(output, "writable") and not output.writable():
        raise UsageError('output can only be read: open the file with mode "wb".')
    return True


def _in_memory(transcript: Transcript | str | Path) -> Transcript | None:
    """A transcript that is given, or comes from a pipe, which can be read only once."""
    from prima.loading.files import check_name

    if isinstance(transcript, Transcript):
        return transcript
    return None if isfile(check_name(transcript)) else read(transcript, partial=True)


def _output(path: str, transcript: str) -> AbstractContextManager[IO[bytes]]:
    """A file to write an export to.

    Raises:
        UsageError: it is the transcript.
    """
    from prima.loading.writing import whole

    if exists(path) and exists(transcript) and samefile(path, transcript):
        raise UsageError(f"{path}: this is the transcript itself: name another file.")
    return whole(path)


def diff(before: Transcript, after: Transcript) -> Difference:
    """Compare two transcripts by behaviour.

    Raises:
        UsageError: one is not a transcript, or its records were not kept.
    """
    from prima.transcript.diff import compare

    check_transcripts(before, after)
    difference = compare(before.rows(), after.rows())
    difference.before, difference.after = before.summary(), after.summary()
    return difference


def explain(code: str) -> str:
    """The meaning of a problem's code.

    Raises:
        UsageError: the code is unknown.
    """
    from prima.checks.codes import diagnoses
    from prima.loading.files import check_text

    check_text(code, "code")
    found = diagnoses()
    if code not in found:
        raise UsageError(f'There is no code "{code}". {did_you_mean(code, found)}'.rstrip())
    return found[code].meaning


def explain_row(transcript: Transcript, number: int) -> str:
    """The reasons for the time of a row of a transcript's table.

    Raises:
        UsageError: there is no such row.
    """
    from prima.transcript.why import explained

    check_transcripts(transcript)
    return "\n".join(explained(transcript.run(), transcript.row(number)))
