"""prima diff."""

from __future__ import annotations

import click
from click.exceptions import Exit

from prima.cli.options import PathName, formats_option, or_stdout, output_option, policy_option
from prima.cli.outputs import check_output
from prima.cli.printing import coloured, echo, tell_cut, write_for_programs
from prima.cli.runs import run_of, tell_failures
from prima.errors import UsageError


@click.command()
@click.argument("before", type=PathName())
@click.argument("after", type=PathName(), required=False)
@policy_option("Run a scenario under this policy; twice, once for each run: {}.", many=True)
@formats_option("text", "json", "html", meaning="What to print; html is a page for the browser.")
@output_option("Write the page here, with --format html.", callback=or_stdout)
def diff(
    before: str, after: str | None, policies: tuple[str, ...], form: str, output: str | None
) -> None:
    """Compare two transcripts by behaviour: moved, added, lost, split, changed, delayed.

    A scenario may take the place of a transcript: it is run first. One scenario may
    be run under two policies. Exit code 0 if the runs are alike, 1 if they differ.

    \b
    prima diff mediated.jsonl fifo.jsonl
    prima diff mediated.jsonl fifo.jsonl --format html -o both.html
    prima diff visit.xml --policy fifo --policy prima
    """
    from prima import api
    from prima.transcript.diff import difference_json, format_difference

    if output is not None and form != "html":
        raise UsageError("-o works only with --format html; other formats go to stdout.")
    (one, first), (other, second) = _runs(before, after, policies)
    if output is not None:
        check_output(output, "page", one, other)
    whole = form == "html"
    before_run, after_run = run_of(one, first, whole), run_of(other, second, whole)
    old, new = before_run.transcript, after_run.transcript
    difference = api.diff(old, new)
    if form == "html":
        from prima.cli.report import write_page
        from prima.report import make

        write_page(make([old, new], [before_run.scenario, after_run.scenario]), output)
    elif form == "json":
        write_for_programs()
        for piece in difference_json(difference):
            echo(piece, nl=False)
    else:
        echo(format_difference(difference, coloured()), nl=False)
    failed = tell_failures([old, new])
    tell_cut(old, new)
    if failed:
        raise Exit(3)
    if difference.differs:
        raise Exit(1)


def _runs(
    before: str, after: str | None, policies: tuple[str, ...]
) -> list[tuple[str, str | None]]:
    """The two files to compare, each with its policy, if any.

    Raises:
        UsageError: not two runs are named.
    """
    if policies and (after is not None or len(policies) != 2):
        raise UsageError("Name one scenario and two policies: --policy fifo --policy prima.")
    if after is None and not policies:
        raise UsageError("Name two transcripts, or a scenario and two policies.")
    if after is None:
        return [(before, policy) for policy in policies]
    return [(before, None), (after, None)]
