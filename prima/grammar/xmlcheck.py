"""Problems of the elements of SRGS's XML form: their places, content and attributes."""

from __future__ import annotations

from functools import partial

from prima.errors import Hint, suggestion, with_article
from prima.grammar.errors import Problems
from prima.grammar.values import is_language
from prima.grammar.vocabulary import GRAMMAR, SRGS
from prima.markup.hints import allowed_in, inside_itself
from prima.markup.spans import name_spans, similar_attribute
from prima.markup.tree import Node

HOLDERS = {"grammar": "rule", "one-of": "item"}
"""What has to be around the expansions in an element."""


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
        """Whether SRGS allows the element there; those of other languages are ignored."""
        if node.namespace != self.space:
            if node.namespace in ("", SRGS):
                message = f"<{node.tag}> is in another namespace than <{parent.tag}>."
                self.note(node, "wrong-namespace", message, f'Declare xmlns="{self.space}".')
            return False
        if node.tag not in GRAMMAR.tags:
            hint = suggestion(node.tag, GRAMMAR.tags, *name_spans(node))
            self.note(node, "unknown-element", f"SRGS has no element <{node.tag}>.", hint)
            return False
        if GRAMMAR.child(parent.tag, node.tag) is None:
            self._misplaced(node, parent)
            return False
        self.attributes(node, set())
        self._content(node)
        return True

    def attributes(self, node: Node, more: set[str]) -> None:
        """Note unknown attributes; ``more`` are known besides those of SRGS."""
        if not node.attributes:
            return
        known = GRAMMAR.attributes[node.tag].keys() | more
        for name in node.attributes:
            if name not in known and ":" not in name and not name.startswith("{"):
                message = f'<{node.tag}> has no attribute "{name}".'
                hint = similar_attribute(node, name, ["xml:lang"] if name == "lang" else known)
                where = partial(node.attribute_place, name, value=False)
                self.problems.note(where, "unknown-attribute", message, hint)
        lang = node.attributes.get("xml:lang")
        if lang is not None and not is_language(lang):
            message = f'"{lang[:40]}" names no language.'
            self.note(node, "bad-value", message, 'Write one such as "en-US".', "xml:lang")

    def _content(self, node: Node) -> None:
        """Note text in an element that holds none, and elements in one that holds only text."""
        if node.tag == "metadata":
            return
        self.no_text(node)
        if not GRAMMAR.children(node.tag):
            for child in node.nodes:
                self._misplaced(child, node)

    def _misplaced(self, node: Node, parent: Node) -> None:
        message = f"<{node.tag}> is not allowed in <{parent.tag}>."
        self.note(node, "misplaced-element", message, _remedy(node.tag, parent.tag))

    def no_text(self, node: Node) -> None:
        """Note text in an element that holds none."""
        if GRAMMAR.elements[node.tag].text or not node.text:
            return
        holder = HOLDERS.get(node.tag, "")
        remedy = _put_into(holder) if holder else "Remove it."
        if node.tag == "grammar" and not node.nodes:
            remedy = 'Write it in SRGS: rules in XML, or "#ABNF 1.0;" before the text.'
        message = f"Text is not allowed in <{node.tag}>."
        self.problems.note(partial(node.text_place, node.text), "stray-text", message, remedy)


def _remedy(tag: str, parent: str) -> str:
    """Where a misplaced element belongs."""
    holder, others = HOLDERS.get(parent, ""), GRAMMAR.parents(tag)
    if holder in others:
        return _put_into(holder)
    if tag == parent:
        return inside_itself(tag)
    return allowed_in(f"<{one}>" for one in others) if tag in GRAMMAR.tags else ""


def _put_into(tag: str) -> str:
    return f"Put it in {with_article(f'<{tag}>')}."
