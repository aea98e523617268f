"""Checks of a scenario with its applications, world and robot: what is never there or said."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from itertools import chain, product

from prima.devices.profile import Profile
from prima.errors import Hint, Place, Problem, Span, meant, suggestion
from prima.errors.diagnoses.names import UNSUPPORTED_COMMAND
from prima.interpreter.acts import type_of
from prima.interpreter.elements import Document
from prima.interpreter.events import STANDARD, KnownEvents, event_place, near
from prima.interpreter.selection import beginnings
from prima.interpreter.surroundings import (
    PLACED,
    Sayings,
    Surroundings,
    check_name,
    check_sensor,
    check_surroundings,
    nearest,
    texts_of,
)
from prima.language.commands import TABLE_4_2
from prima.language.values import read_value
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.session import AnyDocument
from prima.sim.asked import check_replies, check_services
from prima.sim.awaited import MOST, OPEN, awaited, check_awaited, raised
from prima.sim.devices import Cast
from prima.sim.expected import COMMANDS, check_values
from prima.sim.map import Map
from prima.sim.sensed import check_sensors
from prima.sim.world import room_beside
from prima.voicexml.arranging import arguments_of
from prima.voicexml.caught import caught_in, thrown_in
from prima.voicexml.pages import Pages, pages_of, spoken_in
from prima.voicexml.vocabulary import PRIMA_NAMESPACE

WORDS = (
    ("answer", "to", True),
    ("when", "asked", True),
    ("when", "said", False),
    ("never", "says", False),
    *((tag, name, name == "asked") for tag in ("expect", "never") for name in ("asked", "said")),
)
"""An attribute that names words: the tag, the attribute, and whether they are asked, not said."""

TIMES = {"when": "at", "expect": "at", "never": "at", "application": "start"}
"""The attributes with the time at which an element comes."""

CANNOT = UNSUPPORTED_COMMAND.says(
    "This robot cannot do {command}: it lacks {lacks}. This never happens.",
    "Name another Command, or a robot that can do it.",
)


def check_hearing(cast: Cast) -> list[Problem]:
    """Warnings about a scenario together with its applications, world and robot."""
    world, documents = cast.world, cast.documents
    voices = [pages_of(one) for one in documents if not isinstance(one, Document)]
    pages = [page.root for one in voices for page in one]
    events = [KnownEvents(one) for one in documents if isinstance(one, Document)]
    nodes = list(cast.scenario.node.walk())
    problems = [*_not_there(cast, voices), *_late(nodes, cast.scenario.until)]
    problems += [*_outside(nodes, world), *_nobody(nodes), *_unable(nodes, cast.robot)]
    problems += [*check_values(cast.scenario, cast.robot), *check_sensors(nodes, documents)]
    if world.plan is not None:
        problems += world.plan.narrow(room_beside(cast.robot), cast.robot.radius)
    corners = [*_corners(nodes, events, pages, world)]
    problems += [*corners, *_words(nodes, documents, voices)]
    problems += [*check_services(cast, events, voices), *check_replies(cast, pages)]
    if pages:
        return problems  # what a VoiceXML application accepts is known only at run time
    places = {one.place for one in corners}
    triggers = [one for one in check_awaited(nodes, events, cast) if one.place not in places]
    return [*problems, *_unheard(nodes, events), *triggers]


def _not_there(cast: Cast, voices: list[Pages]) -> Iterator[Problem]:
    """Names in documents that neither the world nor the robot has."""
    world, robot = cast.world, cast.robot
    names = Surroundings(
        *(frozenset(world.places), frozenset(robot.gestures)),
        *(robot.touch, frozenset(robot.voices), frozenset({*world.places, *world.things})),
    )
    for document in cast.documents:
        if isinstance(document, Document):
            yield from check_surroundings(document, names)
    for pages in voices:
        for page in pages:
            yield from _in_voicexml(page.root, names, pages.thrown)


def _corners(
    nodes: list[Node], events: list[KnownEvents], pages: list[Node], world: Map
) -> Iterator[Problem]:
    """A corner's event that is waited for but that no corner of the world raises: likely a typo."""
    corners = {corner.event for corner in world.corners} - {"corner"}
    known = {*STANDARD, *corners, *raised(nodes, events)}
    known.update(*(thrown_in(root) for root in pages))
    begins = {name for one in known for name in beginnings(one)}
    for place, name in _waiting(nodes, events, pages):
        if name not in begins:
            yield from _no_corner(place, name, corners)


def _no_corner(place: Place, name: str, corners: set[str]) -> Iterator[Problem]:
    """An event that nothing raises, if a corner's event was probably meant."""
    other = "" if name.startswith(OPEN) else near(name, corners)
    if other or name.startswith("corner."):
        message = f'No corner of the world raises the event "{name}".'
        span = Span.of(place, name)
        hint = meant(other, span) or nearest(name, corners, span)
        remedy = hint or "Write corner, or name the corner's event in the world."
        yield Problem(place, "warning", "unknown-event", message, remedy)


def _waiting(
    nodes: list[Node], events: list[KnownEvents], pages: list[Node]
) -> Iterator[tuple[Place, str]]:
    """The events named by handlers, triggers and expectations, each with its place."""
    for handler in chain.from_iterable(one.handlers for one in events):
        for name in handler.events:
            yield event_place(handler.node, name), name
    for node, name in chain.from_iterable(caught_in(root) for root in pages):
        yield event_place(node, name), name
    for node, attribute, name in awaited(nodes):
        yield node.attribute_place(attribute), name


def _in_voicexml(root: Node, names: Surroundings, thrown: Container[str]) -> Iterator[Problem]:
    """Unknown names in a VoiceXML document: in PRIMA's Commands, and touch sensors."""
    commands = (one for one in root.walk() if one.namespace == PRIMA_NAMESPACE)
    for node in [one for one in commands if type_of(one) in TABLE_4_2]:
        row = TABLE_4_2[type_of(node)]
        for name, value in arguments_of(node, row).items():
            if name in PLACED.keys() & row.arguments.keys() and value is not None:
                yield from check_name(node, name, value, names)
    for node, event in caught_in(root):
        if event not in thrown:
            yield from check_sensor(node, event, names)


def _sayings(documents: list[AnyDocument], voices: list[Pages]) -> tuple[Sayings, Sayings] | None:
    """The applications' questions and sentences; None if known only at run time."""
    asked: list[Sequence[object]] = []
    said: list[Sequence[object]] = []
    for document in [one for one in documents if isinstance(one, Document)]:
        asked += texts_of(document, True)
        said += texts_of(document, False)
    for pages in voices:
        if pages.open:
            return None
        spoken = [text for page in pages for text in spoken_in(page)]
        asked += spoken
        said += spoken
    return Sayings(asked), Sayings(said)


def _words(
    nodes: list[Node], documents: list[AnyDocument], voices: list[Pages]
) -> Iterator[Problem]:
    """Triggers that wait for words that nobody says; forbidden words, if likely a typo."""
    named = [
        (node, name, asked)
        for tag, name, asked in WORDS
        for node in [one for one in nodes if one.tag == tag][:MOST]
        if node.get(name)
    ]
    if named and (sayings := _sayings(documents, voices)) is not None:
        for node, name, asked in named:
            yield from _never_said(node, name, asked, *sayings)


def _never_said(
    node: Node, name: str, asked: bool, questions: Sayings, sayings: Sayings
) -> Iterator[Problem]:
    """Words that no application asks or says; those known only at run time are not reported."""
    words, said = node.get(name), questions if asked else sayings
    if not words.strip() or said.may_hold(words):
        return
    remedy: str | Hint = suggestion(words, said.lines, *value_span(node, name))
    if not remedy and node.tag == "when" and asked and sayings.may_hold(words):
        remedy = 'It is said, not asked: write said="...".'
    if remedy or (name != "says" and said.certain):
        message = f'No application {"asks" if asked else "says"} anything with "{words}".'
        yield Problem(node.attribute_place(name), "warning", "never-said", message, remedy)


def _unheard(nodes: list[Node], events: list[KnownEvents]) -> Iterator[Problem]:
    """Events of the surroundings that no application and no trigger takes."""
    heard = {name for one in events for name in one.heard}
    heard |= {node.get("on") for node in nodes if node.tag == "when"} - {""}
    for node in [one for one in nodes if one.tag == "event"]:
        name = node.get("name")
        if heard.isdisjoint(beginnings(name)):
            message = f'No application handles the event "{name}".'
            near_one = meant(near(name, heard), *value_span(node, "name"))
            remedy = near_one or "Remove it, or handle it."
            yield Problem(node.attribute_place("name"), "warning", "unheard-event", message, remedy)


def _late(nodes: list[Node], until: int) -> Iterator[Problem]:
    """Elements with a time after the end (ms) of the run."""
    for node in nodes:
        name = TIMES.get(node.tag, "")
        at, after = node.get(name), node.get("after") if node.tag == "when" else ""
        if at in ("", "end"):
            continue
        times = [read_value("delay", one) for one in (at, after) if one]
        if sum(one for one in times if isinstance(one, int)) > until:  # others are random
            message = f"The run is over after {until / 1000:g} s (until): this never comes."
            remedy = "Write an earlier time, or a later until."
            place = node.attribute_place(name)
            yield Problem(place, "warning", "out-of-range", message, remedy)


def _outside(nodes: list[Node], world: Map) -> Iterator[Problem]:
    """Users who begin outside the walls (m) of a world whose places are all inside."""
    persons = [one for one in nodes if one.tag == "person" and {"x", "y"} <= one.attributes.keys()]
    for node, (name, least, most) in product(persons, _inside(world)):
        if not least <= float(read_value("number", node.get(name))) <= most:
            message = f'{name} "{node.get(name)}" is outside the walls of the world.'
            remedy = f"They are between {least:g} and {most:g}."
            place = node.attribute_place(name)
            yield Problem(place, "warning", "out-of-range", message, remedy)


def _inside(world: Map) -> list[tuple[str, float, float]]:
    """The bounds (m) of a world's walls in x and y; nothing if a place is outside them."""
    corners = [end for wall in world.walls for end in wall]
    if not corners:
        return []
    (left, right), (low, high) = ((min(side), max(side)) for side in zip(*corners, strict=True))
    around = all(left <= x <= right and low <= y <= high for x, y in world.places.values())
    return [("x", left, right), ("y", low, high)] if around else []


def _unable(nodes: list[Node], robot: Profile) -> Iterator[Problem]:
    """Commands that are waited for or expected, but that the robot cannot do."""
    lacking = {name: row for name, row in TABLE_4_2.items() if name not in robot.commands}
    for node in nodes if lacking else ():
        for attribute in COMMANDS if node.tag in ("when", "expect", "never") else ():
            if row := lacking.get(node.get(attribute)):
                lacks = ", ".join(sorted(row.devices - robot.devices))
                place = node.attribute_place(attribute)
                yield CANNOT.at(place, command=row.name, lacks=lacks)


def _nobody(nodes: list[Node]) -> Iterator[Problem]:
    """A user who moves where no person is anywhere; one who only speaks may be on the phone."""
    persons = [one.attributes for one in nodes if one.tag == "person"]
    if any("at" in one or "x" in one for one in persons):
        return
    lacks = ", as the <person> is nowhere" if persons else " without a <person>"
    for node in [one for one in nodes if one.tag in ("walk", "look", "follow")][:1]:
        message = f"Nobody is there: <{node.tag}> does nothing{lacks}."
        remedy = 'Write where they are at first, such as <person at="..."/>.'
        yield Problem(node.place, "warning", "missing-element", message, remedy)
