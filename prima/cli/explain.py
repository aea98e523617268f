"""prima explain."""

from __future__ import annotations

import os

import click

from prima.cli.common import put
from prima.errors import UsageError


@click.command()
@click.argument("what")
@click.argument("row", type=int, required=False)
def explain(what: str, row: int | None) -> None:
    """Explain a problem's CODE, or why a ROW of a transcript came where it did.

    \b
    prima explain undeclared-variable
    prima explain mediated.jsonl 16
    """
    from prima import api

    if row is None and not os.path.exists(what):
        put(api.explain(what))
    elif row is None:
        raise UsageError("Say which row of the transcript: prima explain TRANSCRIPT ROW.")
    else:
        put(api.explain_row(api.read(what), row))
