"""What commands print: results to stdout, messages to stderr."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import IO, TYPE_CHECKING, Any

import click

from prima.errors import Problem, argument, listed
from prima.errors.visible import escaped, visible

if TYPE_CHECKING:
    from prima.api import Transcript


REFUSING = ("strict", "surrogateescape")
"""Python's error handlers that raise for characters that an encoding lacks."""


def coloured() -> bool:
    """Whether to colour what goes to stdout: not if ``NO_COLOR`` has a value (no-color.org)."""
    return sys.stdout.isatty() and not os.getenv("NO_COLOR") and os.getenv("TERM") != "dumb"


def columns() -> int:
    """Maximum width of a table: the terminal's, or 80 if stdout is not a terminal."""
    import shutil

    return shutil.get_terminal_size((80, 24)).columns if sys.stdout.isatty() else 80


def clean(text: str) -> str:
    """Text with control characters made visible, except newlines and tabs."""
    return visible(text, "\n\t")


def escape_for_people() -> None:
    """Write characters that stdout's encoding lacks as escapes, as stderr does."""
    out = sys.stdout
    if isinstance(out, io.TextIOWrapper) and not _is_utf8(out) and out.errors in REFUSING:
        out.reconfigure(errors="backslashreplace")


def write_for_programs() -> None:
    """Write UTF-8 to stdout from now on, whatever the terminal's encoding."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8", errors="strict")


def _is_utf8(out: io.TextIOWrapper) -> bool:
    return out.encoding.lower().replace("-", "").replace("_", "") == "utf8"


def echo(text: str, nl: bool = True) -> None:
    """Print text to stdout as it is; if nobody reads it any more, the exit code still counts."""
    try:
        stream(text, nl)
    except BrokenPipeError:
        write_nowhere(sys.stdout)


def stream(text: str, nl: bool = True) -> None:
    """Print a piece of an output that ends when nobody reads it any more.

    It is printed in stdout's encoding, where click alone would take UTF-8 instead of ASCII.

    Raises:
        BrokenPipeError: nobody reads it.
    """
    click.echo(text, sys.stdout, nl)


def write_nowhere(output: IO[str]) -> None:
    """Give up what an output still holds, which Python would write at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), output.fileno())


class _Poured(io.RawIOBase):
    """Bytes on stdout; if nobody reads it any more, the exit code still counts."""

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        try:
            sys.stdout.buffer.write(data)
            sys.stdout.buffer.flush()
        except BrokenPipeError:
            write_nowhere(sys.stdout)
        return len(data)


def pouring() -> io.BufferedWriter:
    """A stream of bytes to stdout that does not end when nobody reads it any more."""
    return io.BufferedWriter(_Poured())


def put(text: str) -> None:
    """Print text for people to stdout."""
    echo(clean(text), nl=not text.endswith("\n"))


def tell(text: str) -> None:
    """Print a message to stderr, if anything can be written there."""
    with suppress(OSError):
        click.echo(clean(text), sys.stderr)


def tell_line(text: str) -> None:
    """Print a message to stderr as one line, though a name that it quotes may have several."""
    tell(visible(text))


def tell_problems(problems: list[Problem]) -> None:
    """Print the errors and warnings of a run's documents."""
    from prima.markup.limits import LIMITS

    for problem in listed([one for one in problems if one.severity != "note"], LIMITS.problems):
        tell_line(str(problem))


def tell_cut(*transcripts: Transcript) -> None:
    """Report transcripts that end before their runs did.

    Raises:
        click.exceptions.Exit: with 2, if one ends at an unreadable line.
    """
    for transcript in transcripts:
        if message := transcript.cut or transcript.early:
            tell(f"prima: {message}")
            if _goes_on(transcript):
                tell(how_to_go_on(transcript.name))
    if any(transcript.cut for transcript in transcripts):
        raise click.exceptions.Exit(2)


def _goes_on(transcript: Transcript) -> bool:
    """Whether a live run can go on from its journal: all lines but the last are whole."""
    from prima.transcript.lines import INCOMPLETE

    head = transcript.records[0].get("data", {}) if transcript.records else {}
    torn = not transcript.cut or transcript.cut.endswith(INCOMPLETE)
    return torn and "live" in head and not head.get("redacted")


def how_to_go_on(journal: str, drivers: Sequence[str] = ()) -> str:
    """A message that a live run can go on from its journal, with drivers of these files."""
    words = ["--resume", argument(journal)]
    for file in drivers:
        words += ["--driver", argument(file)]
    return f"Go on with: prima live {' '.join(words)}"


def print_json(data: Any, indent: int | None = 2) -> None:
    """Print data as JSON to stdout, or as a line of JSON without an indent."""
    import json

    write_for_programs()
    text = escaped(json.dumps(data, ensure_ascii=False, indent=indent))
    echo(text.encode(errors="backslashreplace").decode())  # names of files may not be UTF-8
