"""The elements of SRGS's XML form: their content and attributes, and problems of these."""

from __future__ import annotations

from functools import partial

from prima.errors import Hint, suggestion
from prima.grammar.errors import Problems
from prima.grammar.values import is_language
from prima.markup.spans import name_spans, similar_attribute
from prima.markup.tree import Node

SRGS = "http://www.w3.org/2001/06/grammar"
HEADER = {"meta", "metadata", "lexicon", "tag"}
EXPANSION = {"token", "ruleref", "item", "one-of", "tag"}
ATTRIBUTES: dict[str, set[str]] = {
    "grammar": {"version", "mode", "root", "tag-format"},
    "meta": {"name", "http-equiv", "content"},
    "metadata": set(),
    "lexicon": {"uri", "type"},
    "rule": {"id", "scope"},
    "example": set(),
    "token": set(),
    "item": {"repeat", "repeat-prob", "weight"},
    "one-of": set(),
    "ruleref": {"uri", "type", "special"},
    "tag": set(),
}
"""The elements of SRGS and what they may say, beside ``xml:lang`` and the like."""


class GrammarChecker:
    """Notes problems of elements."""

    def __init__(self, problems: Problems) -> None:
        self.problems = problems
        self.space = SRGS
        """The namespace of the grammar being read."""

    def note(
        self, node: Node, code: str, message: str, remedy: str | Hint = "", attribute: str = ""
    ) -> None:
        """Note a problem at an element, or at one of its attributes."""
        self.problems.note(partial(node.attribute_place, attribute), code, message, remedy)

    def known(self, node: Node, parent: Node) -> bool:
        """Whether it is an element of SRGS; those of other languages are ignored."""
        if node.namespace != self.space:
            if node.namespace in ("", SRGS):
                message = f"<{node.tag}> is in another namespace than <{parent.tag}>."
                self.note(node, "wrong-namespace", message, f'Declare xmlns="{self.space}".')
            return False
        if node.tag not in ATTRIBUTES:
            hint = suggestion(node.tag, ATTRIBUTES, *name_spans(node))
            self.note(node, "unknown-element", f"SRGS has no element <{node.tag}>.", hint)
            return False
        self.attributes(node, set())
        return True

    def attributes(self, node: Node, more: set[str]) -> None:
        """Note unknown attributes; ``more`` are known besides those of SRGS."""
        if not node.attributes:
            return
        known = ATTRIBUTES[node.tag] | more
        for name in node.attributes:
            if name not in known and ":" not in name and not name.startswith("{"):
                message = f"<{node.tag}> has no attribute {name}."
                hint = similar_attribute(node, name, known)
                self.note(node, "unknown-attribute", message, hint, name)
        lang = node.attributes.get("xml:lang")
        if lang is not None and not is_language(lang):
            message = f'"{lang[:40]}" names no language.'
            self.note(node, "bad-value", message, 'Write one such as "en-US".', "xml:lang")

    def no_text(self, node: Node) -> None:
        """Note text in an element that holds none."""
        if node.text:
            remedy = "Put it in an <item>."
            if node.tag == "grammar":
                remedy = "Put it in a <rule>."
                if not node.nodes:
                    remedy = 'Write it in SRGS: rules in XML, or "#ABNF 1.0;" before the text.'
            message = f"Text is not allowed in <{node.tag}>."
            self.problems.note(partial(node.text_place, node.text), "stray-text", message, remedy)

    def no_elements(self, node: Node) -> None:
        """Note elements in one that holds none."""
        for child in node.nodes:
            message = f"<{child.tag}> is not allowed in <{node.tag}>."
            self.note(child, "misplaced-element", message)
