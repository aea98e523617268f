"""What a condition says that it most likely does not mean: it assigns, or compares a text."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator
from typing import NamedTuple

from prima.errors import Hint, Place, Problem, Span, one_of, suggestion
from prima.errors.diagnoses.conditions import (
    ASSIGNING_CONDITION,
    FUNCTION_CONDITION,
    LITERAL_CONDITION,
    NEVER_EQUAL,
)
from prima.script.parse import Node, inner, parse_expression

EQUALITY = frozenset(("==", "===", "!=", "!=="))
NUMERIC = re.compile(r"\s*([-+.\d].*)?", re.DOTALL)
"""A text that may equal true, false or a number; an empty one may stand for no answer."""
PLAIN = re.compile(r"[\w .-]*")
"""A text that is written in an attribute as it is."""
MOST = 5
"""Maximum number of values that a message lists."""
LONGEST = 100
"""Characters of a text above which a comparison is not checked."""
TRUE_OR_FALSE = 'It is true or false: write "{field}" or "!{field}".'

TRUE_LITERALS = {
    "object": ("an object", "{ and }"),
    "array": ("a list", "[ and ]"),
    "string": ("a text", "its quotes"),
    "template_string": ("a text", "its quotes"),
}
"""The types of nodes that are always true, unless they are an empty text, and their signs."""
SIGNS = re.compile(r"""\s*[\[{'"`]|[^=]*=""")
"""How code begins that may assign, or be such a literal."""

At = Callable[[int], Place]
"""Gives the place of a character of some code."""


class Compared(NamedTuple):
    """A comparison of a variable with a text."""

    name: str
    text: str
    start: int
    """Where the text begins, with its quote."""


def assigning(code: str, at: At) -> Iterator[Problem]:
    """The problem of a condition that by a slip assigns a variable, or is always true."""
    parsed = parse_expression(code) if SIGNS.match(code) else None
    if parsed is None or not parsed.sound:
        return
    whole = inner(parsed)
    if whole is not None and whole.type == "arrow_function":
        yield FUNCTION_CONDITION.at(at(parsed.start(_sign(whole, "=>"))))
        return
    if whole is not None and whole.type in TRUE_LITERALS and len(parsed.of(whole)) > 2:
        kind, signs = TRUE_LITERALS[whole.type]
        yield LITERAL_CONDITION.at(at(parsed.start(whole)), kind=kind, signs=signs)
        return
    found = (node for node in parsed.walk() if node.type == "assignment_expression")
    if (first := next(found, None)) is not None:
        yield ASSIGNING_CONDITION.at(at(parsed.start(_sign(first, "="))))


def _sign(node: Node, sign: str) -> Node:
    """The part of a node that is its sign; comments may be beside it."""
    return next(one for one in node.children if one.type == sign)


def may_compare(code: str) -> bool:
    """Whether code may compare something with a text."""
    return ("==" in code or "!=" in code) and ("'" in code or '"' in code)


def compared(code: str) -> Iterator[Compared]:
    """Each comparison of a variable with a text, whichever of them comes first."""
    parsed = parse_expression(code) if may_compare(code) else None
    for node in parsed.walk() if parsed is not None else ():
        sides = _sides(node)
        if parsed is not None and sides is not None:
            name, text = sides
            yield Compared(parsed.of(name), parsed.of(text)[1:-1], parsed.start(text))


def _sides(node: Node) -> tuple[Node, Node] | None:
    """The name and the text that a comparison compares."""
    sign, left, right = map(node.child_by_field_name, ("operator", "left", "right"))
    if sign is None or left is None or right is None or sign.type not in EQUALITY:
        return None
    if left.type == "string":
        left, right = right, left
    return (left, right) if (left.type, right.type) == ("identifier", "string") else None


def may_equal(text: str, values: Collection[str]) -> bool:
    """Whether one of some values, or true or false, may equal a text as code has it."""
    return "\\" in text or bool(NUMERIC.fullmatch(text)) or len(text) > LONGEST or text in values


def never_equal(found: Compared, at: At, values: Collection[str] | None) -> Problem:
    """The problem of comparing a field with a text that no answer gives it.

    ``values`` are those that answers give; None if the field is boolean.
    """
    if values is None:
        hint = Hint(TRUE_OR_FALSE.format(field=found.name))
    else:
        plain = filter(PLAIN.fullmatch, values) if PLAIN.fullmatch(found.text) else ()
        hint = suggestion(found.text, plain, Span.of(at(found.start + 1), found.text))
        hint = hint or Hint(f"It is {one_of(values, MOST)}." if values else "")
    return NEVER_EQUAL.at(at(found.start), hint, field=found.name, text=found.text)
