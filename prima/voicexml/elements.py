"""Groups of elements that the algorithm, its content and the checks treat alike."""

from __future__ import annotations

from prima.markup.tree import Node

ITEMS = frozenset(["field", "block", "initial", "subdialog", "object", "record", "transfer"])
"""Form items (2.0, 2.1.2)."""
INPUTS = frozenset({"field", "record", "object", "subdialog", "transfer"})
"""Items that a result fills."""
HANDLERS = ("catch", "error", "help", "noinput", "nomatch")
"""Elements that take events (5.2)."""
SILENT = frozenset(["lexicon", "metadata", "meta", "desc"])
"""Elements of prompts that are not spoken."""


def handler_names(handler: Node) -> list[str]:
    """The events that a handler takes; the empty name is for all."""
    if handler.tag != "catch":
        return [handler.tag]
    return [name.rstrip(".") for name in handler.get("event").split()] or [""]


def handler_number(handler: Node) -> int:
    """The count of a handler or a prompt; 1 if it is not a number."""
    count = handler.get("count", "1")
    return max(int(count), 1) if count.isdecimal() else 1
