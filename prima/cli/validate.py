"""prima validate."""

from __future__ import annotations

import click
from click.exceptions import Exit

from prima.cli.common import format_option, print_json, problem_data, put, tell
from prima.errors import Problem, UsageError


@click.command()
@click.argument("files", nargs=-1, required=True, type=click.Path())
@format_option
def validate(files: tuple[str, ...], form: str) -> None:
    """Check documents of any kind: applications, worlds, robots, scenarios.

    All problems of every file are printed, each with its place and what to write
    instead. Exit code 1 if any is an error, 2 if a file cannot be read.

    \b
    prima validate documents/fa/*.xml documents/ea/*.xml
    """
    from prima import api

    problems: list[Problem] = []
    unread: list[str] = []
    for name in files:
        try:
            problems += api.validate([name])
        except UsageError as error:
            unread.append(str(error))
    if form == "json":
        print_json([problem_data(one) for one in problems])
    else:
        for problem in problems:
            put(str(problem))
    for message in unread:
        tell(f"prima: {message}")
    errors = sum(problem.severity == "error" for problem in problems)
    if form == "text" and not unread:
        notes = sum(problem.severity == "note" for problem in problems)
        warnings = len(problems) - errors - notes
        counts = f"errors: {errors}, warnings: {warnings}" if errors + warnings else "no problems"
        tell(f"files: {len(files)}; {counts}" + (f", notes: {notes}" if notes else ""))
    if unread or errors:
        raise Exit(2 if unread else 1)
