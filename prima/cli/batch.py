"""The batches of prima run: lists, rows, progress."""

from __future__ import annotations

import codecs
import json
import os
import sys
import time
from collections import Counter
from contextlib import closing

import click
from click.exceptions import Exit

from prima.cli import common
from prima.cli.common import PROGRESS_SECONDS, clean, coloured, put, tell
from prima.errors import UsageError, counted
from prima.errors.visible import escaped
from prima.experiments.batch import (
    Options,
    Plan,
    Row,
    format_counts,
    format_head,
    format_row,
    row_data,
    run_batch,
)
from prima.pool import warm_up

MOST_LISTED = 50_000_000
"""Bytes that a list of scenarios may have."""
WIDEST = 100
"""Columns of the table that scenarios take at most, all but longer ones."""


def listed(name: str) -> list[str]:
    """The paths that stand in a file, one in a line, or in standard input for ``-``.

    Raises:
        UsageError: it cannot be read, or names nothing.
    """
    try:
        with open(0 if name == "-" else name, "rb", closefd=name != "-") as stream:
            data = stream.read(MOST_LISTED + 1)
    except (OSError, ValueError) as error:
        raise UsageError(f"{name}: cannot be read: {getattr(error, 'strerror', error)}.") from None
    if len(data) > MOST_LISTED or b"\0" in data or data.lstrip()[:1] == b"<":
        raise UsageError(f"{name}: this is no list of scenarios: one path stands in each line.")
    lines = [line.strip() for line in os.fsdecode(data.removeprefix(codecs.BOM_UTF8)).splitlines()]
    paths = [line for line in lines if line and not line.startswith("#")]
    if not paths:
        raise UsageError(f"{name}: names no scenarios: write their paths, one in each line.")
    return paths


def run_all(
    paths: list[str],
    policies: tuple[str, ...],
    output: str,
    options: Options,
    workers: int,
    form: str,
) -> None:
    """Make many runs, and print a row for each as soon as those before it are there.

    Raises:
        Exit: the highest exit code of a run is not 0.
        UsageError: as :func:`prima.experiments.batch.run_batch`.
        RunError: as there.
    """
    warm_up()
    plan = Plan(paths, policies, output)
    progress = _Progress(len(plan))
    exits: Counter[int] = Counter()
    earlier = 0
    with closing(run_batch(plan, options, workers)) as rows:
        table = _Table(plan, form)
        try:
            for row in rows:
                exits[row.exit] += 1
                earlier += row.earlier
                if row.messages or progress.among_rows:
                    progress.clear()
                table.put(row)
                progress.show(sum(exits.values()), exits.total() - exits[0])
        except KeyboardInterrupt:
            raise click.Abort from None
        finally:
            progress.clear()
    if form == "text":
        put(f"\n{format_counts(exits)}")
    if options.resume:
        tell(f"{earlier} of {counted(len(plan), 'run')} had been made before")
    if any(exits[code] for code in exits if code):
        raise Exit(max(exits))


class _Table:
    """Rows on stdout, and on stderr what went wrong."""

    def __init__(self, plan: Plan, form: str) -> None:
        self.wide = min(max(map(len, ["scenario", *plan.scenarios])), WIDEST)
        self.form = form
        if form == "json":
            common.write_for_programs()
        if form == "text":
            put(format_head(self.wide))

    def put(self, row: Row) -> None:
        """Print a row."""
        if self.form == "json":
            text = json.dumps(row_data(row), ensure_ascii=False)
            click.echo(
                escaped(text.encode(errors="replace").decode())
            )  # of names that are not UTF-8
        else:
            text = clean(format_row(row, self.wide))
            click.echo(f"\033[31m{text}\033[0m" if row.exit and coloured() else text)
        run = f"{row.scenario}, {row.policy}" if row.policy else row.scenario
        for message in row.messages:
            tell(f"prima: {message if message.startswith(row.scenario) else f'{run}: {message}'}")


class _Progress:
    """Tells a terminal how far a batch is."""

    def __init__(self, total: int) -> None:
        self.total = total
        self.terminal = sys.stderr.isatty()
        self.among_rows = sys.stdout.isatty()
        self.shown = ""
        self.told = self.began = 0.0
        """When it was told last, and when the first run was done."""

    def show(self, done: int, bad: int) -> None:
        """Tell that so many runs are done, and so many of them were not fine."""
        now = time.monotonic()
        self.began = self.began or now
        seldom = not self.among_rows and now - self.told < PROGRESS_SECONDS
        if not self.terminal or seldom:
            return
        self.told = now
        wrong = f", {bad} not fine" if bad else ""
        text = f"{done} of {self.total} runs{wrong}"
        if done > 1:
            left = (now - self.began) / (done - 1) * (self.total - done)
            text += f"; about {left:.0f} s left"
        click.echo(f"\r{text.ljust(len(self.shown))} ", err=True, nl=False)
        self.shown = text

    def clear(self) -> None:
        """Take it off the screen, so that something else can be written there."""
        if self.shown:
            click.echo(f"\r{' ' * len(self.shown)} \r", err=True, nl=False)
        self.shown = ""
