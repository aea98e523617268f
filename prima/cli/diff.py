"""prima diff."""

from __future__ import annotations

import click
from click.exceptions import Exit

from prima.cli.common import coloured, print_json
from prima.errors import UsageError


@click.command()
@click.argument("before", type=click.Path())
@click.argument("after", type=click.Path())
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "json", "html"]),
    default="text",
    help="What to print; html is a page for the browser.",
)
@click.option("-o", "--output", type=click.Path(), help="Write the page here, with --format html.")
def diff(before: str, after: str, form: str, output: str | None) -> None:
    """Compare two transcripts by behaviour: moved, added, lost, split, changed, delayed.

    Exit code 0 if they are alike, 1 if they differ.

    \b
    prima diff mediated.jsonl fifo.jsonl
    prima diff mediated.jsonl fifo.jsonl --format html -o both.html
    """
    from prima import api
    from prima.transcript.diff import difference_data, format_difference

    if output is not None and form != "html":
        raise UsageError("-o goes with --format html; other formats go to stdout.")
    old, new = api.read(before), api.read(after)
    difference = api.diff(old, new)
    if form == "html":
        from prima.cli.report import write_page
        from prima.report import make

        write_page(make([old, new]), output, [before, after])
    elif form == "json":
        print_json(difference_data(difference))
    else:
        click.echo(format_difference(difference, coloured()), nl=False, color=coloured())
    if difference.differs:
        raise Exit(1)
