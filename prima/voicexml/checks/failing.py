"""Elements that fail whenever a run reaches them, though they are valid."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prima.errors import Diagnosis, Place, Problem
from prima.markup.tree import Node
from prima.voicexml.elements import HANDLERS, ITEMS, handler_names
from prima.voicexml.platform import NO_CHOICES, Unsupported, uncalled, unrecorded

ALWAYS_FAILS = Diagnosis(
    "always-fails",
    "Element that always fails",
    (
        "The element is valid VoiceXML, but a run cannot do what it asks for: objects, formats of "
        "recordings and destinations of calls that PRIMA does not have, or an enumerate without "
        "choices. Each time, an event is thrown. There is no warning if a handler names that "
        "event, or one such as error.unsupported: the document then expects it."
    ),
    rule="VoiceXML 2.0, 2.3",
    severity="warning",
    message="<{tag}> always fails: {why}.",
    remedy="At run time it is {event}: change it, or catch the event.",
)
NO_OBJECTS = Unsupported("error.unsupported.objectname", "this platform has no objects")


def check_failing(root: Node, application: Node | None = None) -> Iterator[Problem]:
    """Warn of what always fails, unless the document expects it, or its ``application`` root."""
    if root.get("application") and application is None:
        return  # nobody knows what its root expects
    roots = (root,) if application is None else (root, application)
    for dialog in root.all("form", "menu"):
        for item in dialog.walk():
            for found in _failures(item):
                yield from _unexpected(found, (*roots, dialog, item))
    for found in _unrecorded_answers(root):
        yield from _unexpected(found, (*roots, *root.walk()))


def _unexpected(
    found: tuple[Node, Place, Unsupported], holders: Iterable[Node]
) -> Iterator[Problem]:
    """The problem of what fails, unless a handler in one of the ``holders`` expects it."""
    node, place, why = found
    if not any(_expects(one, why.event) for one in holders):
        yield ALWAYS_FAILS.at(place, tag=node.tag, why=why.message, event=why.event)


def _unrecorded_answers(root: Node) -> Iterator[tuple[Node, Place, Unsupported]]:
    """Formats of answers that cannot be recorded, if the document has any recorded (2.1, 7.2)."""
    properties = [one for one in root.walk() if one.key == "property"]
    if not any(_sets(one, "recordutterance") == "true" for one in properties):
        return
    for one in properties:
        if refused := unrecorded(_sets(one, "recordutterancetype")):
            yield one, one.attribute_place("value"), refused


def _sets(node: Node, name: str) -> str:
    """The value that an element gives a property; empty if it is another's."""
    return node.get("value") if node.get("name") == name else ""


def _failures(item: Node) -> Iterator[tuple[Node, Place, Unsupported]]:
    """What fails of an item or menu, each with its place and the event; a condition may avoid it."""
    if {"cond", "expr"} & item.attributes.keys():
        return
    if item.key == "object":
        yield item, item.place, NO_OBJECTS
    if item.key == "record" and (refused := unrecorded(item.get("type"))):
        yield item, item.attribute_place("type"), refused
    if (
        item.key == "transfer"
        and "dest" in item.attributes
        and (refused := uncalled(item.get("dest")))
    ):
        yield item, item.attribute_place("dest"), refused
    if item.key in (*ITEMS, "menu") and not item.all("choice", "option"):
        for node in item.walk():
            if node.key == "enumerate":
                yield node, node.place, NO_CHOICES


def _expects(holder: Node, event: str) -> bool:
    """Whether a handler names an event or its kind, and not just any error."""
    names = (name for handler in holder.all(*HANDLERS) for name in handler_names(handler))
    return any("." in name and f"{event}.".startswith(f"{name}.") for name in names)
