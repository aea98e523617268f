"""Where URIs lead: to dialogs of this document or of others (VoiceXML 2.0, 1.5.2 and 5.3.7)."""

from __future__ import annotations

from collections.abc import Generator
from urllib.parse import urldefrag

from prima.interpreter.transfers import Thrown
from prima.markup.tree import Node
from prima.markup.uris import legal, parted
from prima.voicexml.document import Page
from prima.voicexml.fetching import load_page
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow, GoDialog, Resume, UriRequest


def go_to(
    shared: SharedState, context: Context, uri: str, node: Node, request: UriRequest | None = None
) -> Flow:
    """Follow a URI to a dialog (5.3.7).

    Raises:
        GoDialog: with the page, or without where it is this one.
        Thrown: ``error.badfetch``.
    """
    page, dialog = yield from find_dialog(shared, context, uri, node, request)
    if page is not None:
        yield from root_of(shared, page, context)  # a document needs its root
    raise GoDialog(page, dialog, submitted=request is not None)


def find_dialog(
    shared: SharedState, context: Context, uri: str, node: Node, request: UriRequest | None = None
) -> Generator[None, Resume, tuple[Page | None, str]]:
    """The dialog that a URI names, and its document where that is fetched.

    With a ``request`` it is always fetched, even where the URI has a fragment only.

    Raises:
        Thrown: ``error.badfetch``.
    """
    if not uri:
        raise Thrown.at(node, "error.badfetch", "the URI is missing")
    target, fragment = parted(legal(uri))
    page = None
    if target or request is not None:
        here, root = context.page, context.root
        whole = urldefrag(here.resolve(uri, node))[0] if target else here.uri
        if request is None and root is not None and root.uri == whole:
            page = root  # it is loaded, even if it is what a submit was answered with
        else:
            page = yield from load_page(shared, whole, node, request)
    _check_dialog(page or context.page, fragment, node, f" in {page.uri}" if page else "")
    return page, fragment


def root_of(
    shared: SharedState, page: Page, context: Context | None = None
) -> Generator[None, Resume, Page | None]:
    """The application root of a leaf: the one loaded in a context, or another (1.5.2).

    Raises:
        Thrown: ``error.badfetch`` or ``error.semantic``.
    """
    uri = page.application
    if not uri or uri == page.uri:
        return None
    for loaded in (context.page, context.root) if context is not None else ():
        if loaded is not None and loaded.uri == uri and not loaded.application:
            return loaded
    return (yield from load_page(shared, uri, page.root))


def _check_dialog(page: Page, fragment: str, node: Node, where: str) -> None:
    """Refuse a fragment that names no dialog.

    Raises:
        Thrown: ``error.badfetch``.
    """
    nameless = fragment.startswith("#")  # so are the keys of dialogs without an id
    if nameless or page.dialog(fragment) is None:
        name = f' "{fragment}"' if fragment else ""
        raise Thrown.at(node, "error.badfetch", f"there is no dialog{name}{where}")
