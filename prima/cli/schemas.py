"""prima schemas."""

from __future__ import annotations

import click

from prima.cli.documents import copy_folder
from prima.cli.options import PathName
from prima.cli.printing import tell


@click.command()
@click.argument("folder", type=PathName())
def schemas(folder: str) -> None:
    """Copy the schemas of PRIMA's documents to a new FOLDER, for editors.

    XML Schemas with a catalogue (catalog.xml) for VS Code, IntelliJ and oXygen, RELAX NG
    with locating rules (schemas.xml) for Emacs; docs/editors.md says how to set them up.

    \b
    prima schemas my-robot/schemas
    """
    from prima import loading

    copy_folder(loading.schemas_folder(), folder)
    tell(f"{folder}: schemas, catalog.xml (XML Schema), schemas.xml (RELAX NG)")
