"""Checks the names of services that applications ask, and of what their replies bring."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from prima.errors import Problem, Span, meant, one_of
from prima.errors.diagnoses.names import NO_SUCH_NAME, UNDECLARED_VARIABLE
from prima.interpreter.checks.variables import FIELD
from prima.interpreter.elements import Document
from prima.interpreter.events import KnownEvents, near
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.messages import SERVICE
from prima.sim.devices import Cast
from prima.voicexml.pages import Pages

NAMING = ("next", "src")
"""Attributes of VoiceXML elements that name a service by ``service:NAME``."""

DATA = re.compile(rf"\bevent\s*\??\.\s*{FIELD.pattern}")
REPLY = "reply."

NO_SERVICE = NO_SUCH_NAME.says('The scenario has no service "{name}".', severity="warning")
OF_OTHERS = NO_SUCH_NAME.says(
    'The scenario has the service "{name}" for {others} alone.',
    'In the scenario, write a <service name="{name}"> for this application.',
    "warning",
)
NOT_IN_REPLY = UNDECLARED_VARIABLE.says(
    'No reply of "{service}" in the scenario has "{name}".', severity="warning"
)


def check_replies(cast: Cast, pages: Sequence[Node]) -> Iterator[Problem]:
    """Data that handlers read of a reply, if other data was most likely meant.

    ``pages`` are the root elements of all documents of VoiceXML.
    """
    brought: dict[str, set[str]] = {}
    for one in cast.scenario.services:
        brought.setdefault(one.name, set()).update(*(reply.data for reply in one.replies))
    natives = [one.node for one in cast.documents if isinstance(one, Document)]
    for root in (*natives, *pages):
        for handler in root.walk():
            name = handler.get("event")
            service = name.removeprefix(REPLY)
            if handler.tag in ("on", "catch") and name.startswith(REPLY) and service in brought:
                yield from _misread(handler, service, brought[service])


def _misread(handler: Node, service: str, brought: set[str]) -> Iterator[Problem]:
    """The names that a handler misspells of what a service's replies bring."""
    codes = [(node, name) for node in handler.walk() for name in node.attributes]
    for node, attribute in codes:
        for found in DATA.finditer(node.get(attribute)):
            name = found[1]
            if name not in brought and (other := near(name, brought)):
                place = node.source.inside(node.index, attribute, found.start(1))
                hint = meant(other, Span.of(place, name))
                yield NOT_IN_REPLY.at(place, hint, service=service, name=name)


def check_services(
    cast: Cast, events: Sequence[KnownEvents], voices: Sequence[Pages]
) -> Iterator[Problem]:
    """Services that do not exist, if another was meant, or that are another application's.

    ``events`` has an entry for each document of PRIMA's own language, ``voices`` for each
    application in VoiceXML.
    """
    owners: dict[str, set[str]] = {}
    for service in cast.scenario.services:
        owners.setdefault(service.name, set()).add(service.application)
    for owner, node, attribute, name in _asks(cast, events, voices):
        place = node.attribute_place(attribute)
        if name in owners and owners[name].isdisjoint(("", owner)):
            yield OF_OTHERS.at(place, name=name, others=one_of(sorted(owners[name])))
        elif name not in owners and (other := near(name, owners)):
            hint = meant(other, *value_span(node, attribute, name))
            yield NO_SERVICE.at(place, hint, name=name)


def _asks(
    cast: Cast, events: Sequence[KnownEvents], voices: Sequence[Pages]
) -> Iterator[tuple[str, Node, str, str]]:
    """Who asks a service: the application and its element, the attribute and the name in it."""
    natives, others = iter(events), iter(voices)
    for document in cast.documents:
        if isinstance(document, Document):
            yield from ((document.id, node, "to", name) for node, name in next(natives).asked)
        else:
            asking = [one for page in next(others) for one in _by_uri(page.root)]
            yield from ((document.id, *one) for one in asking)


def _by_uri(root: Node) -> Iterator[tuple[Node, str, str]]:
    """The elements of a VoiceXML document that name a service."""
    for node in root.walk():
        for attribute in NAMING:
            uri = node.get(attribute).strip()
            if uri.startswith(SERVICE):
                yield node, attribute, uri.removeprefix(SERVICE).partition("#")[0]
