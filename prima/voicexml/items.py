"""The results of form items: values, filled elements, subdialogs (VoiceXML 2.0, 2.3 and 2.4)."""

from __future__ import annotations

from typing import Any

from prima.interpreter.selection import satisfied
from prima.markup.tree import Node
from prima.messages import Json
from prima.voicexml.arranging import parts_of
from prima.voicexml.choosing import ItemSelection
from prima.voicexml.content import Content
from prima.voicexml.document import Page
from prima.voicexml.elements import INPUTS
from prima.voicexml.results import RESULTS, shadow
from prima.voicexml.settings import form_items, setting
from prima.voicexml.shared import SharedState
from prima.voicexml.state import Context, Flow, GoDialog, TakenUtterance
from prima.voicexml.targets import go_to

ABSENT = object()
"""Marks a slot that an interpretation lacks: null is a value."""


class Items:
    """Fills the form items of one application."""

    def __init__(self, shared: SharedState, content: Content, selection: ItemSelection) -> None:
        self.shared = shared
        self.content = content
        self.selection = selection
        self.engine = shared.engine

    # What the user said ---------------------------------------------------------------

    def process(self, context: Context, heard: TakenUtterance) -> Flow:
        """Pass what the user said to the item, form, link or choice that took it."""
        owner = heard.owner
        self.shared.app.note(owner, "in" if owner.tag in ("link", "choice") else "heard")
        dialog = _dialog_of(heard.page, owner)
        if dialog is not None and dialog is not context.form:
            page = heard.page if heard.page is not context.page else None
            raise GoDialog(page, _name(heard.page, dialog), heard)
        if owner.tag in ("link", "choice"):
            yield from self._follow(context, owner)
        filled = self._fill(context, heard)
        if not filled:
            return  # the algorithm just continues (C)
        self.leave_initial(context)
        yield from self.run_filled(context, filled)

    def leave_initial(self, context: Context) -> None:
        """Mark all ``initial`` items, once what the user says has filled an input item (2.3.3)."""
        for item in form_items(context):
            if item.tag == "initial":
                self.mark(context, item)

    def _follow(self, context: Context, node: Node) -> Flow:
        """Go to a link's or choice's target: a dialog, or an event (2.2, 2.5).

        A link's attributes are evaluated where it was heard, not where it is written.
        """
        content, nothing = self.content, self.engine.nothing
        if not node.attributes.keys().isdisjoint(("event", "eventexpr")):
            raise content.raised(node, context, nothing)
        uri = content.word(node, "next", context, nothing)
        yield from go_to(self.shared, context, uri, node)

    def remember(self, context: Context, heard: TakenUtterance) -> None:
        """Set ``application.lastresult$`` (5.1.5); record what was said if that is requested.

        With ``recordutterance`` the words heard are the recording (2.1, 7.2).
        """
        if heard.mode == "voice" and setting(context, "recordutterance") == "true":
            heard.recorded = self.shared.keep_recording(heard.utterance)
        results = [shadow(heard)]
        for utterance, interpretation, confidence in heard.others:
            further = TakenUtterance(
                utterance, interpretation, heard.owner, heard.page, confidence, heard.mode
            )
            results.append(shadow(further))
        local = self.shared.local()
        self.engine.set(local, "$results", results)
        self.engine.assign(context.application, "lastresult$", RESULTS, context.scopes(local))

    def forget_results(self, context: Context) -> None:
        """Once input is waited for, ``application.lastresult$`` is undefined, in callers too (5.1.5)."""
        waiting: Context | None = context
        while waiting is not None:
            if self.engine.defined(waiting.application, "lastresult$"):
                self.engine.unset(waiting.application, "lastresult$")
            waiting = waiting.caller

    def _fill(self, context: Context, heard: TakenUtterance) -> list[Node]:
        """Give items their values (3.1.6): an item's own grammar one, a form's perhaps many."""
        owner, found = heard.owner, heard.interpretation
        if owner.tag not in ("form", "menu"):
            self.fill(context, owner, slot_of(found, _slot(owner), found), shadow(heard))
            return [owner]
        filled = []
        for item in form_items(context):
            value = slot_of(found, _slot(item), ABSENT) if item.tag in INPUTS else ABSENT
            if value is not ABSENT:
                self.fill(context, item, value, shadow(heard))
                filled.append(item)
        return filled

    def fill(
        self, context: Context, item: Node, value: Any, shadow: dict[str, Json] | None = None
    ) -> None:
        """Give an item's variable its value, plain data or the engine's, and its shadow variables."""
        context.visited.add(item.index)
        name = item.get("name")
        if name:
            self.engine.set(context.dialog, name, value)
        if name and shadow is not None:
            self.engine.set(context.dialog, f"{name}$", shadow)

    def mark(self, context: Context, item: Node) -> None:
        """Set the variable of a control item."""
        self.fill(context, item, True)

    def run_filled(self, context: Context, filled: list[Node]) -> Flow:
        """Run the filled elements that what was just filled has satisfied (2.4)."""
        assert context.form is not None
        for node in parts_of(context.form):
            if node in filled:
                yield from self._run_own(context, node)
            elif node.tag == "filled":
                context.item = None
                if self._satisfied(context, node, filled):
                    yield from self.content.run(node, context, self.shared.local())

    def _run_own(self, context: Context, item: Node) -> Flow:
        """Run the filled elements in an item."""
        context.item = item
        for action in item.all("filled"):
            if not self.selection.guarded(context, item):
                break  # an earlier one has cleared it
            yield from self.content.run(action, context, self.shared.local())

    def _satisfied(self, context: Context, node: Node, filled: list[Node]) -> bool:
        """Whether a form's filled is to run: for any, or all, of its items (2.4)."""
        items = [item for item in form_items(context) if item.tag in INPUTS]
        names = node.get("namelist").split()
        if names:
            items = [item for item in items if item.get("name") in names]
        mode = node.get("mode")
        return satisfied(mode, items, filled, lambda item: self.selection.guarded(context, item))


def _dialog_of(page: Page, owner: Node) -> Node | None:
    """The dialog that owns the grammar: a form or menu itself, or that of a choice."""
    if owner.tag in ("form", "menu"):
        return owner
    menus = page.dialogs.values() if owner.tag == "choice" else ()
    return next((menu for menu in menus if owner in menu.nodes), None)


def _name(page: Page, dialog: Node) -> str:
    return next((name for name, node in page.dialogs.items() if node is dialog), "")


def _slot(item: Node) -> str:
    return item.get("slot") or item.get("name")


def slot_of(found: Json, path: str, otherwise: Any) -> Any:
    """A slot's value in an interpretation, which may be null.

    A name with dots is a property's whole name or else a path to one further in (3.1.6, C).
    """
    for part in [path] if isinstance(found, dict) and path in found else path.split("."):
        if not isinstance(found, dict) or part not in found:
            return otherwise
        found = found[part]
    return found
