"""prima schemas."""

from __future__ import annotations

import click

from prima.cli.common import tell
from prima.errors import UsageError


@click.command()
@click.argument("folder", type=click.Path())
def schemas(folder: str) -> None:
    """Copy the schemas of PRIMA's documents to a new FOLDER, for an editor that reads them.

    XML Schemas with a catalogue (catalog.xml) for VS Code, IntelliJ and oXygen, RELAX NG
    with locating rules (schemas.xml) for Emacs; docs/editors.md says how to set them up.

    \b
    prima schemas my-robot/schemas
    """
    import shutil

    from prima import loading

    try:
        shutil.copytree(loading.schemas_folder(), folder)
    except FileExistsError:
        raise UsageError(f"{folder}: is there already; name a new folder.") from None
    except OSError as error:
        raise UsageError(f"{folder}: cannot be written: {error.strerror or error}.") from None
    tell(f"{folder}: schemas, catalog.xml (XML Schema), schemas.xml (RELAX NG)")
