"""Events: which handler takes one, and what the platform does itself (VoiceXML 2.0, 5.2)."""

from __future__ import annotations

from prima.interpreter.selection import Candidate, Takers, select_handler, takes, taking
from prima.interpreter.transfers import MAX_DEPTH, GoBack, GoItem, GoOut, Thrown, thrown_of
from prima.markup.tree import Node
from prima.script.evaluation import Scope, ScriptError
from prima.voicexml.content import Content
from prima.voicexml.document import Page
from prima.voicexml.elements import HANDLERS, handler_names, handler_number
from prima.voicexml.platform import own_words
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow, HungUp, Unasked

ASKED_AGAIN = ("noinput", "nomatch", "help", "maxspeechtimeout")
"""Events after which the platform's own handlers ask again (5.2.5)."""


class Events:
    """Handles the events of one application."""

    def __init__(self, shared: SharedState, content: Content) -> None:
        self.shared = shared
        self.content = content
        self.engine = shared.engine
        self._page: Page | None = None
        self._kept: Takers[Node] = Takers()
        """Of that document alone: the handlers would keep others in memory."""

    def handle(self, context: Context, thrown: Thrown, depth: int = 0) -> Flow:
        """Find an event's handler and run it, or do what the platform does (5.2.4, 5.2.5)."""
        self.count(context, thrown)
        try:
            if isinstance(thrown, HungUp):
                yield from self._hang_up(thrown)
            handler = self.find(context, thrown)
            if handler is None:
                yield from self._default(context, thrown)
                return
            yield from self._run(context, handler, thrown)
        except (Thrown, ScriptError) as error:
            again = thrown_of(error)
            self.shared.app.count_step(self.shared.document.node)
            if depth > MAX_DEPTH:
                message = f"error.semantic: {again.source}: its handlers throw without end"
                raise GoOut(message, True) from None
            yield from self.handle(context, again, depth + 1)

    def find(self, context: Context, thrown: Thrown) -> Node | None:
        """The handler of an event: innermost scope, prefix, condition, count, order (5.2.4)."""
        local, where = self._scope(thrown), _place(context)
        found = self._takers(context, thrown)
        self.shared.app.count_looked_at(self.shared.document.node, found)
        return select_handler(
            found,
            lambda name: context.counters.seen(where, name),
            lambda one: self.content.holds(one, context, local),
        )

    def takes(self, context: Context, thrown: Thrown) -> bool:
        """Whether a handler would take an event, without counting it."""
        try:
            return self.taker(context, thrown) is not None
        except Thrown:
            return True

    def taker(self, context: Context, thrown: Thrown) -> Node | None:
        """The handler that would take an event, without counting it.

        Raises:
            Thrown: for a condition that fails.
        """
        held = context.counters
        self.count(context, thrown)
        try:
            return self.find(context, thrown)
        finally:
            context.counters = held

    def finish(self, context: Context) -> Flow:
        """Play what is queued at an application's end (4.1.8); no events are handled any more.

        If the user hangs up meanwhile, there is nobody left to hear the rest (1.5.4).
        """
        self.shared.context = None
        if self.shared.queue and not self.shared.gone:
            try:
                yield from self.shared.play()
            except HungUp as thrown:
                self.shared.gone = thrown.name
            except Thrown as thrown:
                yield from self.unhandled(context, thrown)

    def unhandled(self, context: Context, thrown: Thrown) -> Flow:
        """Play what is queued, then end the application with an unhandled event."""
        yield from self.finish(context)
        raise GoOut(thrown.reason, True, thrown.source)

    def count(self, context: Context, thrown: Thrown) -> None:
        """Count an event where it was thrown, under its name and all prefixes (5.2.2).

        Only names that a handler uses are counted.
        """
        names = {name for one in self._takers(context, thrown) for name in one.names}
        context.counters = context.counters.came(_place(context), names)

    def _takers(self, context: Context, thrown: Thrown) -> list[Candidate[Node]]:
        """The handlers in scope that take an event; one for all events takes VoiceXML's own alone."""
        if context.page is not self._page:
            self._page, self._kept = context.page, Takers()
        scopes = _scopes(context)
        key = (*scopes, thrown.name, thrown.shared)
        takers = self._kept.get(key)
        if takers is None:
            found = [one for node in scopes if node is not None for one in node.all(*HANDLERS)]
            self.shared.app.count_looked_at(self.shared.document.node, found)
            known = (
                Candidate(one, tuple(handler_names(one)), handler_number(one)) for one in found
            )
            takers = taking(known, thrown.name, by_name=thrown.shared)
            self._kept.keep(key, takers)
        return takers

    def _scope(self, thrown: Thrown) -> Scope:
        """The anonymous scope of a handler, with ``_event`` and ``_message`` (5.2.2)."""
        if thrown.message or thrown.worded:
            return self.engine.scope({"_event": thrown.name, "_message": thrown.message})
        return self.engine.scope({"_event": thrown.name}, "_message")

    def _run(self, context: Context, handler: Node, thrown: Thrown) -> Flow:
        """Run a handler as if where the event was thrown; the next item may be quiet."""
        self.shared.reprompted = False
        try:
            yield from self.content.run(handler, context, self._scope(thrown))
        except GoItem:
            context.quiet = not self.shared.reprompted  # the dialog is still the same (5.3.6)
            raise
        context.quiet = not self.shared.reprompted

    def _hang_up(self, thrown: HungUp) -> Flow:
        """The user is gone: play what is queued before, and nothing after (5.3.11)."""
        try:
            if self.shared.queue and not (thrown.outside or self.shared.gone):
                yield from self.shared.play()
        finally:
            self.shared.gone = thrown.name

    def _default(self, context: Context, thrown: Thrown) -> Flow:
        """The platform's own handlers (5.2.5)."""
        if any(takes(one, thrown.name) for one in ASKED_AGAIN):
            context.quiet = False
            lang = context.page.lang
            words = own_words(lang).items()
            said = next((text for one, text in words if takes(one, thrown.name)), "")
            self.content.say(said, lang, thrown.source)
        elif takes("cancel", thrown.name):
            context.quiet = True
        elif isinstance(thrown, Unasked):
            raise GoBack(None, thrown.name, thrown.message)
        elif takes("exit", thrown.name) or takes("connection.disconnect", thrown.name):
            raise GoOut(thrown.name)
        else:
            yield from self.unhandled(context, thrown)


def _scopes(context: Context) -> tuple[Node | None, ...]:
    """The elements whose handlers are in scope, innermost first (5.2.4)."""
    item = context.item if context.item is not context.form else None
    root = context.root.root if context.root else None
    unit = context.unit if context.unit is not context.item else None
    return item, unit, context.form, context.page.root, root


def _place(context: Context) -> int:
    """Where events are counted: at the item, or at the dialog itself."""
    return context.item.index if context.item is not None else -1
