"""Fetching what an application names: documents, scripts, data and grammars (6.1).

A file of the application's folder is there at once. What a service or a host has to answer
takes time: the application asks, and is in its transitioning state until the answer is there.
"""

from __future__ import annotations

from collections.abc import Generator
from urllib.parse import urldefrag

from prima.errors import DocumentError
from prima.interpreter.places import source
from prima.interpreter.transfers import Thrown
from prima.language.values import milliseconds
from prima.markup.tree import Node
from prima.messages import Command, Data, Fetched
from prima.voicexml.document import FetchError, Page, broken, of_web
from prima.voicexml.reading import read_page
from prima.voicexml.settings import setting
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Resume, UriRequest

STEP_BYTES = 200
"""How many bytes of a resource count as one step."""
FETCH_TIMEOUT = 10_000
"""The default of ``fetchtimeout`` (ms)."""
WITHOUT_AUDIO = ("grammar", "script")
"""Elements whose resources are fetched without ``fetchaudio`` (6.3.5)."""
HOSTS_ONLY = "what a host has sent names no file, only what hosts and services answer"


class Missing(Thrown):
    """A resource must be fetched before a grammar that names it can be loaded."""

    def __init__(self, uri: str, node: Node) -> None:
        super().__init__("error.badfetch", f"{uri} has not been fetched", source(node))
        self.uri = uri
        self.node = node


def load_page(
    shared: SharedState, uri: str, node: Node, request: UriRequest | None = None
) -> Generator[None, Resume, Page]:
    """Fetch and read another document of the application.

    Raises:
        Thrown: ``error.badfetch``, with what is wrong with the document; ``error.semantic``
            for an application root that names a root itself (1.5.2).
    """
    asks = node.tag != "vxml" and bool(shared.document.outside(uri))  # a root is kept (6.1.2)
    page = None if asks else shared.pages.get(uri)
    if page is not None:
        _check_reach(page.root.source.file, uri, node)
    else:
        data = yield from fetch(shared, uri, node, request)
        try:
            page = _read(shared, uri, data)
            error = broken(page)
        except DocumentError as failure:
            error = failure
        if error is not None or page is None:
            message = str(error.problems[0]) if error else uri
            raise Thrown.at(node, "error.badfetch", message)
        if not asks:
            shared.pages[uri] = page
    if node.tag == "vxml" and page.application:
        message = f"{uri} names an application root itself"
        raise Thrown.at(node, "error.semantic", message)
    return page


def _read(shared: SharedState, uri: str, data: bytes) -> Page:
    """Read a document; one from a host is not part of the folder, whatever URI the folder maps."""
    if uri in shared.hosted:
        where = shared.hosted[uri]
        return read_page(where, where, data)
    return read_page(uri, shared.document.seen(uri), data, shared.document.page.site)


def fetch(
    shared: SharedState, uri: str, node: Node, request: UriRequest | None = None
) -> Generator[None, Resume, bytes]:
    """A resource's bytes.

    Raises:
        Thrown: ``error.badfetch``, with ``.http.STATUS`` where a host has answered so (5.2.6).
    """
    whole = urldefrag(uri)[0]
    asked = shared.document.outside(whole)
    if not asked:
        return _weighed(shared, _file(shared, whole, node), node)
    answer = yield from _asked(shared, asked, node, request or UriRequest())
    if answer.problem:
        lacks = asked != whole  # the folder represents the server, which has no such file
        status = answer.status or (404 if lacks and not shared.waits.overdue else 0)
        name = f"error.badfetch.http.{status}" if status else "error.badfetch"
        missing = "the folder has no such file; " if lacks else ""
        raise Thrown.at(node, name, f"{asked}: {missing}{answer.problem}")
    if answer.host:
        shared.hosted[whole] = urldefrag(answer.moved)[0] or asked
    else:
        shared.hosted.pop(whole, None)
    return _weighed(shared, answer.body.encode(answer.charset), node)


def _weighed(shared: SharedState, data: bytes, node: Node) -> bytes:
    """Count the bytes to read as steps: reading a lot again and again is a loop as well."""
    for _ in range(len(data) // STEP_BYTES):
        shared.app.count_step(node)
    return data


def _asked(
    shared: SharedState, uri: str, node: Node, request: UriRequest
) -> Generator[None, Resume, Fetched]:
    """Request a resource, and play prompts and fetch audio until the answer arrives (6.1.1)."""
    timeout = milliseconds(_setting(shared, node, "fetchtimeout"), FETCH_TIMEOUT)
    data: Data = {"method": request.method or "get", "params": dict(request.values)}
    late = Fetched(shared.app.name, 0, "", problem="no answer within its fetchtimeout")
    shared.waits.ask(uri, data, late, timeout, node)
    audio = "" if node.tag in WITHOUT_AUDIO else _setting(shared, node, "fetchaudio")
    if audio and not shared.gone:
        said = Command("speak", text=f"[{audio.rpartition('/')[2]}]", source=source(node))
        queued = shared.queue.take()
        yield from shared.waits.pass_time(queued, [said])
    return (yield from shared.waits.fetched())


def _check_reach(where: str, uri: str, node: Node) -> None:
    """Refuse a file that a document from a host would read or go to.

    Raises:
        Thrown: ``error.badfetch``.
    """
    if of_web(node.source.file) and not of_web(where):
        raise Thrown.at(node, "error.badfetch", f"{uri}: {HOSTS_ONLY}")


def _setting(shared: SharedState, node: Node, name: str) -> str:
    """A setting of a fetch: the element's attribute, even if empty, or the property (6.3.5)."""
    wider = setting(shared.context, name) if shared.context is not None else ""
    return node.get(name, wider)


def _file(shared: SharedState, uri: str, node: Node) -> bytes:
    _check_reach(uri, uri, node)
    try:
        return shared.document.fetch(uri)
    except FetchError as error:
        raise Thrown.at(node, "error.badfetch", f"{uri}: {error}") from None


# Grammars -----------------------------------------------------------------------------------


def held(shared: SharedState, uri: str, node: Node) -> bytes:
    """The bytes of a grammar: of a file, or fetched when it was found missing.

    Raises:
        Thrown: ``error.badfetch``; :class:`Missing` if it has not been fetched yet.
    """
    whole = _held_as(shared, uri, node)
    if not shared.document.outside(whole):
        return _file(shared, whole, node)
    found = shared.resources.get(whole)
    if found is None:
        raise Missing(whole, node)
    return found


def _held_as(shared: SharedState, uri: str, node: Node) -> str:
    """The key of a resource that a grammar names: its name if it is in the folder."""
    whole, site = urldefrag(uri)[0], shared.document.page.site
    return whole if site is None or of_web(node.source.file) else site.name(whole)


def refusal(shared: SharedState, by: str, uri: str, node: Node) -> str:
    """Why one grammar may not refer to another, by their URIs; nothing if it may."""
    if _held_as(shared, by, node) not in shared.hosted:
        return ""
    return "" if shared.document.outside(_held_as(shared, uri, node)) else HOSTS_ONLY


def decoded(data: bytes, charset: str) -> str:
    """A script's text, by the charset that its element names (5.3.12)."""
    try:
        return data.decode(charset or "utf-8-sig", errors="replace")
    except LookupError:
        return data.decode(errors="replace")
