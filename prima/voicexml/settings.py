"""A dialog's properties and form items."""

from __future__ import annotations

from prima.interpreter.vocabulary.questions import USUAL_CONFIDENCE
from prima.markup.tree import Node
from prima.voicexml.arranging import items_in
from prima.voicexml.checks.attributes import fits
from prima.voicexml.state import Context
from prima.voicexml.vocabulary import PROPERTIES

DEFAULTS = {
    "timeout": "5s",
    "bargein": "true",
    "maxnbest": "1",
    "termchar": "#",
    "inputmodes": "dtmf voice",
    "confidencelevel": str(USUAL_CONFIDENCE),
}
"""Defaults of properties."""
ANSWERING = ("timeout", "bargein", "bargeintype")
"""Attributes of a prompt that say how it may be answered (4.1)."""


def form_items(context: Context) -> list[Node]:
    """The form items of the active dialog: each unit before the items it holds."""
    form = context.form
    if form is None:
        return []
    if form.tag == "menu":
        return [form]
    return items_in(form)


def setting(context: Context, name: str) -> str:
    """A property's value, innermost first; a value of the wrong kind is ignored (6.3)."""
    page_roots = [context.page.root, context.root.root if context.root else None]
    kind = PROPERTIES.get(name)
    for node in (context.item, context.form, *page_roots):
        for child in reversed(node.all("property") if node is not None else []):
            value = child.get("value")
            if child.get("name") == name and (kind is None or fits(kind, value)):
                return value
    return DEFAULTS.get(name, "")


def answering(context: Context, prompt: Node | None = None) -> dict[str, str]:
    """How a prompt may be answered: its attributes, or the properties as it is queued (4.1.7)."""
    own = prompt.attributes if prompt is not None else {}
    return {name: own.get(name) or setting(context, name) for name in ANSWERING}
