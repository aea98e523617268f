"""Names of elements by purpose, and attributes shared by several."""

from __future__ import annotations

from prima.language.commands import TABLE_4_2
from prima.markup.vocabulary import attribute

SPEAKING = tuple(row.name for row in TABLE_4_2.values() if row.name != "q-and-a")
ACTING = (*SPEAKING, "command", "par", "seq", "iu")
CONTENT = (
    *("var", "assign", "clear", "if", "foreach", "script", "log", "throw", "goto", "return"),
    *("exit", "reprompt", "send", *ACTING),
)
HANDLERS = ("on", "noinput", "nomatch", "help", "error")

EXPR = attribute("expr", "expression", "the value")
COND = attribute(
    "cond", "expression", "a condition; it counts only while this is true", default="true"
)
