"""Conditions that assign, or that compare a field with what no answer gives it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice

from prima.errors import Problem
from prima.markup.tree import Node
from prima.script.conditions import At, Compared, assigning, compared, may_equal, never_equal
from prima.voicexml.arranging import items_in

BOOLEAN = re.compile(r"(builtin:(grammar|dtmf)/)?boolean(\?.*)?", re.DOTALL)
"""A type, or a URI, of answers that are true or false (P)."""
NAME = re.compile(r"[\w$]+")
MOST_CHECKED = 100
"""Maximum number of comparisons checked."""

Answers = dict[str, set[str] | None]
"""The values that answers give to fields, by name; None for a boolean field."""
Found = tuple[Node, Compared, set[str] | None]
"""A comparison with a text that no answer gives, its element, and what answers give."""


def check_conditions(root: Node) -> Iterator[Problem]:
    """Warn of conditions that do not ask what they seem to ask."""
    for node in root.walk():
        if cond := node.get("cond"):
            yield from assigning(cond, _places(node))
    for node, found, values in islice(_never_equal(root), MOST_CHECKED):
        yield never_equal(found, _places(node), values)


def _places(node: Node) -> At:
    """The places of the characters of an element's condition."""
    return lambda start: node.source.inside(node.index, "cond", start)


def _never_equal(root: Node) -> Iterator[Found]:
    """Comparisons of a form's fields with texts that no answer gives them."""
    changed = _changed(root)
    for form in root.all("form"):
        if answers := _answers(form, changed):
            yield from _among(form, answers)


def _among(form: Node, answers: Answers) -> Iterator[Found]:
    for node in form.walk():
        for one in compared(node.get("cond")):
            values = answers.get(one.name, {one.text})
            if not may_equal(one.text, values or ()):
                yield node, one, values


def _answers(form: Node, changed: set[str]) -> Answers:
    """What answers give to the fields of a form whose values are known.

    A grammar of the form itself may give any of them any value, and so may a script in a file.
    """
    if form.all("grammar") or any(one.get("src") or one.get("srcexpr") for one in _scripts(form)):
        return {}
    fields = (one for one in items_in(form) if one.tag == "field" and not one.get("expr"))
    known = ((one.get("name"), _values(one)) for one in fields if one.get("name") not in changed)
    return {name: values for name, values in known if values != set()}


def _values(field: Node) -> set[str] | None:
    """The values of a field's options: None if it is boolean, an empty set if they are unknown."""
    options, grammars = field.all("option"), field.all("grammar")
    kinds = [field.get("type")] if "type" in field.attributes else []
    kinds += [one.get("src") for one in grammars]
    if kinds and not options and all(map(BOOLEAN.fullmatch, kinds)):
        return None
    if kinds or grammars:
        return set()
    return {one.get("value") or " ".join(one.text.split()) for one in options}


def _changed(root: Node) -> set[str]:
    """Names that something besides answers gives a value, or that other variables have."""
    names = {one.get("name").rpartition(".")[2] for one in root.walk() if one.key == "assign"}
    names |= {one.get("name") for one in root.walk() if one.key in ("var", "data")}
    names |= {one.get("item") for one in root.walk() if one.tag == "foreach"}
    return names.union(*(NAME.findall(one.own_text) for one in _scripts(root)))


def _scripts(node: Node) -> list[Node]:
    return [one for one in node.walk() if one.key == "script"]
