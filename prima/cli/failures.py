"""Exceptions that reach the top of the command line: each has a message and an exit code."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import Any

import click

from prima.cli.printing import tell, tell_line, write_nowhere
from prima.errors import DocumentError, RunError, UsageError, brief, listed

FINE, PROBLEMS, USAGE, RUN, INTERRUPTED = 0, 1, 2, 3, 130
LONGEST = 4_000
"""Letters of a message above which its middle is left out: it may name something very long."""


def exit_code(error: BaseException) -> int:
    """Print the message of an exception to stderr; return the exit code.

    Raises:
        Exception: an unexpected one, with ``PRIMA_DEBUG``.
    """
    for kind, handle in HANDLERS:
        if isinstance(error, kind):
            return handle(error)
    if isinstance(error.__cause__, KeyboardInterrupt):  # while Python 3.11 made a class
        return interrupted()
    if "PRIMA_DEBUG" in os.environ:
        raise error
    tell(
        f"prima: this is a defect of prima: {type(error).__name__}: {error}."
        " Please report it; PRIMA_DEBUG=1 shows where."
    )
    return RUN


def interrupted() -> int:
    """Print that the command was interrupted; return the exit code."""
    tell("prima: interrupted")
    return INTERRUPTED


def _message(code: int, text: str = "") -> Callable[[Any], int]:
    """A handler that prints a text, by default that of the exception."""

    def handle(error: BaseException) -> int:
        tell_line(f"prima: {brief(text or str(error), LONGEST)}")
        return code

    return handle


def _usage_error(error: UsageError) -> int:
    from prima.loading.similar import in_words

    tell_line(f"prima: {brief(in_words(error), LONGEST)}")
    return USAGE


def _problems(error: DocumentError) -> int:
    from prima.errors.rendering import render
    from prima.markup.limits import LIMITS
    from prima.testing.sources import SourceLines

    lines = SourceLines()
    shown = [problem for problem in error.problems if problem.severity != "note"]
    for problem in listed(shown, LIMITS.problems):
        tell(render(problem, lines))
    return PROBLEMS


def _no_arguments(error: click.exceptions.NoArgsIsHelpError) -> int:
    tell(error.format_message())
    return USAGE


def _usage(error: click.ClickException) -> int:
    context = getattr(error, "ctx", None)
    usage = f"{context.get_usage()}\n" if context is not None else ""
    tell(f"{usage}prima: {error.format_message()}")
    return USAGE


def closed_pipe(_error: BrokenPipeError) -> int:
    """Nobody reads stdout any more; Python must not flush it at exit."""
    write_nowhere(sys.stdout)
    return FINE


def last_words() -> None:
    """Write what stderr still holds; if that fails, Python must not try again at exit."""
    try:
        sys.stderr.flush()
    except OSError:
        write_nowhere(sys.stderr)


def _system(error: OSError) -> int:
    name = f"{error.filename}: " if isinstance(error.filename, str) else ""
    tell_line(f"prima: {name}cannot go on: {error.strerror}.")
    write_nowhere(sys.stdout)
    return USAGE


NOT_UTF8 = "the name of a file is not UTF-8 and cannot be written here; rename it."
HANDLERS: list[tuple[type[BaseException], Callable[[Any], int]]] = [
    (SystemExit, lambda _error: FINE),  # click raises it when nobody reads any more
    (DocumentError, _problems),
    (UsageError, _usage_error),
    (RunError, _message(RUN)),
    (click.exceptions.NoArgsIsHelpError, _no_arguments),
    (click.ClickException, _usage),
    (BrokenPipeError, closed_pipe),
    (OSError, _system),
    (UnicodeEncodeError, _message(USAGE, NOT_UTF8)),
    (MemoryError, _message(RUN, "out of memory")),
]
"""The first entry of which the exception is an instance handles it."""
