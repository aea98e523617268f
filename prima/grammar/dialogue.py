"""The grammars that documents of PRIMA's own language hold: a part of SRGS, read into its rules."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from prima.errors import Place, did_you_mean
from prima.grammar.grammar import Grammar
from prima.grammar.leads import index_choices
from prima.grammar.model import Document, Part, Reference, Repeat, Rule, Tag, Words
from prima.grammar.text import fold
from prima.grammar.values import choice, repeat, sequence
from prima.markup.tree import Node

if TYPE_CHECKING:
    from typing import Protocol

    class Note(Protocol):
        """Notes a problem at an element or the value of one of its attributes."""

        def __call__(
            self, node: Node, code: str, message: str, remedy: str = "", attribute: str = ""
        ) -> None:
            """Note it, with what to write instead."""


def read_grammar(note: Note, node: Node) -> Grammar:
    """A grammar of rules, or of one expansion."""
    return _Reader(note, node).grammar()


class _Reader:
    """Reads one grammar, of which the schema has been checked."""

    def __init__(self, note: Note, node: Node) -> None:
        self.note = note
        self.node = node
        self.document = Document("", partial(_place, node), dialect="last")

    def grammar(self) -> Grammar:
        """The grammar; what is wrong is noted, and leads to a rule that takes nothing."""
        node, rules = self.node, self.node.all("rule")
        for rule in rules:
            self._rule(rule)
        if rules and node.text:
            message = "This grammar has rules; its own text counts for nothing."
            self.note(node, "stray-text", message)
        if not rules:
            if not node.nodes and not fold(node.text):
                message = "This grammar holds nothing to say."
                self.note(node, "empty-answer", message, "Write what it takes.")
            self._define("root", self._expansion(node))
        self.document.root = node.get("root", rules[0].get("id")) if rules else "root"
        self._rule_named(node, self.document.root, "root")
        self._resolve(node)
        index_choices([self.document])
        return Grammar(self.document, "", self.document.where)

    def _rule(self, node: Node) -> None:
        name = node.get("id")
        if name in self.document.rules:
            self.note(node, "duplicate-id", f'There are two rules "{name}".', attribute="id")
        self._define(name, self._expansion(node))

    def _define(self, name: str, body: Part) -> Rule:
        found = self.document.rules[name] = Rule(name, body, self.document, True)
        return found

    def _rule_named(self, node: Node, name: str, attribute: str, told: bool = False) -> Rule:
        """A rule, or one that takes nothing where there is none."""
        found = self.document.rules.get(name)
        if found is not None:
            return found
        if not told:
            hint = did_you_mean(name, self.document.rules)
            self.note(node, "no-such-rule", f'There is no rule "{name}".', hint, attribute)
        return self._define(name, choice([], []))

    def _resolve(self, node: Node) -> None:
        """Every ruleref names a rule; one without # has been told by the schema's check."""
        names = {}
        for one in node.walk():
            if one.tag == "ruleref":
                name = _named(one)
                names[name] = self._rule_named(one, name, "uri", "#" not in one.get("uri"))
        for reference in self.document.references:
            reference.lead_to(names[reference.uri])

    def _expansion(self, node: Node) -> Part:
        """What an element holds, as often as it says."""
        parts: list[Part] = []
        for item in node.content:
            if isinstance(item, str):
                if folded := fold(item):
                    parts.append(Words(folded, tuple(folded.split())))
            elif (part := self._part(item)) is not None:
                parts.append(part)
        held = sequence(parts)
        return self._repeated(node, held) if node.get("repeat") else held

    def _part(self, node: Node) -> Part | None:
        match node.tag:
            case "one-of":
                items = [self._expansion(child) for child in node.all("item")]
                return choice(items, [None] * len(items))
            case "item":
                return self._expansion(node)
            case "ruleref":
                found = Reference(_named(node), partial(_place, node))
                self.document.references.append(found)
                return found
            case "tag":
                return Tag(node.text, partial(_place, node))
        return None

    def _repeated(self, node: Node, part: Part) -> Part:
        try:
            return Repeat(part, *repeat(node.get("repeat")))
        except ValueError as error:
            self.note(node, "bad-value", str(error), 'Write one such as "0-1".', "repeat")
            return part


def _named(node: Node) -> str:
    return node.get("uri").strip().removeprefix("#")


def _place(node: Node) -> Place:
    return node.place
