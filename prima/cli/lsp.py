"""prima lsp."""

from __future__ import annotations

import sys

import click

from prima.cli.interrupts import fatal
from prima.errors import UsageError


@click.command()
@click.option("--stdio", is_flag=True, help="Use stdin and stdout: the default, and the only way.")
def lsp(stdio: bool) -> None:
    """Serve an editor while documents are written (Language Server Protocol).

    The editor starts it and shows problems as you type, completion, documentation,
    definitions, renaming and quick fixes. docs/editors.md says how to set editors up.

    \b
    nvim --cmd 'au FileType xml lua vim.lsp.start({name="prima", cmd={"prima", "lsp"}})' tour.xml

    \b
    prima lsp --stdio
    """
    try:
        from prima.lsp.server import serve
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("pygls", "lsprotocol", "cattrs", "attrs"):
            raise
        message = 'The language server needs pygls: pip install "prima[editor]".'
        raise UsageError(message) from None
    if sys.stdin is None or sys.stdin.isatty():
        message = "An editor starts this command; docs/editors.md says how to set it up."
        raise UsageError(f"lsp: {message} To check a file here: prima validate FILE.")
    with fatal():
        shut_down = serve()
    if not shut_down:
        raise click.exceptions.Exit(1)
