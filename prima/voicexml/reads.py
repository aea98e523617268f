"""The variables that elements of a VoiceXML document read, or change by their names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from prima.errors import Place
from prima.markup.tree import Node
from prima.script.globals import IDENTIFIER
from prima.script.names import Names, expression_names, script_names
from prima.script.slips import is_bare
from prima.script.walk import OBJECTS
from prima.voicexml.checks import is_code

LISTING = frozenset(["submit", "clear", "return", "exit", "subdialog", "disconnect", "data"])
"""Elements whose namelist names variables."""
FILES = ("src", "srcexpr")
"""Attributes of an external script."""
LISTED = re.compile(r"\S+")
"""A name in a list of names."""


class Read(NamedTuple):
    """A variable that a piece of code reads."""

    name: str
    node: Node
    attribute: str
    start: int
    at_once: bool = True
    """Whether it is read as soon as the code is evaluated."""

    @property
    def place(self) -> Place:
        """Where it is written."""
        return self.node.source.inside(self.node.index, self.attribute, self.start)

    @property
    def bare(self) -> bool:
        """Whether it may have been meant as a text."""
        code = self.node.get(self.attribute)
        said = self.node.tag == "value" and code.strip() == self.name
        return (
            is_code(self.node, self.attribute) and not said and is_bare(code, self.name, self.start)
        )


def reads(node: Node) -> Iterator[Read]:
    """The variables that an element reads, or changes by their names."""
    for attribute, names in _sound(node):
        for name, start in names.free.items():
            at_once = name in names.now
            yield Read(name, node, attribute, names.now.get(name, start), at_once)
    if node.key == "assign":
        yield from _listed(node, "name")
    elif node.key in LISTING:
        yield from _listed(node, "namelist")


def _sound(node: Node) -> Iterator[tuple[str, Names]]:
    """The code of an element without faults, with its attributes (none for a script).

    Code with faults is most likely a text, whose words are not variables.
    """
    for attribute, code in node.attributes.items():
        if is_code(node, attribute) and (names := expression_names(code)).sound:
            yield attribute, names
    if node.key == "script" and node.attributes.keys().isdisjoint(FILES):
        names = script_names(node.own_text)
        if names.sound:
            yield "", names


def _listed(node: Node, attribute: str) -> Iterator[Read]:
    for whole in LISTED.finditer(node.get(attribute)):
        head = whole[0].partition(".")[0]
        if IDENTIFIER.fullmatch(head):
            yield Read(head, node, attribute, whole.start())


def scope_members(node: Node) -> Iterator[Read]:
    """Members of scopes, such as ``document.x``, that must exist."""
    for attribute, names in _sound(node):
        for use in names.uses:
            if use.parted:
                start = use.start - len(use.holder) - 1
                yield Read(f"{use.holder}.{use.name}", node, attribute, start)
    changed = {"assign": "name", "clear": "namelist"}.get(node.key, "")
    for whole in LISTED.finditer(node.get(changed)):
        holder, _, rest = whole[0].partition(".")
        name = rest.partition(".")[0]
        if holder in OBJECTS and IDENTIFIER.fullmatch(name):
            yield Read(f"{holder}.{name}", node, changed, whole.start())
