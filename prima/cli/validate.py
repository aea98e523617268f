"""prima validate."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from itertools import chain

import click
from click.exceptions import Exit

from prima.checks.ignores import KINDS, SETTINGS
from prima.cli.options import (
    PathName,
    formats_option,
    limit_option,
    map_option,
    paths_option,
)
from prima.cli.printing import coloured, echo, print_json, put, tell, tell_line
from prima.cli.progress import show_count
from prima.errors import Problem, UsageError, listed, one_of
from prima.errors.visible import visible
from prima.markup.limits import LIMITS

WATCH_SECONDS = 0.3
MANY = 50
"""The number of files from which progress is shown on a terminal."""


@click.command()
@click.argument("files", nargs=-1, required=True, type=PathName())
@formats_option(
    "text", "short", "json", "sarif", meaning="What to print; short omits source lines."
)
@click.option("--watch", is_flag=True, help="Check again whenever a file changes, until Ctrl-C.")
@click.option("--strict", is_flag=True, help="Count warnings as problems: exit code 1.")
@click.option(
    "--notes", is_flag=True, help="Print notes too: the cost of holds and units to others."
)
@paths_option(
    "--with", "fas", "Certify how each of FILES, an EA, can affect this FA.", metavar="FA"
)
@click.option("--robot", type=PathName(), help="The robot's profile for --with.")
@map_option
@limit_option
def validate(
    files: tuple[str, ...],
    form: str,
    watch: bool,
    strict: bool,
    notes: bool,
    fas: tuple[str, ...],
    robot: str | None,
    maps: tuple[str, ...],
) -> None:
    """Check documents of any kind: applications, worlds, robots, scenarios, VoiceXML.

    All problems of every file are printed with place, source line and remedy. A folder
    stands for all documents in it. Exit code 1 if any problem is an error, or with
    --strict a warning; 2 if a file cannot be read.

    \b
    prima validate documents/fa/follow.xml documents/ea
    prima validate documents --format sarif > problems.sarif
    prima validate documents --strict
    prima validate my-guide.xml --watch
    prima validate site/voice/main.vxml --map https://example.org/app/=site/
    prima validate --with documents/fa/follow.xml documents/ea/museum.xml
    """
    _check_options(bool(fas), bool(robot), watch, strict)
    if fas:
        if any((watch, notes, strict, maps, form in ("short", "sarif"))):
            raise UsageError("--with works only with --robot and --format text or json.")
        _certify(fas, files, robot or "", form)
        return
    if watch:
        _watch(files, form, notes, maps)
    unread, errors, warnings = _check(files, form, notes, maps)
    if unread or errors or (strict and warnings):
        raise Exit(2 if unread else 1)


def _check_options(fas: bool, robot: bool, watch: bool, strict: bool) -> None:
    """Refuse options that have no effect.

    Raises:
        UsageError: there is one.
    """
    if robot and not fas:
        raise UsageError("--robot works only with --with.")
    if watch and strict and not fas:
        raise UsageError("--watch has no exit code of its own; leave out --strict.")


def _certify(fas: tuple[str, ...], eas: tuple[str, ...], robot: str, form: str) -> None:
    from prima.certificate import certificate_data, certificates, format_certificate
    from prima.loading import is_application

    applications = [name for name in _expanded(eas) if name in eas or is_application(name)]
    if not applications:
        raise UsageError(f"{eas[0]}: contains no applications.")
    found = certificates(fas, applications, robot)
    if form == "json":
        print_json([certificate_data(one) for one in found])
    else:
        put("\n".join(map(format_certificate, found)))


def _check(
    files: tuple[str, ...], form: str, notes: bool, maps: tuple[str, ...]
) -> tuple[int, int, int]:
    """Check and print; return the numbers of unreadable files, errors and warnings."""
    names = _expanded(files)
    problems, unread = _problems(names, maps)
    _show([one for one in problems if notes or one.severity != "note"], form)
    for message in unread:
        tell_line(f"prima: {message}")
    counts = Counter(problem.severity for problem in problems)
    if form in ("text", "short") and not unread:
        tell(f"files: {len(names)}; {_counts(counts['error'], counts['warning'])}")
    return len(unread), counts["error"], counts["warning"]


def _problems(names: list[str], maps: tuple[str, ...]) -> tuple[list[Problem], list[str]]:
    """The problems of the files, in their order, and what is said of those that cannot be read."""
    from prima import loading  # not the whole interface, for a quick start
    from prima.loading.similar import in_words

    found: dict[str, list[Problem]] = {name: [] for name in names}
    unread: list[str] = []
    validation = loading.Validation(loading.mappings(maps, names))
    for index, name in enumerate(loading.upper_first(names), 1):
        try:
            found[name] = validation.problems(name)
        except UsageError as error:
            unread.append(in_words(error))
        if len(names) >= MANY:
            show_count(index, len(names), "files")
    return loading.once([*chain(*found.values()), *validation.ignored()]), unread


def _counts(errors: int, warnings: int) -> str:
    return f"errors: {errors}, warnings: {warnings}" if errors + warnings else "no problems"


def _expanded(files: tuple[str, ...]) -> list[str]:
    """The files, and the documents in the folders, each once however often it is named.

    Raises:
        UsageError: a folder contains no document.
    """
    found: dict[str, str] = {}
    for name in _each(files):
        found.setdefault(os.path.abspath(name), name)
    return list(found.values())


def _each(files: tuple[str, ...]) -> Iterator[str]:
    """The files, and the documents in the folders."""
    for name in files:
        if not os.path.isdir(name):
            yield name
            continue
        from pathlib import Path

        from prima.loading import is_foreign

        each = sorted(str(path) for path in Path(name).rglob("*") if path.suffix in KINDS)
        found = [one for one in each if not is_foreign(one)]
        if not found:
            raise UsageError(
                f"{name}: contains no documents (files with the suffix {one_of(KINDS)})."
            )
        yield from found


def _show(every: list[Problem], form: str) -> None:
    problems = listed(every, LIMITS.problems)
    if form == "json":
        from prima.errors.rendering import problem_data

        data = [problem_data(one) for one in problems]
        if len(every) > LIMITS.problems:
            data[-1]["more"] = len(every) - LIMITS.problems
        print_json(data)
    elif form == "sarif":
        from prima.checks.codes import diagnoses
        from prima.errors.rendering import sarif
        from prima.version import __version__

        print_json(sarif(problems, __version__, diagnoses()))
    elif problems and form == "text":
        from prima.errors.rendering import render
        from prima.testing.sources import SourceLines

        lines = SourceLines()
        for problem in problems:
            echo(render(problem, lines, coloured()))
    else:
        for problem in problems:
            put(visible(str(problem)))


def _watch(files: tuple[str, ...], form: str, notes: bool, maps: tuple[str, ...]) -> None:
    """Check now and after every change, until interrupted."""
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
    """The modification time of each document in the files' folders: a scenario names others."""
    from pathlib import Path

    folders = {name if os.path.isdir(name) else os.path.dirname(name) or "." for name in files}
    found: dict[str, float] = {}
    for path in (path for folder in folders for path in Path(folder).rglob("*")):
        if path.suffix in KINDS or path.name == SETTINGS:
            with suppress(OSError):
                found[str(path)] = path.stat().st_mtime_ns
    return found
