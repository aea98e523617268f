"""A VoiceXML document as the values that checks of PRIMA's own language work on.

What is found out without running anything is found out of both languages in the same way: what
units reach (U5), how long they speak, what is said twice (O3), how long others wait (certificates).
A sketch has what such checks need and nothing else: of a question that it asks, of a grammar that
an answer may fill other items.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import chain
from urllib.parse import urlsplit

from prima.interpreter.acts import Act, CommandRun, Expression, Foreach, Goto, Handler, If, all_acts
from prima.interpreter.deadcontent import branches
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Filled,
    Form,
    Item,
    Prompt,
    Subdialog,
    Unit,
    all_items,
)
from prima.interpreter.entering import FormTarget
from prima.interpreter.units import Finder, Reach, thrown_by
from prima.markup.tree import Node
from prima.markup.uris import parted
from prima.messages import Json
from prima.script.choices import PossibleText, choices
from prima.voicexml.acting import ACTS, code_of, runs_in, saying, speak, spoken_pieces, text_of
from prima.voicexml.arranging import is_unit, longest_of
from prima.voicexml.document import Page
from prima.voicexml.elements import HANDLERS, ITEMS, handler_names, handler_number
from prima.voicexml.platform import own_words
from prima.voicexml.vocabulary import PRIMA_NAMESPACE

ASKING = ("field", "initial", "record", "menu")
FETCHING = ("goto", "submit", "data")
"""Elements of content whose fetch may play something."""
CALLING = ("subdialog", "transfer")
LEADING = ("goto", "submit", "subdialog")
FAILURES = ("error.badfetch", "error.unsupported.format", "error.unsupported.builtin")
"""Events thrown by a question's grammars and by fetches, besides those of PRIMA's language."""
UNIVERSAL = ("help", "cancel", "exit")


class Sketch:
    """One document, with the handlers of its application root."""

    def __init__(self, page: Page, root: Page | None) -> None:
        self.page = page
        self.wider = [page.root, *([root.root] if root is not None else [])]
        self._units: dict[int, tuple[Form, Unit]] = {}
        handlers = [one for node in self.wider for one in self._handlers(node)]
        handlers += _platforms_own(page)
        forms = {name: self._form(name, node) for name, node in page.dialogs.items()}
        properties = {
            name: one for node in self.wider[::-1] for name, one in _properties(node).items()
        }
        self.document = Document(
            "", "", page.lang, page.uri, forms, tuple(handlers), (), (), (), properties, page.root
        )
        self.finder = Finder(self.document, self._thrown)

    @property
    def units(self) -> list[tuple[Form, Unit]]:
        """The units around form items, each with its form."""
        return [*self._units.values()]

    def reach(self, unit: Node | Unit) -> Reach:
        """All that may run in a unit."""
        node = unit.node if isinstance(unit, Unit) else unit
        return self.finder.reach(*self._units[node.index])

    # Dialogs ------------------------------------------------------------------------------

    def _form(self, name: str, node: Node) -> Form:
        items = [node] if node.tag == "menu" else node.nodes
        made = [self._item(one) for one in items if _is_item(one)]
        filled = [self._filled(one) for one in node.all("filled")]
        if node.all("grammar"):  # an answer may fill any item of the form
            filled += _filled_in(made)
        handlers = () if node.tag == "menu" else self._handlers(node)
        form = Form(name, tuple(made), handlers, (), (), (), tuple(filled), _properties(node), node)
        self._units |= {one.node.index: (form, one) for one in made if isinstance(one, Unit)}
        return form

    def _item(self, node: Node) -> Item:
        name = node.get("name") or f"#{node.index}"
        expr, cond = code_of(node, "expr"), code_of(node, "cond")
        own = (name, expr, cond, self._handlers(node), _properties(node), node, None)
        if is_unit(node):
            inner = tuple(self._item(one) for one in node.nodes if _is_item(one))
            return Unit(*own, items=inner, longest=longest_of(node))
        if node.tag == "block":
            return Block(*own, content=self._acts(node, node.content))
        filled = tuple(self._filled(one) for one in node.all("filled"))
        # Its prompts and the Commands in them: they are carried out before it asks or calls.
        asked = [one for one in all_acts(self._acts(node, node.content)) if type(one) is CommandRun]
        fetched = [node] if node.tag in CALLING else node.all("choice")
        asked += chain.from_iterable(map(self.fetching, fetched))
        filled = (*filled, Filled("any", (), tuple(asked), node))
        if node.tag not in ASKING:
            return Subdialog(*own, filled=filled)
        return Field(*own, prompts=tuple(self._prompts(node)), filled=filled)

    def _filled(self, node: Node) -> Filled:
        names = tuple(node.get("namelist").split())
        return Filled(node.get("mode") or "all", names, self._acts(node, node.content), node)

    def _handlers(self, holder: Node) -> tuple[Handler, ...]:
        return tuple(
            Handler(
                tuple(handler_names(node)),
                code_of(node, "cond"),
                handler_number(node),
                None,
                self._acts(node, node.content),
                node,
            )
            for node in holder.all(*HANDLERS)
        )

    def _prompts(self, item: Node) -> Iterator[Prompt]:
        for pieces, node in spoken_pieces(item.content):
            words = text_of(pieces)
            if words and node is not None:
                count = handler_number(node)
                yield Prompt(words, count, code_of(node, "cond"), None, None, node)
            elif words:
                yield Prompt(words, 1, None, None, None, item)

    # Content ------------------------------------------------------------------------------

    def _acts(self, holder: Node, content: Iterable[Node | str]) -> tuple[Act, ...]:
        """The content of an element as acts; text outside prompts is at its first element."""
        made: list[Act] = []
        for pieces, node in spoken_pieces(content):
            if not pieces:
                made += self._act(node) if node is not None else ()
                continue
            at = node or (pieces[0] if isinstance(pieces[0], Node) else holder)
            said = saying(pieces, at, holder)
            cond = code_of(node, "cond") if node is not None else None
            made += [If(((cond, tuple(said)),), holder)] if cond is not None else said
        return tuple(made)

    def _act(self, node: Node) -> Iterator[Act]:
        if node.namespace == PRIMA_NAMESPACE:
            yield from runs_in(node)
            return
        if node.tag in FETCHING:
            yield from self.fetching(node)
        if node.tag == "if":
            parts = branches(node)
            found = [(code_of(head, "cond"), self._acts(node, part)) for head, part in parts]
            yield If(tuple(found), node)
        elif node.tag == "foreach":
            array = Expression(node.get("array"), node, "array")
            yield Foreach(node.get("item"), array, self._acts(node, node.content), node)
        elif node.tag in ACTS:
            yield ACTS[node.tag](node)

    def fetching(self, node: Node) -> Iterator[CommandRun]:
        """What may be played while an element's resource is fetched, or a call is made."""
        fetched = node.get("fetchaudio", self._played)
        audio = fetched if node.tag != "transfer" else node.get("transferaudio")
        here = node.tag != "submit" and (node.get("next") or node.get("src")).startswith("#")
        if audio and not here:
            said = f"[{audio.rpartition('/')[2]}]"
            yield speak((Expression("", node, "fetchaudio"),), node, (said,))

    @cached_property
    def _played(self) -> str:
        """The longest name that a property gives of what is played during fetches."""
        properties = (one for wider in self.wider for one in wider.walk() if one.key == "property")
        found = (one.get("value") for one in properties if one.get("name") == "fetchaudio")
        return max(found, key=len, default="")

    def leads(self, act: Goto | Subdialog) -> list[FormTarget]:
        """The dialogs that an element leads to, of this document or of others."""
        node, where = act.node, "src" if isinstance(act, Subdialog) else "next"
        if node.tag not in LEADING:
            return []  # a transfer's destination, or an object
        if where in node.attributes:
            return self._targets(node, PossibleText(node.get(where).strip(), True))
        found = choices(node.get("srcexpr" if where == "src" else "expr"))
        return [target for one in found for target in self._targets(node, one)]

    def _targets(self, node: Node, uri: PossibleText) -> list[FormTarget]:
        """The dialog of a URI, or those of all URIs with that beginning."""
        own = self.page.uri
        if uri.text[:1] == "#" or (not uri.text and not uri.whole):
            return [FormTarget(f"{own}#{parted(uri.text)[1]}", uri.whole)]
        base, name = parted(self.page.resolve(uri.text, node) if uri.text else "")
        parts = urlsplit(base)
        if parts.scheme == "service" and name:
            return [FormTarget(f"{own}#{name}", uri.whole)]
        if not parts.path or parts.scheme or parts.netloc:
            return []
        mark = "#" if uri.whole or "#" in uri.text else ""
        return [FormTarget(f"{parts.path}{mark}{name}", uri.whole)]

    # Events -------------------------------------------------------------------------------

    def _thrown(self, item: Item) -> Iterator[str | None]:
        """The events that visiting an item may throw, including by what the user says to a link."""
        yield from thrown_by(item)
        yield from FAILURES
        if not isinstance(item, Field):
            return
        yield "maxspeechtimeout"
        yield from self._called_in(item.node)
        yield from self._called_outside
        form = self._holders.get(id(item))
        yield from self._called_in(form.node) if form is not None else ()

    @cached_property
    def _called_outside(self) -> list[str | None]:
        """Events that the user may cause anywhere in the document."""
        return list(dict.fromkeys(one for node in self.wider for one in self._called_in(node)))

    @cached_property
    def _holders(self) -> dict[int, Form]:
        """The forms of the items in units."""
        return {id(item): form for form, unit in self._units.values() for item in unit.items}

    @staticmethod
    def _called_in(node: Node) -> Iterator[str | None]:
        """Events that the user may cause by the direct children of an element."""
        for link in node.all("link"):
            if link.attributes.keys() & {"event", "eventexpr"}:
                yield link.get("event") or None
        if any(one.get("name") == "universals" for one in node.all("property")):
            yield from UNIVERSAL


def _platforms_own(page: Page) -> Iterator[Handler]:
    """The platform's own handlers that speak, which take what no other handler does (5.2.5)."""
    for event, words in own_words(page.lang).items():
        said = speak((words,), page.root, (words,))
        yield Handler((event,), None, 1, None, (said,), page.root)


def _filled_in(items: Iterable[Item]) -> Iterator[Filled]:
    """The ``filled`` of all fields, of those in units too, without what is done in their prompts."""
    for item in all_items(tuple(items)):
        if isinstance(item, Field):
            yield from (one for one in item.filled if one.node is not item.node)


def _properties(node: Node) -> dict[str, Json]:
    """The properties that an element sets."""
    return {one.get("name"): one.get("value") for one in node.all("property")}


def _is_item(node: Node) -> bool:
    return node.tag in ITEMS or node.tag == "menu" or is_unit(node)
