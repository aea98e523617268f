"""Executable content, which takes no time (VoiceXML 2.0, 5.3)."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable

from prima.interpreter.deadcontent import branches
from prima.interpreter.places import source
from prima.interpreter.transfers import GoBack, GoItem, GoOut, Thrown, no_item, undeclared
from prima.markup.tree import Node
from prima.messages import SERVICE, Json, Say
from prima.script.evaluation import RESULT_LIMIT, Scope, ScriptError
from prima.script.wrapping import check_variable
from prima.voicexml.access import host_of_page, may_read
from prima.voicexml.dom import DOM, plain_tree
from prima.voicexml.elements import INPUTS
from prima.voicexml.evaluating import is_worded
from prima.voicexml.fetching import decoded, fetch
from prima.voicexml.prompts import Speaker
from prima.voicexml.settings import form_items
from prima.voicexml.shared import SharedState
from prima.voicexml.speech import Speech
from prima.voicexml.state import HANGUP, SCOPES, Context, Flow, GoDialog, HungUp, UriRequest
from prima.voicexml.targets import go_to
from prima.voicexml.vocabulary import PRIMA_NAMESPACE, SPOKEN

STEP_TAGS = 10
"""How many tags of a ``data`` document count as one step."""


class Content(Speaker):
    """Runs executable content for one application; only fetching takes time."""

    def __init__(self, shared: SharedState) -> None:
        super().__init__(shared)
        self._maker: Scope | None = None

    def run(self, node: Node, context: Context, local: Scope) -> Flow:
        """Run all that an element holds, in document order."""
        self.shared.app.note(node)
        yield from self.run_all(node, node.content, context, local)

    def run_all(
        self, holder: Node, content: Iterable[Node | str], context: Context, local: Scope
    ) -> Flow:
        """Run pieces of an element's content; adjacent text and speech make one prompt (4.1.2)."""
        speech = Speech(context.page.lang, "")
        for item in content:
            if isinstance(item, str) or item.tag in SPOKEN - {"prompt"}:
                node = holder if isinstance(item, str) else item
                if not speech.place or not speech.parts:
                    speech.place = source(node)
                self.read(item, context, local, speech)
                continue
            self.flush(speech)
            self.note_bargein(context)
            self.shared.app.count_step(item)
            if item.namespace == PRIMA_NAMESPACE:
                self.enqueue(item, context, local)
            elif item.tag == "prompt":
                self.prompt(item, context, local)
            else:
                yield from self.act(item, context, local)
        self.flush(speech)
        self.note_bargein(context)

    def act(self, node: Node, context: Context, local: Scope) -> Flow:
        """Run one element that is not spoken."""
        match node.tag:
            case "var":
                self.declare(node, local, context, local)
            case "assign":
                self.assign(node, context, local)
            case "clear":
                self.clear(node, context, local)
            case "if":
                yield from self.branch(node, context, local)
            case "foreach":
                for element in self.elements(node, context, local):
                    self.engine.put(local, node.get("item"), element)
                    yield from self.run(node, context, local)
            case "script":
                yield from self.script(node, local, context, local)
            case "log":
                self.log(node, context, local)
            case "reprompt":
                self.shared.reprompted = True
            case "data":
                yield from self.data(node, local, context, local)
            case _:
                yield from self.leave(node, context, local)

    def leave(self, node: Node, context: Context, local: Scope) -> Flow:
        """Run an element from which control does not return."""
        match node.tag:
            case "throw":
                raise self.raised(node, context, local)
            case "goto":
                yield from self.go(node, context, local)
            case "submit":
                yield from self.submit(node, context, local)
            case "exit":
                self.report(node, context, local)
                raise GoOut()
            case "disconnect":
                self.report(node, context, local)
                if self.shared.gone == HANGUP:  # there is nobody left to disconnect (1.5.4)
                    raise GoOut(HANGUP)
                raise HungUp(HANGUP, "", source(node))
            case "return":
                self.give_back(node, context, local)

    # Variables ------------------------------------------------------------------------

    def declare(self, node: Node, scope: Scope, context: Context, local: Scope) -> None:
        """Declare a variable in a scope (5.3.1)."""
        self.check_name(node)
        if "expr" not in node.attributes:
            if not self.engine.has(scope, node.get("name")):  # an existing one keeps its value
                self.engine.unset(scope, node.get("name"))
            return
        self.put(scope, node.get("name"), node, "expr", context, local)

    def put(
        self, scope: Scope, name: str, node: Node, attribute: str, context: Context, local: Scope
    ) -> None:
        """Give a variable of a scope the value of an expression."""
        with self.failing(node, attribute):
            self.engine.assign(scope, name, self.code(node, attribute), context.scopes(local))

    def assign(self, node: Node, context: Context, local: Scope) -> None:
        """Give a declared variable a value (5.3.2)."""
        with self.failing(node, "expr"):
            code = self.code(node, "expr")
            self.engine.assign_declared(node.get("name"), code, context.scopes(local))

    def clear(self, node: Node, context: Context, local: Scope) -> None:
        """Undefine variables, and reset what counts visits of form items (5.3.3)."""
        # A menu is not a form item: its counters are reset when it is entered, not here (4.1.6, 5.2.2).
        items = [one for one in form_items(context) if one.tag != "menu"]
        names = node.get("namelist").split()
        self.shared.app.count_step(node, len(names) or len(items))
        named = defaultdict(list)
        for item in items:
            named[item.get("name")].append(item)
        for item in items if not names else ():
            context.visited.discard(item.index)
            self.forget(item, context)
        for whole in names:
            scope, name = self._declared(node, whole, context, local)
            with self.failing(node, "namelist"):  # the session's stay
                self.engine.unset(scope, name)
            for item in named[name] if scope is context.dialog else ():
                self.forget(item, context)

    def _declared(self, node: Node, name: str, context: Context, local: Scope) -> tuple[Scope, str]:
        """The scope of a variable and its name there; ``name`` may begin with that of the scope."""
        prefix, _, rest = name.partition(".")
        scopes = dict(zip(SCOPES, context.scopes(local), strict=True))
        if rest and prefix in scopes:
            scopes, name = {prefix: scopes[prefix]}, rest
        for scope in reversed(scopes.values()):
            if self.engine.has(scope, name):
                return scope, name
        raise undeclared(node, name)

    def forget(self, item: Node, context: Context) -> None:
        """Reset a form item: its variable, prompt counter and event counters."""
        if item.get("name"):
            self.engine.unset(context.dialog, item.get("name"))
        context.counters = context.counters.without(item.index)

    def values(
        self, node: Node, names: list[str], context: Context, local: Scope
    ) -> dict[str, Json]:
        """Variables as plain data."""
        found: dict[str, Json] = {}
        for name in names:
            with self.failing(node, "namelist"):
                check_variable(name)
                found[name] = self.engine.value(name, context.scopes(local))
            self.shared.app.count_value(found[name], node)
        return found

    def sent(self, node: Node, names: list[str], context: Context, local: Scope) -> dict[str, Json]:
        """Variables as a request sends them: null as its text, undefined as None (5.3.8)."""
        found = self.values(node, names, context, local)
        for name in [one for one, value in found.items() if value is None]:
            if self.engine.condition(f"{name} === null", context.scopes(local)):
                found[name] = "null"
        return found

    # Control ----------------------------------------------------------------------------

    def branch(self, node: Node, context: Context, local: Scope) -> Flow:
        """Run the first branch whose condition holds (5.3.4)."""
        for head, part in branches(node):
            if self.holds(head, context, local):
                yield from self.run_all(head, part, context, local)
                return

    def go(self, node: Node, context: Context, local: Scope) -> Flow:
        """Leave for an item, a dialog or a document (5.3.7)."""
        item = self.word(node, "nextitem", context, local)
        if item or {"nextitem", "expritem"} & node.attributes.keys():
            if item not in {one.get("name") for one in form_items(context)} - {""}:
                context.item = None  # it is handled in the dialog's scope
                raise no_item(node, item)
            raise GoItem(item)
        yield from go_to(self.shared, context, self.word(node, "next", context, local), node)

    def submit(self, node: Node, context: Context, local: Scope) -> Flow:
        """Submit values and go to the document returned, or send them and go on (5.3.8)."""
        inputs = [one.get("name") for one in form_items(context) if one.tag in INPUTS]
        names = node.get("namelist").split() if "namelist" in node.attributes else inputs
        values = self.sent(node, [name for name in names if name], context, local)
        uri = self.word(node, "next", context, local)
        service, _, dialog = uri.removeprefix(SERVICE).partition("#")
        if uri.startswith(SERVICE) and dialog:
            if context.page.dialog(dialog) is None:
                raise Thrown.at(node, "error.badfetch", f'there is no dialog "{dialog}"')
            self.shared.app.send(service, {"params": values}, source(node))
            raise GoDialog(None, dialog)
        request = UriRequest(node.get("method"), values)
        yield from go_to(self.shared, context, uri, node, request)

    def give_back(self, node: Node, context: Context, local: Scope) -> None:
        """Come back from a subdialog (5.3.10)."""
        if not context.depth:
            raise Thrown.at(node, "error.semantic", "there is no subdialog to return from")
        values = self.engine.scope()
        for name in node.get("namelist").split():
            self.shared.app.count_step(node)
            with self.failing(node, "namelist"):
                self.engine.assign(values, name, name, context.scopes(local))
                self.engine.detach(values, name)
        event = self.event(node, context, local)
        message = self.word(node, "message", context, local)
        raise GoBack(values, event, message, is_worded(node))

    # Scripts, data and the transcript -----------------------------------------------------

    def script(self, node: Node, scope: Scope, context: Context, local: Scope) -> Flow:
        """Run a script; its declarations belong to the enclosing scope (5.3.12)."""
        code = node.own_text
        attribute = next((one for one in ("src", "srcexpr") if one in node.attributes), "")
        if attribute:
            data = yield from fetch(self.shared, self.resource(node, context, local), node)
            code = decoded(data, node.get("charset"))
        try:
            self.engine.script(code, scope, context.scopes(local))
        except ScriptError as error:
            if attribute:
                error = ScriptError(f"line {error.line}: {error}")
            raise self.failure(error, node, attribute) from None

    def resource(self, node: Node, context: Context, local: Scope) -> str:
        """The URI that an element fetches.

        Raises:
            Thrown: ``error.badfetch`` where there is none.
        """
        uri = self.word(node, "src", context, local).strip()
        if not uri:
            raise Thrown.at(node, "error.badfetch", "the URI is missing")
        return context.page.resolve(uri, node)

    def data(self, node: Node, scope: Scope, context: Context, local: Scope) -> Flow:
        """Fetch an XML document as a read-only DOM (VoiceXML 2.1, 5)."""
        if node.get("name"):
            self.check_name(node)
        values = self.sent(node, node.get("namelist").split(), context, local)
        request = UriRequest(node.get("method"), values)
        uri = self.resource(node, context, local)
        content = yield from fetch(self.shared, uri, node, request)
        if not node.get("name"):
            return
        for _ in range(content.count(b"<") // STEP_TAGS):
            self.shared.app.count_step(node)
        tree, host = plain_tree(uri, content, source(node)), host_of_page(context.page)
        if not may_read(tree, host):
            message = f"{uri}: its access-control does not name {host}"
            raise Thrown.at(node, "error.noauthorization", message)
        held = self.engine.scope({"tree": tree})
        nothing = self.engine.nothing
        with self.failing(node, "src"):
            self.engine.put(held, "dom", self._dom())
            scopes = (nothing, nothing, nothing, nothing, held)
            self.engine.assign(scope, node.get("name"), "dom.whole(tree)", scopes)

    def _dom(self) -> Scope:
        """The factory of documents; its classes exist once there is a document (2.1, D)."""
        if self._maker is None:
            scopes = (self.engine.nothing,) * 5
            self._maker = self.engine.raw(DOM, scopes)
            maker, session = self.engine.scope(), self.shared.session
            self.engine.put(maker, "dom", self._maker)
            for name in ("Node", "DOMException"):
                self.engine.assign(session, name, f"dom.{name}", (*scopes[:-1], maker))
        return self._maker

    def report(self, node: Node, context: Context, local: Scope) -> None:
        """Write what exit and disconnect return to the transcript."""
        found: Json = self.values(node, node.get("namelist").split(), context, local) or None
        if "expr" in node.attributes:
            found = self.value(node, "expr", context, local)
        if found is not None:
            shown = json.dumps(found, ensure_ascii=False)
            self.write(f"{node.tag}: {shown}", node)

    def log(self, node: Node, context: Context, local: Scope) -> None:
        """Write a log entry to the transcript (5.3.13)."""
        label = f"{node.get('label')}: " if node.get("label") else ""
        parts = [self.read_whole(node, context, local).take()[0]]
        if "expr" in node.attributes:
            parts.append(self.text(node, context, local))
        self.write(label + " ".join(part for part in parts if part), node)

    def write(self, text: str, node: Node) -> None:
        """Write a line into the transcript."""
        said = text[:RESULT_LIMIT]
        self.shared.app.count_output(len(said), node)
        self.shared.app.actions.append(Say("log", said, source(node)))
