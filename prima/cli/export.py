"""prima export."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path

import click
from click.exceptions import Exit

from prima.cli.options import PathName, or_stdout, output_option, suggesting
from prima.cli.outputs import check_output
from prima.cli.printing import pouring, tell
from prima.errors import UsageError, counted, one_of
from prima.exports import FORMATS


@click.command()
@click.argument("transcript", type=PathName())
@click.option(
    "--to",
    metavar="FORMAT",
    shell_complete=suggesting(*FORMATS),
    help=f"{one_of(f'{name} ({use})' for name, use in FORMATS.items())};"
    " by default according to OUTPUT's suffix.",
)
@output_option("The file to write; else to stdout.", callback=or_stdout)
@click.option(
    "--lang",
    "langs",
    multiple=True,
    metavar="[APP=]TAG",
    help="Language of all applications or of one; only for eaf.",
)
def export(transcript: str, to: str | None, output: str | None, langs: tuple[str, ...]) -> None:
    """Write a transcript in the format of another tool.

    Tiers hold what was said and done, by whom, the events, devices, streams, floor,
    rules of decisions and reactions; docs/exports.md lists them.

    \b
    prima export mediated.jsonl --to eaf -o mediated.eaf
    prima export mediated.jsonl --to csv
    prima export mediated.jsonl -o mediated.eaf --lang en --lang guide=ja
    """
    from prima import api

    form = _format(to, output)
    if output is not None:
        check_output(output, "export", transcript)
    out = pouring()
    made = api.export(transcript, form, output or out, _languages(langs))
    out.flush()
    if output:
        amount = f"{counted(made.tiers, 'tier')} with {made.marks} intervals and points"
        tell(f"{output}: {amount} of {made.seconds:.1f} s")
    if made.early:
        tell(f"prima: {made.early}")
    if made.cut:
        tell(f"prima: {made.cut}")
        raise Exit(2)


def _format(to: str | None, output: str | None) -> str:
    """The format that is named, or that of the file's suffix.

    Raises:
        UsageError: there is neither, or the format is not for a terminal.
    """
    form = to.lower() if to else Path(output or "").suffix.lower()[1:]
    if not to and form not in FORMATS:
        if output is None:
            raise UsageError(f"Name a format: --to {one_of(FORMATS)}.")
        named = f'no format has the suffix "{form}"' if form else "it has no suffix"
        raise UsageError(f"{output}: {named}; name a format: --to {one_of(FORMATS)}.")
    if output is None and form == "mcap" and sys.stdout.isatty():
        raise UsageError("mcap is a binary format: name a file with -o.")
    return form


def _languages(langs: Iterable[str]) -> dict[str, str]:
    """The language of each application, and of all under ``""``.

    Raises:
        UsageError: an application, or all, have two.
    """
    found: dict[str, str] = {}
    for lang in langs:
        app, _, tag = lang.rpartition("=")
        if found.setdefault(app, tag) != tag:
            whose = f"of {app}" if app else "of all"
            raise UsageError(f"--lang gives two languages {whose}: {found[app]} and {tag}.")
    return found
