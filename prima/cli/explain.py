"""prima explain."""

from __future__ import annotations

import os
from textwrap import shorten
from typing import TYPE_CHECKING

import click

from prima.cli.common import columns, format_option, print_json, put, tell_cut
from prima.errors import UsageError, did_you_mean

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem as Completion


def _codes(_context: click.Context, _parameter: click.Parameter, begun: str) -> list[Completion]:
    """Rules and codes that begin so, or else files."""
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
    """Explain a RULE of mediation, a problem's CODE, or why a ROW of a transcript came.

    A rule comes with a run that shows it: a picture, rows of its table, and how to run it.
    A code comes with a wrong example, what prima validate says of it, and a right one.
    Without argument, all rules and codes are listed with a line each.

    \b
    prima explain
    prima explain F2
    prima explain undeclared-variable
    prima explain mediated.jsonl 16
    """
    from prima.checks.codes import diagnoses
    from prima.handbook.rulebook import named

    if what is None:
        _list(form)
        return
    rule = named(what)
    known = bool(rule) or what in diagnoses()
    if row is not None and known and not os.path.exists(what):
        kind = "rule" if rule else "code"
        raise UsageError(f"{what} is a {kind}, which has no rows: prima explain {what}.")
    if row is None and rule:
        _rule(rule, form)
    elif row is None and (known or not os.path.exists(what)):
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
    """Every rule and every code in a few words."""
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


def _lines(told: dict[str, str]) -> None:
    """A line for each name."""
    width, line = max(map(len, told)), columns()
    for name, text in told.items():
        put(f"{name:{width}}  {shorten(text, line - width - 2, placeholder=' ...')}")


def _rule(name: str, form: str) -> None:
    """A rule with its example."""
    from prima.handbook.rulebook import data, shown

    if form == "json":
        print_json(data(name))
    else:
        put(shown(name, columns()))


def _code(code: str, form: str) -> None:
    """A code with its examples.

    Raises:
        UsageError: there is no such code, nor a rule or a file of that name.
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
