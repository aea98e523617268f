"""The command line: the only place that prints, sets exit codes and catches everything.

Exit codes: 0 fine; 1 problems found, or transcripts differ; 2 wrong usage or
unreadable input; 3 a run ended by an error or a limit; 130 Ctrl-C.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module

import click

from prima.cli.failures import exit_code, interrupted, last_words
from prima.cli.interrupts import interruptible
from prima.cli.printing import escape_for_people
from prima.errors import did_you_mean
from prima.version import __version__

COMMANDS = {
    "demo": "Run two applications on one robot; see the report.",
    "new": "Start a document that is commented, valid, and runs.",
    "validate": "Check documents; certify what one can do to another.",
    "run": "Run a scenario in simulation and print its transcript.",
    "talk": "Play the user of a run in the terminal.",
    "live": "Run applications on a robot, in real time.",
    "test": "Check what scenarios expect; cover documents.",
    "show": "Print a transcript as a table.",
    "diff": "Compare two runs by behaviour.",
    "report": "Show a run, two compared, or a sweep as a page for the browser.",
    "graph": "Draw an application's states, or a run's trees and streams.",
    "replay": "Run a transcript's inbound events again.",
    "export": "Write a transcript for ELAN, Praat, a player, Foxglove, a table.",
    "explain": "Explain a rule, a problem's code, or a transcript's row.",
    "study": "Measure situations under every policy.",
    "sweep": "Run scenarios over many values; write a tidy table.",
    "explore": "Find every order of events that other timings bring.",
    "documents": "Copy the documents that come with PRIMA.",
    "schemas": "Copy the schemas of documents, for editors.",
    "lsp": "Serve an editor while documents are written.",
}
"""Each is a module of this package with a command of the same name, in the order of the help.

The descriptions are here so that the help imports none of them.
"""


class Commands(click.Group):
    """Commands, imported when used; suggests one for a misspelt name."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names of all commands."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """A command by its name."""
        if cmd_name not in COMMANDS:
            return None
        found = getattr(import_module(f"prima.cli.{cmd_name}"), cmd_name)
        assert isinstance(found, click.Command)
        return found

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find a command, or suggest the one probably meant."""
        name = args[0] if args else ""
        if name and not name.startswith("-") and self.get_command(ctx, name) is None:
            hint = did_you_mean(name, self.list_commands(ctx)) or "prima --help lists them."
            raise click.UsageError(f'There is no command "{name}". {hint}'.rstrip(), ctx)
        return super().resolve_command(ctx, args)


@click.group(cls=Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="prima")
def cli() -> None:
    """Mediate robot applications written as XML documents.

    \b
    prima demo
    prima validate documents/fa/follow.xml
    prima run documents/scenarios/follow-during-navigation.xml
    """


def main() -> None:
    """Run the command line; each ending has its exit code and no traceback."""
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115
    escape_for_people()
    with interruptible():
        try:
            code = cli.main(standalone_mode=False)
            sys.stdout.flush()
        except (click.Abort, KeyboardInterrupt) as error:
            ended = error.__cause__  # click takes the end of any file for Ctrl-D
            code = exit_code(ended) if isinstance(ended, EOFError) else interrupted()
        except (Exception, SystemExit) as error:
            code = exit_code(error)
    last_words()
    sys.exit(code if isinstance(code, int) else 0)
