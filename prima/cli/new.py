"""prima new."""

from __future__ import annotations

import click

from prima.cli.options import PathName, SuggestingChoice
from prima.cli.printing import tell

KINDS = ("fa", "ea", "vxml", "scenario", "world", "robot")


@click.command()
@click.argument("kind", type=SuggestingChoice(KINDS))
@click.argument("name", type=PathName())
def new(kind: str, name: str) -> None:
    """Start a document that is commented, valid, and runs.

    NAME is the file, with or without its suffix. A scenario uses the applications, the
    world and the robot in its folder; missing ones are written beside it. No file is
    ever overwritten.

    \b
    prima new ea guide
    prima new fa friend
    prima new scenario visit
    prima run visit.xml
    """
    from prima.templates import attempt, write

    written = write(kind, name)
    for path in written:
        tell(f"written: {path}")
    tell(f"Now try: {attempt(kind, written[-1])}")
