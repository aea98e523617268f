"""Snippets: what is inserted for an element, with tab stops."""

from __future__ import annotations

from prima.grammar.vocabulary import GRAMMAR
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.lsp.tables import AllowedElement
from prima.markup.vocabulary import Element, Vocabulary
from prima.voicexml.vocabulary import ALTERNATIVES, PRIMA_NAMESPACE, VOICEXML


def snippet(choice: AllowedElement) -> str:
    """A snippet of an element with its required parts and tab stops."""
    element = choice.element
    needed = enumerate(_needed(choice.vocabulary, element), 1)
    words = [choice.name, *(f'{name}="${place}"' for place, name in needed)]
    if not element.children and not element.text:
        return " ".join(words) + "/>$0"
    return " ".join(words) + f">$0</{choice.name}>"


def _needed(vocabulary: Vocabulary, element: Element) -> list[str]:
    """Attributes that an element requires, or usually has."""
    needed = [item.name for item in element.attributes if item.required]
    if vocabulary is VOICEXML:
        for line in ALTERNATIVES.get(element.key, ()):
            if line.endswith("!") and "content" not in line:
                needed.append(line.split()[0])
    if vocabulary is DIALOGUE and element.key == "goto":
        needed.append("next")
    return needed


def opening(choice: AllowedElement) -> str:
    """A snippet of a new document."""
    namespace = choice.vocabulary.namespace
    begin = f'{choice.name} xmlns="{namespace}"'
    if choice.vocabulary is VOICEXML:
        begin += f' xmlns:p="{PRIMA_NAMESPACE}" version="2.1" xml:lang="en"'
        return f'{begin}>\n  <form id="$1">\n    <block>$0</block>\n  </form>\n</{choice.name}>'
    if choice.vocabulary is DIALOGUE:
        begin += ' version="1.0" kind="${1|ea,fa|}" id="$2" xml:lang="en"'
        body = '\n  <form id="$3">\n    <block>\n      $0\n      <exit/>\n    </block>\n  </form>\n'
        return f"{begin}>{body}</{choice.name}>"
    if choice.vocabulary is GRAMMAR:
        begin += ' version="1.0" xml:lang="en" root="$1" tag-format="semantics/1.0"'
        return f'{begin}>\n  <rule id="$1" scope="public">$0</rule>\n</{choice.name}>'
    begin += ' version="1.0" id="$1"'
    if choice.name == "scenario":
        begin += ' world="$2" robot="$3"'
    return f"{begin}>\n  $0\n</{choice.name}>"
