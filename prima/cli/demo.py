"""prima demo."""

from __future__ import annotations

import os
import sys

import click

from prima.cli.options import output_option
from prima.cli.outputs import check_output
from prima.cli.printing import columns, put, tell
from prima.cli.report import write_page

SCENARIO = "follow-during-navigation.xml"
"""Figure 5.3 of the thesis: an FA and an EA on one robot."""


@click.command()
@output_option("Write the report here.", default="prima-demo.html", show_default=True)
@click.option("--no-open", is_flag=True, help="Open no browser.")
def demo(output: str, no_open: bool) -> None:
    """Run two applications on one robot, and show the run as a report.

    A personality that follows the user, and a service that guides them: Figure 5.3 of the
    thesis. The transcript is printed. The report is written to a file, and opened in a
    browser if there is a terminal and a display.

    \b
    prima demo
    prima demo --no-open -o demo.html
    """
    from prima import api
    from prima.report import make

    check_output(output, "page")
    loaded = api.load_scenario(api.documents_folder() / "scenarios" / SCENARIO)
    made = api.rehearse(loaded)
    put(made.table(columns=columns()))
    write_page(make([made], [loaded]), output)
    if not no_open and _has_display():
        _open(output)


def is_terminal() -> bool:
    """Whether stdout is a terminal."""
    return sys.stdout.isatty()


def _has_display() -> bool:
    """Whether the user is at a terminal of this machine and can see a browser."""
    if not is_terminal():
        return False
    if sys.platform in ("darwin", "win32"):
        return "SSH_CONNECTION" not in os.environ
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _open(path: str) -> None:
    """Open a page in the user's browser, or report that it fails."""
    import webbrowser
    from pathlib import Path

    if not webbrowser.open(Path(path).resolve().as_uri()):
        tell("No browser could be started.")
