"""The elements of SRGS's XML form as a table: their attributes and what they may hold."""

from __future__ import annotations

from prima.markup.vocabulary import Vocabulary, elements

SRGS = "http://www.w3.org/2001/06/grammar"

_EXPANSION = "one-of item ruleref tag token"
TABLE = f"""
grammar version xml:lang mode root tag-format xml:base > rule tag meta metadata lexicon | What the
    user may say or key in. | SRGS 4
meta name http-equiv content | A fact about the grammar. | SRGS 4.11.1
metadata | Facts about the grammar, in another language. | SRGS 4.11.2
lexicon uri type | How words are pronounced. | SRGS 4.10
rule > {_EXPANSION} example #text | A named part of a grammar. | SRGS 3.1
  id*: id | its name
  scope: text(private public) |
one-of > item | Alternatives. | SRGS 2.4
item repeat repeat-prob weight > {_EXPANSION} #text | A part of an expansion, or an alternative. |
    SRGS 2.5
ruleref | Another rule: of this grammar, of a file, or a special one. | SRGS 2.2
  uri: text |
  special: text(NULL VOID GARBAGE) |
  type: text |
tag > #text | The meaning of a match. | SRGS 2.6, SISR 1.0
token > #text | Words that belong together. | SRGS 2.1
example > #text | A phrase that the rule takes, for the reader. | SRGS 3.3
"""
GRAMMAR = Vocabulary(SRGS, "srgs", "grammar", elements(TABLE))
"""SRGS's elements; every one may also have xml:lang, and attributes of other languages."""
