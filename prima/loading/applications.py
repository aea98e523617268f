"""Loads applications of both languages, with the files of their folder that they name."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from prima.errors import (
    DocumentError,
    Problem,
    has_errors,
)
from prima.interpreter.elements import Document
from prima.interpreter.reader import read_document
from prima.loading.files import Folder, absolute, check_name, read_file
from prima.loading.kinds import is_voicexml
from prima.loading.similar import alike

if TYPE_CHECKING:
    from prima.devices.endpoints import Endpoint
    from prima.grammar import Grammar
    from prima.session import AnyDocument
    from prima.voicexml.site import Site


Taken = Callable[[str, bytes], object]
"""Receives the name and the bytes of each file that a document includes."""


def read_application(
    path: str,
    data: bytes,
    name: str = "",
    kind: str = "",
    site: Site | None = None,
    taken: Taken | None = None,
) -> tuple[AnyDocument, list[Problem]]:
    """Read an application of either language; a VoiceXML document is named after its file.

    ``kind`` is ``fa`` or ``ea`` if the run specifies it; it overrides the document's.
    ``site`` is where a VoiceXML document and its folder are served. ``taken`` is called with
    each grammar that a document of PRIMA's own language names.

    Raises:
        DocumentError: there is no document at all.
    """
    if not is_voicexml(data):
        native, problems = read_native(path, data, taken)
        if kind and native.kind != kind:
            native = replace(native, kind=kind)  # others may run the same document unchanged
        return native, problems
    from prima.voicexml.document import VoiceDocument
    from prima.voicexml.reading import read_page

    file = Path(path)
    page = read_page(site.name(site.uri) if site else file.name, path, data, site)
    own = name or named_after(file)
    folder = Folder(str(absolute(site.folder if site else file.parent)))
    return VoiceDocument(
        own, kind or "ea", path, page, folder.fetch, page.root, folder.glance
    ), page.problems


def named_after(file: Path) -> str:
    """The name of a VoiceXML document in a file, if the run gives it no other."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", file.stem).strip("-") or "voice"


def read_native(
    path: str, data: bytes, taken: Taken | None = None
) -> tuple[Document, list[Problem]]:
    """Read an application in PRIMA's own language, with the grammars in its folder."""

    fetched = fetcher(Path(path).parent)

    def fetch(uri: str) -> bytes:
        found = fetched(uri)
        if taken is not None:
            taken(uri, found)
        return found

    return read_document(path, data, fetch)


def load(path: str | Path) -> Document:
    """Load an application in PRIMA's language.

    Raises:
        DocumentError: with all problems, if any is an error.
        UsageError: the file cannot be read.
    """
    document, problems = read_native(check_name(path), read_file(path))
    if has_errors(problems):
        raise DocumentError(problems)
    return document


def fetcher(folder: Path, site: Site | None = None) -> Callable[[str], bytes]:
    """Returns the bytes of grammars in a folder, by their URIs if it was copied from a site."""
    listed: dict[Path, list[Path]] = {}

    def fetch(uri: str) -> bytes:
        from prima.grammar.errors import NotThere
        from prima.voicexml.document import FetchError

        name = site.name(uri) if site else uri
        try:
            return Folder(str(folder)).fetch(name)
        except FetchError as error:
            beside = ":" not in name and not name.startswith(("/", "../"))
            other = alike(folder / unquote(name), listed) if beside else ""
            raise NotThere(str(error).rstrip("."), other) from None

    return fetch


def in_folder(folder: Path, problem: Problem) -> Problem:
    """A problem of a file, with the file's path in a folder."""
    return problem._replace(place=problem.place._replace(file=str(folder / problem.place.file)))


def digest(data: bytes) -> str:
    """The SHA-256 of a file's bytes, in hexadecimal."""
    import hashlib

    return hashlib.sha256(data).hexdigest()


def load_services(path: str) -> tuple[list[Endpoint], str]:
    """Load a document of services; gives its digest as well.

    Raises:
        DocumentError: with all its problems.
        UsageError: the file cannot be read.
    """
    data = read_file(path)
    return services_of(path, data), digest(data)


def services_of(path: str, data: bytes) -> list[Endpoint]:
    """Read a document of services, with the grammars of its folder that it names.

    Raises:
        DocumentError: with all its problems.
    """
    from prima.devices.endpoints import read_services
    from prima.grammar import load

    folder = Path(path).parent
    fetch = fetcher(folder)

    def grammar(name: str) -> Grammar:
        try:
            return load(fetch(name), base=name, fetch=fetch)
        except DocumentError as error:
            raise DocumentError([in_folder(folder, one) for one in error.problems]) from None

    return read_services(path, data, grammar)
