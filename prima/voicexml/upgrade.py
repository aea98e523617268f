"""Versions of VoiceXML: documents of 1.0, or without a version, are read as later ones."""

from __future__ import annotations

import re
from collections.abc import Callable

from prima.errors import Problem
from prima.errors.diagnoses.structure import MISSING_ATTRIBUTE
from prima.errors.diagnoses.values import BAD_VALUE
from prima.grammar.media import UNTYPED
from prima.markup.spans import added
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute

VERSIONS = ("2.0", "2.1")
OLD = "1.0"
RENAMED = {"vxml": {"base": "xml:base", "lang": "xml:lang"}, "pros": {"vol": "volume"}}
"""Attributes of VoiceXML 1.0 with their later names."""
DROPPED = {"subdialog": ("modal",)}
"""Attributes of VoiceXML 1.0 without a meaning now; ``caching`` is one on any element."""
EVENTS = re.compile(r"(?<!\S)(error\.)?telephone(?=[.\s]|$)")
"""Events of the telephone, which are those of a connection now (2.0, 5.2.6)."""

NO_VERSION = MISSING_ATTRIBUTE.says(
    '<vxml> needs the attribute "version": the document is read as VoiceXML 2.1.',
    'Write version="2.0" or "2.1".',
    "warning",
)
OLD_VERSION = BAD_VALUE.says(
    "The document is of VoiceXML 1.0: it is read as 2.0, its older elements as newer.",
    "Rewrite it in 2.0 or 2.1.",
    "warning",
)
OTHER_VERSION = BAD_VALUE.says(
    'version "{version}" is not a version of VoiceXML that is run here.', "Write 2.0 or 2.1."
)


def old(root: Node) -> bool:
    """Whether a document is VoiceXML 1.0, which has no namespace and partly other elements."""
    return root.get("version").strip() == OLD


def version_problem(root: Node) -> Problem | None:
    """The problem of a document's version, if any: an error if it cannot be run (1.5)."""
    version = root.get("version").strip()
    if version in VERSIONS:
        return None
    if "version" not in root.attributes:
        item = Attribute("version", "text", "the version", default="2.1")
        return NO_VERSION.at(root.place, added("", root, item))
    place = root.attribute_place("version")
    if version == OLD:
        return OLD_VERSION.at(place)
    return OTHER_VERSION.at(place, version=version)


def is_other_version(root: Node) -> bool:
    """Whether a document is of a version that is not run, so that little is known of it."""
    problem = version_problem(root)
    return problem is not None and problem.severity == "error"


def upgrade(root: Node) -> None:
    """Turn the elements and attributes of VoiceXML 1.0 into those of 2.0, where they differ."""
    for node in root.walk():
        attributes = node.attributes
        for name in ("caching", *DROPPED.get(node.tag, ())):
            attributes.pop(name, None)
        for name, later in RENAMED.get(node.tag, {}).items():
            if name in attributes:
                attributes.setdefault(later, attributes.pop(name))
        if attributes.get("fetchhint") == "stream":
            del attributes["fetchhint"]
        if "event" in attributes:
            attributes["event"] = EVENTS.sub(r"\1connection", attributes["event"])
        change = CHANGED.get(node.tag)
        if change is not None:
            change(node)


def _dtmf(node: Node) -> None:
    node.tag = "grammar"
    node.attributes["mode"] = "dtmf"
    _grammar(node)


def _grammar(node: Node) -> None:
    """A grammar's text without a type is in the format of 1.0's examples: not supported."""
    written = node.text and not node.nodes and not node.text.startswith("#ABNF")
    if written and "type" not in node.attributes:
        node.attributes["type"] = UNTYPED


def _div(node: Node) -> None:
    node.tag = "s" if node.attributes.pop("type", "") == "sentence" else "p"


def _emp(node: Node) -> None:
    node.tag = "emphasis"


def _pros(node: Node) -> None:
    """Rates were words per minute; only a change in percent still means the same."""
    node.tag = "prosody"
    if "rate" in node.attributes and not node.get("rate").endswith("%"):
        node.attributes["rate"] = "+0%"


def _break(node: Node) -> None:
    ms = node.attributes.pop("msecs", "").strip()
    if ms.isdecimal():
        node.attributes.setdefault("time", f"{ms}ms")


def _sayas(node: Node) -> None:
    """Replace one element by three: substituted words, sounds, and kinds of text."""
    given = {name: node.attributes.pop(name, "") for name in ("sub", "phon", "class")}
    for name, tag, later in SAID_AS:
        if given[name]:
            node.tag, node.attributes[later] = tag, given[name]
            return
    node.tag, node.attributes["rate"] = "prosody", "+0%"


SAID_AS = (("sub", "sub", "alias"), ("phon", "phoneme", "ph"), ("class", "say-as", "interpret-as"))
CHANGED: dict[str, Callable[[Node], None]] = {
    "dtmf": _dtmf,
    "grammar": _grammar,
    "div": _div,
    "emp": _emp,
    "pros": _pros,
    "break": _break,
    "sayas": _sayas,
}
"""How elements of VoiceXML 1.0 are upgraded."""
