"""The texts that an expression may give, as far as they are literals in it."""

from __future__ import annotations

from typing import NamedTuple

from prima.script.parse import Code, Node, inner, parse_expression


class PossibleText(NamedTuple):
    """A possible value of an expression, or a prefix of one."""

    text: str
    whole: bool


UNKNOWN = PossibleText("", False)
"""Any text."""


def choices(code: str) -> list[PossibleText]:
    """The texts that an expression may give: literals, and conditionals of literals.

    >>> choices("old ? '#ask' : '#step' + number")
    [PossibleText(text='#ask', whole=True), PossibleText(text='#step', whole=False)]
    """
    parsed = parse_expression(code)
    node = inner(parsed) if parsed is not None else None
    if parsed is None or node is None:
        return [UNKNOWN]
    found: list[PossibleText] = []
    waiting: list[Node | None] = [node]
    while waiting:
        node = waiting.pop()
        if node is not None and node.type == "ternary_expression":
            waiting += [node.child_by_field_name(one) for one in ("alternative", "consequence")]
        elif node is not None and node.type == "parenthesized_expression":
            waiting += node.named_children
        else:
            found.append(_choice(parsed, node))
    return list(dict.fromkeys(found))


def _choice(code: Code, node: Node | None) -> PossibleText:
    """The choice of an expression without conditions: a literal, or a literal prefix."""
    whole = True
    while node is not None and node.type == "binary_expression":
        operator = node.child_by_field_name("operator")
        if operator is None or operator.type != "+":
            return UNKNOWN
        node, whole = node.child_by_field_name("left"), False
    text = code.of(node) if node is not None and node.type == "string" else ""
    return PossibleText(text[1:-1], whole) if text and "\\" not in text else UNKNOWN
