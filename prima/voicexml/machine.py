"""The Form Interpretation Algorithm of VoiceXML as one coroutine (2.0, 2.1.6 and appendix C)."""

from __future__ import annotations

from collections.abc import Generator

from prima.interpreter.places import source
from prima.interpreter.selection import Counters
from prima.interpreter.transfers import GoBack, GoItem, GoOut, Thrown, check_depth, thrown_of
from prima.markup.tree import Node
from prima.script.evaluation import ScriptError
from prima.voicexml.arranging import holds_inside, is_unit, parts_of
from prima.voicexml.calls import Calls
from prima.voicexml.choosing import ItemSelection
from prima.voicexml.content import Content
from prima.voicexml.document import Page
from prima.voicexml.elements import ITEMS
from prima.voicexml.events import Events
from prima.voicexml.inputs import Inputs
from prima.voicexml.items import Items
from prima.voicexml.questions import Questions
from prima.voicexml.recorder import RecordItems
from prima.voicexml.scopes import Documents
from prima.voicexml.shared import SharedState
from prima.voicexml.state import (
    Context,
    Flow,
    GoDialog,
    Params,
    Resume,
    TakenUtterance,
    Unasked,
    UriRequest,
)
from prima.voicexml.targets import find_dialog, root_of
from prima.voicexml.units import Units

DIALOG_STEPS = 100
"""Beginning a dialog counts as so many pieces of content."""
ITEM_STEPS = 10
"""Selecting an item counts as so many."""


class Machine:
    """Runs one application's dialogs; everything it does itself takes no time."""

    def __init__(self, shared: SharedState) -> None:
        self.shared = shared
        self.app = shared.app
        self.engine = shared.engine
        self.content = Content(shared)
        self.documents = Documents(shared, self.content)
        self.inputs = Inputs(shared, self.content)
        self.events = Events(shared, self.content)
        self.selection = ItemSelection(shared, self.content)
        self.items = Items(shared, self.content, self.selection)
        self.calls = Calls(shared, self.content, self.inputs, self.items)
        recorder = RecordItems(shared, self.inputs, self.items)
        self.questions = Questions(shared, self.inputs, self.items, recorder)
        self.units = Units(shared, self.items, self.selection, self.events, self.visit_all)
        self.state = ""
        """The dialog that is active, by its name."""

    # Documents -----------------------------------------------------------------------

    def start(self) -> Flow:
        """Run the application from its first dialog to its end (1.5.1)."""
        page, nothing = self.shared.document.page, self.engine.nothing
        context = Context(
            self.documents.begin(), page, nothing, nothing, self.engine.named("dialog")
        )
        self.shared.context = context
        reason = GoOut()
        try:
            yield from self.execute(context, page, "")
        except GoOut as out:
            reason = out
        if not reason.failed:
            yield from self.events.finish(context)
        raise reason

    def execute(self, context: Context, page: Page, dialog: str) -> Flow:
        """Run documents and dialogs of one context until it is left."""
        fetched: Page | None = page
        heard: TakenUtterance | None = None
        submitted = False
        while True:
            try:
                if fetched is not None:
                    page, fetched = fetched, None
                    yield from self._enter(context, page, submitted)
                node = page.dialog(dialog)
                if node is None:
                    message = "the document has no dialog: add a <form> or <menu>"
                    raise Thrown.at(page.root, "error.badfetch", message)
                yield from self.dialog(context, node, heard)
                raise GoOut
            except GoDialog as go:
                fetched, dialog, heard = go.page, go.dialog, go.heard
                submitted = go.submitted
            except Thrown as thrown:
                yield from self.events.unhandled(context, thrown)

    def _enter(self, context: Context, page: Page, submitted: bool) -> Flow:
        """Set up a document's scopes; a failure is an event in it, where no dialog is active."""
        context.form = context.item = None
        context.counters = Counters()
        try:
            yield from self.documents.enter(context, page, submitted)
        except (Thrown, ScriptError) as error:
            yield from self.events.handle(context, thrown_of(error))

    # Dialogs --------------------------------------------------------------------------

    def dialog(self, context: Context, form: Node, heard: TakenUtterance | None) -> Flow:
        """One form or menu, the state that is active until it is left."""
        outer, app = self.state, self.app
        for page in (context.page, context.root):
            if page is not None:
                self.shared.note_document(page)
        named = context.page.dialogs.items()
        self.state = next((name for name, one in named if one is form), "")
        app.note(form, "enter", self.state)
        try:
            yield from self._interpret(context, form, heard)
        finally:
            self.state = outer
            app.note(None, "leave", outer)

    def _interpret(self, context: Context, form: Node, heard: TakenUtterance | None) -> Flow:
        """Initialise, then select, collect, process (appendix C)."""
        self.app.count_step(form, DIALOG_STEPS)
        self.app.count_looked_at(form, form.content)
        context.form, context.item, context.unit = form, None, None
        context.counters, context.visited = Counters(), set()
        context.quiet = False
        wanted = ""
        try:
            yield from self._initialise(context, form)
        except (Thrown, ScriptError) as error:
            wanted = yield from self._handled_before_items(context, error)
            context.quiet = False  # a handler silences the item after an iteration of the loop (C)
        if heard is not None:
            self.app.count_step(form)
            context.item = form if form.tag == "menu" else None
            try:
                yield from self.items.process(context, heard)
            except GoItem as go:
                wanted = go.item
            except (Thrown, ScriptError) as error:
                wanted = yield from self._handled(context, error)
        yield from self.visit_all(context, wanted)

    def visit_all(self, context: Context, wanted: str = "") -> Flow:
        """Visit the items of the dialog, or of the unit that it is in, until none is left.

        ``wanted`` is the name of the item to begin with.

        Raises:
            GoItem: to an item outside of the unit, or to the unit itself, which begins again.
        """
        unit, more = context.unit, True
        while more:
            self.app.count_step(unit or context.form or self.shared.document.node, ITEM_STEPS)
            context.item = None
            try:
                item = self.selection.select(context, wanted)
            except (Thrown, ScriptError) as error:
                wanted = yield from self._handled_before_items(context, error)
                continue
            try:
                more = yield from self._visit_next(context, item, wanted)
                wanted = ""
            except GoItem as go:
                wanted = go.item
            except (Thrown, ScriptError) as error:
                if self.units.left_by(context, error):
                    raise
                wanted = yield from self._handled(context, error)
            if wanted and unit is not None and not holds_inside(unit, wanted):
                raise GoItem(wanted)

    def _visit_next(
        self, context: Context, item: Node | None, wanted: str
    ) -> Generator[None, Resume, bool]:
        """Visit the next item, if one was selected; gives whether anything was left to do."""
        if item is not None:
            context.item = item
            yield from self.visit(context, item, wanted)
        elif context.unit is not None and self.shared.queue and not self.shared.gone:
            yield from self.shared.play()  # a unit ends when all of it has been played
        else:
            return False
        return True

    def _handled(
        self, context: Context, error: Thrown | ScriptError
    ) -> Generator[None, Resume, str]:
        """Handle an event; gives the item that its handler goes to, if any."""
        try:
            yield from self.events.handle(context, thrown_of(error))
        except GoItem as go:
            return go.item
        return ""

    def _handled_before_items(
        self, context: Context, error: Thrown | ScriptError
    ) -> Generator[None, Resume, str]:
        """Handle an event at initialisation or selection; gives the item that its handler goes to.

        Raises:
            GoOut: it leads nowhere, so the dialog is over (appendix C).
        """
        wanted = yield from self._handled(context, error)
        if not wanted:
            raise GoOut
        return wanted

    def _initialise(self, context: Context, form: Node) -> Flow:
        """Make a form's variables and those of its items, in document order (2.1.6.1)."""
        context.dialog = self.engine.named("dialog")
        params, context.params = context.params or Params(self.engine.scope()), None
        for node in parts_of(form) if form.tag == "form" else ():
            name = node.get("name")
            if node.tag == "var" and name in params.names:
                del params.names[name]
                self.engine.hand(context.dialog, name, params.values)
            elif node.tag in ("var", "script", "data"):
                yield from self.documents.declare(node, context.dialog, context)
            elif node.tag in ITEMS or is_unit(node):
                self.selection.declare(context, node)
        for name in params.names:
            message = f'no variable of the form is the parameter "{name}"'
            raise Unasked.at(form, "error.semantic", message)

    def visit(self, context: Context, item: Node, wanted: str = "") -> Flow:
        """Collect: prompts, then what the item waits for; in a unit perhaps an item that is wanted."""
        self.app.note(item)
        if is_unit(item):
            inner = wanted if item.get("name") != wanted else ""
            yield from self.units.span(context, item, inner)
            return
        quiet, context.quiet = context.quiet, False
        if item.tag == "block":
            self.items.mark(context, item)
            yield from self.content.run(item, context, self.shared.local())
            return
        if not quiet:
            yield from self._prompt(context, item)
        match item.tag:
            case "subdialog":
                yield from self._call(context, item)
            case "object":
                name = item.get("classid") or "object"
                raise Thrown.at(item, "error.unsupported.objectname", name)
            case "transfer":
                yield from self.calls.transfer(context, item)
            case _:
                yield from self.questions.ask(context, item)

    # Subdialogs -----------------------------------------------------------------------

    def _call(self, context: Context, item: Node) -> Flow:
        """A subdialog, in a context of its own (2.3.4)."""
        check_depth(context.depth, item)
        params, nothing = self._params(context, item), self.engine.nothing
        uri = self.content.word(item, "src", context, nothing)
        names, method = item.get("namelist").split(), item.get("method")
        values = self.content.sent(item, names, context, nothing)
        request = UriRequest(method, values) if names or method == "post" else None
        fetched, dialog = yield from find_dialog(self.shared, context, uri, item, request)
        page = fetched or context.page
        if fetched is not None:
            yield from root_of(self.shared, fetched)  # its own, which is not the caller's
        inner = Context(context.session, page, nothing, nothing, self.engine.named("dialog"))
        inner.params, inner.depth, inner.caller = params, context.depth + 1, context
        self.shared.context = inner
        try:
            yield from self.execute(inner, page, dialog)
        except GoBack as back:
            result = back
        finally:
            self.shared.context = context
        if result.event:
            thrown = Thrown(result.event, result.message, source(item))
            thrown.worded = result.worded
            raise thrown
        self.items.fill(context, item, result.values)
        yield from self.items.run_filled(context, [item])

    def _params(self, context: Context, item: Node) -> Params:
        """The params of a subdialog, by value (6.4)."""
        nothing, given = self.engine.nothing, Params(self.engine.scope())
        for param in item.all("param"):
            name = param.get("name")
            given.names[name] = None
            if "expr" in param.attributes:
                self.content.put(given.values, name, param, "expr", context, nothing)
                self.engine.detach(given.values, name)
            else:
                self.engine.set(given.values, name, param.get("value"))
        return given

    # Prompts --------------------------------------------------------------------------

    def _prompt(self, context: Context, item: Node) -> Flow:
        """Queue the prompts of an item that its counter has reached, then count the visit (C)."""
        bare: list[Node | str] = []
        for piece in self.selection.prompts(context, item):
            if isinstance(piece, str) or piece.tag != "prompt":
                bare.append(piece)
                continue
            yield from self.content.run_all(item, bare, context, self.shared.local())
            bare = []
            self.content.utter(piece, context, self.shared.local())
        yield from self.content.run_all(item, bare, context, self.shared.local())
        context.counters = context.counters.asked(item.index)
