"""Constants of scripts: their values, paths into them, and whether code only reads them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from prima.script.literals import Beyond, literal, string
from prima.script.parse import Code, Node, inner, parse_bracketed, parse_expression, parse_script

STEPS = frozenset(["member_expression", "subscript_expression"])
NAMES = frozenset(["identifier", "shorthand_property_identifier"])
WRITES = frozenset(
    [
        *("update_expression", "array_pattern", "pair_pattern", "rest_pattern"),
        *("assignment_pattern", "object_assignment_pattern"),
    ]
)
"""Expressions that change what is in them."""
WRITTEN = {
    "assignment_expression": "left",
    "augmented_assignment_expression": "left",
    "for_in_statement": "left",
    "call_expression": "function",
    "new_expression": "constructor",
}
"""Expressions that change a part of them, or call it, which may change its object."""


class Path(NamedTuple):
    """An expression such as ``panels[at].parts[0]``."""

    name: str
    """The variable's name."""
    steps: list[str | None]
    """Names and indexes of members; None for one that is computed."""


def constants(script: str) -> Iterator[tuple[str, Any]]:
    """The names and values of a script's constants that are literal arrays or objects."""
    code = parse_script(script)
    if code is None:
        return
    for declaration in code.root.named_children:
        kind = declaration.child_by_field_name("kind")
        if declaration.type != "lexical_declaration" or kind is None or kind.type != "const":
            continue
        for one in declaration.named_children:
            name, value = one.child_by_field_name("name"), one.child_by_field_name("value")
            if name is None or value is None or value.type not in ("array", "object"):
                continue
            try:
                yield code.name(name), literal(code, value)
            except Beyond:
                continue


def path(expression: str) -> Path | None:
    """The path that an expression is; None if it is anything else."""
    code = parse_bracketed(expression)
    node = None if code is None else inner(code)
    steps: list[str | None] = []
    while code is not None and node is not None and node.type in STEPS:
        if node.child_by_field_name("optional_chain") is not None:
            return None
        steps.append(_step(code, node))
        node = node.child_by_field_name("object")
    if code is None or node is None or node.type != "identifier" or not steps:
        return None
    return Path(code.name(node), steps[::-1])


def _step(code: Code, node: Node) -> str | None:
    member, index = node.child_by_field_name("property"), node.child_by_field_name("index")
    if member is not None:
        return code.of(member)
    if index is not None and index.type == "string":
        try:
            return string(code, index)
        except Beyond:
            return None
    text = "" if index is None else code.of(index)
    return text if text.isdecimal() else None


def changed_names(piece: str) -> set[str] | None:
    """The variables whose content code may change or pass on; None for all of them."""
    code = parse_expression(piece)
    if code is None:
        return None
    parents = {node.id: parent for node, parent in code.walk_inside() if parent is not None}
    names = (node for node in code.walk() if node.type in NAMES)
    return {code.name(node) for node in names if not _only_reads(node, parents)}


def _only_reads(name: Node, parents: Mapping[int, Node]) -> bool:
    """Whether code only reads a variable's content at one of its occurrences."""
    whole, outer = name, parents[name.id]
    while outer.type in STEPS and outer.child_by_field_name("object") == whole:
        whole, outer = outer, parents[outer.id]
    operator = outer.child_by_field_name("operator")
    how = "" if operator is None else operator.type
    if whole == name:  # only its declaration, and a loop over its keys, do not pass it on
        part = {"variable_declarator": "name", "for_in_statement": "right"}.get(outer.type)
        return part is not None and outer.child_by_field_name(part) == whole and how != "of"
    part = WRITTEN.get(outer.type)
    written = part is not None and outer.child_by_field_name(part) == whole
    return how != "delete" and outer.type not in WRITES and not written
