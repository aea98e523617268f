"""Assignments of a variable's own old value, in documents of both languages."""

from __future__ import annotations

import re
from collections.abc import Iterator

from prima.errors import Problem, replaced
from prima.errors.diagnoses.names import BAD_EXPRESSION
from prima.markup.spans import value_span
from prima.markup.tree import Node

STEP = re.compile(r"\s*([\w$.]+)\s*(\+\+|--)\s*")

NO_STEP = BAD_EXPRESSION.says(
    '"{code}" is the value before the step, so that "{name}" stays as it is.', severity="warning"
)


def no_step(assign: Node) -> Iterator[Problem]:
    """Warn of an ``assign`` such as that of ``n++`` to ``n``."""
    code = assign.get("expr")
    if not code.rstrip().endswith(("++", "--")):
        return
    name, found = assign.get("name").strip(), STEP.fullmatch(code)
    if found is not None and found[1] == name:
        right = f"{name} {found[2][0]} 1"
        hint = replaced(f"Write {right}.", right, *value_span(assign, "expr"))
        yield NO_STEP.at(assign.attribute_place("expr"), hint, code=code.strip(), name=name)
