"""Grammars as documents write them (SRGS 1.0, XML form), read into what matches."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prima.errors import Diagnosis, Hint, suggestion
from prima.errors.diagnosis import NO_HINT
from prima.interpreter.diagnoses import (
    BAD_REPEAT,
    EMPTY_GRAMMAR,
    NO_RULE,
    TEXT_BESIDE_RULES,
    TWO_RULES,
)
from prima.interpreter.grammar import Choice, Grammar, Part, Reference, Sequence, Tag, Words, fold
from prima.markup.spans import value_span
from prima.markup.tree import Node

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
            """Note it, with what to write instead."""


def read_grammar(note: Note, node: Node) -> Grammar:
    """An SRGS grammar of rules, or of one expansion."""
    grammar = Grammar()
    rules = node.all("rule")
    for rule in rules:
        name = rule.get("id")
        if name in grammar.rules:
            note(TWO_RULES, rule, "id", name=name)
        grammar.rules[name] = _expansion(note, rule)
    if rules:
        grammar.root = node.get("root", rules[0].get("id"))
        if node.text:
            note(TEXT_BESIDE_RULES, node)
    else:
        if not node.nodes and not fold(node.text):
            note(EMPTY_GRAMMAR, node)
        grammar.root = "root"
        grammar.rules["root"] = _expansion(note, node)
    if grammar.root not in grammar.rules:
        hint = suggestion(grammar.root, grammar.rules, *value_span(node, "root"))
        note(NO_RULE, node, "root", hint, name=grammar.root)
        grammar.rules[grammar.root] = Choice([])
    _check_references(note, node, grammar)
    if next(grammar.large(), None) is not None:
        from prima.interpreter.leads import index_choices  # few grammars need it

        index_choices(grammar)
    return grammar


def _check_references(note: Note, node: Node, grammar: Grammar) -> None:
    """Every ruleref names a rule."""
    for child in node.nodes:
        name = child.get("uri").strip().removeprefix("#")
        if child.tag == "ruleref" and name not in grammar.rules:
            hint = suggestion(name, grammar.rules, *value_span(child, "uri", name))
            if "#" in child.get("uri"):  # else told already
                note(NO_RULE, child, "uri", hint, name=name)
            grammar.rules[name] = Choice([])
        _check_references(note, child, grammar)


def _expansion(note: Note, node: Node) -> Part:
    """The expansion that an element holds."""
    parts: list[Part] = []
    for item in node.content:
        if isinstance(item, str):
            if fold(item):
                parts.append(Words(fold(item)))
            continue
        match item.tag:
            case "one-of":
                parts.append(Choice([_expansion(note, child) for child in item.all("item")]))
            case "item":
                parts.append(_expansion(note, item))
            case "ruleref":
                parts.append(Reference(item.get("uri").strip().removeprefix("#")))
            case "tag":
                parts.append(Tag(item.text))
    low, high = _repeat(note, node)
    return Sequence(parts, low, high)


def _repeat(note: Note, node: Node) -> tuple[int, int]:
    """The repeat attribute of an item: n, m-n or m-."""
    text = node.get("repeat", "1") or "1"
    low, dash, high = text.partition("-")
    fits = all(
        part.isascii() and part.isdecimal() and len(part) <= 3
        for part in (low, *([high] if high else []))
    )
    if not fits or (high and int(low) > int(high)):
        note(BAD_REPEAT, node, "repeat", value=text)
        return 1, 1
    return int(low), int(high) if high else (999 if dash else int(low))
