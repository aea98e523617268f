"""Literals of ECMAScript as values of Python."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from prima.script.parse import Code, Node, inner, parse_expression

WORDS = {"true": True, "false": False, "null": None}
NUMBER = frozenset("0123456789.eE+-")
ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "b": "\b", "f": "\f", "v": "\v"}
UNCOMMON = frozenset("ux0123456789\n\r\u2028\u2029")
"""Escapes: characters after a backslash that do not stand for themselves, except white space."""
DEEPEST = 50
"""Maximum nesting of arrays and objects."""


class Beyond(Exception):
    """The code needs an engine."""


def literal(code: Code, node: Node, depth: int = 0) -> Any:
    """The value of a literal in so many arrays and objects; every evaluation copies it (:func:`fresh`).

    Raises:
        Beyond: it needs an engine.
    """
    if depth > DEEPEST:
        raise Beyond
    if node.type == "array":
        return _array(code, node, depth)
    if node.type == "object":
        return _object(code, node, depth)
    if node.type == "unary_expression" and node.children[0].type == "-":
        operand = node.children[1]
        if operand.type == "number":
            return -number(code, operand)
    return _plain(code, node)


def plain_literal(expression: str) -> float | str | bool | None:
    """The value of an expression that is a number, a text or a truth value; None if it is not."""
    code = parse_expression(expression)
    node = inner(code) if code is not None and code.sound else None
    if code is None or node is None or node.type in ("array", "object"):
        return None
    try:
        value: float | str | bool | None = literal(code, node)
    except Beyond:
        return None
    return value


def fresh(value: Any) -> Any:
    """A copy of a literal's value, with all that is in it."""
    if isinstance(value, list):
        return [fresh(one) for one in value]
    if isinstance(value, dict):
        return {name: fresh(one) for name, one in value.items()}
    return value


def number(code: Code, node: Node) -> float:
    """A decimal number.

    Raises:
        Beyond: it is written in another way.
    """
    text = code.of(node)
    whole = text.partition(".")[0]
    if not set(text) <= NUMBER or (len(whole) > 1 and whole[0] == "0" and whole.isdigit()):
        raise Beyond
    return float(text)


def string(code: Code, node: Node) -> str:
    """A text in quotes.

    Raises:
        Beyond: an escape in it is uncommon.
    """
    pieces = []
    for part in node.named_children:
        text = code.of(part)
        if part.type == "escape_sequence":
            if text[1] in UNCOMMON:
                raise Beyond
            text = ESCAPES.get(text[1:], text[1:])
        pieces.append(text)
    return "".join(pieces)


def strings(expression: str) -> Iterator[str]:
    """The texts in quotes in an expression."""
    code = parse_expression(expression)
    for node in code.walk() if code is not None else ():
        if node.type == "string" and code is not None:
            try:
                yield string(code, node)
            except Beyond:
                continue


def _plain(code: Code, node: Node) -> Any:
    """A number, text or word: not an array or object."""
    if node.type == "number":
        return number(code, node)
    if node.type == "string":
        return string(code, node)
    if node.type in WORDS:
        return WORDS[node.type]
    raise Beyond


def _array(code: Code, node: Node, depth: int) -> list[Any]:
    children = node.children
    if any(one.type in ("[", ",") and two.type == "," for one, two in pairwise(children)):
        raise Beyond  # an element is omitted
    return [literal(code, one, depth + 1) for one in node.named_children]


def _object(code: Code, node: Node, depth: int) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for pair in node.named_children:
        key, value = pair.child_by_field_name("key"), pair.child_by_field_name("value")
        if pair.type != "pair" or key is None or value is None:
            raise Beyond
        if key.type not in ("property_identifier", "string"):
            raise Beyond
        name = string(code, key) if key.type == "string" else code.of(key)
        if name.isdigit() or name == "__proto__" or "\\" in name or not name.isascii():
            raise Beyond
        values[name] = literal(code, value, depth + 1)
    return values
