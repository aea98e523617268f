"""Fetching what an application names: documents, scripts, data and grammars."""

from __future__ import annotations

from typing import TYPE_CHECKING
from urllib.parse import urldefrag

from prima.errors import DocumentError
from prima.interpreter.content import source
from prima.markup.tree import Node
from prima.voicexml.document import FetchError, Page, broken, read_page
from prima.voicexml.state import Thrown

if TYPE_CHECKING:
    from prima.voicexml.machine import Machine


def load_page(owner: Machine, uri: str, node: Node) -> Page:
    """Fetch and read another document of the application.

    Raises:
        Thrown: ``error.badfetch``, with what is wrong with the document; ``error.semantic``
            for an application root that names a root itself (1.5.2).
    """
    page = owner.pages.get(uri)
    if page is None:
        data = owner.fetch(uri, node)
        try:
            page = read_page(uri, uri, data)
            error = broken(page)
        except DocumentError as failure:
            error = failure
        if error is not None or page is None:
            message = f"{source(node)}: {error.problems[0] if error else uri}"
            raise Thrown("error.badfetch", message, source(node))
        owner.pages[uri] = page
    if node.tag == "vxml" and page.application:
        message = f"{source(node)}: {uri} names an application root itself"
        raise Thrown("error.semantic", message, source(node))
    return page


def fetch(owner: Machine, uri: str, node: Node) -> bytes:
    """A resource's bytes.

    Raises:
        Thrown: ``error.badfetch`` or what the fetcher says.
    """
    try:
        return owner.document.fetch(urldefrag(uri)[0])
    except FetchError as error:
        raise Thrown(error.event, f"{source(node)}: {uri}: {error}", source(node)) from None


def decoded(data: bytes, charset: str) -> str:
    """A script's text, by the charset that its element names (5.3.12)."""
    try:
        return data.decode(charset or "utf-8-sig", errors="replace")
    except LookupError:
        return data.decode(errors="replace")
