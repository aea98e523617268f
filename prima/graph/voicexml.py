"""The states of a VoiceXML application: the forms and menus of all its documents."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from prima.graph.labels import (
    ASKED,
    AnswerLabel,
    answered,
    condition,
    joined,
    known,
    literals,
    notes,
    quoted,
    sayings,
)
from prima.graph.model import Graph, clean, settle
from prima.graph.model import GraphNode as Box
from prima.graph.throws import Taker
from prima.graph.transitions import ANY, Branches, Transitions
from prima.graph.voicenodes import (
    asked,
    divided,
    leaves_at_its_end,
    leaves_user,
    said,
    said_by,
    takers,
)
from prima.interpreter.acts import type_of
from prima.language.commands import TABLE_4_2
from prima.markup.tree import Node
from prima.voicexml.arranging import is_unit, parts_of
from prima.voicexml.document import Page, VoiceDocument
from prima.voicexml.elements import ITEMS
from prima.voicexml.pages import pages_of
from prima.voicexml.sketch import ASKING
from prima.voicexml.vocabulary import NAMESPACE


def states(document: VoiceDocument) -> Graph:
    """The dialogs of an application and the transitions between them."""
    return _VoiceGraph(document).graph


class _VoiceGraph(Transitions[Node]):
    """Goes from document to document, as the application does."""

    goes_on = (*sorted(ASKED), "cancel", "maxspeechtimeout")  # 5.2.5

    def __init__(self, document: VoiceDocument) -> None:
        super().__init__(f"The states of {clean(document.id)}")
        self.pages = pages_of(document)
        self.first = self.page = document.page
        self.outer: list[Sequence[Taker[Node]]] = []
        """The handlers of the document, and of its root document."""
        for page in self.pages:
            self._declare(page)
        for page in self.pages:
            self._read(page)
        settle(self.graph, self._everywhere_of())

    # Documents --------------------------------------------------------------------------------

    def _read(self, page: Page) -> None:
        """Add the transitions of a document."""
        self.page = page
        self.hints = _hints(page)
        root = self.pages.root(page)
        self.outer = [takers(page.root), *([takers(root.root)] if root else [])]
        for name, dialog in page.dialogs.items():
            self._dialog(name, dialog)
        self._everywhere()

    def _everywhere_of(self) -> dict[str, list[str]]:
        """The dialogs, also of leaf documents, in which each document's handlers are active."""
        pages = list(self.pages)
        found: dict[str, list[str]] = {}
        for page in pages:
            leaves = [other for other in pages if other.application == page.uri]
            found[page.uri + ANY] = [
                self._key(one, name) for one in (page, *leaves) for name in one.dialogs
            ]
        return found

    def _declare(self, page: Page) -> None:
        """Add boxes for all dialogs of a document, in document order."""
        for name, dialog in page.dialogs.items():
            title = name if not name.startswith("#") else f"{dialog.tag} {name[1:]}"
            title = title if page is self.first else f"{page.uri}#{title}"
            box = self.graph.node(self._key(page, name), title, start=not self.graph.nodes)
            box.source = f"{page.uri}:{dialog.place.line}"
            _describe(box, dialog)

    def _key(self, page: Page, name: str) -> str:
        return f"{page.uri}#{name}"

    # Dialogs ----------------------------------------------------------------------------------

    def _dialog(self, name: str, dialog: Node) -> None:
        """Add all transitions of a dialog."""
        self.here = self._key(self.page, name)
        self._links(dialog.all("link"))
        if dialog.tag == "menu":
            self._choices(dialog)
        own = takers(dialog)
        self._items(dialog, own)
        for unit in filter(is_unit, dialog.nodes):
            self.scopes = [takers(unit), own, *self.outer]
            self.handlers(takers(unit))
        self.scopes = [own, *self.outer]
        for filled in dialog.all("filled"):
            names = filled.get("namelist").split()
            self.content(filled.nodes, answered(names, filled.get("mode", "all")))
        self.handlers(own)
        if dialog.tag == "form" and not leaves_at_its_end(dialog):
            self.graph.edge(self.here, "", "exit", "at its end")

    def _items(self, dialog: Node, own: Sequence[Taker[Node]]) -> None:
        """Add the transitions of a dialog's items."""
        parts = parts_of(dialog)
        many = sum(one.tag in ASKING for one in parts) > 1
        units = {id(item): one for one in dialog.nodes if is_unit(one) for item in one.nodes}
        for item in (one for one in parts if one.tag in ITEMS):
            unit = units.get(id(item))
            self.scopes = [takers(item), *([takers(unit)] if unit else []), own, *self.outer]
            self._item(item, many)

    def _item(self, item: Node, many: bool) -> None:
        """Add the transitions of an item; with ``many`` questions, those of one have its name."""
        name = item.get("name")
        cond = item.get("cond").strip()
        conditions = [condition(cond)] if cond else []
        bridged = item.get("bridge") == "true" or item.get("type", "blind") != "blind"
        if item.tag == "block":
            self.content(item.nodes, "then", conditions)
        elif item.tag == "subdialog":
            self._target(item, "src", "srcexpr", "call", joined(f"subdialog {name}", conditions))
        elif item.tag == "transfer" and not bridged:
            self.graph.edge(self.here, "", "exit", joined("the call is passed on", conditions))
        self._links(item.all("link"))
        reply = AnswerLabel(name, item.get("type").partition("?")[0] == "boolean")
        for filled in item.all("filled"):
            self.content(filled.nodes, _filled(item, many), (), reply)
        self.handlers(takers(item), f"{name}: " if many and name else "")

    def _choices(self, menu: Node) -> None:
        """A menu's choices; with ``dtmf`` the first nine have keys of their own (2.2.1)."""
        key = 0
        for choice in menu.all("choice"):
            own = choice.get("dtmf")
            if menu.get("dtmf") == "true" and not own and key < 9:
                key += 1
                own = str(key)
            words = said(choice)
            label = f"said {quoted(words)}" if words else sayings(choice.all("grammar"))
            label = label or "chosen"
            self._led(choice, f"{label} or key {clean(own)}" if own else label)

    def _everywhere(self) -> None:
        """Add handlers and links that are active in all dialogs of a document and its leaves."""
        page = self.page
        self.here = page.uri + ANY
        self.scopes = self.outer
        self.handlers(self.outer[0])
        self._links(page.root.all("link"))
        for name, dialog in page.dialogs.items():
            own = [one for one in dialog.all("grammar") if one.get("scope") == "document"]
            if dialog.get("scope") == "document" or own:
                words = sayings(own or dialog.all("grammar")) or "one of its choices"
                self.graph.edge(self.here, self._key(page, name), "go", f"said {words}")
        if self.graph.out(self.here):
            self.graph.node(self.here, self._title_of_any(), kind="any")

    def _title_of_any(self) -> str:
        pages, uri = list(self.pages), self.page.uri
        title = "in any state" if len(pages) == 1 else f"in any state of {uri}"
        is_root = any(page.application == uri for page in pages)
        return title + (" and its leaf documents" if is_root else "")

    def _states(self) -> Iterable[tuple[str, Sequence[Taker[Node]]]]:
        dialogs = self.page.dialogs.items()
        return ((self._key(self.page, name), takers(dialog)) for name, dialog in dialogs)

    # Transitions ------------------------------------------------------------------------------

    def _links(self, links: Iterable[Node]) -> None:
        for link in links:
            keys = [f"key {clean(link.get('dtmf'))}"] if link.get("dtmf") else []
            self._led(link, " or ".join([*said_by(link), *keys]) or "link")

    def _led(self, node: Node, label: str) -> None:
        """Add the transition of a link or choice; one that throws shows at its handlers."""
        if node.attributes.keys() & {"next", "expr"}:
            self._target(node, "next", "expr", "go", label)

    def _leaves(self, act: Node, label: str) -> bool:
        match act.tag if act.namespace == NAMESPACE else "":
            case "goto":
                if not act.attributes.keys() & {"nextitem", "expritem"}:
                    self._target(act, "next", "expr", "go", label)
            case "submit":
                names = " ".join(act.get("namelist").split())
                self._target(act, "next", "expr", "go", f"{label}, submits {names}".rstrip())
            case "exit":
                self.graph.edge(self.here, "", "exit", label)
            case "disconnect":
                self.graph.edge(self.here, "", "exit", label + ", hangs up")
            case "return":
                event = act.get("event") or act.get("eventexpr")
                thrown = f", throws {event}" if event else ""
                self.graph.edge(self.here, "", "return", label + thrown)
            case "throw":
                if event := act.get("event"):
                    self.throw(event, label)
            case _:
                return False
        return True

    def _passes(self, act: Node, base: str, conditions: list[str], reply: AnswerLabel) -> None:
        if act.tag == "foreach" and act.namespace == NAMESPACE:
            self.content(act.nodes, base, conditions, reply)

    def _branches(self, act: Node) -> Branches[Node]:
        return divided(act) if act.tag == "if" and act.namespace == NAMESPACE else ()

    def _target(self, node: Node, plain: str, computed: str, kind: str, label: str) -> None:
        """Add an edge to an element's target."""
        if code := node.get(computed):
            for name in literals(code, [*self.page.dialogs, *(f"#{d}" for d in self.page.dialogs)]):
                self.graph.edge(self.here, self._key(self.page, name), "guess", label)
            self.graph.edge(self.here, "", "computed", label, code)
            return
        target = self.pages.target(self.page, node)
        page = target.page
        if page is not None and target.key in page.dialogs:
            label = f"{label}, asks {target.asked}" if target.asked else label
            self.graph.edge(self.here, self._key(page, target.key), kind, label)
        else:
            kind = "outside" if target.asked else "missing"
            self.graph.edge(self.here, "", kind, label, node.get(plain).strip())


def _describe(box: Box, dialog: Node) -> None:
    """Describe a dialog: its marks, and what it asks or says."""
    parts = parts_of(dialog)
    asking = [one for one in (dialog, *parts) if one.tag in ASKING]
    leaving = list(filter(leaves_user, dialog.walk()))
    box.marks = _marks(dialog, parts, bool(asking), bool(leaving))
    questions = list(filter(None, map(asked, asking)))
    blocks = filter(None, (said(one) for one in parts if one.tag == "block"))
    first = "" if asking else next(blocks, "")
    box.notes = notes(questions, first, [TABLE_4_2[type_of(one)].title for one in leaving[:1]])


def _marks(dialog: Node, parts: list[Node], asks: bool, leaves: bool) -> list[str]:
    """The special properties of a dialog, each in one or two words."""
    tags = {one.tag for one in parts}
    marks = {
        "asks": asks,
        "unit": any(is_unit(one) for one in dialog.walk()),
        "records": "record" in tags,
        "calls somebody": "transfer" in tags,
        "leaves the user": leaves,
    }
    return [mark for mark, applies in marks.items() if applies]


def _filled(item: Node, many: bool) -> str:
    """The cause of what an item's ``filled`` do."""
    name = item.get("name")
    match item.tag:
        case "subdialog":
            return f"{clean(name) or item.tag} has returned"
        case "record":
            return f"{name or 'it'} recorded"
        case "transfer" | "object":
            return f"{name or item.tag} over"
    return f"{name} answered" if many and name else "answered"


def _hints(page: Page) -> dict[str, list[str]]:
    """The known sources of events: links and choices that throw them."""
    sources: list[tuple[str, str]] = []
    for node in page.root.walk():
        event = node.get("event")
        if event and node.tag == "link":
            sources.append((event, "".join(said_by(node)) or "link"))
        elif event and node.tag == "choice":
            sources.append((event, f"said {quoted(said(node))}"))
    return known(sources)
