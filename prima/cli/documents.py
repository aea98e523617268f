"""prima documents."""

from __future__ import annotations

import click

from prima.cli.common import tell
from prima.errors import UsageError


@click.command()
@click.argument("folder", type=click.Path())
def documents(folder: str) -> None:
    """Copy the documents that come with PRIMA to a new FOLDER, to read, run and change.

    \b
    prima documents my-robot
    prima run my-robot/scenarios/follow-during-navigation.xml
    """
    import shutil

    from prima import api

    try:
        shutil.copytree(api.documents_folder(), folder)
    except FileExistsError:
        raise UsageError(f"{folder}: is there already; name a new folder.") from None
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written: {error.strerror}.") from None
    tell(f"{folder}: applications, worlds, robots and scenarios")
