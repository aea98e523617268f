"""The languages as editors need them: the elements and attributes allowed at a place."""

from __future__ import annotations

from dataclasses import dataclass

from prima.devices.vocabulary.robot import ROBOT
from prima.devices.vocabulary.services import SERVICES
from prima.grammar.builtin import TYPES
from prima.grammar.vocabulary import GRAMMAR
from prima.interpreter.units import ARRANGING
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.lsp.scan import ScannedTag, ScannedText
from prima.markup.vocabulary import Element, Vocabulary, attributes_by_name
from prima.scheduler.policy import BASELINES
from prima.sim.vocabulary.scenario import SCENARIO
from prima.sim.vocabulary.user import USER
from prima.sim.vocabulary.world import WORLD
from prima.voicexml.arranging import UNIT, UNIT_HOLDS
from prima.voicexml.vocabulary import (
    COMMANDS,
    EXPRESSIONS,
    HOLDING,
    PROPERTY_NAMES,
    VOICEXML,
    kind_of,
)

LISTED: dict[tuple[str, str, str], tuple[str, ...]] = {
    ("dialogue", "property", "value"): ("true", "false"),
    ("scenario", "scenario", "policy"): ("prima", "prima+all", *BASELINES),
    ("voicexml", "vxml", "version"): ("2.1", "2.0"),
    ("voicexml", "field", "type"): TYPES,
    ("voicexml", "property", "name"): tuple(sorted(PROPERTY_NAMES)),
}
"""Values to propose that no vocabulary lists, by vocabulary, key of the element and attribute."""

VOCABULARIES = (DIALOGUE, WORLD, ROBOT, SCENARIO, USER, SERVICES, VOICEXML, GRAMMAR)
BY_NAMESPACE = {one.namespace: one for one in VOCABULARIES}
BY_ROOT = {one.elements[one.root].tag: one for one in reversed(VOCABULARIES)}


def resolve(page: ScannedText) -> None:
    """Set the vocabulary and key of every tag, if they can be determined."""
    for tag in page.tags:
        parent = tag.parent
        tag.namespaces = _namespaces(tag, parent.namespaces if parent else {})
        tag.namespace = tag.namespaces.get(tag.prefix[:-1], "")
        if parent is None or parent.vocabulary is None:
            vocabulary = BY_NAMESPACE.get(tag.namespace)
            if vocabulary is None and parent is None and not tag.prefix:
                vocabulary = BY_ROOT.get(tag.local)  # no namespace written yet
            tag.vocabulary = vocabulary
            is_root = vocabulary and vocabulary.elements[vocabulary.root].tag == tag.local
            tag.key = vocabulary.root if vocabulary and is_root else tag.local
        else:
            tag.vocabulary, tag.key = _child(parent, tag)


def _namespaces(tag: ScannedTag, outer: dict[str, str]) -> dict[str, str]:
    own = {
        attr.name[6:]: attr.value
        for attr in tag.attributes
        if attr.name == "xmlns" or attr.name.startswith("xmlns:")
    }
    return outer | own if own else outer


def _child(parent: ScannedTag, tag: ScannedTag) -> tuple[Vocabulary | None, str]:
    """The vocabulary and key of an element in another, guessed for a misplaced one."""
    inner = parent.vocabulary
    assert inner is not None
    if inner is VOICEXML and parent.key == "grammar":
        inner = GRAMMAR
    own = BY_NAMESPACE.get(tag.namespace, inner)
    if own is not inner and not (inner is GRAMMAR and own is VOICEXML):
        around_items = own is DIALOGUE and tag.local == "iu" and parent.key == "form"
        return own, UNIT if around_items else tag.local
    return inner, _key(inner, parent, tag)


def _key(inner: Vocabulary, parent: ScannedTag, tag: ScannedTag) -> str:
    if parent.key in inner.elements and (key := inner.child(parent.key, tag.local)) is not None:
        return key
    return next((one.key for one in inner.elements.values() if one.tag == tag.local), tag.local)


@dataclass(frozen=True, slots=True)
class AllowedElement:
    """An element allowed at a place: its name as written there, and its declaration."""

    name: str
    element: Element
    vocabulary: Vocabulary


def children(tag: ScannedTag) -> list[AllowedElement]:
    """The elements allowed in an element."""
    element, vocabulary = tag.element, tag.vocabulary
    if element is None or vocabulary is None:
        return []
    if tag.key == UNIT and tag.parent is not None and tag.parent.vocabulary is VOICEXML:
        return _in_unit(tag)
    inner = vocabulary
    if vocabulary is VOICEXML and tag.key == "grammar":
        inner, element = GRAMMAR, GRAMMAR.elements["grammar"]
    found = [
        AllowedElement(tag.prefix + inner.elements[key].tag, inner.elements[key], inner)
        for key in element.children
        if key in inner.elements
    ]
    return found + _of_prima(tag) if inner is VOICEXML else found


def _of_prima(tag: ScannedTag) -> list[AllowedElement]:
    """The elements of PRIMA allowed in one of VoiceXML, if they have a prefix there."""
    prefix = _prefix(tag, DIALOGUE)
    acts = tag.key in HOLDING or VOICEXML.child(tag.key, "assign")
    keys = sorted([*COMMANDS, *ARRANGING]) if acts else [UNIT] if tag.key == "form" else []
    own = [DIALOGUE.elements[key] for key in keys if prefix]
    return [AllowedElement(prefix + one.tag, one, DIALOGUE) for one in own]


def _in_unit(tag: ScannedTag) -> list[AllowedElement]:
    """The elements allowed in a ``p:iu`` around form items of VoiceXML."""
    prefix = _prefix(tag, VOICEXML)
    keys = [key for key in VOICEXML.elements if key in UNIT_HOLDS]
    return [AllowedElement(prefix + key, VOICEXML.elements[key], VOICEXML) for key in keys]


def _prefix(tag: ScannedTag, vocabulary: Vocabulary) -> str:
    """The prefix of a vocabulary's elements at a place, with its colon; none by default."""
    known = [prefix for prefix, uri in tag.namespaces.items() if uri == vocabulary.namespace]
    return f"{known[0]}:" if known and known[0] else ""


def roots() -> list[AllowedElement]:
    """The possible root elements."""
    return [
        AllowedElement(one.elements[one.root].tag, one.elements[one.root], one)
        for one in VOCABULARIES
    ]


def values(vocabulary: Vocabulary, element: Element, name: str) -> tuple[str, ...]:
    """The possible values of an attribute, if they are few."""
    item, expression = attributes_by_name(element).get(name, (None, False))
    if item is None or expression:
        return ()
    if item.choices:
        return item.choices
    if item.kind == "boolean":
        return ("true", "false")
    if listed := LISTED.get((vocabulary.name, element.key, name)):
        return listed
    if vocabulary is VOICEXML:
        kind = kind_of(element.key, name)
        return tuple(kind.split()) if kind not in ("time", "integer", "rate") else ()
    return ()


def is_code(tag: ScannedTag, name: str) -> bool:
    """Whether an attribute holds ECMAScript."""
    element = tag.element
    if element is None:
        return False
    if tag.vocabulary is VOICEXML:
        return name in EXPRESSIONS
    item, expression = attributes_by_name(element).get(name, (None, False))
    return expression or (item is not None and item.kind == "expression")
