"""Values of a scenario by their paths, as ``when[2].after`` or ``person.speed``.

A path leads from the root element down. Each step is the name of a child element, with its
number among those of that name (``when[2]``) or its own name (``service[message-server]``)
where there are several; a first step may be an element's ``id``. The last one may be an
attribute; without one the path means the element's own value, as in OWN.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from prima.errors import UsageError, did_you_mean, one_of
from prima.language.values import DRAWABLE
from prima.markup.edits import TextEdit, set_attribute, set_text
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute
from prima.sim.vocabulary import SCENARIO

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
}
"""The attribute that is an element's own value; its text where it is empty.

Of a ``when`` it is ``after``, or ``at`` where that is its trigger.
"""
LOADED = frozenset({"scenario", "person", "application", "service", "reply"})
"""Elements of which some attributes name files, or what runs."""
LIGHT = frozenset(
    {
        *("until", "date", "policy", "patience", "seed", "id", "title"),
        *("at", "x", "y", "speed", "after", "start", "reason", "status"),
    }
)
"""Attributes of these elements that do neither."""
MOST_TOLD = 12
"""Names that a message lists."""


class ScenarioValue(NamedTuple):
    """A value of a scenario: an attribute of an element, or its text."""

    path: str
    node: Node
    attribute: Attribute | None
    """None for its text."""

    @property
    def kind(self) -> str:
        """The kind of its values (see :mod:`prima.language.values`): also of those that are drawn."""
        kind = self.attribute.kind if self.attribute else "text"
        return DRAWABLE.get(kind, kind)

    @property
    def written(self) -> str:
        """The value in the scenario, or the attribute's default."""
        if self.attribute is None:
            return self.node.text
        return self.node.attributes.get(self.attribute.name, self.attribute.default)

    @property
    def loads(self) -> bool:
        """Whether another value may mean that other files are read, or other applications run."""
        return self.node.tag in LOADED and (
            self.attribute is None or self.attribute.name not in LIGHT
        )

    def edit(self, value: str) -> TextEdit:
        """Give it a value; an empty one takes the attribute, or the element of a text, away."""
        if self.attribute is None:
            return set_text(self.node, value)
        return set_attribute(self.node, self.attribute.name, value)


def find(root: Node, path: str) -> ScenarioValue:
    """The value that a path means in a scenario.

    Raises:
        UsageError: the path is malformed, or leads to nothing, or to several elements.
    """
    return _Search(root, path).found()


class _Search:
    """The search for one path."""

    def __init__(self, root: Node, path: str) -> None:
        self.root = root
        self.path = path
        if WHOLE.fullmatch(path) is None:
            raise self.wrong("Write it as when[2].after or person.speed.")
        self.steps = [(one["name"], one["which"]) for one in STEP.finditer(path)]

    def wrong(self, why: str) -> UsageError:
        return UsageError(f'"{self.path}" is no value of the scenario. {why}'.rstrip())

    def found(self) -> ScenarioValue:
        node = self.root
        for index, (name, which) in enumerate(self.steps):
            last = which is None and index == len(self.steps) - 1
            attribute = _attribute(node, name) if last else None
            if attribute is not None and not (index == 0 and self.named(name)):
                return ScenarioValue(self.path, node, attribute)
            node = self.below(node, name, which, index == 0)
        return self.own(node)

    def named(self, name: str) -> Node | None:
        """The element with an id."""
        everything = iter(self.root.walk())
        next(everything)  # its own id names the scenario
        return next((one for one in everything if one.get("id") == name), None)

    def below(self, node: Node, name: str, which: str | None, first: bool) -> Node:
        """The child that a step means."""
        called = self.named(name) if first and which is None else None
        if called is not None:
            return called
        there = node.all(name)
        if not there:
            raise self.wrong(self.nothing(node, name, first))
        if which is None:
            if len(there) > 1:
                ways = f"{name}[1] to {name}[{len(there)}]"
                raise self.wrong(f"There are {len(there)} <{name}>: write {ways}, or an id.")
            return there[0]
        if which.isascii() and which.isdigit():
            if not 1 <= int(which[:9]) <= len(there):
                there_are = "There is one" if len(there) == 1 else f"There are {len(there)}"
                raise self.wrong(f"{there_are} <{name}>.")
            return there[int(which) - 1]
        for one in there:
            if which in (one.get("id"), one.get("name"), one.get("to"), one.get("src")):
                return one
        raise self.wrong(f'No <{name}> has the name "{which}".')

    def nothing(self, node: Node, name: str, first: bool) -> str:
        element = SCENARIO.elements[node.key]
        names = {one.name for one in element.attributes} | {one.tag for one in node.nodes}
        if first:
            names |= {one.get("id") for one in self.root.walk() if "id" in one.attributes}
        names -= {"version", ""}
        hint = did_you_mean(name, names) or f"There are {one_of(sorted(names)[:MOST_TOLD])}."
        return hint if names else f"<{node.tag}> has no attributes."

    def own(self, node: Node) -> ScenarioValue:
        """An element's own value."""
        own = OWN.get(node.tag)
        if node.tag == "when":
            own = "at" if "at" in node.attributes else "after"
        if own == "":
            return ScenarioValue(self.path, node, None)
        attribute = _attribute(node, own or "")
        if attribute is None:
            names = [one.name for one in SCENARIO.elements[node.key].attributes]
            ways = one_of([f"{self.path}.{name}" for name in names][:MOST_TOLD])
            raise self.wrong(f"<{node.tag}> has no value of its own: write {ways}.")
        return ScenarioValue(self.path, node, attribute)


def _attribute(node: Node, name: str) -> Attribute | None:
    element = SCENARIO.elements[node.key]
    return next((one for one in element.attributes if one.name == name), None)
