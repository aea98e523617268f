"""Expected transcripts: the table beside a scenario, compared with that of a run."""

from __future__ import annotations

from difflib import unified_diff
from pathlib import Path

from prima.errors import DocumentError, UsageError
from prima.loading.files import read_file
from prima.loading.writing import write_whole
from prima.transcript.diff import Difference, compare, format_difference
from prima.transcript.table import Row, format_rows, read_table, width

LONGEST_DIFFERENCE = 200
"""Lines of a difference that are shown."""


def golden_of(scenario: Path) -> Path:
    """Where a scenario's expected table is: beside it, with the name's end ``.txt``."""
    return scenario.with_suffix(".txt")


def read_golden(path: Path) -> str | None:
    """The expected table, or None where there is none.

    Raises:
        UsageError: it cannot be read, or is no text.
    """
    if not path.exists():
        return None
    try:
        return read_file(path).decode("utf-8-sig").replace("\r\n", "\n")
    except (DocumentError, UnicodeDecodeError):
        raise UsageError(f"{path}: this is no transcript's table: it is not UTF-8.") from None


def difference(golden: str, run: list[Row], by: str) -> str:
    """How a run's table differs from the expected one; empty where it does not.

    How wide the expected table is does not matter: the run's is made as wide.

    Args:
        golden: the expected table.
        run: the run's rows.
        by: ``text``, or ``behavior``: times may then be off by less than half a second.
    """
    table = format_rows(run, columns=width(golden.partition("\n")[0]))
    if golden == table:
        return ""
    try:
        rows = compare(read_table(golden), read_table(table))
    except (ValueError, IndexError):
        return _lines(golden, table)  # what is expected is no table
    if rows.differs:
        return _changed(rows)
    return "" if by == "behavior" else _lines(golden, table)


def _changed(rows: Difference) -> str:
    """The rows that changed, with what stands around them."""
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
    return _bounded(list(made)) or "They differ in their line ends alone."


def _bounded(lines: list[str]) -> str:
    more = len(lines) - LONGEST_DIFFERENCE
    kept = [*lines[:LONGEST_DIFFERENCE], *([f"... and {more} lines more"] if more > 0 else [])]
    return "\n".join(kept)


def write_golden(path: Path, table: str) -> None:
    """Write a table to be expected from now on.

    Raises:
        UsageError: it cannot be written.
    """
    write_whole(path, table)
