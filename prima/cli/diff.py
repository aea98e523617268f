"""prima diff."""

from __future__ import annotations

import click
from click.exceptions import Exit

from prima.cli.common import coloured, format_option, print_json


@click.command()
@click.argument("before", type=click.Path())
@click.argument("after", type=click.Path())
@format_option
def diff(before: str, after: str, form: str) -> None:
    """Compare two transcripts by behaviour: moved, added, lost, split, changed, delayed.

    Exit code 0 if they are alike, 1 if they differ.

    \b
    prima diff mediated.jsonl fifo.jsonl
    """
    from prima import api
    from prima.transcript.diff import difference_data, format_difference

    difference = api.diff(api.read(before), api.read(after))
    if form == "json":
        print_json(difference_data(difference))
    else:
        click.echo(format_difference(difference, coloured()), nl=False, color=coloured())
    if difference.differs:
        raise Exit(1)
