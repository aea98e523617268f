"""Grammars in documents of PRIMA's own language, a subset of SRGS, read into rules."""

from __future__ import annotations

import re
from functools import partial
from typing import TYPE_CHECKING

from prima.errors import Diagnosis, Hint
from prima.errors.diagnoses.grammars import BAD_TOKEN, EMPTY_ANSWER, NO_SUCH_RULE
from prima.errors.diagnoses.structure import DUPLICATE_ID, STRAY_TEXT
from prima.errors.diagnoses.values import BAD_VALUE
from prima.errors.diagnosis import NO_HINT
from prima.grammar.errors import other_rule
from prima.grammar.grammar import Grammar
from prima.grammar.model import GrammarDocument, Part, Reference, Repeat, Rule, Tag, Words
from prima.grammar.prefixes import index_choices
from prima.grammar.text import fold
from prima.grammar.values import choice, repeat, sequence
from prima.markup.spans import value_span
from prima.markup.tree import Node
from prima.script.names import script_names

if TYPE_CHECKING:
    from typing import Protocol

    class Note(Protocol):
        """Notes a problem at an element or the value of one of its attributes."""

        def __call__(
            self,
            diagnosis: Diagnosis,
            node: Node,
            attribute: str = "",
            hint: Hint = NO_HINT,
            **parameters: object,
        ) -> None:
            """Note a problem, with a remedy."""


TWO_RULES = DUPLICATE_ID.says('There are two rules "{name}".', "Rename one.")
NO_RULE = NO_SUCH_RULE.says('There is no rule "{name}".')
TEXT_BESIDE_RULES = STRAY_TEXT.says(
    "This grammar has rules; its own text has no effect.", "Write it into a <rule>, or remove it."
)
EMPTY_GRAMMAR = EMPTY_ANSWER.says("This grammar has no words.", "Write what it takes.")
NO_ITEMS = EMPTY_ANSWER.says(
    "This <one-of> has no items: nothing matches it.",
    "Write an <item> for each answer.",
    "warning",
)
BARRED = BAD_TOKEN.says(
    'There is no "|" here: the words before and behind it are one answer.',
    "Write <one-of> with an <item> for each answer.",
    "warning",
)
OF_ABNF = BAD_TOKEN.says(
    '"{sign}" has no meaning between the words of this grammar.',
    'Write <item repeat="0-1"> for what may be left out, <ruleref uri="#..."/> for a rule.',
    "warning",
)
SIGN = re.compile(r"\[|\$(?=[^\W\d])|#(?:ABNF|JSGF)\b")
"""What grammars in the ABNF form, and their kin, hold beside words."""
TAG_IS_TEXT = BAD_VALUE.says(
    'A <tag> is text here, not code: the value is "{text}".',
    "Write the value alone, or name a .grxml file with src.",
    severity="warning",
)
RESULTS = {"out", "$"}
"""What tags that are code assign their values to, in other grammars (SISR)."""
NO_RULES = Hint("Remove root: this grammar holds no <rule>.")
"""The remedy for the name of a rule where there is none."""
MOST_REPEATED = 999
"""The greatest number of ``repeat``."""
BAD_REPEAT = BAD_VALUE.says("{wrong}", 'Write one such as "0-1".')


class DialogueGrammarReader:
    """Reads one grammar, which has been checked by the schema."""

    def __init__(self, note: Note, node: Node) -> None:
        self.note = note
        self.node = node
        self.document = GrammarDocument("", partial(node.attribute_place, ""), dialect="last")

    def grammar(self) -> Grammar:
        """The grammar; a rule with a problem matches nothing."""
        node, rules = self.node, self.node.all("rule")
        for rule in rules:
            self._rule(rule)
        if rules and node.text:
            self.note(TEXT_BESIDE_RULES, node)
        if not rules:
            if "root" in node.attributes:
                self.note(NO_RULE, node, "root", NO_RULES, name=node.get("root"))
            self._define("", self._expansion(node))  # no reference names it
        if self._is_wordless():
            self.note(EMPTY_GRAMMAR, node)
        self.document.root = node.get("root", rules[0].get("id")) if rules else ""
        self._rule_named(node, self.document.root, "root")
        self._resolve(node)
        index_choices([self.document])
        return Grammar(self.document, "", self.document.where)

    def _is_wordless(self) -> bool:
        """Whether no part of the grammar holds a word, and nothing else is wrong with it."""
        every = [one for one in self.node.walk() if one.tag != "tag"]
        told = any(one.tag == "one-of" and not one.all("item") for one in every)
        told |= any(
            one.tag == "ruleref" and _named(one) not in self.document.rules for one in every
        )
        return not told and not any(fold(one.text) for one in every)

    def _rule(self, node: Node) -> None:
        name = node.get("id")
        if name in self.document.rules:
            self.note(TWO_RULES, node, "id", name=name)
        self._define(name, self._expansion(node))

    def _define(self, name: str, body: Part) -> Rule:
        found = self.document.rules[name] = Rule(name, body, self.document, True)
        return found

    def _rule_named(self, node: Node, name: str, attribute: str, reported: bool = False) -> Rule:
        """A rule by its name, or one that matches nothing."""
        found = self.document.rules.get(name)
        if found is not None:
            return found
        if not reported:
            hint = other_rule(name, self.document.rules, *value_span(node, attribute, name))
            self.note(NO_RULE, node, attribute, hint, name=name)
        return self._define(name, choice([], []))

    def _resolve(self, node: Node) -> None:
        """Resolve all references; those without # have been reported by the schema's check."""
        names = {}
        for one in node.walk():
            if one.tag == "ruleref":
                name = _named(one)
                reported = not one.get("uri").strip().startswith("#")
                names[name] = self._rule_named(one, name, "uri", reported)
        for reference in self.document.references:
            reference.resolve(names[reference.uri])

    def _expansion(self, node: Node) -> Part:
        """The content of an element, repeated as it specifies."""
        parts: list[Part] = []
        for item in node.content:
            if isinstance(item, str):
                if "|" in item:
                    self.note(BARRED, node)
                elif sign := SIGN.search(item):
                    self.note(OF_ABNF, node, sign=sign[0])
                if folded := fold(item):
                    parts.append(Words(folded, tuple(folded.split())))
            elif (part := self._part(item)) is not None:
                parts.append(part)
        held = sequence(parts)
        return self._repeated(node, held) if "repeat" in node.attributes else held

    def _part(self, node: Node) -> Part | None:
        match node.tag:
            case "one-of":
                items = [self._expansion(child) for child in node.all("item")]
                if not items:
                    self.note(NO_ITEMS, node)
                return choice(items, [None] * len(items))
            case "item":
                return self._expansion(node)
            case "ruleref":
                found = Reference(_named(node), partial(node.attribute_place, ""))
                self.document.references.append(found)
                return found
            case "tag":
                if "=" in node.text and _is_code(node.text):
                    self.note(TAG_IS_TEXT, node, text=node.text)
                return Tag(node.text, partial(node.attribute_place, ""))
        return None

    def _repeated(self, node: Node, part: Part) -> Part:
        text = node.get("repeat")
        try:
            low, high = repeat(text)
        except ValueError as error:
            self.note(BAD_REPEAT, node, "repeat", wrong=str(error))
            return part
        if max(low, high or 0) > MOST_REPEATED:
            form = f"2, 0-1 or 1-, with numbers up to {MOST_REPEATED}"
            wrong = f'repeat "{text[:40]}" is not of the form {form}.'
            self.note(BAD_REPEAT, node, "repeat", wrong=wrong)
            return part
        return Repeat(part, low, high)


def _named(node: Node) -> str:
    return node.get("uri").strip().removeprefix("#")


def _is_code(tag: str) -> bool:
    """Whether a tag, read as a script, names the result of a rule (SISR)."""
    return any(use.name in RESULTS for use in script_names(tag).uses)
