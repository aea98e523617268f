"""prima report."""

from __future__ import annotations

import sys
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from prima.cli.options import PathName, SuggestingChoice, output_option, paths_option, policy_option
from prima.cli.outputs import check_output
from prima.cli.printing import echo, tell, tell_cut, write_for_programs
from prima.cli.runs import GivenRun, is_markup, run_of, tell_failures
from prima.errors import UsageError, counted, did_you_mean, one_of

if TYPE_CHECKING:
    from prima.loading import Loaded
    from prima.results.figures import Figure


@click.command()
@click.argument("runs", metavar="TRANSCRIPT|SCENARIO...|TABLE", nargs=-1, type=PathName())
@output_option("Write the page here, or a folder for figures.")
@policy_option("Run a scenario under this policy; twice to compare two runs: {}.", many=True)
@paths_option(
    "--scenario",
    "scenarios",
    "The scenario of a transcript: adds the map and the user's path. Twice for two.",
)
@click.option(
    "--by",
    "factors",
    metavar="FACTOR",
    multiple=True,
    help="A factor of a sweep, for its map of orders; once or twice.",
)
@click.option(
    "--to",
    "form",
    type=SuggestingChoice(["html", "svg"]),
    default="html",
    help="A page (html), or a sweep's figures as files (svg).",
)
@click.option("--figure", metavar="NAME", help="With --to svg: this figure alone, as a measure.")
def report(
    runs: tuple[str, ...],
    output: str | None,
    policies: tuple[str, ...],
    scenarios: tuple[str, ...],
    factors: tuple[str, ...],
    form: str,
    figure: str | None,
) -> None:
    """Show a run as a page for the browser, compare two, or show the table of a sweep.

    A scenario is run first. The page has a timeline, the map with robot and user, and
    the transcript with the reasons for every row. Of a sweep's table, or the folder that
    has it, it shows distributions, tests and a map of orders. It is one file and needs no
    network.

    \b
    prima report documents/scenarios/navigate-alone.xml -o navigate.html
    prima report visit.xml --policy prima --policy fifo -o both.html
    prima report mediated.jsonl fifo.jsonl -o both.html
    prima report fifo.jsonl --scenario documents/scenarios/navigate-alone.xml -o fifo.html
    prima report sweep.csv -o sweep.html
    prima report sweep.csv --to svg -o figures/
    """
    if any(map(_is_table, runs)):
        if len(runs) > 1 or policies or scenarios:
            raise UsageError("Of a sweep, name its table alone, without --policy and --scenario.")
        _report_table(runs[0], output, factors, form, figure)
        return
    if factors or figure or form != "html":
        raise UsageError("--by, --to svg and --figure are for the table of a sweep.")
    _report_runs(runs, output, policies, scenarios)


def _report_runs(
    runs: tuple[str, ...], output: str | None, policies: tuple[str, ...], scenarios: tuple[str, ...]
) -> None:
    """Write the page of one run, or of two.

    Raises:
        Exit: an application ended by an error.
        UsageError: there are none or too many, or nothing can be written.
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
    failed = tell_failures(transcripts)
    tell_cut(*transcripts)
    if failed:
        raise Exit(3)


def _is_table(path: str) -> bool:
    """Whether a path names a table, or a folder that may have one."""
    named = Path(path)
    return named.suffix.lower() in (".csv", ".parquet") or named.is_dir()


def _report_table(
    path: str, output: str | None, factors: tuple[str, ...], form: str, figure: str | None
) -> None:
    """Write the page of a sweep's table, or its figures.

    Raises:
        UsageError: it is not such a table, or nothing can be written.
    """
    from prima import results

    if len(factors) > 2:
        raise UsageError("--by: the map of orders has at most two factors.")
    if figure is not None and form != "svg":
        raise UsageError("--figure needs --to svg.")
    if output is None and sys.stdout.isatty():
        raise UsageError("Name the file to write: -o sweep.html, or a folder: --to svg -o figures.")
    output = None if output == "-" else output
    if output is not None:
        check_output(output, "page", *results.files(path))
    data = results.read(path)
    if form == "html":
        folder = Path(output).parent if output is not None else Path()
        write_page(results.make(data, folder, factors), output)
    else:
        _write_figures(results.draw(data, factors), output, figure)
    if data.sheet.cut:
        tell(f"prima: {data.sheet.path}: the table is not whole: {data.sheet.cut}.")
        raise Exit(2)


def _write_figure(figures: list[Figure], output: str | None, name: str) -> None:
    """Write the figure of a name.

    Raises:
        UsageError: there is none, or it cannot be written.
    """
    from prima.loading.writing import write_whole

    found = next((one for one in figures if one.name == name), None)
    if found is None:
        names = [one.name for one in figures]
        listed = one_of(names) if names else "none, as no measure differs between runs"
        message = f'--figure: no figure "{name}"; there is {listed}. {did_you_mean(name, names)}'
        raise UsageError(message.strip())
    if output is None:
        write_for_programs()
        echo(found.whole(), nl=False)
        return
    write_whole(output, found.whole())
    tell(f"{output}: written")


def _write_figures(figures: list[Figure], output: str | None, name: str | None) -> None:
    """Write all figures into a folder, or the one that is named.

    Raises:
        UsageError: there is no such figure, or nothing can be written.
    """
    from prima.loading.writing import make_folder, write_whole

    if name is not None:
        _write_figure(figures, output, name)
        return
    if output is None:
        raise UsageError("Name the folder for the figures: -o figures, or one: --figure NAME.")
    folder = Path(output)
    make_folder(folder)
    for one in figures:
        write_whole(folder / f"{one.file}.svg", one.whole())
    tell(f"{output}: {counted(len(figures), 'figure')}")


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


def _scenarios(shown: list[GivenRun], maps: list[Loaded]) -> list[Loaded | None]:
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
        echo(page, nl=False)
        return
    write_whole(output, page)
    tell(f"{output}: {len(page.encode()) // 1024 + 1} kB; open it in a browser")
