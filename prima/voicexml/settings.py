"""What holds for a dialog: its properties and its form items."""

from __future__ import annotations

from prima.markup.tree import Node
from prima.voicexml.arranging import is_unit, parts_of
from prima.voicexml.elements import ITEMS
from prima.voicexml.state import Context

DEFAULTS = {"timeout": "5s", "bargein": "true", "maxnbest": "1", "termchar": "#"}
"""Values of properties that no document sets."""


def form_items(context: Context) -> list[Node]:
    """The form items of the active dialog: units, and behind each what it holds."""
    form = context.form
    if form is None:
        return []
    if form.tag == "menu":
        return [form]
    return [one for one in parts_of(form) if one.tag in ITEMS or is_unit(one)]


def setting(context: Context, name: str) -> str:
    """A property's value, innermost first (6.3)."""
    page_roots = [context.page.root, context.root.root if context.root else None]
    for node in (context.item, context.form, *page_roots):
        for child in reversed(node.all("property") if node is not None else []):
            if child.get("name") == name:
                return child.get("value")
    return DEFAULTS.get(name, "")


def number(context: Context, name: str, default: float) -> float:
    """A property as a number."""
    try:
        return float(setting(context, name))
    except ValueError:
        return default
