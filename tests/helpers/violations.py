"""What the checker of invariants finds, for tests of it."""

from __future__ import annotations

from collections.abc import Iterable

from prima.invariants.checker import Checker
from prima.invariants.model import GONE, Record


def unfinished(records: Iterable[Record], policy: str = "prima") -> list[str]:
    """ABs that are still in working memory after the last record (for invariant 9)."""
    checker = Checker(records, policy)
    checker.run()
    return [
        f"invariant 9: {ab.shown} of {ab.tree.name} is {ab.phase} at the end"
        for ab in checker.abs.values()
        if ab.phase != GONE
    ]


def numbers(violations: Iterable[str]) -> set[int]:
    """Which invariants are violated."""
    return {int(text.split()[1].rstrip(":")) for text in violations}
