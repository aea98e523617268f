"""The events that an expression may name, according to its document."""

from __future__ import annotations

from prima.interpreter.elements import Document
from prima.interpreter.sensors import names_in
from prima.markup.tree import Node
from prima.script.choices import choices
from prima.script.globals import IDENTIFIER

WRITERS = ("var", "assign")


def events_named(document: Document, code: str) -> frozenset[str] | None:
    """The events that an expression may name; None where only a run tells.

    It tells them itself, as ``old ? 'a' : 'b'``, or it is a variable that is given nothing else.
    """
    name = code.strip()
    given = _given(document, name) if IDENTIFIER.fullmatch(name) else [name]
    if not given:
        return None
    found = [one for text in given for one in choices(text)]
    return frozenset(one.text for one in found) if all(one.whole for one in found) else None


def _given(document: Document, name: str) -> list[str]:
    """The expressions that a variable is given; none where it may be given something else."""
    if document.node.tag != "prima" or _changes(document, name):
        return []
    nodes = [one for one in document.node.walk() if _named(one) == name]
    if any(one.tag not in WRITERS for one in nodes):
        return []
    return [code for one in nodes if (code := one.get("expr"))]


def _named(node: Node) -> str:
    """The variable that an element is about, without its scope."""
    return node.get("name" if node.tag != "foreach" else "item").rpartition(".")[2]


def _changes(document: Document, name: str) -> bool:
    """Whether scripts or expressions may give a variable a value."""
    return any(
        one.opaque or name in one.declared | one.written | one.changed for one in names_in(document)
    )
