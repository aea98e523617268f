"""prima explain."""

from __future__ import annotations

import os
from textwrap import shorten
from typing import TYPE_CHECKING

import click

from prima.cli.common import format_option, print_json, put, tell_cut
from prima.errors import UsageError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem as Completion

LINE = 100
"""Letters of a line of the list of codes."""


def _codes(_context: click.Context, _parameter: click.Parameter, begun: str) -> list[Completion]:
    """Codes that begin so, or else files."""
    from click.shell_completion import CompletionItem

    from prima.codes import CODES

    found = [CompletionItem(code) for code in CODES if begun and code.startswith(begun)]
    return found or [CompletionItem(begun, type="file")]


@click.command()
@click.argument("what", required=False, shell_complete=_codes)
@click.argument("row", type=int, required=False)
@format_option
def explain(what: str | None, row: int | None, form: str) -> None:
    """Explain a problem's CODE, or why a ROW of a transcript came where it did.

    A code comes with a wrong example, what prima validate says of it, and a right one.
    Without CODE, all codes are listed with a line each.

    \b
    prima explain
    prima explain undeclared-variable
    prima explain mediated.jsonl 16
    """
    from prima.codes import CODES

    if what is None:
        _list(form)
    elif not os.path.exists(what) and (row is None or what in CODES):
        if row is not None:
            raise UsageError(f"{what} is a code, which has no rows: prima explain {what}.")
        _code(what, form)
    elif row is None:
        raise UsageError("Say which row of the transcript: prima explain TRANSCRIPT ROW.")
    else:
        from prima import api

        transcript = api.read(what, partial=True)
        text = api.explain_row(transcript, row)
        if form == "json":
            print_json({"row": row, "lines": text.split("\n")})
        else:
            put(text)
        tell_cut(transcript)


def _list(form: str) -> None:
    """Every code with the first sentence of its explanation."""
    from prima.codes import CODES

    if form == "json":
        print_json([{"code": code, "explanation": text} for code, text in CODES.items()])
        return
    width = max(map(len, CODES))
    for code in sorted(CODES):
        first = CODES[code].partition(". ")[0].rstrip(".")
        put(f"{code:{width}}  {shorten(first, LINE - width - 2, placeholder=' ...')}")


def _code(code: str, form: str) -> None:
    """A code with its examples."""
    from prima.examples import data, shown

    if form == "json":
        print_json(data(code))
    else:
        put(shown(code))
