"""prima report."""

from __future__ import annotations

import sys

import click

from prima.cli.common import check_output, start_watchdog, tell, tell_cut, write_for_programs
from prima.errors import UsageError


@click.command()
@click.argument("transcripts", metavar="TRANSCRIPT...", nargs=-1, type=click.Path())
@click.option("-o", "--output", type=click.Path(), help="Write the page here.")
@click.option(
    "--scenario",
    "scenarios",
    multiple=True,
    type=click.Path(),
    help="The scenario that was run: shows its map, and the user's way. Twice for two.",
)
def report(transcripts: tuple[str, ...], output: str | None, scenarios: tuple[str, ...]) -> None:
    """Show a run as a page for the browser, or compare two.

    The page holds a timeline, the map with robot and user, and the transcript with the
    reasons of every row. It needs nothing beside it, and no network.

    \b
    prima report mediated.jsonl -o report.html
    prima report mediated.jsonl fifo.jsonl -o both.html
    prima report fifo.jsonl --scenario documents/scenarios/navigate-alone.xml -o fifo.html
    """
    from prima import api
    from prima.report import make

    if not transcripts:
        raise UsageError("Name a transcript, as prima run -o writes it.")
    if output is None and sys.stdout.isatty():
        raise UsageError("Say where the page goes: -o report.html.")
    output = None if output == "-" else output
    if output is not None:
        check_output(output, "page", *transcripts, *scenarios)
    if scenarios:
        start_watchdog()
    loaded = [api.load_scenario(path) for path in scenarios]
    read = [api.read(path, partial=True) for path in transcripts]
    write_page(make(read, loaded), output)
    tell_cut(*read)


def write_page(page: str, output: str | None) -> None:
    """Write a page to a file, or to stdout where there is none.

    Raises:
        UsageError: it cannot be written.
    """
    from pathlib import Path

    if output is None:
        write_for_programs()
        click.echo(page, nl=False)
        return
    try:
        Path(output).write_text(page, encoding="utf-8", newline="\n")
    except OSError as error:
        raise UsageError(f"{output}: cannot be written: {error.strerror}.") from None
    tell(f"{output}: {len(page.encode()) // 1024 + 1} kB; open it in a browser")
