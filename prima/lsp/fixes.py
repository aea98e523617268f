"""Quick fixes: the fixes of a problem as changes of an open text."""

from __future__ import annotations

from dataclasses import dataclass

from prima.errors import Fix, Problem
from prima.lsp.text import Lines


@dataclass(frozen=True, slots=True)
class TextChange:
    """A piece of text in place of another; ``start`` and ``end`` are offsets."""

    start: int
    end: int
    text: str


def changes(lines: Lines, fix: Fix) -> list[TextChange]:
    """The changes of a text that a fix makes."""
    return [
        TextChange(
            lines.place(span.line, span.column),
            lines.place(span.end_line, span.end_column),
            text,
        )
        for span, text in fix.edits
    ]


def fixes(lines: Lines, problem: Problem) -> list[tuple[str, list[TextChange]]]:
    """The fixes of a problem: titles, and changes of the text."""
    return [(fix.title, changes(lines, fix)) for fix in problem.fixes]
