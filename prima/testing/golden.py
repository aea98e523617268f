"""Expected tables: the file beside a scenario, compared with a run's table."""

from __future__ import annotations

from difflib import unified_diff
from pathlib import Path

from prima.errors import DocumentError, UsageError
from prima.loading.files import read_file
from prima.transcript.diff import Difference, compare, format_difference
from prima.transcript.row import Row
from prima.transcript.table import format_rows, read_table, width

LONGEST_DIFFERENCE = 200
"""Maximum number of lines of a difference."""


def golden_of(scenario: Path) -> Path:
    """The file of a scenario's expected table: beside it, with the suffix ``.txt``."""
    return scenario.with_suffix(".txt")


def read_golden(path: Path) -> str:
    """The expected table.

    Raises:
        UsageError: it cannot be read, or is not text.
    """
    try:
        return read_file(path).decode("utf-8-sig").replace("\r\n", "\n")
    except (DocumentError, UnicodeDecodeError):
        raise UsageError(f"{path}: not a transcript's table: it is not UTF-8.") from None


def difference(golden: str, run: list[Row], by: str) -> str:
    """The difference of a run's table from the expected one; empty if there is none.

    The run's table is laid out as wide as the expected one.

    Args:
        golden: the expected table.
        run: the run's rows.
        by: ``text``, or ``behavior``, which ignores differences in time below 0.5 s.
    """
    table = format_rows(run, columns=width(golden.partition("\n")[0]))
    if golden == table:
        return ""
    try:
        rows = compare(read_table(golden), read_table(table))
    except (ValueError, IndexError):
        return _lines(golden, table)  # the expected file is not a table
    if rows.differs:
        return _changed(rows)
    return "" if by == "behavior" else _lines(golden, table)


def _changed(rows: Difference) -> str:
    """The rows that changed, with those around them."""
    lines = format_difference(rows).rstrip("\n").split("\n")
    *shown, last = lines
    kept = [
        line
        for index, line in enumerate(shown)
        if any(not near.startswith("  ") for near in shown[max(index - 1, 0) : index + 2])
    ]
    return _bounded([*kept, last])


def _lines(golden: str, table: str) -> str:
    """The lines that changed."""
    made = unified_diff(
        golden.splitlines(), table.splitlines(), "expected", "this run", lineterm="", n=1
    )
    return _bounded(list(made)) or "Only line endings differ."


def _bounded(lines: list[str]) -> str:
    more = len(lines) - LONGEST_DIFFERENCE
    kept = [*lines[:LONGEST_DIFFERENCE], *([f"... and {more} more lines"] if more > 0 else [])]
    return "\n".join(kept)
