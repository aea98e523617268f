"""prima show."""

from __future__ import annotations

import click
from click.exceptions import Exit

from prima.cli.common import put, tell, why_option


@click.command()
@click.argument("transcript", type=click.Path())
@why_option
def show(transcript: str, why: bool) -> None:
    """Print a transcript as the table that people read.

    \b
    prima show mediated.jsonl --why
    """
    from prima import api

    made = api.read(transcript, partial=True)
    put(made.table(why))
    if made.cut:
        tell(f"prima: {made.cut}")
        raise Exit(2)
