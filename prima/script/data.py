"""Scripts that need no engine because they only declare variables with literal values.

Most tables of rooms, panels and answers are of this kind.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

from prima.script.globals import BUILT_IN, CONSTANTS, INHERITED, RESERVED, VARIABLES
from prima.script.literals import Beyond, literal
from prima.script.parse import Code, Node, parse_script

MOST_CODE = 20_000
"""Maximum length of a script evaluated in Python."""
MOST_SCRIPTS = 100
"""Maximum number of scripts whose data is cached."""
DECLARATIONS = ("variable_declaration", "lexical_declaration")
TAKEN = RESERVED | INHERITED | BUILT_IN | CONSTANTS | VARIABLES
"""Names with a predefined meaning."""


class ScriptData(NamedTuple):
    """The names that a script declares."""

    values: dict[str, Any]
    """Values by variable, in order."""
    pieces: int
    """The approximate number of pieces of code in it."""


@lru_cache(maxsize=MOST_SCRIPTS)
def declared(code: str) -> ScriptData | None:
    """The declarations of a script; None if it needs an engine."""
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
    """Add the declarations of ``const a = 1, b = [2];``.

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
