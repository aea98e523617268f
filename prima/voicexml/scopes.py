"""Documents and their scopes (VoiceXML 2.0, 1.5.2 and 5.1)."""

from __future__ import annotations

from prima.markup.tree import Node
from prima.script.evaluation import Scope
from prima.voicexml.content import Content
from prima.voicexml.document import Page
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow
from prima.voicexml.targets import root_of

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

    def __init__(self, shared: SharedState, content: Content) -> None:
        self.shared = shared
        self.content = content
        self.engine = shared.engine

    def begin(self) -> Scope:
        """Make the scope of the whole session (5.1.4); documents see it and cannot change it."""
        session, nothing = self.engine.scope(), self.engine.nothing
        self.engine.put(session, "session", session)
        given = self.engine.scope({"given": dict(self.shared.app.connection)})
        for code in (CONNECTION, TELEPHONE):
            self.engine.raw(code, (session, nothing, nothing, nothing, given))
        self.shared.session = session
        return self.engine.view(session)

    def enter(self, context: Context, page: Page, submitted: bool = False) -> Flow:
        """Make a document the active one, keeping its application's state (1.5.2)."""
        root = yield from root_of(self.shared, page, context)
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
            self.engine.unset(scope, "lastresult$")  # nothing has been heard yet (5.1.5)
        context.dialog = self.engine.named("dialog")
        for node in page.root.all("var", "script", "data"):
            yield from self.declare(node, scope, context)

    def declare(self, node: Node, scope: Scope, context: Context) -> Flow:
        """Run a declaration of a document or form: a variable, a script's variables, or data."""
        content, local = self.content, self.shared.local()
        match node.tag:
            case "script":
                yield from content.script(node, scope, context, local)
            case "data":
                yield from content.data(node, scope, context, local)
            case _:
                content.declare(node, scope, context, local)
