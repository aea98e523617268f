"""The output of prima talk."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from prima.cli.printing import clean, coloured, columns, echo, put, tell
from prima.cli.terminal import Keyboard

if TYPE_CHECKING:
    from prima.talk import Game
    from prima.transcript.row import Row

COLOURS = {"U": "cyan", "E": "yellow"}
"""Colours of rows, by who does it."""


class TerminalScreen:
    """Prints rows, answers and messages above the line being typed, if any."""

    def __init__(self, game: Game, why: bool, json: bool, interactive: bool) -> None:
        self.interactive = interactive
        self.typist: Keyboard | None = None
        self._why = why
        self._json = json
        self._apps = game.names.applications
        self._headed = False

    def rows(self, rows: list[Row]) -> None:
        """Show rows as they happen."""
        from prima.transcript.table import format_head, format_row, layout

        if self._json:
            return
        shape = layout(self._apps, columns(), self._why)
        lines = [] if self._headed else [format_head(shape)]
        self._headed = True
        for row in rows:
            text = "\n".join(format_row(row, shape))
            colour = COLOURS.get(row.actor) if coloured() else None
            lines.append(click.style(clean(text), fg=colour) if colour else clean(text))
        self._print("\n".join(lines), styled=True)

    def show(self, text: str) -> None:
        """Show the result of a command; with JSON records on stdout, as a message."""
        if self._json:
            self.tell(text)
        else:
            self._print(text)

    def tell(self, text: str) -> None:
        """Print a message."""
        if self.typist is not None:
            self.typist.clear()
        tell(text)
        if self.typist is not None:
            self.typist.restore()

    def _print(self, text: str, styled: bool = False) -> None:
        if self.typist is not None:
            self.typist.clear()
        if styled:
            echo(text)
        else:
            put(text)
        sys.stdout.flush()
        if self.typist is not None:
            self.typist.restore()
