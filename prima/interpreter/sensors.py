"""The sensors that a document reads, by the first part of their names, such as ``position``."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

from prima.interpreter.elements import Document
from prima.script.globals import CONSTANTS, STRANGE
from prima.script.names import Names, expression_names, script_names
from prima.script.parse import Code, Node, parse_expression, parse_script

TAKEN = CONSTANTS | {"sensor"}
"""Names that conditions use without declaration."""
NOTHING_READ: frozenset[str] = frozenset()
"""The result of :func:`sensors_read` for a document that depends on no sensor."""


def hides_sensors(document: Document) -> bool:
    """Whether the document may declare a variable with a name that conditions use."""
    return any(
        node.attributes.get("name", "").strip() in TAKEN for node in document.node.walk()
    ) or any(
        names.opaque or not TAKEN.isdisjoint(names.declared | names.written | names.changed)
        for names in names_in(document)
    )


def names_in(document: Document) -> Iterator[Names]:
    """The names in each piece of a document's code."""
    yield from (expression_names(expression.code) for expression in document.expressions)
    yield from map(script_names, document.scripts)


@lru_cache(maxsize=1000)
def sensors_of(code: str) -> frozenset[str] | None:
    """The sensors that a condition reads.

    None if it may depend on anything else, or if they cannot be determined.
    """
    names = expression_names(code)
    if names.opaque or not names.read.keys() <= TAKEN:
        return None
    return _looked_at(parse_expression(code)) or None


def sensors_read(document: Document) -> frozenset[str] | None:
    """All sensors that may affect a document's behaviour; None if they cannot be determined.

    A condition that depends on other things too is looked at whenever any sensor changes, and so is
    what turned true while a subdialog had the place of the form that watches for it.
    """
    if document.sensors is None:
        document.sensors = (_sensors_read(document),)
    return document.sensors[0]


def _sensors_read(document: Document) -> frozenset[str] | None:
    if not _watches_are_clear(document):
        return None
    read: set[str] = set()
    for parsed in _codes(document):
        found = _looked_at(parsed)
        if found is None:
            return None
        read |= found
    return frozenset(read)


def _watches_are_clear(document: Document) -> bool:
    """Whether the sensors that watches read can be determined, and are checked in time."""
    inner = [watch for form in document.forms.values() for watch in form.watches]
    watches = [*document.watches, *inner]
    if inner and any(node.tag == "subdialog" for node in document.node.walk()):
        return False
    if watches and hides_sensors(document):
        return False
    return all(sensors_of(watch.when.code) is not None for watch in watches)


def _looked_at(code: Code | None) -> frozenset[str] | None:
    """The sensors that code reads; None if it may read others indirectly."""
    if code is None or not code.sound:
        return None
    read = set()
    for node in code.walk():
        found = _sensor(code, node) if node.type in NAMED else ""
        if found is None:
            return None
        read.add(found)
    return frozenset(read - {""})


def _sensor(code: Code, node: Node) -> str | None:
    """The sensor that a name reads; empty for another name, None if it may be any."""
    text = code.of(node)
    if node.type == "this" or text == "eval" or STRANGE in text or "\\" in text:
        return None
    if text == "application" and _member(code, node) in ("", "valueOf"):
        return None
    if text != "sensor":
        return ""
    whole = node.parent if node.type == "property_identifier" else node
    return _member(code, whole) or None


NAMED = frozenset(["identifier", "property_identifier", "shorthand_property_identifier", "this"])
"""Nodes that may name a sensor or anything else."""


def _member(code: Code, node: Node | None) -> str:
    """The member read of a node's value; empty if none is read, or a method."""
    parent = node.parent if node is not None else None
    if parent is None or parent.type != "member_expression" or parent.children[0] != node:
        return ""
    if parent.parent is not None and parent.parent.type == "call_expression":
        return ""
    part = parent.child_by_field_name("property")
    return code.of(part) if part is not None else ""


def _codes(document: Document) -> Iterator[Code | None]:
    """All code of a document, with the variables that elements name."""
    yield from (parse_expression(expression.code) for expression in document.expressions)
    yield from map(parse_script, document.scripts)
    for node in document.node.walk():
        for name in ("name", "namelist"):
            value = node.attributes.get(name, "")
            if any(word in value for word in ("sensor", "application", STRANGE)):
                yield from (parse_expression(word) for word in value.split())
