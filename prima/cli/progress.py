"""The records of runs, and their progress, shown while they are made and written."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import IO, TYPE_CHECKING, Any

import click

from prima.errors import UsageError

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.messages import Record

PROGRESS_SECONDS = 0.5
"""How often the progress of a long run is shown."""


def show_count(done: int, total: int, what: str) -> None:
    """Show on a terminal how many of several things are done."""
    if total > 1 and sys.stderr.isatty():
        click.echo(f"\r{done} of {total} {what}", err=True, nl=done == total)


def print_records(records: list[Record]) -> None:
    """Print the records of an instant as JSON lines."""
    from prima.transcript.lines import line

    sys.stdout.writelines(map(line, records))
    sys.stdout.flush()


def run_into(output: str, rehearse: Callable[[Any], Transcript]) -> Transcript:
    """Run and write the transcript line by line, so that an interrupted run is kept.

    The file is opened at the first line: a refused run leaves it untouched.
    """
    stream: IO[str] | None = None

    def write(line: str) -> None:
        nonlocal stream
        if stream is None:
            line.encode()  # may raise, before the file is opened
            opened = open(output, "w", encoding="utf-8", buffering=1)  # noqa: SIM115
            stream = files.enter_context(opened)
        stream.write(line)

    try:
        with ExitStack() as files:
            if not sys.stderr.isatty():
                return rehearse(write)
            made = rehearse(_with_progress(write))
            click.echo(f"\r{' ' * 60}\r", err=True, nl=False)
            return made
    except OSError as error:
        raise UsageError(f"{output}: cannot be written: {error.strerror}.") from None
    except UnicodeEncodeError:
        message = "a transcript cannot name a file whose path is not UTF-8; rename it."
        raise UsageError(f"{output}: {message}") from None


def _with_progress(write: Callable[[str], object]) -> Callable[[str], None]:
    """Write lines, and show the progress of the run now and then."""
    shown = time.monotonic()
    count = 0

    def note(line: str) -> None:
        nonlocal shown, count
        write(line)
        count += 1
        if time.monotonic() - shown > PROGRESS_SECONDS:
            shown = time.monotonic()
            seconds = line.removeprefix('{"time":').partition(",")[0]
            click.echo(f"\r{seconds} s, {count} records ", err=True, nl=False)

    return note


class ProgressBar:
    """Shows the progress of many runs on a terminal."""

    def __init__(self, total: int) -> None:
        self.total = total
        self.terminal = sys.stderr.isatty()
        self.among_rows = sys.stdout.isatty()
        self.shown = ""
        self.last = self.began = 0.0
        """When it was shown last, and when the first run was done."""

    def show(self, done: int, bad: int) -> None:
        """Show how many runs are done, and how many of them failed."""
        now = time.monotonic()
        self.began = self.began or now
        seldom = not self.among_rows and now - self.last < PROGRESS_SECONDS
        if not self.terminal or seldom:
            return
        self.last = now
        wrong = f", {bad} not fine" if bad else ""
        of = f" of {self.total}" if done <= self.total else ""  # exploring ends with a few more
        text = f"{done}{of} runs{wrong}"
        if of and done > 1:
            left = (now - self.began) / (done - 1) * (self.total - done)
            text += f"; about {left:.0f} s left"
        click.echo(f"\r{text.ljust(len(self.shown))} ", err=True, nl=False)
        self.shown = text

    def make_room(self, messages: bool) -> None:
        """Erase it where a row, or messages, would be printed over it."""
        if messages or self.among_rows:
            self.clear()

    def clear(self) -> None:
        """Erase it, so that something else can be printed."""
        if self.shown:
            click.echo(f"\r{' ' * len(self.shown)} \r", err=True, nl=False)
        self.shown = ""
