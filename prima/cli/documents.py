"""prima documents."""

from __future__ import annotations

import click

from prima.cli.common import copy_folder, tell


@click.command()
@click.argument("folder", type=click.Path())
def documents(folder: str) -> None:
    """Copy the documents that come with PRIMA to a new FOLDER, to read, run and change.

    \b
    prima documents my-robot
    prima run my-robot/scenarios/follow-during-navigation.xml
    """
    from prima import api

    copy_folder(api.documents_folder(), folder)
    tell(f"{folder}: applications, worlds, robots and scenarios")
