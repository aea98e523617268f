"""Names in code that were most likely meant as something else: values of other languages, texts."""

from __future__ import annotations

from prima.errors import Hint, Span, replaced

ELSEWHERE = {
    **dict.fromkeys(("True", "TRUE"), "true"),
    **dict.fromkeys(("False", "FALSE"), "false"),
    **dict.fromkeys(("None", "Null", "NULL", "nil"), "null"),
}
"""Values as other languages write them, with those of ECMAScript."""


def value_elsewhere(name: str, *spans: Span) -> Hint:
    """ECMAScript's value for a name by which another language writes it; nothing for others."""
    right = ELSEWHERE.get(name, "")
    return replaced(f"Write {right}.", right, *spans) if right else Hint()


def is_bare(code: str, name: str, start: int) -> bool:
    """Whether a name is all of some code, or compared, and may have been meant as a text."""
    if name in ELSEWHERE:
        return False
    return code.strip() == name or code[:start].rstrip().endswith(("==", "!="))


def or_text(hint: Hint, name: str) -> Hint:
    """The same hint, and how to write a name as a text."""
    return hint._replace(text=f"{hint.text} For the text itself write '{name}'.")
