"""Values of a scenario by path, such as ``when[2].after`` or ``person.speed``.

A path leads from the root element down. Each step is the name of a child element, with its
number among those of that name (``when[2]``) or its own name (``service[message-server]``)
where there are several; a first step may be an element's ``id``. The last one may be an
attribute; without one the path denotes the element's own value, as in OWN.

A path that begins with ``robot`` and does not denote the scenario's own ``<robot>`` continues in
the document of the scenario's robot: ``robot.speed``, ``robot.gesture[nod]``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

from prima.devices.vocabulary.robot import ROBOT
from prima.errors import UsageError, did_you_mean, one_of
from prima.language.distributions import MEASURED
from prima.language.values import DRAWABLE
from prima.markup.edits import TextEdit, set_attribute, set_text
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute, Vocabulary
from prima.sim.vocabulary.scenario import SCENARIO

STEP = re.compile(r"(?P<name>[^\[\].]+)(?:\[(?P<which>[^\]]*)\])?")
WHOLE = re.compile(r"[^\[\].]+(\[[^\]]*\])?(\.[^\[\].]+(\[[^\]]*\])?)*")
OWN = {
    **dict.fromkeys(("answer", "say", "message", "note", "alternative"), ""),
    **dict.fromkeys(("robot", "person", "look"), "at"),
    **dict.fromkeys(("walk", "transfer"), "to"),
    **dict.fromkeys(("fail", "repair"), "device"),
    **dict.fromkeys(("reply", "failure"), "after"),
    **dict.fromkeys(("sensor", "data"), "value"),
    **dict.fromkeys(("load", "unload"), "application"),
    "application": "src",
    "touch": "sensor",
    "wait": "for",
    "follow": "distance",
    "event": "name",
    "release": "resume",
    **dict.fromkeys(("gesture", "adds"), "duration"),
    "voice": "rate",
}
"""The attribute that is an element's own value; if empty, its text is.

Of a ``when`` it is ``after``, or ``at`` where that is its trigger.
"""
NAMES = ("id", "name", "to", "src", "lang", "sensor", "command")
"""Attributes by whose values a step may choose among elements of one name."""
LOADED = frozenset({"scenario", "person", "application", "service", "reply"})
"""Elements with attributes that name files or applications."""
LIGHT = frozenset(
    {
        *("until", "date", "policy", "patience", "seed", "id", "title"),
        *("at", "x", "y", "speed", "after", "start", "reason", "status"),
    }
)
"""Attributes of these elements that name neither."""
OF_USERS = frozenset({("answer", "after"), ("answer", "chance"), ("person", "speed")})
"""Elements with attributes that the person's user determines where nothing is written."""
MOST_TOLD = 12
"""The number of names that a message lists."""


class ScenarioValue(NamedTuple):
    """A value of a scenario, or of its robot's document: an attribute, or an element's text."""

    path: str
    node: Node
    attribute: Attribute | None
    """None for its text."""
    of_robot: bool = False
    """Whether it is in the robot's document."""

    @property
    def kind(self) -> str:
        """The kind of its values (see :mod:`prima.language.values`), including random ones."""
        kind = self.attribute.kind if self.attribute else "text"
        return DRAWABLE.get(kind, kind)

    @property
    def written(self) -> str:
        """The value in its document, or the attribute's default."""
        if self.attribute is None:
            return self.node.text
        return self.node.attributes.get(self.attribute.name, self.attribute.default)

    @property
    def as_it_is(self) -> str:
        """The level that changes nothing; empty where a user may determine the value."""
        if self.attribute is None or self.attribute.name in self.node.attributes:
            return self.written
        return "" if (self.node.tag, self.attribute.name) in OF_USERS else self.written

    @property
    def loads(self) -> bool:
        """Whether another value may cause other files to be read, or other applications to run."""
        if self.of_robot or self.node.tag not in LOADED:
            return False
        return self.attribute is None or self.attribute.name not in LIGHT

    def edit(self, value: str) -> TextEdit:
        """Give it a value; an empty one removes the attribute, or the element of a text."""
        if self.attribute is None:
            return set_text(self.node, value)
        return set_attribute(self.node, self.attribute.name, value)


def find(root: Node, path: str, robot: Callable[[], Node]) -> ScenarioValue:
    """The value that a path denotes in a scenario.

    ``robot`` returns the document of its robot, if the path leads there.

    Raises:
        DocumentError: the robot's document has errors.
        UsageError: the path is malformed, or leads to nothing, to several elements, or to
            something that only another document of the robot can change.
    """
    steps = _steps(path)
    if not _leads_to_robot(root, steps):
        return _Search(root, path, SCENARIO).found(steps)
    search = _Search(robot(), path, ROBOT)
    found = search.found(steps[1:])._replace(of_robot=True)
    if found.kind not in MEASURED:
        message = f'"{path}" is neither a number nor a time.'
        raise UsageError(f"{message} Vary the robot's document: --vary robot=ONE.xml|OTHER.xml.")
    return found


_Step = tuple[str, str | None]
"""A name, and which of several elements it selects."""


def _steps(path: str) -> list[_Step]:
    if WHOLE.fullmatch(path) is None:
        why = "Write it as when[2].after or person.speed."
        raise UsageError(f'"{path}" is not a value of the scenario. {why}')
    return [(one["name"], one["which"]) for one in STEP.finditer(path)]


def _leads_to_robot(root: Node, steps: list[_Step]) -> bool:
    """Whether a path leads into the robot's document: the scenario lacks its second step."""
    if steps[0] != ("robot", None) or len(steps) == 1 or _named(root, "robot"):
        return False
    return steps[1][0] not in {one.name for one in SCENARIO.elements["robot"].attributes}


def _named(root: Node, name: str) -> Node | None:
    """The element with an id."""
    everything = iter(root.walk())
    next(everything)  # the root's id names the document
    return next((one for one in everything if one.get("id") == name), None)


class _Search:
    """The search for one path in a document."""

    def __init__(self, root: Node, path: str, vocabulary: Vocabulary) -> None:
        self.root = root
        self.path = path
        self.vocabulary = vocabulary

    def wrong(self, why: str) -> UsageError:
        where = "the scenario" if self.vocabulary is SCENARIO else self.root.place.file
        return UsageError(f'"{self.path}" is not a value of {where}. {why}'.rstrip())

    def found(self, steps: list[_Step]) -> ScenarioValue:
        """The value to which steps lead."""
        node = self.root
        for index, (name, which) in enumerate(steps):
            last = which is None and index == len(steps) - 1
            attribute = self.attribute(node, name) if last else None
            if attribute is not None and not (index == 0 and _named(self.root, name)):
                return ScenarioValue(self.path, node, attribute)
            node = self.below(node, name, which, index == 0)
        return self.own(node)

    def attribute(self, node: Node, name: str) -> Attribute | None:
        """An attribute that an element may have."""
        element = self.vocabulary.elements[node.key]
        return next((one for one in element.attributes if one.name == name), None)

    def below(self, node: Node, name: str, which: str | None, first: bool) -> Node:
        """The child that a step denotes."""
        called = _named(self.root, name) if first and which is None else None
        if called is not None:
            return called
        there = node.all(name)
        if not there:
            raise self.wrong(self.nothing(node, name, first))
        if which is None:
            return self.single(there, name)
        if which.isascii() and which.isdigit():
            return self.numbered(there, name, which)
        return self.named(there, name, which)

    def named(self, there: list[Node], name: str, which: str) -> Node:
        """The one of several elements that has a name."""
        for one in there:
            if which in (one.get(key) for key in NAMES):
                return one
        names = {one.get(key) for one in there for key in NAMES} - {""}
        hint = did_you_mean(which, names) or (f"Write {one_of(names, MOST_TOLD)}." if names else "")
        raise self.wrong(f'No <{name}> has the name "{which}". {hint}')

    def single(self, there: list[Node], name: str) -> Node:
        if len(there) > 1:
            ways = f"{name}[1] to {name}[{len(there)}]"
            raise self.wrong(f"There are {len(there)} <{name}>: write {ways}, or an id.")
        return there[0]

    def numbered(self, there: list[Node], name: str, which: str) -> Node:
        if not 1 <= int(which[:9]) <= len(there):
            there_are = "There is one" if len(there) == 1 else f"There are {len(there)}"
            raise self.wrong(f"{there_are} <{name}>.")
        return there[int(which) - 1]

    def nothing(self, node: Node, name: str, first: bool) -> str:
        element = self.vocabulary.elements[node.key]
        names = {one.name for one in element.attributes} | {one.tag for one in node.nodes}
        if first:
            names |= {one.get("id") for one in self.root.walk() if "id" in one.attributes}
        names -= {"version", ""}
        hint = did_you_mean(name, names) or f"There are {one_of(names, MOST_TOLD)}."
        return hint if names else f"<{node.tag}> has no attributes."

    def own(self, node: Node) -> ScenarioValue:
        """An element's own value."""
        own = OWN.get(node.tag)
        if node.tag == "when":
            own = "at" if "at" in node.attributes else "after"
        if own == "":
            if node.nodes:
                inside = node.nodes[0].tag
                why = f"It holds <{inside}> beside its text: remove that, or vary"
                raise self.wrong(f"{why} {self.path}.{inside}.")
            return ScenarioValue(self.path, node, None)
        attribute = self.attribute(node, own or "")
        if attribute is None:
            names = [one.name for one in self.vocabulary.elements[node.key].attributes]
            ways = one_of((f"{self.path}.{name}" for name in names), MOST_TOLD)
            raise self.wrong(f"<{node.tag}> has no value of its own: write {ways}.")
        return ScenarioValue(self.path, node, attribute)
