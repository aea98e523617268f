"""The events that an expression may name, by its document."""

from __future__ import annotations

from prima.interpreter.elements import Document
from prima.interpreter.sensors import names_in
from prima.markup.tree import Node
from prima.script.choices import choices
from prima.script.globals import IDENTIFIER

WRITERS = ("var", "assign")


def events_named(document: Document, code: str) -> frozenset[str] | None:
    """The events that an expression may name; None if only a run determines them.

    The names are literals in it, as ``old ? 'a' : 'b'``, or in every assignment to its variable.
    """
    name = code.strip()
    given = _given(document, name) if IDENTIFIER.fullmatch(name) else [name]
    if not given:
        return None
    found = [one for text in given for one in choices(text)]
    return frozenset(one.text for one in found) if all(one.whole for one in found) else None


def _given(document: Document, name: str) -> list[str]:
    """The expressions assigned to a variable; none if it may get another value."""
    if document.node.tag != "prima" or _changes(document, name):
        return []
    nodes = [one for one in document.node.walk() if _named(one) == name]
    if any(one.tag not in WRITERS for one in nodes):
        return []
    return [code for one in nodes if (code := one.get("expr"))]


def _named(node: Node) -> str:
    """The variable that an element names, without its scope."""
    return node.get("name" if node.tag != "foreach" else "item").rpartition(".")[2]


def _changes(document: Document, name: str) -> bool:
    """Whether scripts or expressions may assign to a variable."""
    return any(
        one.opaque or name in one.declared | one.written | one.changed for one in names_in(document)
    )
