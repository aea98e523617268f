"""Variables that a VoiceXML document uses and nothing declares: error.semantic when it gets there.

Where it cannot be told, a name is taken for declared: it counts in a whole dialog, wherever in it
it is declared, and in a whole document if outside of all dialogs.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from prima.errors import Problem, did_you_mean
from prima.markup.tree import Node
from prima.names import (
    IDENTIFIER,
    Known,
    Scope,
    assigned_names,
    declared_names,
    free_names,
    is_only_asked,
)
from prima.script.compiling import compiled
from prima.voicexml.check import NAMING, is_code
from prima.voicexml.document import Page

ALWAYS = frozenset(
    [
        *("session", "application", "document", "dialog", "lastresult$"),
        *("_event", "_message", "_prompt", "_dtmf", "event"),
    ]
)
"""What the platform declares (5.1.2, 5.1.4, 5.1.5, 5.2.2, 2.2.4)."""
LISTING = frozenset(["submit", "clear", "return", "exit", "subdialog"])
"""Elements whose namelist names variables."""
DIALOGS = ("form", "menu")
SETUP = ("var", "script", "data")
NOTHING = Scope()
LISTED = re.compile(r"\S+")
"""A name in a list of names."""

Text = Callable[[Page, Node], str | None]
"""Gives the text of a script in a file, if it can be had."""


class Unknown(Exception):
    """A script that cannot be read may declare anything."""


def check_variables(page: Page, root: Page | None, text: Text) -> list[Problem]:
    """Warnings of variables that nothing declares in a document and its application root."""
    if page.application and root is None:
        return []
    try:
        shared = [_outside(page, text), *([_outside(root, text)] if root is not None else [])]
        dialogs = {id(node): _declared(page, node, text) for node in page.dialogs.values()}
    except Unknown:
        return []
    problems: list[Problem] = []
    everywhere = Known(*shared, Scope(set().union(*dialogs.values())))
    outside = Known(*shared)
    for node in page.root.nodes:
        if node.tag in DIALOGS:
            problems += _used(node, Known(*shared, dialogs.get(id(node), NOTHING)))
        elif node.tag in SETUP:
            problems += _used(node, outside)
        elif dialogs:  # else handlers and links stand in the dialogs of other documents
            problems += _used(node, everywhere)
    return problems


def _outside(page: Page, text: Text) -> Scope:
    """What a document declares outside of its dialogs, and anywhere in handlers and links."""
    found = Scope()
    for node in page.root.nodes:
        if node.tag not in DIALOGS:
            found |= _declared(page, node, text)
    return found


def _declared(page: Page, top: Node, text: Text) -> Scope:
    """The names that an element and all that it holds declare."""
    found = Scope()
    for node in top.walk():
        if node.key == "script":
            code = text(page, node) if {"src", "srcexpr"} & node.attributes.keys() else None
            if code is None and ("src" in node.attributes or "srcexpr" in node.attributes):
                raise Unknown
            code = code or node.own_text
            found |= declared_names(code) | assigned_names(code) | set(free_names(code))
        if name := node.get(NAMING.get(node.key, "")):
            found |= {name, f"{name}$"}
    return found


def _used(top: Node, known: Known) -> Iterator[Problem]:
    for node in top.walk():
        for attribute in node.attributes:
            if is_code(node, attribute):
                yield from _in_code(node, attribute, known)
        if node.key == "assign":
            yield from _listed(node, "name", known)
        elif node.key in LISTING:
            yield from _listed(node, "namelist", known)


def _in_code(node: Node, attribute: str, known: Known) -> Iterator[Problem]:
    code = node.get(attribute)
    plain = compiled(code)
    for name, start in (free_names(code) if plain is None else plain.names).items():
        if name not in ALWAYS and name not in known and not is_only_asked(code, start):
            yield _undeclared(node, attribute, start, name, known)


def _listed(node: Node, attribute: str, known: Known) -> Iterator[Problem]:
    for whole in LISTED.finditer(node.get(attribute)):
        head = whole[0].partition(".")[0]
        if IDENTIFIER.fullmatch(head) and head not in ALWAYS and head not in known:
            yield _undeclared(node, attribute, whole.start(), head, known)


def _undeclared(node: Node, attribute: str, start: int, name: str, known: Known) -> Problem:
    message = f'The variable "{name}" is not declared: this will be error.semantic.'
    remedy = did_you_mean(name, known.written()) or f'Declare it: <var name="{name}"/>.'
    place = node.source.inside(node.index, attribute, start)
    return Problem(place, "warning", "undeclared-variable", message, remedy)
