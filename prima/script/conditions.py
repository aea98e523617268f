"""What a condition says that it most likely does not mean: it assigns, or compares a text."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from prima.script.parse import Node, inner, parse_expression

EQUALITY = frozenset(("==", "===", "!=", "!=="))


class Assigned(NamedTuple):
    """A condition that assigns where a comparison was meant."""

    start: int
    """Where the sign is that should be another."""
    function: bool
    """Whether it is a function, by ``=>`` for ``>=``."""


class Compared(NamedTuple):
    """A comparison of a variable with a text."""

    name: str
    text: str
    start: int
    """Where the text begins, with its quote."""


def assigned(code: str) -> Assigned | None:
    """Where a condition assigns a variable, or is a function, if it does or is."""
    parsed = parse_expression(code) if "=" in code else None
    if parsed is None or not parsed.sound:
        return None
    whole = inner(parsed)
    if whole is not None and whole.type == "arrow_function":
        sign = next(one for one in whole.children if one.type == "=>")
        return Assigned(parsed.start(sign), function=True)
    found = (node for node in parsed.walk() if node.type == "assignment_expression")
    first = next(found, None)
    return first and Assigned(parsed.start(first.children[1]), function=False)


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
    if node.type != "binary_expression" or node.children[1].type not in EQUALITY:
        return None
    left, _, right = node.children
    if left.type == "string":
        left, right = right, left
    return (left, right) if (left.type, right.type) == ("identifier", "string") else None
