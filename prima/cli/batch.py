"""The batches of prima run: lists, rows, progress."""

from __future__ import annotations

import codecs
import os
from collections import Counter
from contextlib import closing

import click
from click.exceptions import Exit

from prima.cli.printing import coloured, echo, print_json, put, tell, tell_line
from prima.cli.progress import ProgressBar
from prima.errors import UsageError, counted
from prima.errors.visible import visible
from prima.experiments.batch import run_batch
from prima.experiments.plan import BatchPlan, BatchRow, Options
from prima.experiments.rows import format_counts, format_head, format_row, row_data
from prima.loading.files import at_once, check_folder, readable
from prima.pool.processes import warm_up

MOST_LISTED = 50_000_000
"""Maximum size of a list of scenarios (bytes)."""
WIDEST = 100
"""Maximum width of the table's columns of scenarios and policies."""


def listed(name: str) -> list[str]:
    """The paths in a file, one per line; ``-`` is standard input.

    Raises:
        UsageError: it cannot be read, or is empty.
    """
    check_folder(name, "To run the scenarios in it, leave out --from.")
    given, opener = (0, None) if name == "-" else (name, at_once)
    with readable(name), open(given, "rb", closefd=name != "-", opener=opener) as stream:
        data = stream.read(MOST_LISTED + 1)
    if len(data) > MOST_LISTED or b"\0" in data or data.lstrip()[:1] == b"<":
        raise UsageError(f"{name}: not a list of scenarios: write one path per line.")
    lines = [line.strip() for line in data.removeprefix(codecs.BOM_UTF8).splitlines()]
    paths = [os.fsdecode(line) for line in lines if line and not line.startswith(b"#")]
    if not paths:
        raise UsageError(f"{name}: names no scenarios: write their paths, one per line.")
    return paths


def run_all(
    paths: list[str],
    policies: tuple[str, ...],
    output: str,
    options: Options,
    workers: int,
    form: str,
) -> None:
    """Make many runs, and print a row for each as soon as the earlier ones have theirs.

    Raises:
        Exit: the highest exit code of a run is not 0.
        UsageError: as :func:`prima.experiments.batch.run_batch`.
        RunError: as there.
    """
    warm_up()
    plan = BatchPlan(paths, policies, output)
    table, progress = _Table(plan, form), ProgressBar(len(plan))
    exits: Counter[int] = Counter()
    earlier = 0
    try:
        with closing(run_batch(plan, options, workers)) as rows:
            for row in rows:
                exits[row.exit] += 1
                earlier += row.earlier
                progress.make_room(bool(row.messages))
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
    """Prints rows to stdout and messages to stderr."""

    def __init__(self, plan: BatchPlan, form: str) -> None:
        columns = plan.scenarios, [one or "" for one in plan.policies]
        self.wide = [min(max(map(len, column)), WIDEST) for column in columns]
        self.form = form
        if form == "text":
            put(format_head(self.wide))

    def put(self, row: BatchRow) -> None:
        """Print a row."""
        if self.form == "json":
            print_json(row_data(row), indent=None)
        else:
            text = visible(format_row(row, self.wide))
            echo(f"\033[31m{text}\033[0m" if row.exit and coloured() else text)
        run = f"{row.scenario}, {row.policy}" if row.policy else row.scenario
        for message in row.messages:
            tell_line(
                f"prima: {message if message.startswith(row.scenario) else f'{run}: {message}'}"
            )
