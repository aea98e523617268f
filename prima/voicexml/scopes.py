"""Documents and their scopes: entering one, and going to another (VoiceXML 2.0, 1.5.2 and 5.1)."""

from __future__ import annotations

from collections.abc import Generator
from urllib.parse import urldefrag

from prima.interpreter.transfers import Thrown
from prima.markup.tree import Node
from prima.markup.uris import legal, parted
from prima.script.evaluation import Scope
from prima.voicexml.document import Page
from prima.voicexml.fetching import load_page
from prima.voicexml.owner import MachineOwner
from prima.voicexml.state import Context, Flow, GoDialog, Resume, UriRequest

CONNECTION = """session.connection = (function (held) {
  for (const name of ['local', 'remote', 'protocol']) held[name] = held[name] || {};
  if (held.originator) held.originator = held[held.originator];
  return held;
})(given)"""
"""The user's connection, as far as known; the rest is undefined (5.1.4)."""
TELEPHONE = """session.telephone =
  { ani: session.connection.remote.uri, dnis: session.connection.local.uri }"""
"""The variables of VoiceXML 1.0, and of many platforms after it."""


class Documents:
    """Enters the documents of one application."""

    def __init__(self, owner: MachineOwner) -> None:
        self.owner = owner
        self.engine = owner.engine
        self.session = owner.engine.nothing
        """The session's variables, for the platform alone (5.1.2)."""

    def begin(self) -> Scope:
        """Make the scope of the whole session (5.1.4); documents see it and cannot change it."""
        session, nothing = self.engine.scope(), self.engine.nothing
        self.engine.put(session, "session", session)
        given = self.engine.scope({"given": dict(self.owner.app.connection)})
        for code in (CONNECTION, TELEPHONE):
            self.engine.raw(code, (session, nothing, nothing, nothing, given))
        self.session = session
        return self.engine.view(session)

    def enter(self, context: Context, page: Page, submitted: bool = False) -> Flow:
        """Make a document the active one, keeping its application's state (1.5.2)."""
        root = yield from self.root(page, context)
        to_root = root is None and context.root is not None and context.root.uri == page.uri
        if to_root and not submitted:
            context.document = context.application
            context.page, context.root = page, None
            return
        try:
            if root is not None:
                yield from self._enter_root(context, root)
        finally:
            context.page, context.root = page, root
            context.document = self.engine.scope()
            if root is None:
                context.application = context.document
        yield from self._declare(context, page)

    def root(
        self, page: Page, context: Context | None = None
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
        return (yield from load_page(self.owner, uri, page.root))

    def _enter_root(self, context: Context, root: Page) -> Flow:
        """Enter the application of a leaf: the current one, or a new one."""
        if context.root is not None and context.root.uri == root.uri:
            return
        if context.root is None and context.page.uri == root.uri:
            context.application = context.document
            return
        context.page, context.root = root, None
        context.application = context.document = self.engine.scope()
        yield from self._declare(context, root)

    def _declare(self, context: Context, page: Page) -> Flow:
        """Make the variables of the active document, in document order (5.1.2)."""
        scope = context.document
        self.engine.put(scope, "document", scope)
        if context.application is scope:
            self.engine.put(scope, "application", scope)
        context.dialog = self.engine.named("dialog")
        for node in page.root.all("var", "script", "data"):
            yield from self.declare(node, scope, context)

    def declare(self, node: Node, scope: Scope, context: Context) -> Flow:
        """Run a declaration of a document or form: a variable, a script's variables, or data."""
        content, local = self.owner.content, self.owner.local()
        match node.tag:
            case "script":
                yield from content.script(node, scope, context, local)
            case "data":
                yield from content.data(node, scope, context, local)
            case _:
                content.declare(node, scope, context, local)

    def go(self, context: Context, uri: str, node: Node, request: UriRequest | None = None) -> Flow:
        """Follow a URI to a dialog (5.3.7).

        Raises:
            GoDialog: with the page, or without where it is this one.
            Thrown: ``error.badfetch``.
        """
        page, dialog = yield from self.find(context, uri, node, request)
        if page is not None:
            yield from self.root(page, context)  # a document needs its root
        raise GoDialog(page, dialog, submitted=request is not None)

    def find(
        self, context: Context, uri: str, node: Node, request: UriRequest | None = None
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
                page = yield from load_page(self.owner, whole, node, request)
        _check_dialog(page or context.page, fragment, node, f" in {page.uri}" if page else "")
        return page, fragment


def _check_dialog(page: Page, fragment: str, node: Node, where: str) -> None:
    """Refuse a fragment that names no dialog.

    Raises:
        Thrown: ``error.badfetch``.
    """
    nameless = fragment.startswith("#")  # so are the keys of dialogs without an id
    if nameless or page.dialog(fragment) is None:
        name = f' "{fragment}"' if fragment else ""
        raise Thrown.at(node, "error.badfetch", f"there is no dialog{name}{where}")
