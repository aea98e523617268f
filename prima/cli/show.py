"""prima show."""

from __future__ import annotations

import click

from prima.cli.options import PathName, why_option
from prima.cli.printing import columns, put, tell_cut


@click.command()
@click.argument("transcript", type=PathName())
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
