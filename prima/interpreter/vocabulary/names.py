"""Names of elements by purpose, and attributes shared by several."""

from __future__ import annotations

from prima.language.commands import TABLE_4_2

SPEAKING = " ".join(row.name for row in TABLE_4_2.values() if row.name != "q-and-a")
ACTING = f"{SPEAKING} command par seq iu"
CONTENT = "var assign clear if foreach script log throw goto return exit reprompt send " + ACTING
HANDLERS = "on noinput nomatch help error"

EXPR = "expr: expression | the value"
COND = "cond: expression = true | a condition; it counts only while this is true"
