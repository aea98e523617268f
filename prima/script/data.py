"""Scripts that need no engine: they declare variables with the values of literals, and nothing else.

Most tables of rooms, panels and answers are of this kind.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

from prima.script.globals import BUILT_IN, CONSTANTS, INHERITED, RESERVED, VARIABLES
from prima.script.literals import Beyond, literal
from prima.script.parse import Code, Node, parse_script

MOST_CODE = 20_000
"""Characters that a script evaluated in Python may have."""
MOST_SCRIPTS = 100
"""Scripts whose data is kept."""
DECLARATIONS = ("variable_declaration", "lexical_declaration")
TAKEN = RESERVED | INHERITED | BUILT_IN | CONSTANTS | VARIABLES
"""Names that mean something already."""


class ScriptData(NamedTuple):
    """What a script declares."""

    values: dict[str, Any]
    """By the variables, in their order."""
    pieces: int
    """The number of pieces of code it was made of, about."""


@lru_cache(maxsize=MOST_SCRIPTS)
def declared(code: str) -> ScriptData | None:
    """What a script declares; None if it needs an engine."""
    if len(code) > MOST_CODE:
        return None
    parsed = parse_script(code)
    if parsed is None or not parsed.sound:
        return None
    values: dict[str, Any] = {}
    try:
        for statement in parsed.root.named_children:
            if statement.type != "comment":
                _declare(parsed, statement, values)
    except Beyond:
        return None
    return ScriptData(values, 1 + parsed.root.descendant_count // 2)


def _declare(code: Code, statement: Node, values: dict[str, Any]) -> None:
    """Take in ``const a = 1, b = [2];``.

    Raises:
        Beyond: it is something else.
    """
    if statement.type not in DECLARATIONS:
        raise Beyond
    for one in statement.named_children:
        name, value = one.child_by_field_name("name"), one.child_by_field_name("value")
        if name is None or name.type != "identifier" or value is None:
            raise Beyond
        variable = code.of(name)
        if variable in TAKEN or variable in values or not variable.isascii() or "\\" in variable:
            raise Beyond
        values[variable] = literal(code, value)
