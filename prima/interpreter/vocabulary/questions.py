"""Elements of questions and of the grammars of their answers."""

from __future__ import annotations

from prima.language.commands import TABLE_4_2
from prima.markup.vocabulary import Element, attribute

USUAL_CONFIDENCE = 0.5
"""The default of the minimum confidence (VoiceXML 2.0, 6.3.2)."""
_ASKING = TABLE_4_2["q-and-a"].arguments
PROPERTIES = {
    item.name: item
    for item in (
        attribute(
            "timeout",
            "duration",
            _ASKING["timeout"].doc,
            low=_ASKING["timeout"].low,
            high=_ASKING["timeout"].high,
        ),
        attribute("bargein", "boolean", _ASKING["bargein"].doc),
        attribute(
            "confidencelevel",
            "number",
            "how sure the recogniser has to be of an answer; below it, it is nomatch",
            default=f"{USUAL_CONFIDENCE}",
            low=0,
            high=1,
        ),
    )
}
"""Settings of questions, by name."""

GRAMMARS = (
    Element(
        "grammar",
        "Answers as an SRGS grammar: rules, one expansion written at once, or a file.",
        (
            attribute("root", "id", "the rule to begin with; by default the first"),
            attribute("src", "text", "a file with an SRGS grammar, and # and a rule of it"),
        ),
        ("rule", "one-of", "item", "ruleref", "tag"),
        text=True,
        source="SRGS 1.0",
    ),
    Element(
        "rule",
        "A named part of a grammar.",
        (attribute("id", "id", "its name", "required"),),
        ("one-of", "item", "ruleref", "tag"),
        text=True,
        source="SRGS 3.1",
    ),
    Element("one-of", "Alternatives.", (), ("item",), source="SRGS 2.4"),
    Element(
        "item",
        "A part of an expansion, or an alternative.",
        (attribute("repeat", "text", "how often: 2, 0-1, 1-"),),
        ("one-of", "item", "ruleref", "tag"),
        text=True,
        source="SRGS 2.5",
    ),
    Element(
        "ruleref",
        "Another rule of the same grammar.",
        (attribute("uri", "target", "# and the rule's id", "required"),),
        source="SRGS 2.2",
    ),
    Element(
        "tag",
        "The value that matching this gives, as a literal.",
        text=True,
        source="SISR 1.0 literals",
    ),
)
