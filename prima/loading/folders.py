"""The folders of documents and schemas that come with the package."""

from __future__ import annotations

from pathlib import Path


def shipped(name: str, folder: str = "") -> Path:
    """A file or folder of the package; in a checkout it is beside the package, in a folder."""
    package = Path(__file__).parent.parent
    inside = package / name
    return inside if inside.exists() else package.parent / folder / name


def schemas_folder() -> Path:
    """The folder of the schemas that come with the package."""
    return shipped("schemas")


def documents_folder() -> Path:
    """The folder of the demo documents that come with the package."""
    return shipped("documents")
