"""prima graph."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from prima.cli.options import PathName, SuggestingChoice, limit_option, or_stdout, output_option
from prima.cli.outputs import check_output
from prima.cli.printing import echo, tell, tell_cut, write_for_programs
from prima.errors import UsageError
from prima.graph import FORMATS, SUFFIXES, WHATS, picture

if TYPE_CHECKING:
    from prima.api import Transcript


@click.command()
@click.argument("file", type=PathName())
@click.option(
    "--to", type=SuggestingChoice(FORMATS), help="By default according to OUTPUT's suffix, or svg."
)
@click.option(
    "--what",
    type=SuggestingChoice(WHATS),
    help="An application's states; a transcript's tree of Atomic Behaviors, or its streams;"
    " a world's map.",
)
@click.option("--row", type=int, help="Draw the tree as of this row of the transcript's table.")
@limit_option
@output_option("The file to write; else to stdout.", callback=or_stdout)
def graph(file: str, to: str | None, what: str | None, row: int | None, output: str | None) -> None:
    """Draw the states of an application, the trees and streams of a run, or a world's map.

    FILE is an application, a transcript or a world, which is detected. SVG needs no
    other program; DOT and Mermaid are for other programs.

    \b
    prima graph documents/fa/follow.xml -o follow.svg
    prima graph documents/fa/follow.xml --to mermaid
    prima graph mediated.jsonl --row 13 -o memory.svg
    prima graph mediated.jsonl --what streams -o streams.svg
    prima graph documents/worlds/office.xml -o office.svg
    """
    from prima.loading.writing import write_whole

    form = to or SUFFIXES.get(Path(output or "").suffix.lower())
    if output and form is None:
        raise UsageError(
            f"{output}: unknown suffix; name a format: --to svg, dot, mermaid or json."
        )
    if form is None and sys.stdout.isatty():
        raise UsageError(
            "Name the file to write: -o FILE.svg; or print text with --to dot or mermaid."
        )
    if output is not None:
        check_output(output, "picture", file)
    read: list[Transcript] = []
    made = picture(file, form or "svg", what or "", row, read)
    if output is None:
        write_for_programs()
        echo(made, nl=False)
    else:
        write_whole(output, made)
        tell(f"written: {output}")
    tell_cut(*read)
