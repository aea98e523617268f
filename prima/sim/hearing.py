"""What a scenario waits for and never comes, and what happens in it that nobody hears."""

from __future__ import annotations

from collections.abc import Iterator

from prima.errors import MANY_WORDS, Problem, did_you_mean
from prima.interpreter.elements import Document
from prima.interpreter.events import STANDARD, Events, beginnings, near
from prima.interpreter.surroundings import Sayings, Surroundings, check_surroundings
from prima.markup.tree import Node
from prima.sim.rehearsal import Cast

MOST = 500
"""So many triggers of a kind are looked at: each is compared with all that may be said."""


def check_hearing(cast: Cast) -> list[Problem]:
    """Warnings about a scenario together with its applications, world and robot."""
    world, robot = cast.world, cast.robot
    names = Surroundings(
        frozenset(world.places), frozenset(world.things), frozenset(robot.gestures), robot.touch
    )
    documents = [document for document in cast.documents if isinstance(document, Document)]
    problems = [one for document in documents for one in check_surroundings(document, names)]
    if len(documents) < len(cast.documents):
        return problems  # what a VoiceXML application says and hears is known only when it runs
    events = [Events(document) for document in documents]
    nodes = list(_nodes(cast.scenario.node))
    problems += _services(events, {service.name for service in cast.scenario.services})
    problems += _words(nodes, documents)
    return [*problems, *_unheard(nodes, events), *_triggers(nodes, events, cast)]


def _nodes(root: Node) -> Iterator[Node]:
    stack = [root]
    while stack:
        node = stack.pop()
        stack += reversed(node.nodes)
        yield node


def _words(nodes: list[Node], documents: list[Document]) -> Iterator[Problem]:
    """Triggers that wait for words which nobody says."""
    questions, sayings = Sayings(documents, True), Sayings(documents, False)
    for tag, name, asked in (
        ("answer", "to", True),
        ("when", "asked", True),
        ("when", "said", False),
    ):
        for node in [one for one in nodes if one.tag == tag][:MOST]:
            words = node.get(name)
            said = questions if asked else sayings
            if words.strip() and not said.may_hold(words):
                what = "asks" if asked else "says"
                message = f'No application {what} anything with "{words}".'
                remedy = did_you_mean(words, said.lines if len(said.lines) <= MANY_WORDS else ())
                if asked and not remedy and sayings.may_hold(words):
                    remedy = 'It is said, not asked: write said="...".' if tag == "when" else ""
                place = node.attribute_place(name)
                yield Problem(place, "warning", "never-said", message, remedy)


def _unheard(nodes: list[Node], events: list[Events]) -> Iterator[Problem]:
    """Events of the surroundings that no application and no trigger takes."""
    heard = {name for one in events for name in one.heard}
    heard |= {node.get("on") for node in nodes if node.tag == "when"} - {""}
    for node in [one for one in nodes if one.tag == "event"]:
        name = node.get("name")
        if heard.isdisjoint(beginnings(name)):
            message = f'No application handles the event "{name}".'
            nearest = near(name, heard)
            remedy = f'Did you mean "{nearest}"?' if nearest else "Remove it, or handle it."
            yield Problem(node.attribute_place("name"), "warning", "unheard-event", message, remedy)


def _triggers(nodes: list[Node], events: list[Events], cast: Cast) -> Iterator[Problem]:
    """Triggers that wait for an event whose name is most likely a slip."""
    known = set(STANDARD) | {f"touch.{sensor}" for sensor in cast.robot.touch}
    known |= {corner.event for corner in cast.world.corners}
    known |= {node.get("name") for node in nodes if node.tag == "event"}
    known |= {raised.name for one in events for raised in one.raised}
    begins = {name for one in known for name in beginnings(one)}
    for node in [one for one in nodes if one.tag == "when"][:MOST]:
        name = node.get("on")
        if not name or name in begins:
            continue
        nearest = near(name, known)
        if nearest:
            message, remedy = f'Nothing raises an event "{name}".', f'Did you mean "{nearest}"?'
            place = node.attribute_place("on")
            yield Problem(place, "warning", "unknown-event", message, remedy)


def _services(events: list[Events], names: set[str]) -> Iterator[Problem]:
    """Services that are asked and not there, where another one was most likely meant."""
    for one in events:
        for node, service in one.asked:
            nearest = near(service, names)
            if service not in names and nearest:
                message = f'The scenario has no service "{service}".'
                remedy = f'Did you mean "{nearest}"?'
                place = node.attribute_place("to")
                yield Problem(place, "warning", "no-such-name", message, remedy)
