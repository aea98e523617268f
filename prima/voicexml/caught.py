"""Events that VoiceXML documents throw and catch, and names that are most likely misspelt."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prima.errors import Problem, Span, meant
from prima.errors.diagnoses.names import UNKNOWN_EVENT
from prima.interpreter.events import MOST_GUESSES, STANDARD, event_place, slip_of
from prima.interpreter.selection import beginnings
from prima.markup.tree import Node

EVENTS = STANDARD | {
    *("exit", "maxspeechtimeout", "connection.disconnect.transfer", "error.connection.noroute"),
    *("error.connection.baddestination", "error.connection.busy", "error.connection.noresource"),
    *("error.connection.protocol", "error.noauthorization", "error.noresource"),
    *("error.connection.noauthorization", "error.unsupported.language"),
    *("error.unsupported.format", "error.unsupported.builtin", "error.unsupported.objectname"),
    *("error.unsupported.uri", "error.unsupported.transfer.blind", "error.badfetch.http"),
    *("error.unsupported.transfer.bridge", "error.unsupported.transfer.consultation"),
}
"""Events that no document need throw: VoiceXML's (2.0, 5.2.6; 2.1, 8) and PRIMA's."""
OPEN = ("touch.", "error.unsupported.", "error.badfetch.", "error.connection.protocol.")
"""Prefixes of events that continue with the name of a sensor, Command or code."""


def thrown_in(root: Node) -> Iterator[str]:
    """The events that a document throws itself, including by what the user says or chooses."""
    for node in root.walk():
        if node.tag in ("throw", "link", "choice", "return") and node.get("event"):
            yield node.get("event")


def caught_in(root: Node) -> Iterator[tuple[Node, str]]:
    """The events that handlers of a document name, each with its handler."""
    for node in root.walk():
        if node.tag == "catch":
            yield from ((node, name) for name in node.get("event").split())


NEVER_RAISED = UNKNOWN_EVENT.says('Nothing raises an event "{name}".')


def check_caught(root: Node, thrown: Iterable[str]) -> Iterator[Problem]:
    """Warn of handlers whose event is most likely misspelt: any other may be thrown elsewhere."""
    known = {*EVENTS, *thrown}
    begins = {"", *(name for one in known for name in beginnings(one))}
    strange = [one for one in caught_in(root) if one[1].rstrip(".") not in begins]
    for node, name in strange[:MOST_GUESSES]:
        other = "" if name.startswith(OPEN) else slip_of(name, known)
        if other:
            place = event_place(node, name)
            yield NEVER_RAISED.at(place, meant(other, Span.of(place, name)), name=name)
