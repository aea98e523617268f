"""Constraints between single elements of VoiceXML and their children."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from itertools import pairwise

from prima.errors import Problem, suggestion
from prima.errors.diagnoses.names import NO_SUCH_ITEM
from prima.errors.diagnoses.structure import AFTER_ELSE, DUPLICATE_NAME, UNKNOWN_ATTRIBUTE
from prima.errors.diagnoses.values import EXCLUSIVE
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.voicexml.arranging import items_in
from prima.voicexml.checks.attributes import missing
from prima.voicexml.elements import INPUTS

NUMBERED = EXCLUSIVE.says(
    "This menu numbers its choices itself: a choice may add *, # or 0 alone.",
    "Remove this dtmf, or that of the <menu>.",
)
OF_ITEM = UNKNOWN_ATTRIBUTE.says(
    '<{tag}> in <{item}> has no "{name}": it belongs to this <{item}>.', "Remove it."
)
TWO_ITEMS = DUPLICATE_NAME.says('Two items of the form have the name "{name}".', "Rename one.")
NO_INPUT_ITEM = NO_SUCH_ITEM.says(
    'The form has no input item "{name}".', "Name an input item of this form."
)
BEHIND_ELSE = AFTER_ELSE.says("<{tag}> comes after <else>.", "Put the <else> last.")


def _check_menu(menu: Node) -> Iterator[Problem]:
    for choice in menu.all("choice") if menu.get("dtmf") == "true" else ():
        if choice.get("dtmf") and choice.get("dtmf") not in ("*", "#", "0"):
            yield NUMBERED.at(choice.attribute_place("dtmf"))


def _check_item(item: Node) -> Iterator[Problem]:
    for child in item.all("filled", "grammar"):
        for name in ("mode", "namelist") if child.tag == "filled" else ("scope",):
            if name in child.attributes:
                place = child.attribute_place(name, value=False)
                yield OF_ITEM.at(place, tag=child.tag, item=item.tag, name=name)


def _check_form(form: Node) -> Iterator[Problem]:
    named = [node for node in items_in(form) if node.get("name")]
    yield from _check_names(named)
    yield from _check_filled(form, {node.get("name") for node in named if node.tag in INPUTS})


def _check_names(items: list[Node]) -> Iterator[Problem]:
    counts = Counter(node.get("name") for node in items)
    for node in items:
        name = node.get("name")
        if counts[name] > 1:
            counts[name] = 0
            yield TWO_ITEMS.at(node.attribute_place("name"), name=name)


def _check_filled(form: Node, inputs: set[str]) -> Iterator[Problem]:
    for filled in form.all("filled"):
        for name in filled.get("namelist").split():
            if name not in inputs:
                hint = suggestion(name, inputs, *value_span(filled, "namelist", name))
                yield NO_INPUT_ITEM.at(filled.attribute_place("namelist"), hint, name=name)


def _check_if(node: Node) -> Iterator[Problem]:
    for before, branch in pairwise(node.all("else", "elseif")):
        if before.tag == "else":
            yield BEHIND_ELSE.at(branch.place, tag=branch.tag)


def _check_say_as(node: Node) -> Iterator[Problem]:
    """Check a ``say-as``; older documents write ``type`` (4.1.1)."""
    if not {"interpret-as", "type"} & node.attributes.keys():
        yield missing(node, "interpret-as")


RULES: dict[str, Callable[[Node], Iterator[Problem]]] = {
    "form": _check_form,
    "menu": _check_menu,
    "if": _check_if,
    "say-as": _check_say_as,
    **dict.fromkeys((*INPUTS, "choice", "link"), _check_item),
}
"""The checks of elements, by their keys."""
