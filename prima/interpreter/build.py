"""Builds a document from elements: its forms, their items, handlers, links and watches."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from prima.errors import Hint
from prima.grammar.answers import Answers
from prima.grammar.text import fold
from prima.interpreter.acts import Declare, Expression, Handler, Script
from prima.interpreter.buildcontent import ContentBuilder, Parts
from prima.interpreter.diagnoses import (
    BAD_PROPERTY,
    BARRED_OPTION,
    EMPTY_OPTION,
    ID_WITH_DOT,
    NO_FORM_AT_ALL,
    NO_GRAMMAR,
    NO_ITEM,
    OF_FORMS,
    SECOND_GRAMMAR,
    TAKES_NO_ANSWER,
    TWO_FORMS,
    TWO_OPTIONS,
)
from prima.interpreter.elements import (
    Block,
    Document,
    Field,
    Filled,
    Form,
    Item,
    Link,
    Prompt,
    Subdialog,
    Unit,
    Watch,
)
from prima.interpreter.units import LONGEST_UNIT_MS, Finder, unit_problem, units_of
from prima.interpreter.vocabulary.questions import PROPERTIES
from prima.language.commands import TABLE_4_2
from prima.language.values import BadValue, read_value
from prima.markup.tree import Node

if TYPE_CHECKING:
    from prima.grammar.grammar import Grammar
    from prima.messages import Json

HOLD_MS = 15_000
"""The default of hold-for: how long a stream is held for an event (X3)."""
EVENT = re.compile(r"event|_message|\beval\b|valueOf|\\u")
"""Words in code that may read the event being handled."""
CLOCK = re.compile(r"session|\beval\b|valueOf|\\u")
"""Words in code that may read the time of the run."""
ItemParts = tuple[
    str,
    Expression | None,
    Expression | None,
    tuple[Handler, ...],
    dict[str, "Json"],
    Node,
    int | None,
]
"""The common parts of form items, in the order of :class:`Item`'s fields."""


class Builder(ContentBuilder):
    """Builds a document; collects what is wrong in ``problems`` and goes on."""

    # The document -------------------------------------------------------------

    def document(self) -> Document:
        """Build the whole application."""
        root = self.root
        forms: dict[str, Form] = {}
        parts = self.parts(root)
        for node in parts.get("form", ()):
            name = node.get("id")
            if name in forms:
                self.problem(TWO_FORMS, node, "id", name=name)
            forms.setdefault(name, self.form(node))
        if "." in root.get("id"):
            self.problem(ID_WITH_DOT, root, "id", name=root.get("id"))
        if not forms:
            self.problem(NO_FORM_AT_ALL, root)
        document = Document(
            id=root.get("id"),
            kind=root.get("kind"),
            lang=self.lang,
            file=root.source.file,
            forms=forms,
            handlers=self.handlers(parts),
            links=self.links(parts),
            watches=self.watches(parts),
            setup=self.setup(parts),
            properties=self.properties(parts),
            node=root,
            expressions=self.expressions,
            scripts=self.scripts,
            assigns_parts=self.assigns_parts,
            counting=self.counting,
            curious=self.any_has(EVENT),
            timed=self.any_has(CLOCK),
        )
        self.settle_units(document)
        return document

    def any_has(self, words: re.Pattern[str]) -> bool:
        """Whether any code or variable name of the document contains certain words."""
        codes = {*self.words, *(one.code for one in self.expressions)}  # most occur many times
        return any(map(words.search, codes))

    def form(self, node: Node) -> Form:
        """A form."""
        parts = self.parts(node)
        return Form(  # by position: keywords would take as long as the call
            node.get("id"),
            self.items(parts),
            self.handlers(parts),
            self.links(parts),
            self.watches(parts),
            self.setup(parts),
            self.filleds(parts),
            self.properties(parts),
            node,
            self.hold(node),
            node.get("channel") == "connect",
            " ".join(node.get("resume-text", "").split()),
        )

    def hold(self, node: Node) -> int | None:
        """How long a stream is held, by the hints of an element (X3)."""
        if node.get("stream") != "hold":
            return None
        longest: int = self.value(node, "hold-for", "duration", HOLD_MS)
        return longest

    def setup(self, parts: Parts) -> tuple[Declare | Script, ...]:
        """Variables and scripts, in document order."""
        found: list[Declare | Script] = []
        for child in parts.get("setup", ()):
            found.append(self.declare(child) if child.tag == "var" else self.script(child))
        return tuple(found)

    def properties(self, parts: Parts) -> dict[str, Json]:
        """Properties by name, as values."""
        found: dict[str, Json] = {}
        for child in parts.get("property", ()):
            name = child.get("name")
            if name in PROPERTIES:
                item, text = PROPERTIES[name], child.get("value")
                try:
                    found[name] = value = read_value(item.kind, text)
                except BadValue as error:
                    hint = Hint(error.remedy)
                    self.problem(
                        BAD_PROPERTY, child, "value", hint, name=name, value=text, wrong=error.wrong
                    )
                    continue
                self.bounded(child, "value", item, value)
        return found

    def links(self, parts: Parts) -> tuple[Link, ...]:
        """Links in document order."""
        found = []
        for child in parts.get("link", ()):
            self.one_of_two(child, "next", "event")
            held = child.all("grammar")
            grammars = self.grammars(held)
            if not held:
                self.problem(NO_GRAMMAR, child)
            for more in held[1:]:
                self.problem(SECOND_GRAMMAR, more)
            if grammars:
                to = self.target(child, "next")
                found.append(Link(to, child.get("event"), Answers(grammars=grammars[:1]), child))
        return tuple(found)

    def grammars(self, nodes: list[Node]) -> list[Grammar]:
        """Grammars, except those of files that cannot be used."""
        if not nodes:
            return []
        from prima.interpreter.grammars import grammar_of  # few documents have any

        self.outside = self.outside or any("src" in node.attributes for node in nodes)
        found = [
            grammar_of(node, self.lang, self.fetch, self.problem, self.problems) for node in nodes
        ]
        return [one for one in found if one is not None]

    def watches(self, parts: Parts) -> tuple[Watch, ...]:
        """Watches in document order."""
        return tuple(
            Watch(child.get("name"), self.code(child.get("when"), child, "when"), child)
            for child in parts.get("watch", ())
        )

    # Form items ---------------------------------------------------------------

    def items(self, parts: Parts) -> tuple[Item, ...]:
        """The form items of a form or a unit."""
        made: list[Item] = []
        for child in parts.get("items", ()):
            match child.tag:
                case "block":
                    block = Block(*self.item(child, self.parts(child)), content=self.content(child))
                    made.append(block)
                case "field":
                    made.append(self.field(child))
                case "subdialog":
                    made.append(self.subdialog(child))
                case "iu" if child.key == "iu-items":
                    made.append(self.unit(child))
        return tuple(made)

    def item(self, node: Node, parts: Parts) -> ItemParts:
        """The common parts of a form item."""
        name = node.get("name")
        self.plain_name(node, "name")
        if not name:
            self._unnamed += 1
            name = f"$item{self._unnamed}"
        handlers = self.handlers(parts) if node.tag != "block" else ()
        return (
            name,
            self.expression(node),
            self.condition_of(node),
            handlers,
            self.properties(parts),
            node,
            self.hold(node) if "stream" in node.attributes else None,
        )

    def field(self, node: Node) -> Field:
        """A field, with the answers that it takes."""
        parts = self.parts(node)
        prompts, answers = self.prompts(parts), self.answers(node, parts)
        return Field(
            *self.item(node, parts),
            prompts=prompts,
            answers=answers,
            filled=self.filleds(parts, node),
            lang=self.lang,
            connect=node.get("channel") == "connect",
        )

    def prompts(self, parts: Parts) -> tuple[Prompt, ...]:
        """The prompts of a field."""
        made = []
        for child in parts.get("prompt", ()):
            prompt = Prompt(
                text=self.text(child),
                count=self.value(child, "count", "integer", 1),
                cond=self.condition_of(child),
                timeout=self.value(child, "timeout", "duration", None),
                bargein=self.value(child, "bargein", "boolean", None),
                node=child,
            )
            self.check_length(child, prompt.text, prompt.timeout or 0)
            made.append(prompt)
        return tuple(made)

    def answers(self, node: Node, parts: Parts) -> Answers:
        """The answers that a field takes."""
        answers = Answers(type=node.get("type"))
        for child in parts.get("option", ()):
            said = child.text
            if "|" in said:
                self.problem(BARRED_OPTION, child)
            if not fold(said):
                self.problem(EMPTY_OPTION, child)
            elif fold(said) in answers.options:
                self.problem(TWO_OPTIONS, child, answer=said)
            answers.options.setdefault(fold(said), child.get("value", said))
        answers.grammars = self.grammars(parts.get("grammar", []))
        strange = any(not child.key for child in node.nodes)  # reported already
        if not (answers.options or "grammar" in parts or answers.type or strange):
            self.problem(TAKES_NO_ANSWER, node, name=node.get("name"))
        return answers

    def subdialog(self, node: Node) -> Subdialog:
        """A subdialog."""
        parts = self.parts(node)
        return Subdialog(
            *self.item(node, parts),
            form=self.target(node, "src"),
            params=self.params(node),
            filled=self.filleds(parts, node),
        )

    def unit(self, node: Node) -> Unit:
        """A unit around form items; its reach is computed once the document is complete."""
        parts = self.parts(node)
        unit = Unit(*self.item(node, parts), items=self.items(parts))
        unit.longest = self.value(node, "longest", "duration", LONGEST_UNIT_MS)
        if not unit.items and all(one.key for one in node.nodes):
            self.problem(NO_ITEM, node)
        return unit

    def settle_units(self, document: Document) -> None:
        """U5: give each unit the devices of all that may run in it."""
        finder = Finder(document)
        reported: set[int] = set()
        for form, unit in units_of(document):
            reach = finder.reach(form, unit)
            unit.devices, unit.types = reach.devices, reach.types
            for one in reach.commands:
                problem = unit_problem(one, TABLE_4_2.get(one.command.type), unit)
                if problem is not None and id(one.command) not in reported:
                    reported.add(id(one.command))
                    self.problems.append(problem)

    def filleds(self, parts: Parts, item: Node | None = None) -> tuple[Filled, ...]:
        """Filled elements of a form, or of an item, whose answer alone they wait for (2.4)."""
        for child in parts.get("filled", ()) if item is not None else ():
            for name in sorted(child.attributes.keys() & {"mode", "namelist"}):
                self.problem(OF_FORMS, child, name, name=name)
        return tuple(
            Filled(child.get("mode", "all"), self.names(child), self.content(child), child)
            for child in parts.get("filled", ())
        )
