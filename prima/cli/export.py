"""prima export."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import click
from click.exceptions import Exit

from prima.cli.common import check_output, or_stdout, suggesting, tell
from prima.errors import UsageError, counted, one_of
from prima.exports import FORMATS


@click.command()
@click.argument("transcript", type=click.Path())
@click.option(
    "--to",
    metavar="FORMAT",
    shell_complete=suggesting(*FORMATS),
    help=f"{one_of(f'{name} ({use})' for name, use in FORMATS.items())};"
    " by default what OUTPUT's suffix tells.",
)
@click.option(
    "-o",
    "--output",
    type=click.Path(),
    callback=or_stdout,
    help="The file to write; else to stdout.",
)
@click.option(
    "--lang",
    "langs",
    multiple=True,
    metavar="[APP=]TAG",
    help="In what language it is spoken, by all or by one application; for eaf.",
)
def export(transcript: str, to: str | None, output: str | None, langs: tuple[str, ...]) -> None:
    """Write a transcript in the format of another tool.

    Who said and did what, the events, the devices, the streams, the floor, each
    decision's rule and the reactions stand in tiers; docs/exports.md says which.

    \b
    prima export mediated.jsonl --to eaf -o mediated.eaf
    prima export mediated.jsonl --to csv
    prima export mediated.jsonl -o mediated.eaf --lang en --lang guide=ja
    """
    from prima import api

    form = to.lower() if to else Path(output or "").suffix.lower()[1:]
    if not form:
        raise UsageError(f"say in what format: --to {one_of(FORMATS)}.")
    if output is None and form == "mcap" and sys.stdout.isatty():
        raise UsageError("mcap is no text for a terminal: name a file with -o.")
    if output is not None:
        check_output(output, "export")
    made = api.export(transcript, form, output or sys.stdout.buffer, _languages(langs))
    if output:
        amount = f"{counted(made.tiers, 'tier')} with {made.marks} intervals and points"
        tell(f"{output}: {amount} of {made.seconds:.1f} s")
    else:
        sys.stdout.buffer.flush()
    if made.early:
        tell(f"prima: {made.early}")
    if made.cut:
        tell(f"prima: {made.cut}")
        raise Exit(2)


def _languages(langs: Iterable[str]) -> dict[str, str]:
    """``APP=TAG`` and ``TAG`` as the interface wants them.

    Raises:
        UsageError: one application, or all, are given two.
    """
    found: dict[str, str] = {}
    for lang in langs:
        app, _, tag = lang.rpartition("=")
        if found.setdefault(app, tag) != tag:
            whose = f"of {app}" if app else "of all"
            raise UsageError(f"--lang tells two languages {whose}: {found[app]} and {tag}.")
    return found
