"""prima explain."""

from __future__ import annotations

import os
from textwrap import shorten
from typing import TYPE_CHECKING

import click

from prima.cli.options import format_option
from prima.cli.printing import columns, print_json, put, tell_cut
from prima.errors import UsageError, did_you_mean
from prima.transcript.table import NARROWEST

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem as Completion


def _codes(_context: click.Context, _parameter: click.Parameter, begun: str) -> list[Completion]:
    """Rules and codes with this prefix, or else files."""
    from click.shell_completion import CompletionItem

    from prima.checks.codes import diagnoses
    from prima.handbook.rulebook import rules

    names = [*rules(), *diagnoses()]
    found = [CompletionItem(name) for name in names if begun and name.startswith(begun)]
    return found or [CompletionItem(begun, type="file")]


@click.command()
@click.argument("what", required=False, shell_complete=_codes)
@click.argument("row", type=int, required=False)
@format_option
def explain(what: str | None, row: int | None, form: str) -> None:
    """Explain a RULE of mediation, a problem's CODE, or the reason for a ROW of a transcript.

    For a rule, a run shows it: a picture, rows of its table, and the command to run it.
    For a code, there are a wrong example, the output of prima validate, and a right one.
    Without arguments, all rules and codes are listed.

    \b
    prima explain
    prima explain F2
    prima explain undeclared-variable
    prima explain mediated.jsonl 16
    """
    from prima.checks.codes import diagnoses
    from prima.handbook.rulebook import named
    from prima.loading.files import check_folder

    if what is None:
        _list(form)
        return
    rule = named(what)
    known = bool(rule) or what in diagnoses()
    if row is not None:
        if known and not os.path.exists(what):
            kind = "rule" if rule else "code"
            raise UsageError(f"{what} is a {kind}, which has no rows: prima explain {what}.")
        _row(what, row, form)
    elif rule:
        _rule(rule, form)
    elif known or not os.path.exists(what):
        _code(what, form)
    else:
        check_folder(what, "Name a transcript in it, and its row.")
        raise UsageError("Say which row of the transcript: prima explain TRANSCRIPT ROW.")


def _row(file: str, row: int, form: str) -> None:
    """Print the reasons for a row of a transcript."""
    from prima import api

    transcript = api.read(file, partial=True)
    text = api.explain_row(transcript, row)
    if form == "json":
        print_json({"row": row, "lines": text.split("\n")})
    else:
        put(text)
    tell_cut(transcript)


def _list(form: str) -> None:
    """List every rule and code in a few words."""
    from prima.checks.codes import diagnoses
    from prima.handbook.rulebook import rules

    if form == "json":
        listed = [
            {"code": rule.name, "kind": "rule", "explanation": rule.text}
            for rule in rules().values()
        ]
        listed += [
            {"code": one.code, "kind": "problem", "title": one.title, "explanation": one.meaning}
            for one in diagnoses().values()
        ]
        print_json(listed)
        return
    put("Rules of mediation:")
    _lines({rule.name: rule.brief for rule in rules().values()})
    put("\nCodes of problems:")
    _lines({code: one.title for code, one in diagnoses().items()})


def _lines(texts: dict[str, str]) -> None:
    """Print a line for each name."""
    width = max(map(len, texts))
    room = max(columns() - width - 2, NARROWEST)
    for name, text in texts.items():
        put(f"{name:{width}}  {shorten(text, room, placeholder=' ...')}")


def _rule(name: str, form: str) -> None:
    """Print a rule with its example."""
    from prima.handbook.rulebook import data, shown

    if form == "json":
        print_json(data(name))
    else:
        put(shown(name, columns()))


def _code(code: str, form: str) -> None:
    """Print a code with its examples.

    Raises:
        UsageError: no code, rule or file has that name.
    """
    from prima.checks.codes import diagnoses
    from prima.handbook.examples import data, shown
    from prima.handbook.rulebook import suggestion

    if code not in diagnoses():
        hint = (
            suggestion(code) or did_you_mean(code, diagnoses()) or "prima explain lists them all."
        )
        raise UsageError(f'There is no rule, code or file "{code}". {hint}')
    if form == "json":
        print_json(data(code))
    else:
        put(shown(code))
