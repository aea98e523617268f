"""The folders of documents and schemas that come with the package."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prima.loading.files import path_of

if TYPE_CHECKING:
    from pathlib import Path


def schemas_folder() -> Path:
    """The folder of the schemas that come with the package."""
    inside = path_of(__file__).parent.parent / "schemas"
    return inside if inside.is_dir() else path_of(__file__).parent.parent.parent / "schemas"


def documents_folder() -> Path:
    """The folder of the demo documents that come with the package."""
    inside = path_of(__file__).parent.parent / "documents"
    return inside if inside.is_dir() else path_of(__file__).parent.parent.parent / "documents"
