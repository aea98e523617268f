"""Variables that a VoiceXML document uses and nothing declares: error.semantic when it gets there.

Where it cannot be told, a name is taken for declared: it counts in a whole dialog, wherever in it
it is declared, and in a whole document if outside of all dialogs.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from prima.errors import Place, Problem, did_you_mean
from prima.markup.tree import Node
from prima.script.globals import IDENTIFIER
from prima.script.known import Known, Scope
from prima.script.names import Names, expression_names, script_names
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


def _script(page: Page, node: Node, text: Text) -> Names:
    """The names in a script, which may stand in a file.

    Raises:
        Unknown: it cannot be read.
    """
    elsewhere = {"src", "srcexpr"} & node.attributes.keys()
    code = text(page, node) if elsewhere else node.own_text
    if code is None:
        raise Unknown
    found = script_names(code)
    if found.opaque:
        raise Unknown
    return found


def _declared(page: Page, top: Node, text: Text) -> Scope:
    """The names that an element and all that it holds declare."""
    found = Scope()
    for node in top.walk():
        if node.key == "script":
            names = _script(page, node, text)
            found |= names.declared | names.written
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
        elif node.key == "script" and not {"src", "srcexpr"} & node.attributes.keys():
            yield from _in_script(node, known)


def _in_code(node: Node, attribute: str, known: Known) -> Iterator[Problem]:
    for name, start in expression_names(node.get(attribute)).free.items():
        if name not in ALWAYS and name not in known:
            place = node.source.inside(node.index, attribute, start)
            yield _undeclared(place, name, known)


def _in_script(node: Node, known: Known) -> Iterator[Problem]:
    """What a script in the document reads that nothing declares: also in functions."""
    code = node.own_text
    for name, start in script_names(code).free.items():
        if name not in ALWAYS and name not in known:
            place = node.source.inside(node.index, "", start)
            yield _undeclared(place, name, known)


def _listed(node: Node, attribute: str, known: Known) -> Iterator[Problem]:
    for whole in LISTED.finditer(node.get(attribute)):
        head = whole[0].partition(".")[0]
        if IDENTIFIER.fullmatch(head) and head not in ALWAYS and head not in known:
            place = node.source.inside(node.index, attribute, whole.start())
            yield _undeclared(place, head, known)


def _undeclared(place: Place, name: str, known: Known) -> Problem:
    message = f'The variable "{name}" is not declared: this will be error.semantic.'
    remedy = did_you_mean(name, known.written()) or f'Declare it: <var name="{name}"/>.'
    return Problem(place, "warning", "undeclared-variable", message, remedy)
