"""The rows of a batch, as text and as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from prima.experiments.plan import BatchRow
from prima.transcript.criteria import shown_time

COLUMNS = (
    ("scenario", 8),
    ("policy", 8),
    ("exit", 4),
    ("ended", 5),
    ("records", 7),
    ("seconds", 8),
    ("broken", 6),
    ("reactions", 9),
    ("mean s", 6),
    ("responses", 9),
    ("mean s", 6),
)
"""Headings and least widths."""


def row_data(row: BatchRow) -> dict[str, Any]:
    """A row as data for JSON; it does not depend on when or how the run was made."""
    data = asdict(row)
    del data["earlier"], data["full"]
    return data


def format_head(wide: Sequence[int]) -> str:
    """The headings, with columns of these widths at least for scenarios and policies."""
    return _line([head for head, _ in COLUMNS], wide)


def format_row(row: BatchRow, wide: Sequence[int]) -> str:
    """A row of the table."""
    cells = [row.scenario, row.policy or "-", str(row.exit), row.ended or "-"]
    if row.ended is None:
        return _line(cells, wide)
    cells += [str(row.records), f"{row.seconds:.2f}", str(row.streams_broken)]
    cells += [str(row.reactions), shown_time(row.reaction_mean)]
    return _line([*cells, str(row.responses), shown_time(row.response_mean)], wide)


def _line(cells: list[str], wide: Sequence[int]) -> str:
    least = [width for _, width in COLUMNS]
    widths = [*map(max, wide, least), *least[len(wide) :]]
    return "  ".join(
        cell.ljust(width) if index in (0, 1, 3) else cell.rjust(width)
        for index, (cell, width) in enumerate(zip(cells, widths, strict=False))
    ).rstrip()


def format_counts(exits: Mapping[int, int]) -> str:
    """The number of runs for each exit code."""
    parts = [f"runs: {sum(exits.values())}", f"fine: {exits.get(0, 0)}"]
    return "; ".join(parts + [f"exit code {one}: {exits[one]}" for one in sorted(exits) if one])
