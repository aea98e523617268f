"""A folder of files that represents a site at a URI (2.0, 6.1.1)."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import quote, unquote, urljoin, urlsplit

from prima.markup.uris import legal


@dataclass(frozen=True, slots=True)
class Site:
    """Where an application was copied from.

    ``uri`` is that of its first document, ``root`` that of its folder, with a ``/`` at its end.
    """

    uri: str
    root: str
    folder: str

    def whole(self, uri: str) -> str:
        """The URI of a name in the folder; any other name unchanged."""
        return uri if urlsplit(legal(uri)).scheme else self.root + uri.removeprefix("./")

    def name(self, uri: str) -> str:
        """The name in the folder of a URI's file; a URI outside it unchanged."""
        if not uri.startswith(self.root):
            return uri
        name = uri[len(self.root) :]
        return f"./{name}" if ":" in name.partition("/")[0] else name  # not a scheme

    def join(self, base: str, uri: str) -> str:
        """A URI resolved against its base; as a name if it is in the folder."""
        return self.name(urljoin(self.whole(base), legal(uri)))


def site_of(file: str, uri: str, folder: str = "") -> Site:
    """The site of a first document's file; by default the file's own folder represents the URI's.

    Raises:
        ValueError: with a message and a remedy: the document cannot be at that URI.
    """
    parts = urlsplit(uri)
    if parts.scheme not in ("http", "https") or not parts.netloc or parts.query or parts.fragment:
        raise ValueError(
            f'"{uri}" is not the URI of a document.',
            'Write the whole one, such as "https://example.org/app/main.vxml".',
        )
    if not folder:
        root = uri[: uri.rindex("/") + 1] if parts.path else f"{uri}/"
        return Site(uri, root, os.path.dirname(file) or ".")
    inside = within(file, folder)
    if inside is None:
        raise ValueError(f'"{file}" is not in the folder "{folder}".', "Name a folder above it.")
    written = "/".join(uri.split("/")[-1 - inside.count("/") :])
    if unquote(written) != inside:
        raise ValueError(
            f'"{uri}" does not end as the document\'s path in "{folder}".',
            f'It should end with "/{inside}".',
        )
    return Site(uri, uri.removesuffix(written), folder)


def within(file: str, folder: str) -> str | None:
    """A file's path relative to a folder above it, separated by ``/``; None if it is not in it."""
    path = os.path.relpath(os.path.abspath(file), os.path.abspath(folder))
    return None if path.split(os.sep)[0] == os.pardir else path.replace(os.sep, "/")


def mapping_of(text: str) -> tuple[str, str]:
    """The URI and the folder of a mapping on the command line, ``URI=FOLDER``.

    Raises:
        ValueError: it is not such a mapping.
    """
    uri, folder = halves(text)
    parts = urlsplit(uri)
    if parts.scheme not in ("http", "https") or not parts.netloc or not folder:
        raise ValueError(
            f'"{text}" maps no URI to a folder.', 'Write "https://example.org/app/=folder/".'
        )
    return f"{uri.rstrip('/')}/", folder


def halves(text: str) -> tuple[str, str]:
    """The URI and the folder of ``URI=FOLDER``, unchecked; in a URI that ends with ``/`` may be ``=``."""
    uri, mark, folder = text.partition("/=")
    return (f"{uri}/", folder) if mark else text.partition("=")[::2]


def mapped(file: str, maps: Mapping[str, str]) -> tuple[str, str] | None:
    """The URI of a file by the mapping whose folder holds it, the innermost one, and that folder."""
    found = [(uri, folder) for uri, folder in maps.items() if within(file, folder) is not None]
    if not found:
        return None
    uri, folder = max(found, key=lambda one: len(os.path.abspath(one[1])))
    return uri + quote(within(file, folder) or ""), folder
