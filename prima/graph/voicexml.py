"""The states of a VoiceXML application: the forms and menus of all its documents."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from urllib.parse import urldefrag, urlsplit

from prima.errors import DocumentError
from prima.graph.labels import (
    ASKED,
    condition,
    handled,
    joined,
    literals,
    otherwise,
    quoted,
    sayings,
)
from prima.graph.model import Graph, clean, settle
from prima.graph.model import Node as Box
from prima.graph.throws import Taker, Throws, chosen
from prima.interpreter.selection import takes
from prima.language.commands import TABLE_4_2
from prima.markup.tree import Node
from prima.voicexml.arranging import is_unit, parts_of
from prima.voicexml.document import FetchError, Page, VoiceDocument
from prima.voicexml.reading import read_page
from prima.voicexml.vocabulary import NAMESPACE, PRIMA_NAMESPACE, WORDED

MOST_PAGES = 100
"""Maximum number of documents of one application."""
ASKING = ("field", "initial", "record", "menu")
ITEMS = ("block", "field", "initial", "record", "transfer", "object", "subdialog")
GOING_ON = (*sorted(ASKED), "cancel", "maxspeechtimeout")
"""Events after which the dialog goes on if no handler takes them (5.2.5)."""
HANDLERS = ("catch", "error", "help", "noinput", "nomatch")


def states(document: VoiceDocument) -> Graph:
    """The dialogs of an application and the transitions between them."""
    return _Reader(document).graph


class _Reader:
    """Goes from document to document, as the application does."""

    def __init__(self, document: VoiceDocument) -> None:
        self.fetch = document.fetch
        self.graph = Graph(f"The states of {clean(document.id)}")
        self.pages: dict[str, Page | None] = {document.page.uri: document.page}
        self.first = self.page = document.page
        self.here = ""
        self.hints: dict[str, list[str]] = {}
        self.scopes: list[Node] = []
        """Elements that may have handlers of a thrown event, innermost first."""
        self.throws = Throws()
        self._declare(self.first)
        self._read_pages()
        settle(self.graph, self._everywhere_of())

    def _read_pages(self) -> None:
        """Read all documents that the first one leads to."""
        done: set[str] = set()
        while waiting := [page for page in self.pages.values() if page and page.uri not in done]:
            for page in waiting:
                done.add(page.uri)
                self.page = page
                self.hints = _hints(page)
                if page.application:
                    self._open(page.application)
                for name, dialog in page.dialogs.items():
                    self._dialog(name, dialog)
                self._everywhere()

    def _everywhere_of(self) -> dict[str, list[str]]:
        """The dialogs, also of leaf documents, in which each document's handlers are active."""
        pages = [page for page in self.pages.values() if page]
        found: dict[str, list[str]] = {}
        for page in pages:
            leaves = [other for other in pages if other.application == page.uri]
            found[f"{page.uri}#:any"] = [
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
            self._describe(box, dialog)

    def _key(self, page: Page, name: str) -> str:
        return f"{page.uri}#{name}"

    def _open(self, uri: str) -> Page | None:
        """A document of the application's folder, read once; None if it cannot be read."""
        if uri not in self.pages:
            self.pages[uri] = None
            if len(self.pages) <= MOST_PAGES:
                try:
                    page = read_page(uri, uri, self.fetch(uri))
                except (FetchError, DocumentError):
                    return None
                self.pages[uri] = page
                self._declare(page)
        return self.pages[uri]

    # Dialogs --------------------------------------------------------------------------------

    def _describe(self, box: Box, dialog: Node) -> None:
        """Describe a dialog: its marks, and what it asks or says."""
        parts = parts_of(dialog)
        asking = [one for one in (dialog, *parts) if one.tag in ASKING]
        leaving = [one for one in dialog.walk() if _leaves(one)]
        box.marks = _marks(dialog, parts, bool(asking), bool(leaving))
        questions = [text for one in asking if (text := _asked(one))]
        box.notes = [f"asks {quoted(text)}" for text in questions[:3]]
        if len(questions) > 3:
            box.notes.append(f"and {len(questions) - 3} more")
        if not asking:
            said = [text for one in parts if one.tag == "block" and (text := _said(one))]
            box.notes += [f"says {quoted(said[0])}"] if said else []
        box.notes += [clean(TABLE_4_2[one.tag].title) for one in leaving[:1]]

    def _dialog(self, name: str, dialog: Node) -> None:
        """Add all transitions of a dialog."""
        self.here = self._key(self.page, name)
        self._links(dialog.all("link"))
        if dialog.tag == "menu":
            self._choices(dialog)
        parts = parts_of(dialog)
        asked = [one for one in parts if one.tag in ASKING]
        for item in [one for one in parts if one.tag in ITEMS]:
            units = [one for one in dialog.nodes if is_unit(one) and item in one.nodes]
            self.scopes = [item, *units, dialog, *self._outer()]
            self._item(item, len(asked) > 1)
        for unit in [one for one in dialog.nodes if is_unit(one)]:
            self.scopes = [unit, dialog, *self._outer()]
            self._handlers(unit.all(*HANDLERS))
        self.scopes = [dialog, *self._outer()]
        for filled in dialog.all("filled"):
            names = ", ".join(filled.get("namelist").split()) or "all"
            self._content(filled, f"{names} answered", [])
        self._handlers(dialog.all(*HANDLERS))
        if dialog.tag == "form" and not _leaves_at_its_end(dialog):
            self.graph.edge(self.here, "", "exit", "at its end")

    def _item(self, item: Node, many: bool) -> None:
        name = item.get("name")
        cond = item.get("cond").strip()
        conditions = [condition(cond, "", False)] if cond else []
        base = f"{name} answered" if many and name else "answered"
        if item.tag == "block":
            self._content(item, "then", conditions)
        elif item.tag == "subdialog":
            base = f"{clean(name)} has returned".strip()
            self._target(item, "src", "srcexpr", "call", joined(f"subdialog {name}", conditions))
        elif item.tag == "record":
            base = f"{name or 'it'} recorded"
        elif item.tag in ("transfer", "object"):
            base = f"{name or item.tag} over"
        bridged = item.get("bridge") == "true" or item.get("type", "blind") != "blind"
        if item.tag == "transfer" and not bridged:
            self.graph.edge(self.here, "", "exit", joined("the call is passed on", conditions))
        self._links(item.all("link"))
        for filled in item.all("filled"):
            self._content(filled, base, [], name, item.get("type").partition("?")[0] == "boolean")
        self._handlers(item.all(*HANDLERS), f"{name}: " if many and name else "")

    def _choices(self, menu: Node) -> None:
        """A menu's choices; with ``dtmf`` the first nine have keys of their own (2.2.1)."""
        key = 0
        for choice in menu.all("choice"):
            own = choice.get("dtmf")
            if menu.get("dtmf") == "true" and not own and key < 9:
                key += 1
                own = str(key)
            words = _said(choice)
            told = f"said {quoted(words)}" if words else sayings(choice.all("grammar"))
            told = told or "chosen"
            self._led(choice, f"{told} or key {clean(own)}" if own else told)

    def _everywhere(self) -> None:
        """Add handlers and links that are active in all dialogs of a document and its leaves."""
        page = self.page
        self.here = f"{page.uri}#:any"
        self.scopes = self._outer()
        self._handlers(page.root.all(*HANDLERS))
        self._links(page.root.all("link"))
        for name, dialog in page.dialogs.items():
            own = [one for one in dialog.all("grammar") if one.get("scope") == "document"]
            if dialog.get("scope") == "document" or own:
                told = sayings(own or dialog.all("grammar")) or "one of its choices"
                self.graph.edge(self.here, self._key(page, name), "go", f"said {told}")
        if self.graph.out(self.here):
            one = len([other for other in self.pages.values() if other]) == 1
            root = any(other and other.application == page.uri for other in self.pages.values())
            title = "in any state" if one else f"in any state of {page.uri}"
            title += " and its leaf documents" if root else ""
            self.graph.node(self.here, title, kind="any")

    # What leads away ------------------------------------------------------------------------

    def _links(self, links: Iterable[Node]) -> None:
        for link in links:
            keys = [f"key {clean(link.get('dtmf'))}"] if link.get("dtmf") else []
            said = sayings(link.all("grammar"))
            self._led(link, " or ".join(([f"said {said}"] if said else []) + keys) or "link")

    def _led(self, node: Node, told: str) -> None:
        """Add the transition of a link or choice; one that throws shows at its handlers."""
        if node.attributes.keys() & {"next", "expr"}:
            self._target(node, "next", "expr", "go", told)

    def _handlers(self, handlers: Iterable[Node], where: str = "") -> None:
        for node in handlers:
            events = _events(node)
            told = handled(events, _count(node), node.get("cond").strip(), self.hints)
            self._content(node, where + told, [])
            if not self.here.endswith("#:any") and node.tag == "catch" and _stays(node, events):
                self.graph.edge(self.here, self.here, "stay", told)

    def _outer(self) -> list[Node]:
        """The document and its root document, which may hold handlers."""
        root = self.pages.get(self.page.application or "")
        return [self.page.root, *([root.root] if root else [])]

    def _throw(self, event: str, told: str) -> None:
        """Add the transitions of handlers that take a thrown event, unless it is computed."""
        with self.throws.following(event) as followed:
            if not event or not followed:
                return
            if self.here.endswith("#:any"):
                self._throw_in_dialogs(event, told)
            self._taken(event, told)

    def _throw_in_dialogs(self, event: str, told: str) -> None:
        """What a document's handlers throw is taken by a dialog's own handlers first."""
        here, scopes = self.here, self.scopes
        for name, dialog in self.page.dialogs.items():
            if any(takes(one, event) for node in dialog.all(*HANDLERS) for one in _events(node)):
                self.here, self.scopes = self._key(self.page, name), [dialog]
                self._taken(event, told, ends=False)
        self.here, self.scopes = here, scopes

    def _taken(self, event: str, told: str, ends: bool = True) -> None:
        found, always = chosen(
            Taker(node, _count(node), node.get("cond").strip())
            for scope in self.scopes
            for node in scope.all(*HANDLERS)
            if any(takes(name, event) for name in _events(node))
        )
        told = f"{told}, throws {event}"
        for one in found:
            self._content(one.handler, one.told(told), [])
            if not self.here.endswith("#:any") and _stays(one.handler, _events(one.handler)):
                self.graph.edge(self.here, self.here, "stay", one.told(told))
        if ends and not always and not any(takes(name, event) for name in GOING_ON):
            self.graph.edge(self.here, "", "exit", told)

    def _content(
        self, node: Node, base: str, conditions: list[str], name: str = "", truth: bool = False
    ) -> bool:
        """Add all transitions of executable content; return whether it never reaches its end."""
        return self._acts(node.nodes, base, conditions, name, truth)

    def _acts(
        self, acts: list[Node], base: str, conditions: list[str], name: str, truth: bool
    ) -> bool:
        conditions = list(conditions)
        for act in acts:
            told = joined(base, conditions)
            match act.tag if act.namespace == NAMESPACE else "":
                case "goto":
                    if not act.attributes.keys() & {"nextitem", "expritem"}:
                        self._target(act, "next", "expr", "go", told)
                    return True
                case "submit":
                    names = " ".join(act.get("namelist").split())
                    self._target(act, "next", "expr", "go", f"{told}, submits {names}".rstrip())
                    return True
                case "exit" | "disconnect":
                    hung = ", hangs up" if act.tag == "disconnect" else ""
                    self.graph.edge(self.here, "", "exit", told + hung)
                    return True
                case "return":
                    event = act.get("event") or act.get("eventexpr")
                    thrown = f", throws {event}" if event else ""
                    self.graph.edge(self.here, "", "return", told + thrown)
                    return True
                case "throw":
                    self._throw(act.get("event"), told)
                    return True
                case "if":
                    over, left = self._branches(act, base, conditions, name, truth)
                    if over:
                        return True
                    conditions += left
                case "foreach":
                    self._content(act, base, conditions, name, truth)
        return False

    def _branches(
        self, node: Node, base: str, conditions: list[str], name: str, truth: bool
    ) -> tuple[bool, list[str]]:
        ends: list[bool] = []
        told: list[str] = []
        complete = False
        for cond, acts in _divided(node):
            complete = cond is None
            one = otherwise(told) if cond is None else condition(cond, name, truth)
            ends.append(self._acts(acts, base, [*conditions, one], name, truth))
            told.append(one)
        return all(ends) and complete, [otherwise(told)] if any(ends) and not complete else []

    def _target(self, node: Node, plain: str, computed: str, kind: str, told: str) -> None:
        """Add an edge to an element's target."""
        code = node.get(computed)
        if code:
            for name in literals(code, [*self.page.dialogs, *(f"#{d}" for d in self.page.dialogs)]):
                self.graph.edge(self.here, self._key(self.page, name), "guess", told)
            self.graph.edge(self.here, "", "computed", told, code)
            return
        uri = node.get(plain).strip()
        base, fragment = urldefrag(self.page.resolve(uri, node) if uri[:1] != "#" else uri)
        if urlsplit(base).scheme == "service" and fragment in self.page.dialogs:
            told, base = f"{told}, asks {base}", ""
        if urlsplit(base).scheme or base.startswith("//"):
            self.graph.edge(self.here, "", "outside", told, uri)
            return
        page = self._open(base) if base else self.page
        dialog = page and (fragment or next(iter(page.dialogs), ""))
        if page is None or dialog not in page.dialogs:
            self.graph.edge(self.here, "", "missing", told, uri)
        else:
            self.graph.edge(self.here, self._key(page, dialog or ""), kind, told)


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


def _divided(node: Node) -> Iterator[tuple[str | None, list[Node]]]:
    """The parts of an ``if`` with their conditions; ``else`` has none."""
    cond: str | None = node.get("cond")
    part: list[Node] = []
    for child in node.nodes:
        if child.tag in ("elseif", "else"):
            yield cond, part
            cond, part = (child.get("cond") if child.tag == "elseif" else None), []
        else:
            part.append(child)
    yield cond, part


def _events(handler: Node) -> list[str]:
    """The events that a handler takes; the empty name is for all."""
    if handler.tag != "catch":
        return [handler.tag]
    return [name if name != "." else "" for name in handler.get("event").split()] or [""]


def _count(handler: Node) -> int:
    """The occurrence from which a handler takes its events."""
    count = handler.get("count", "1")
    return int(count) if re.fullmatch("[0-9]{1,4}", count) else 1


def _stays(handler: Node, events: list[str]) -> bool:
    """Whether a handler does something without a transition."""
    ways = {"goto", "submit", "exit", "return", "disconnect", "throw"}
    empty = not handler.nodes and not handler.text
    return not (empty or ASKED.issuperset(events) or any(one.tag in ways for one in handler.walk()))


def _leaves(node: Node) -> bool:
    """Whether an element is a Command of the robot that leaves the user."""
    row = TABLE_4_2.get(node.tag) if node.namespace == PRIMA_NAMESPACE else None
    return row is not None and row.leaves


def _leaves_at_its_end(form: Node) -> bool:
    """Whether a form is left before its items end; otherwise the application ends (2.1.6)."""
    units = {id(one): node for node in form.nodes if is_unit(node) for one in node.nodes}
    for item in [one for one in parts_of(form) if one.tag in ITEMS]:
        around = units.get(id(item))
        if item.attributes.keys() & {"cond", "expr"} or (around and around.get("cond")):
            continue
        contents = [item] if item.tag == "block" else item.all("filled")
        if any(_never_ends(content.nodes) for content in contents):
            return True
    return any(_never_ends(filled.nodes) for filled in form.all("filled"))


def _never_ends(acts: list[Node]) -> bool:
    """Whether content always leaves its dialog."""
    for act in acts:
        if act.tag in ("submit", "exit", "return", "disconnect", "throw", "goto"):
            return not act.attributes.keys() & {"nextitem", "expritem"}
        if act.tag == "if":
            parts = list(_divided(act))
            if parts[-1][0] is None and all(_never_ends(part) for _, part in parts):
                return True
    return False


def _hints(page: Page) -> dict[str, list[str]]:
    """The known sources of events: links and choices that throw them."""
    found: dict[str, list[str]] = {}
    for node in page.root.walk():
        event = node.get("event")
        if event and node.tag == "link":
            said = sayings(node.all("grammar"))
            found.setdefault(event, []).append(f"said {said}" if said else "link")
        elif event and node.tag == "choice":
            found.setdefault(event, []).append(f"said {quoted(_said(node))}")
    return {event: list(dict.fromkeys(hints)) for event, hints in found.items()}


def _asked(node: Node) -> str:
    """The first question of a dialog or item."""
    prompts = [one for one in node.all("prompt") if one.get("count", "1") == "1"]
    text = _said(prompts[0]) if prompts else ""
    return text or (node.text if node.tag in ("menu", "field") else "")


def _said(node: Node, depth: int = 0) -> str:
    """The words of a prompt or block, without those under conditions."""
    parts: list[str] = []
    for item in node.content:
        if isinstance(item, str):
            parts.append(item)
        elif item.tag == "value":
            parts.append(f"{{{item.get('expr')}}}")
        elif item.tag == "enumerate":
            parts.append("...")
        elif depth < 40 and (item.namespace == PRIMA_NAMESPACE or item.tag in (*WORDED, "prompt")):
            parts.append(" " + _said(item, depth + 1) + " ")
    return clean(" ".join("".join(parts).split()))
