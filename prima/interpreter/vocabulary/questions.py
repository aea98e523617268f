"""Elements of the grammars of answers, and settings of questions."""

from __future__ import annotations

from prima.language.commands import TABLE_4_2
from prima.markup.vocabulary import Attribute, attribute

USUAL_CONFIDENCE = 0.5
"""The default of the minimum confidence (VoiceXML 2.0, 6.3.2)."""
PROPERTIES = {
    item.name: item
    for item in (
        *(
            Attribute(name, one.kind, one.doc, low=one.low, high=one.high)
            for name, one in TABLE_4_2["q-and-a"].arguments.items()
        ),
        attribute(
            f"confidencelevel: number 0..1 = {USUAL_CONFIDENCE} | how sure the recogniser has to be"
            " of an answer; below it, it is nomatch"
        ),
    )
}
"""Settings of questions, by name."""

GRAMMARS = """
grammar > rule one-of item ruleref tag #text | Answers as an SRGS grammar: rules, one expansion
    written at once, or a file. | SRGS 1.0
  root: id | the rule to begin with; by default the first
  src: text | a file with an SRGS grammar, and # and a rule of it
rule > one-of item ruleref tag #text | A named part of a grammar. | SRGS 3.1
  id*: id | its name
one-of > item | Alternatives. | SRGS 2.4
item > one-of item ruleref tag #text | A part of an expansion, or an alternative. | SRGS 2.5
  repeat: text | how often: 2, 0-1, 1-
ruleref | Another rule of the same grammar. | SRGS 2.2
  uri*: target | # and the rule's id
tag > #text | The value that matching this gives, as a literal. | SISR 1.0 literals
"""
