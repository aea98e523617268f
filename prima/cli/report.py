"""prima report."""

from __future__ import annotations

import sys
from itertools import product
from typing import TYPE_CHECKING

import click

from prima.cli.common import (
    check_output,
    suggesting,
    tell,
    tell_cut,
    write_for_programs,
)
from prima.cli.runs import Run, is_markup, run_of
from prima.errors import UsageError
from prima.scheduler.policy import POLICIES, USAGE

if TYPE_CHECKING:
    from prima.loading import Loaded


@click.command()
@click.argument("runs", metavar="TRANSCRIPT|SCENARIO...", nargs=-1, type=click.Path())
@click.option("-o", "--output", type=click.Path(), help="Write the page here.")
@click.option(
    "--policy",
    "policies",
    multiple=True,
    shell_complete=suggesting(*POLICIES),
    help=f"Run a scenario under this policy; twice to compare two runs: {USAGE}.",
)
@click.option(
    "--scenario",
    "scenarios",
    multiple=True,
    type=click.Path(),
    help="The scenario of a transcript: adds the map and the user's path. Twice for two.",
)
def report(
    runs: tuple[str, ...],
    output: str | None,
    policies: tuple[str, ...],
    scenarios: tuple[str, ...],
) -> None:
    """Show a run as a page for the browser, or compare two.

    A scenario is run first. The page has a timeline, the map with robot and user, and
    the transcript with the reasons for every row. It is one file and needs no network.

    \b
    prima report documents/scenarios/navigate-alone.xml -o navigate.html
    prima report visit.xml --policy prima --policy fifo -o both.html
    prima report mediated.jsonl fifo.jsonl -o both.html
    prima report fifo.jsonl --scenario documents/scenarios/navigate-alone.xml -o fifo.html
    """
    from prima.report import make

    if not runs:
        raise UsageError("Name a scenario, or a transcript, as prima run -o writes it.")
    wanted = list(product(runs, policies or (None,)))
    if len(wanted) > 2:
        raise UsageError(f"These are {len(wanted)} runs; a report shows one run or compares two.")
    if output is None and sys.stdout.isatty():
        raise UsageError("Name the file to write: -o report.html.")
    output = None if output == "-" else output
    if output is not None:
        check_output(output, "page", *runs, *scenarios)
    maps = _maps(runs, scenarios)
    shown = [run_of(path, policy) for path, policy in wanted]
    transcripts = [run.transcript for run in shown]
    write_page(make(transcripts, _scenarios(shown, maps)), output)
    tell_cut(*transcripts)


def _maps(runs: tuple[str, ...], scenarios: tuple[str, ...]) -> list[Loaded]:
    """The scenarios of transcripts.

    Raises:
        DocumentError: one is wrong.
        UsageError: they are neither one for each transcript, nor one for all.
    """
    from prima import api

    if not scenarios:
        return []
    transcripts = [path for path in runs if not is_markup(path)]
    if not transcripts:
        raise UsageError(
            "--scenario works only with transcripts; a scenario that is run has its own map."
        )
    if len(scenarios) not in (1, len(transcripts)):
        raise UsageError("Name one --scenario for all transcripts, or one for each.")
    return [api.load_scenario(path) for path in scenarios]


def _scenarios(shown: list[Run], maps: list[Loaded]) -> list[Loaded | None]:
    """The scenario of each run: its own, or the next one after --scenario."""
    left = iter(maps if len(maps) > 1 else maps * len(shown))
    return [run.scenario or next(left, None) for run in shown]


def write_page(page: str, output: str | None) -> None:
    """Write a page to a file, or to stdout.

    Raises:
        UsageError: it cannot be written.
    """
    from prima.loading.writing import write_whole

    if output is None:
        write_for_programs()
        click.echo(page, nl=False)
        return
    write_whole(output, page)
    tell(f"{output}: {len(page.encode()) // 1024 + 1} kB; open it in a browser")
