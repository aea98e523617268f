"""Tables of the languages for editors: allowed elements, and the meaning of names."""

from __future__ import annotations

from dataclasses import dataclass

from prima.devices.vocabulary import ROBOT, SERVICES
from prima.grammar.builtin import TYPES
from prima.interpreter.vocabulary import DIALOGUE
from prima.lsp.descriptions import VOICEXML_ATTRIBUTES
from prima.lsp.scan import Page, Tag
from prima.markup.vocabulary import (
    Attribute,
    Element,
    Vocabulary,
    attribute,
    attributes_by_name,
)
from prima.sim.vocabulary import SCENARIO, USER, WORLD
from prima.voicexml.arranging import ARRANGING, UNIT, UNIT_HOLDS
from prima.voicexml.vocabulary import COMMANDS, EXPRESSIONS, HOLDING, SRGS, VALUES, VOICEXML

_PARTS = ("one-of", "item", "ruleref", "tag", "token")
_REPEAT = (
    attribute("repeat", "text", ""),
    attribute("repeat-prob", "text", ""),
    attribute("weight", "text", ""),
)

GRAMMAR = Vocabulary(
    SRGS,
    "srgs",
    "grammar",
    (
        Element(
            "grammar",
            VOICEXML.elements["grammar"].doc,
            VOICEXML.elements["grammar"].attributes,
            ("rule", *_PARTS, "meta", "metadata", "lexicon"),
            True,
            source="SRGS 4",
        ),
        Element(
            "rule",
            "A named part of a grammar.",
            (
                attribute("id", "id", "its name", "required"),
                attribute("scope", "text", "", choices=("private", "public")),
            ),
            (*_PARTS, "example"),
            True,
            source="SRGS 3.1",
        ),
        Element("one-of", "Alternatives.", (), ("item",), source="SRGS 2.4"),
        Element(
            "item",
            "A part of an expansion, or an alternative.",
            _REPEAT,
            _PARTS,
            True,
            source="SRGS 2.5",
        ),
        Element(
            "ruleref",
            "Another rule: of this grammar, of a file, or a special one.",
            (
                attribute("uri", "text", ""),
                attribute("special", "text", "", choices=("NULL", "VOID", "GARBAGE")),
                attribute("type", "text", ""),
            ),
            source="SRGS 2.2",
        ),
        Element("tag", "The meaning of a match.", (), (), True, source="SRGS 2.6, SISR 1.0"),
        Element("token", "Words that belong together.", (), (), True, source="SRGS 2.1"),
        Element(
            "example",
            "A phrase that the rule takes, for the reader.",
            (),
            (),
            True,
            source="SRGS 3.3",
        ),
        Element("meta", VOICEXML.elements["meta"].doc, VOICEXML.elements["meta"].attributes),
        Element("metadata", VOICEXML.elements["metadata"].doc, (), (), True),
        Element(
            "lexicon", VOICEXML.elements["lexicon"].doc, VOICEXML.elements["lexicon"].attributes
        ),
    ),
)
"""SRGS in XML, as used in VoiceXML documents."""

VOCABULARIES = (DIALOGUE, WORLD, ROBOT, SCENARIO, USER, SERVICES, VOICEXML, GRAMMAR)
BY_NAMESPACE = {one.namespace: one for one in VOCABULARIES}
BY_ROOT = {one.elements[one.root].tag: one for one in reversed(VOCABULARIES)}


def resolve(page: Page) -> None:
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
            tag.key = vocabulary.root if vocabulary and _is_root(vocabulary, tag) else tag.local
        else:
            tag.vocabulary, tag.key = _child(parent, tag)


def _is_root(vocabulary: Vocabulary, tag: Tag) -> bool:
    return vocabulary.elements[vocabulary.root].tag == tag.local


def _namespaces(tag: Tag, outer: dict[str, str]) -> dict[str, str]:
    own = {
        attr.name[6:]: attr.value
        for attr in tag.attributes
        if attr.name == "xmlns" or attr.name.startswith("xmlns:")
    }
    return outer | own if own else outer


def _child(parent: Tag, tag: Tag) -> tuple[Vocabulary | None, str]:
    """The vocabulary and key of an element in another, guessed for a misplaced one."""
    inner = parent.vocabulary
    assert inner is not None
    if inner is VOICEXML and parent.key == "grammar":
        inner = GRAMMAR
    if tag.namespace and tag.namespace != inner.namespace and tag.namespace in BY_NAMESPACE:
        own = BY_NAMESPACE[tag.namespace]
        if not (inner is GRAMMAR and own is VOICEXML):
            around_items = own is DIALOGUE and tag.local == "iu" and parent.key == "form"
            return own, UNIT if around_items else tag.local
    key = inner.child(parent.key, tag.local) if parent.key in inner.elements else None
    if key is None:
        key = next((one.key for one in inner.elements.values() if one.tag == tag.local), tag.local)
    return inner, key


@dataclass(frozen=True, slots=True)
class Choice:
    """An element allowed at a place: its name as written there, and its declaration."""

    name: str
    element: Element
    vocabulary: Vocabulary


def children(tag: Tag) -> list[Choice]:
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
        Choice(tag.prefix + inner.elements[key].tag, inner.elements[key], inner)
        for key in element.children
        if key in inner.elements
    ]
    prefix = _prefix(tag, DIALOGUE)
    if inner is VOICEXML and prefix:
        acts = tag.key in HOLDING or VOICEXML.child(tag.key, "assign")
        keys = sorted([*COMMANDS, *ARRANGING]) if acts else [UNIT] if tag.key == "form" else []
        own = [DIALOGUE.elements[key] for key in keys]
        found += [Choice(prefix + one.tag, one, DIALOGUE) for one in own]
    return found


def _in_unit(tag: Tag) -> list[Choice]:
    """The elements allowed in a ``p:iu`` around form items of VoiceXML."""
    prefix = _prefix(tag, VOICEXML)
    keys = [key for key in VOICEXML.elements if key in UNIT_HOLDS]
    return [Choice(prefix + key, VOICEXML.elements[key], VOICEXML) for key in keys]


def _prefix(tag: Tag, vocabulary: Vocabulary) -> str:
    """The prefix of a vocabulary's elements at a place, with its colon; none by default."""
    known = [prefix for prefix, uri in tag.namespaces.items() if uri == vocabulary.namespace]
    return f"{known[0]}:" if known and known[0] else ""


def roots() -> list[Choice]:
    """The possible root elements."""
    return [
        Choice(one.elements[one.root].tag, one.elements[one.root], one)
        for one in VOCABULARIES
        if one is not GRAMMAR
    ]


def attributes(element: Element) -> dict[str, tuple[Attribute, bool]]:
    """An element's attributes as written, and whether each is an expression."""
    return attributes_by_name(element)


def about_attribute(item: Attribute) -> str:
    """The description of an attribute."""
    return item.doc or VOICEXML_ATTRIBUTES.get(item.name, "")


def values(vocabulary: Vocabulary, element: Element, name: str) -> tuple[str, ...]:
    """The possible values of an attribute, if they are few."""
    item, expression = attributes(element).get(name, (None, False))
    if item is None or expression:
        return ()
    if item.choices:
        return item.choices
    if item.kind == "boolean":
        return ("true", "false")
    if vocabulary is DIALOGUE and (element.key, name) == ("property", "value"):
        return ("true", "false")
    if vocabulary is VOICEXML:
        if (element.key, name) == ("vxml", "version"):
            return ("2.1", "2.0")
        if (element.key, name) == ("field", "type"):
            return TYPES
        kind = VALUES.get(f"{element.key} {name}") or VALUES.get(name, "")
        return tuple(kind.split()) if kind not in ("time", "integer", "rate") else ()
    return ()


def is_code(tag: Tag, name: str) -> bool:
    """Whether an attribute holds ECMAScript."""
    element = tag.element
    if element is None:
        return False
    if tag.vocabulary is VOICEXML:
        return name in EXPRESSIONS
    item, expression = attributes(element).get(name, (None, False))
    return expression or (item is not None and item.kind == "expression")


# Names ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Use:
    """The reference in an attribute's value: the kinds of names, and the notation.

    ``how`` is empty, ``#`` (behind a ``#``), ``list`` (several with spaces) or ``uri``
    (a file, a ``#`` and a name).
    """

    kinds: tuple[str, ...]
    how: str = ""


_FORM, _POINT = Use(("form",), "#"), Use(("place", "thing"))
_VARIABLES = Use(("variable",), "list")

DEFINES: dict[tuple[str, str, str], str] = {
    ("dialogue", "prima", "id"): "application",
    ("dialogue", "form", "id"): "form",
    ("dialogue", "rule", "id"): "rule",
    **{
        ("dialogue", key, "name"): "variable"
        for key in ("var", "field", "block", "subdialog", "iu-items")
    },
    ("dialogue", "foreach", "item"): "variable",
    ("dialogue", "watch", "name"): "event",
    **{("dialogue", key, "event"): "event" for key in ("throw", "send", "link", "return")},
    ("world", "place", "id"): "place",
    ("world", "thing", "id"): "thing",
    ("world", "corner", "event"): "event",
    ("robot", "touch", "sensor"): "sensor",
    ("robot", "device", "name"): "device",
    ("robot", "gesture", "name"): "gesture",
    ("robot", "adds", "command"): "command",
    ("scenario", "application", "id"): "application",
    ("scenario", "person", "id"): "person",
    ("scenario", "service", "name"): "service",
    ("scenario", "event", "name"): "event",
    ("scenario", "sensor", "name"): "reading",
    ("voicexml", "form", "id"): "form",
    ("voicexml", "menu", "id"): "form",
    **{
        ("voicexml", key, "name"): "variable"
        for key in (
            *("var", "field", "block", "initial", "record", "object", "subdialog"),
            *("transfer", "data"),
        )
    },
    **{("voicexml", key, "item"): "variable" for key in ("foreach", "said-foreach")},
    **{("voicexml", key, "event"): "event" for key in ("throw", "link", "return", "choice")},
    ("srgs", "rule", "id"): "rule",
}
"""Attributes that define a name, by vocabulary and key of the element."""

REFERS: dict[tuple[str, str, str], Use] = {
    ("dialogue", "goto", "next"): _FORM,
    ("dialogue", "link", "next"): _FORM,
    ("dialogue", "subdialog", "src"): _FORM,
    ("dialogue", "goto", "nextitem"): Use(("variable",)),
    ("dialogue", "assign", "name"): Use(("variable",), "code"),
    **{("dialogue", key, "namelist"): _VARIABLES for key in ("clear", "return", "filled")},
    ("dialogue", "ruleref", "uri"): Use(("rule",), "#"),
    ("dialogue", "grammar", "root"): Use(("rule",)),
    ("dialogue", "on", "event"): Use(("event",), "list"),
    ("dialogue", "topological-move", "to"): Use(("place",)),
    **{
        ("dialogue", key, "toward"): _POINT
        for key in ("turn-and-speak", "set-direction", "point-by-hand")
    },
    ("dialogue", "gesture", "name"): Use(("gesture",)),
    ("dialogue", "command", "type"): Use(("command",)),
    ("dialogue", "send", "to"): Use(("service",)),
    ("world", "way", "from"): Use(("place",)),
    ("world", "way", "to"): Use(("place",)),
    ("robot", "adds", "devices"): Use(("device",), "list"),
    ("robot", "allows", "command"): Use(("command",)),
    ("robot", "substitute", "command"): Use(("command",)),
    ("robot", "substitute", "by"): Use(("command",)),
    ("scenario", "robot", "at"): Use(("place",)),
    ("scenario", "person", "at"): _POINT,
    ("scenario", "walk", "to"): _POINT,
    ("scenario", "look", "at"): _POINT,
    ("scenario", "touch", "sensor"): Use(("sensor",)),
    ("scenario", "fail", "device"): Use(("device",)),
    ("scenario", "repair", "device"): Use(("device",)),
    ("scenario", "when", "doing"): Use(("command",)),
    ("scenario", "when", "done"): Use(("command",)),
    ("scenario", "when", "on"): Use(("event",)),
    ("scenario", "unload", "application"): Use(("application",)),
    ("scenario", "service", "application"): Use(("application",)),
    ("scenario", "message", "to"): Use(("application",)),
    ("scenario", "when", "person"): Use(("person",)),
    ("scenario", "answer", "person"): Use(("person",)),
    ("voicexml", "goto", "next"): Use(("form",), "uri"),
    ("voicexml", "link", "next"): Use(("form",), "uri"),
    ("voicexml", "choice", "next"): Use(("form",), "uri"),
    ("voicexml", "submit", "next"): Use(("form",), "uri"),
    ("voicexml", "subdialog", "src"): Use(("form",), "uri"),
    ("voicexml", "goto", "nextitem"): Use(("variable",)),
    ("voicexml", "assign", "name"): Use(("variable",), "code"),
    **{
        ("voicexml", key, "namelist"): _VARIABLES
        for key in (
            "clear",
            "return",
            "filled",
            "submit",
            "subdialog",
            "exit",
            "disconnect",
            "data",
        )
    },
    ("voicexml", "catch", "event"): Use(("event",), "list"),
    ("srgs", "ruleref", "uri"): Use(("rule",), "uri"),
    ("voicexml", "grammar", "root"): Use(("rule",)),
    ("srgs", "grammar", "root"): Use(("rule",)),
}
"""Attributes that refer to a name, by vocabulary and key of the element."""

FILES: dict[tuple[str, str, str], tuple[str, ...]] = {
    ("scenario", "scenario", "world"): ("world",),
    ("scenario", "scenario", "robot"): ("robot",),
    ("scenario", "application", "src"): ("dialogue", "voicexml"),
    ("scenario", "person", "user"): ("user",),
    ("scenario", "reply", "src"): (),
    ("world", "area", "application"): ("dialogue", "voicexml"),
    ("voicexml", "vxml", "application"): ("voicexml",),
    **{("voicexml", key, "next"): ("voicexml",) for key in ("goto", "submit", "link", "choice")},
    ("voicexml", "subdialog", "src"): ("voicexml",),
    ("voicexml", "grammar", "src"): ("srgs",),
    ("dialogue", "grammar", "src"): ("srgs",),
    ("srgs", "ruleref", "uri"): ("srgs",),
    **{("voicexml", key, "src"): () for key in ("script", "audio", "data")},
}
"""Attributes that name a file, with the vocabularies of documents that fit."""

SHARED = frozenset(
    [
        *("place", "thing", "sensor", "device", "gesture", "command", "service"),
        *("application", "event", "reading"),
    ]
)
"""Kinds of names that documents of one scenario share."""
