"""Reads the attributes and texts of elements, and notes what is wrong with them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from prima.errors import Diagnosis, Hint, Problem
from prima.errors.diagnosis import NO_HINT
from prima.interpreter.acts import Expression, Pause, Text, pauses_in, type_of
from prima.interpreter.diagnoses import (
    BEYOND,
    HAS_BOTH,
    NEEDS_ARGUMENT,
    NEEDS_EITHER,
    NEEDS_VALUE,
    NEVER_FITS,
    NEVER_WITHIN,
    ONLY_A_PAUSE,
    ONLY_ONE,
    SAYS_NOTHING,
    SPEAKS_TOO_LONG,
    TURN_TOO_LONG,
)
from prima.interpreter.units import leading
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.language.arguments import (
    alternatives,
    check_argument,
    excluding_arguments,
    missing_argument,
)
from prima.language.commands import (
    LETTER_MS,
    PATIENCE_MS,
    TABLE_4_2,
    Argument,
    CommandType,
    too_long,
)
from prima.language.values import XML_SPACE, BadValue, is_beyond, outside, read_value
from prima.markup.spans import nearest_allowed
from prima.markup.tree import Node
from prima.markup.vocabulary import Attribute
from prima.script.literals import plain_literal

if TYPE_CHECKING:
    from prima.interpreter.grammars import Fetch
    from prima.messages import Json


def folded(text: str, first: bool) -> str:
    """Text between elements, white space folded; the first one has no leading space."""
    words = " ".join(text.split())
    if not words:
        return " " if text and not first else ""
    lead = " " if text[:1].isspace() and not first else ""
    return lead + words + (" " if text[-1:].isspace() else "")


class AttributeReader:
    """Reads attributes of a document; what is wrong is collected in ``problems``."""

    def __init__(self, root: Node, fetch: Fetch | None = None) -> None:
        self.root = root
        self.fetch = fetch
        """Returns the bytes of files that the document names."""
        self.outside = False
        """Whether it names any."""
        self.problems: list[Problem] = []
        self.lang = root.get("xml:lang", "en")
        self.expressions: list[Expression] = []
        self.words: list[str] = []
        """Code and names of variables other than expressions."""
        self.scripts: list[str] = []
        self.assigns_parts = self.counting = False
        self._unnamed = 0
        self._runs = 0
        """The number of runs of Commands built."""

    def problem(
        self,
        diagnosis: Diagnosis,
        node: Node,
        attribute: str = "",
        hint: Hint = NO_HINT,
        **parameters: object,
    ) -> None:
        """Note a problem at an element or at the value of one of its attributes."""
        self.problems.append(diagnosis.at(node.attribute_place(attribute), hint, **parameters))

    def value(self, node: Node, name: str, kind: str, default: Json) -> Json:
        """An attribute as a value of its kind, within its bounds."""
        text = node.attributes.get(name)
        if text is None:
            return default
        try:
            value = read_value(kind, text)
        except ValueError:
            return default  # the schema's problem, reported already
        for item in DIALOGUE.elements[node.key].attributes if node.key else ():
            if item.name == name:
                self.bounded(node, name, item, value)
        return value

    def bounded(self, node: Node, name: str, item: Attribute, value: Json) -> None:
        """Note an attribute's number that is out of its bounds."""
        if is_beyond(value, item.low, item.high):
            text = node.get(name)
            wrong = f'{item.name} "{text}" {outside(item.kind, item.low, item.high)}'
            self.problem(BEYOND, node, name, nearest_allowed(item, text, node, name), wrong=wrong)

    def expression(self, node: Node, name: str = "expr") -> Expression | None:
        """An attribute as an expression, if it is given."""
        code = node.attributes.get(name)
        return None if code is None or not code.strip() else self.code(code, node, name)

    def condition_of(self, node: Node) -> Expression | None:
        """The cond of an item, handler or prompt; None if it is the default, which always holds."""
        return self.expression(node, "cond") if node.get("cond").strip() != "true" else None

    def code(self, code: str, node: Node, attribute: str) -> Expression:
        """An expression, noted as one of the document's."""
        made = Expression(code, node, attribute)
        self.expressions.append(made)
        return made

    def either(self, node: Node, name: str) -> str | Expression:
        """An attribute, or the expression in NAME-expr; never both."""
        if f"{name}-expr" not in node.attributes:
            return node.get(name)
        found = self.expression(node, f"{name}-expr")
        if found is None:
            return node.get(name)
        if name in node.attributes:
            self.exclusive(node, name, f"{name}-expr")
        return found

    def target(self, node: Node, name: str) -> str:
        """The form that an attribute names; the schema reports a missing #."""
        return node.attributes.get(name, "").strip(XML_SPACE).removeprefix("#")

    def one_of_two(self, node: Node, first: str, second: str) -> None:
        """Note an element that has neither or both of two attributes, or of their expressions."""
        one, other = self.written(node, first), self.written(node, second)
        if one and other:
            self.exclusive(node, one, other)
        elif not (one or other or self.strange(node)):
            self.problem(NEEDS_EITHER, node, tag=node.tag, first=first, second=second)

    @staticmethod
    def written(node: Node, name: str) -> str:
        """The name of an attribute or of its ``-expr`` form, whichever is given; else empty."""
        if name in node.attributes:
            return name
        return f"{name}-expr" if f"{name}-expr" in node.attributes else ""

    @staticmethod
    def strange(node: Node) -> bool:
        """Whether something unknown was reported in an element: likely what is missing."""
        return not node.key or not node.attributes.keys() <= DIALOGUE.attributes[node.key].keys()

    def exclusive(self, node: Node, first: str, second: str) -> None:
        """Note that two attributes exclude each other."""
        self.problem(HAS_BOTH, node, second, tag=node.tag, first=first, second=second)

    def text(self, node: Node) -> Text:
        """Text with values in it, white space folded."""
        parts: list[str | Expression | Pause] = []
        for item in node.content:
            if isinstance(item, str):
                text = folded(item, first=not parts)
                parts += [text] if text else []
            elif item.tag == "value":
                expr = self.expression(item)
                parts += [] if expr is None else [expr]
            elif item.tag == "break":
                parts.append(self.pause(item))
        if parts and isinstance(parts[-1], str):
            parts[-1] = parts[-1].rstrip()
        return tuple(part for part in parts if part != "")

    def pause(self, node: Node) -> Pause:
        """A break."""
        return Pause(int(self.value(node, "time", "duration", 0)))  # in ms

    def params(self, node: Node) -> tuple[tuple[str, str | Expression], ...]:
        """The param children."""
        found: list[tuple[str, str | Expression]] = []
        for child in node.all("param"):
            expr = self.expression(child)
            if expr is not None and "value" in child.attributes:
                self.exclusive(child, "value", "expr")
            elif expr is None and "value" not in child.attributes:
                self.problem(NEEDS_VALUE, child)
            found.append((child.get("name"), expr or child.get("value")))
        return tuple(found)

    def names(self, node: Node) -> tuple[str, ...]:
        """The namelist attribute."""
        return tuple(node.get("namelist").split())

    # Commands -----------------------------------------------------------------

    @staticmethod
    def is_now(node: Node) -> bool:
        """Whether a Command is wanted now, or the first one of several (O2)."""
        node = leading(node)
        row = TABLE_4_2.get(type_of(node))
        return node.get("order") == "now" or (row is not None and row.now)

    def arguments(self, node: Node, row: CommandType) -> dict[str, Json | Expression]:
        """A Command's motion arguments, literal or as expressions."""
        args: dict[str, Json | Expression] = {}
        for key, text in node.attributes.items():
            bare = key.removesuffix("-expr")
            argument = row.arguments.get(bare)
            if argument is None:
                continue
            if bare != key:
                if bare in node.attributes:
                    self.exclusive(node, bare, key)
                args[bare] = self.code(text, node, key)
                self._check_literal(node, key, argument)
                continue
            try:
                check_argument(bare, argument, text)
                args[bare] = text  # read by the mediator, like the value of an expression
            except BadValue as error:
                if error.beyond:
                    hint = nearest_allowed(argument, text, node, key)
                    self.problem(BEYOND, node, key, hint, wrong=error.wrong)
        return args

    def _check_literal(self, node: Node, key: str, argument: Argument) -> None:
        """Note a literal as an expression whose value a Command never takes: error.semantic."""
        value = plain_literal(node.get(key))
        try:
            if value is not None:
                check_argument(key, argument, value)
        except BadValue as error:
            number = argument.kind == "duration" and not isinstance(value, str | bool)
            hint = Hint("A number counts seconds." if number else error.remedy)
            diagnosis = NEVER_WITHIN if error.beyond else NEVER_FITS
            self.problem(diagnosis, node, key, hint, wrong=error.wrong)

    def check_complete(self, node: Node, row: CommandType, text: Text | None) -> None:
        """Check that a Command has what it needs, beyond its schema."""
        self.check_arguments(node, row)
        self.check_length(node, text)
        wordless = text is not None and all(isinstance(part, Pause) for part in text)
        if wordless or (row.text == "required" and text is None):
            paused = wordless and row.text == "required"
            self.problem(ONLY_A_PAUSE if paused else SAYS_NOTHING, node, tag=node.tag)

    def check_arguments(self, node: Node, row: CommandType) -> None:
        """Check the required and exclusive arguments of a Command that its schema cannot express.

        An argument with a wrong value counts as given: the value is reported already.
        """
        written = {key.removesuffix("-expr"): key for key in node.attributes}
        choices = alternatives(row)
        if excluding := excluding_arguments(row, written):
            last = [key for name, key in written.items() if name in choices][-1]
            self.problem(ONLY_ONE, node, last, wrong=excluding)
        required = {name for name, item in row.arguments.items() if item.required}
        if self.strange(node) or not required <= written.keys():
            return  # reported already
        if missing := missing_argument(row, written):
            hint = Hint(f'Write {min(choices)}="...", for one.' if choices else "")
            self.problem(NEEDS_ARGUMENT, node, hint=hint, wrong=missing)

    def check_length(self, node: Node, text: Text | None, timeout: int = 0) -> None:
        """Note an utterance or question that certainly takes too long (E3, E6)."""
        letters = sum(len(part) for part in text or () if isinstance(part, str))
        silence = pauses_in(text) + timeout
        others = letters * LETTER_MS + silence - timeout
        hint = Hint("Shorten its timeout.") if timeout > others else NO_HINT
        if wrong := too_long(letters, silence):
            self.problem(SPEAKS_TOO_LONG, node, hint=hint, wrong=wrong)
        elif wrong := too_long(letters, silence, PATIENCE_MS):
            self.problem(TURN_TOO_LONG, node, hint=hint, wrong=wrong)
