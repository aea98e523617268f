"""prima validate."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator

import click
from click.exceptions import Exit

from prima.checks.ignores import KINDS, SETTINGS
from prima.cli.common import (
    Choice,
    SourceLines,
    coloured,
    limit_option,
    map_option,
    print_json,
    put,
    raise_limits,
    tell,
)
from prima.errors import Problem, UsageError, listed, one_of
from prima.markup.limits import LIMITS

WATCH_SECONDS = 0.3
MANY = 50
"""From so many files on, a terminal is told how far it is."""


@click.command()
@click.argument("files", nargs=-1, required=True, type=click.Path())
@click.option(
    "--format",
    "form",
    type=Choice(["text", "short", "json", "sarif"]),
    default="text",
    help="What to print; short leaves out the source lines.",
)
@click.option("--watch", is_flag=True, help="Check again whenever a file changes, until Ctrl-C.")
@click.option("--strict", is_flag=True, help="Count warnings as problems: exit code 1.")
@click.option("--notes", is_flag=True, help="Print notes too: what holds and units cost others.")
@click.option(
    "--with",
    "fas",
    metavar="FA",
    multiple=True,
    type=click.Path(),
    help="Certify what each of FILES, an EA, can do to this FA.",
)
@click.option("--robot", type=click.Path(), default="", help="The robot's profile for --with.")
@map_option
@limit_option
def validate(
    files: tuple[str, ...],
    form: str,
    watch: bool,
    strict: bool,
    notes: bool,
    fas: tuple[str, ...],
    robot: str,
    maps: tuple[str, ...],
    limits: tuple[str, ...],
) -> None:
    """Check documents of any kind: applications, worlds, robots, scenarios, VoiceXML.

    All problems of every file are printed, each with its place, its source line and
    what to write instead. A folder stands for all documents in it. Exit code 1 if any
    problem is an error, or with --strict a warning; 2 if a file cannot be read.

    \b
    prima validate documents/fa/follow.xml documents/ea
    prima validate documents --format sarif > problems.sarif
    prima validate documents --strict
    prima validate my-guide.xml --watch
    prima validate site/voice/main.vxml --map https://example.org/app/=site/
    prima validate --with documents/fa/follow.xml documents/ea/museum.xml
    """
    raise_limits(limits)
    if robot and not fas:
        raise UsageError("--robot goes with --with.")
    if fas and (watch or notes or strict or maps or form in ("short", "sarif")):
        raise UsageError("A certificate (--with) takes --format text or json alone.")
    if fas:
        _certify(fas, files, robot, form)
        return
    if watch:
        _watch(files, form, notes, maps)
    unread, errors, warnings = _check(files, form, notes, maps)
    if unread or errors or (strict and warnings):
        raise Exit(2 if unread else 1)


def _certify(fas: tuple[str, ...], eas: tuple[str, ...], robot: str, form: str) -> None:
    from prima.certificate import certificate_data, certificates, format_certificate
    from prima.loading import is_application

    applications = [
        name for name in _expanded(eas) if name in eas or is_application(name)
    ]  # of a folder's documents, those that can be certified
    found = certificates(fas, applications, robot)
    if form == "json":
        print_json([certificate_data(one) for one in found])
    else:
        put("\n".join(map(format_certificate, found)))


def _check(
    files: tuple[str, ...], form: str, notes: bool, maps: tuple[str, ...]
) -> tuple[int, int, int]:
    """Check and print; gives how many files could not be read, and the errors and warnings."""
    from prima import loading  # not the whole interface, for a quick start

    problems: list[Problem] = []
    unread: list[str] = []
    names = list(_expanded(files))
    validation = loading.Validation(loading.mappings(maps, names))
    for index, name in enumerate(names, 1):
        try:
            problems += validation.problems(name)
        except UsageError as error:
            unread.append(str(error))
        if len(names) >= MANY and sys.stderr.isatty():
            click.echo(f"\r{index} of {len(names)} files", err=True, nl=index == len(names))
    problems = loading.once([*problems, *validation.ignored()])
    _show([one for one in problems if notes or one.severity != "note"], form)
    for message in unread:
        tell(f"prima: {message}")
    errors = sum(problem.severity == "error" for problem in problems)
    warnings = sum(problem.severity == "warning" for problem in problems)
    if form in ("text", "short") and not unread:
        counts = f"errors: {errors}, warnings: {warnings}" if errors + warnings else "no problems"
        tell(f"files: {len(names)}; {counts}")
    return len(unread), errors, warnings


def _expanded(files: tuple[str, ...]) -> Iterator[str]:
    """The files named, with all documents of folders among them.

    Raises:
        UsageError: a folder holds no document.
    """
    for name in files:
        if not os.path.isdir(name):
            yield name
            continue
        from pathlib import Path

        found = sorted(str(path) for path in Path(name).rglob("*") if path.suffix in KINDS)
        if not found:
            raise UsageError(
                f"{name}: holds no documents (files whose names end in {one_of(KINDS)})."
            )
        yield from found


def _show(every: list[Problem], form: str) -> None:
    problems = listed(every, LIMITS.problems)
    if form == "json":
        from prima.errors.rendering import problem_data

        told = [problem_data(one) for one in problems]
        if len(every) > LIMITS.problems:
            told[-1]["more"] = len(every) - LIMITS.problems
        print_json(told)
    elif form == "sarif":
        from prima import __version__
        from prima.checks.codes import diagnoses
        from prima.errors.rendering import sarif

        print_json(sarif(problems, __version__, diagnoses()))
    elif problems and form == "text":
        from prima.errors.rendering import render

        lines = SourceLines()
        for problem in problems:
            click.echo(render(problem, lines, coloured()), color=coloured())
    else:
        for problem in problems:
            put(str(problem))


def _watch(files: tuple[str, ...], form: str, notes: bool, maps: tuple[str, ...]) -> None:
    """Check now and after every change, until somebody interrupts."""
    import time

    seen: dict[str, float] | None = None
    while True:
        now = _changes(files)
        if now != seen:
            seen = now
            if sys.stdout.isatty():
                click.clear()
            tell(time.strftime("%H:%M:%S"))
            _check(files, form, notes, maps)
            sys.stdout.flush()
        time.sleep(WATCH_SECONDS)


def _changes(files: tuple[str, ...]) -> dict[str, float]:
    """When each document in the folders of the files was changed: a scenario names others."""
    from pathlib import Path

    folders = {name if os.path.isdir(name) else os.path.dirname(name) or "." for name in files}
    found: dict[str, float] = {}
    for folder in folders:
        for path in Path(folder).rglob("*"):
            if path.suffix in KINDS or path.name == SETTINGS:
                try:
                    found[str(path)] = path.stat().st_mtime_ns
                except OSError:
                    continue
    return found
