"""prima show."""

from __future__ import annotations

import click

from prima.cli.common import columns, put, tell_cut, why_option


@click.command()
@click.argument("transcript", type=click.Path())
@why_option
def show(transcript: str, why: bool) -> None:
    """Print a transcript as a table.

    \b
    prima show mediated.jsonl --why
    """
    from prima import api

    made = api.read(transcript, partial=True)
    put(made.table(why, columns()))
    tell_cut(made)
