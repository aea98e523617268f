"""prima documents."""

from __future__ import annotations

import shutil
from pathlib import Path

import click

from prima.cli.options import PathName
from prima.cli.printing import tell
from prima.errors import UsageError


@click.command()
@click.argument("folder", type=PathName())
def documents(folder: str) -> None:
    """Copy the documents that come with PRIMA to a new FOLDER, to read, run and change.

    \b
    prima documents my-robot
    prima run my-robot/scenarios/follow-during-navigation.xml
    """
    from prima import api

    copy_folder(api.documents_folder(), folder)
    tell(f"{folder}: applications, worlds, robots and scenarios")


def copy_folder(source: Path, folder: str) -> None:
    """Copy a folder that comes with PRIMA to a new one.

    Raises:
        UsageError: the new one exists already, or cannot be written.
    """
    try:
        shutil.copytree(source, folder)
    except FileExistsError:
        raise UsageError(f"{folder}: already exists; name a new folder.") from None
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written: {error.strerror or error}.") from None
