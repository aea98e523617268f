"""What the checker of invariants finds, for tests of it."""

from __future__ import annotations

from collections.abc import Iterable

from prima.invariants.checker import violations
from prima.invariants.memory import Memory
from prima.invariants.model import GONE, Record
from prima.invariants.table import contradictions, row

ADDED = {
    "dance": row("locomotion neck arm"),
    "spin": row("locomotion"),
    "waltz": row("locomotion localization"),
    "point-by-laser": row("laser"),
}
"""Commands added by the robots of generated runs, and by shipped ones."""


def wrong_additions(records: Iterable[Record]) -> list[str]:
    """Requests of added Commands that differ from those that robots add (for invariant 15)."""
    return [
        f"invariant 15: {one['behavior']} is {one['command']}, but {text}"
        for one in records
        if one["phase"] == "request" and one["command"] in ADDED
        for text in contradictions(one, ADDED)
    ]


def unfinished(records: Iterable[Record], policy: str = "prima") -> list[str]:
    """ABs that are still in working memory after the last record (for invariant 9)."""
    memory = Memory(records, policy)
    violations(memory)
    return [
        f"invariant 9: {ab.shown} of {ab.tree.name} is {ab.phase} at the end"
        for ab in memory.abs.values()
        if ab.phase != GONE
    ]


def numbers(violations: Iterable[str]) -> set[int]:
    """Which invariants are violated."""
    return {int(text.split()[1].rstrip(":")) for text in violations}
