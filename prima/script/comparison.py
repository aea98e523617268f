"""Simple conditions: a variable, its negation, or its comparison with a literal."""

from __future__ import annotations

from typing import NamedTuple

from prima.script.literals import Beyond, string
from prima.script.parse import Code, Node, inner, parse_bracketed

TRUTH = {"true": True, "false": False}


class Comparison(NamedTuple):
    """A condition that holds if a variable has a value; true and false are any such values."""

    name: str
    """The variable, with its scope if that is written: ``dialog.x``."""
    value: str | bool


def comparison(condition: str) -> Comparison | None:
    """The comparison in ``x``, ``!x``, ``!x == true`` or ``x == 'word'``; None for other code."""
    code = parse_bracketed(condition)
    node = None if code is None else inner(code)
    if code is None or node is None:
        return None
    if node.type != "binary_expression":
        return _of(code, node, True)
    operator, right = node.child_by_field_name("operator"), node.child_by_field_name("right")
    if right is None or operator is None or operator.type not in ("==", "==="):
        return None
    try:
        value = string(code, right) if right.type == "string" else TRUTH.get(right.type)
    except Beyond:
        return None
    return None if value is None else _of(code, node.child_by_field_name("left"), value)


def _of(code: Code, node: Node | None, value: str | bool) -> Comparison | None:
    operator = None if node is None else node.child_by_field_name("operator")
    if node is not None and operator is not None and operator.type == "!":
        argument = node.child_by_field_name("argument")
        return _of(code, argument, not value) if isinstance(value, bool) else None
    named = node is not None and node.type in ("identifier", "member_expression")
    return Comparison(code.of(node), value) if named and node is not None else None
