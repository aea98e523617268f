"""Prices of a VoiceXML application, and the order of its dialogs."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from prima.checks.prices.firsts import responds
from prima.checks.prices.model import Gap, Outline, Price, PricedReaction, PricedState
from prima.checks.prices.pages import TARGETS
from prima.checks.prices.tags import holders, is_foreign, returns, thrown_by
from prima.checks.prices.times import ASKED_AGAIN, OFTEN, QUESTION
from prima.checks.prices.voicetimes import VoiceTimes
from prima.devices.profile import Profile
from prima.interpreter.selection import takes
from prima.markup.tree import Node
from prima.voicexml.arranging import UNIT
from prima.voicexml.document import Page, VoiceDocument
from prima.voicexml.elements import HANDLERS, handler_names, leaves, to_item
from prima.voicexml.sketch import ASKING, Sketch
from prima.voicexml.vocabulary import SPOKEN

SILENT_ACTS = ("assign", "var", "log", "script", "clear", "desc")


class VoicePrices(VoiceTimes):
    """The outline of a VoiceXML application and its further documents."""

    def __init__(self, document: VoiceDocument, profile: Profile) -> None:
        super().__init__(document, profile)
        self.thrown = {name for page in self.pages for name in thrown_by(page.root)}
        self.parts: list[Price] = []
        self.states: dict[str, PricedState] = {}
        self.caught: list[tuple[Node, PricedState]] = []
        self.inside: set[int] = set()
        """The elements in units around form items, by their identities."""
        for page in self.pages:
            self._say(page)
        for page in self.pages:
            self._read(page)

    def _say(self, page: Page) -> None:
        """The speech of the elements of a document."""
        self.page = page
        for node in [*page.root.all(*HANDLERS), *page.dialogs.values()]:
            for holder in holders(node):
                self.said[id(holder)] = list(self._own(holder))

    def _read(self, page: Page) -> None:
        """Add the activity of a document."""
        self.page, self.sketch = page, Sketch(page, self.pages.root(page))
        units = [one for dialog in page.dialogs.values() for one in dialog.nodes if one.key == UNIT]
        self.inside |= {id(node) for unit in units for node in unit.walk()}
        for name, dialog in page.dialogs.items():
            self.states[self._key(page, name)] = self._dialog(name, dialog)
        for node in page.root.all(*HANDLERS):
            self._catch(node, PricedState("", node))
        for node in page.root.all("property"):
            self.parts += self._waiting(node, node.get("value"), node.get("name"))

    @staticmethod
    def _key(page: Page, name: str) -> str:
        return f"{page.uri}#{name}"

    def outline(self) -> Outline:
        """All that is known of the application."""
        parts = list({(one.node.place, one.what): one for one in self.parts}.values())
        reactions = [
            PricedReaction(
                tuple(name or "message" for name in names),
                node,
                *self._begins(node, parts),
                state,
                None if leaves(node.content) and not returns(node) else "",
            )
            for node, state in self.caught
            if (names := [name for name in handler_names(node) if is_foreign(name)])
        ]
        return Outline(parts, self.states, reactions, [], [], self.pages.gaps)

    def _begins(self, handler: Node, parts: list[Price]) -> tuple[list[Price], list[Price]]:
        """The first Commands of a handler, and those up to its response: perhaps anything."""
        firsts = self._first(handler) or parts
        until = firsts if all(map(responds, firsts)) else [*firsts, *parts]
        return firsts, until if any(map(responds, until)) else []

    def _first(self, handler: Node) -> list[Price]:
        """The first Commands of a handler, if they are the same in each case; otherwise nothing."""
        for piece in handler.content:
            if isinstance(piece, str) and not piece.strip():
                continue
            if isinstance(piece, Node) and piece.tag in SILENT_ACTS:
                continue
            said = isinstance(piece, str) or piece.tag in SPOKEN
            if said and not (isinstance(piece, Node) and piece.get("cond")):
                return [self._asked_anew(handler)]
            return [] if isinstance(piece, str) else [*self._steps(piece, first=True)]
        return []

    def _asked_anew(self, handler: Node) -> Price:
        """The question that listened, asked again from its beginning with the handler's speech."""
        lasts = max((one.lasts for one in self.parts if one.listens), default=1)
        return Price(handler, "question", QUESTION.devices, lasts, engages=True)

    # Dialogs ----------------------------------------------------------------------------

    def _dialog(self, name: str, dialog: Node) -> PricedState:
        """The activity of a dialog, and where answers and its own events lead."""
        state = PricedState(self._key(self.page, name), dialog)
        items = [dialog] if dialog.tag == "menu" else dialog.nodes
        root = self.pages.root(self.page)
        wider = [self._held(one).wide for one in (self.page.root, *([root.root] if root else ()))]
        for node in chain([dialog], *wider):
            for inner in self._walk(node):
                self._lead(state, inner)
                state.parts += self.said.get(id(inner), ()) if id(inner) not in self.inside else ()
        for item in items:
            self._item(state, item, dialog)
        for node in dialog.walk():
            if node.tag in HANDLERS:
                self._catch(node, state)
        self.parts += state.parts
        return state

    def _walk(self, node: Node) -> Iterator[Node]:
        """An element and its content, without handlers that only wait for events from outside."""
        if node.tag == "catch" and all(self._is_outside(name) for name in handler_names(node)):
            return
        yield node
        for inner in node.nodes:
            yield from self._walk(inner)

    def _is_outside(self, name: str) -> bool:
        own = any(takes(name, one) for one in self.thrown) or "" in self.thrown
        return bool(name) and is_foreign(name) and not own

    def _item(self, state: PricedState, item: Node, dialog: Node) -> None:
        """The question of a form item."""
        if item.key == UNIT:
            state.parts.append(self._unit(item, dialog))
        elif item.tag == "transfer":
            state.parts += self._call(item)
        elif item.tag in ASKING:
            asked = self._question(item, dialog)
            state.parts.append(asked)
            if not self._bounded(item, dialog):
                state.repeats.append(Gap(item.place, ASKED_AGAIN))

    def _lead(self, state: PricedState, node: Node) -> None:
        """Where an element leads without a wait for an event."""
        if node.tag in TARGETS:
            target = self.pages.target(self.page, node)
            for name in target.dialogs if target.page else ():
                leads = state.calls if node.tag == "subdialog" else state.goes
                leads[self._key(target.page, name)] = node  # type: ignore[arg-type]
        if node.tag == "foreach":
            state.unknown.append(Gap(node.place, OFTEN))
        if node.tag == "clear" or (node.tag == "goto" and to_item(node)):
            state.repeats.append(Gap(node.place, "items of the dialog are visited again"))

    def _catch(self, node: Node, around: PricedState) -> None:
        """A handler: its activity is a reaction if its event comes from outside."""
        does = PricedState(node.get("event") or node.tag, node)
        for holder in holders(node):
            does.parts += self.said[id(holder)]
        self.parts += does.parts if id(node) not in self.inside else ()
        for inner in node.walk():
            self._lead(does, inner)
        # VoiceXML always continues to ask: a reaction that stays goes on with its dialog.
        if around.name and not leaves(node.content):
            does.goes.setdefault(around.name, node)
        self.caught.append((node, does))

    def _bounded(self, item: Node, dialog: Node) -> bool:
        """Whether a question is eventually left if the user never answers it."""
        scope = [one for node in self._scopes(item, dialog) for one in self._held(node).handlers]
        return all(
            any(
                event in handler_names(one) and not one.get("cond") and leaves(one.content)
                for one in scope
            )
            for event in ("noinput", "nomatch")
        )
