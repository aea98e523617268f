"""The work that one utterance may cause for an application, and the time that its tags see."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

TIME_LIMIT = 0.5
"""Seconds of processor time that the tags of one utterance may take."""
MOST_MATCHING = 400_000
"""Steps that matching one utterance may take, in all grammars that listen."""


@dataclass(slots=True)
class Budget:
    """What one utterance has taken, in all documents, analyses and grammars of an application."""

    now: int = 0
    """The time that tags see (ms since 1970, UTC)."""
    spent: float = 0.0
    """Seconds of the processor that tags have taken."""
    steps: int = MOST_MATCHING
    """Steps of matching that are left; at or below 0 where the application listens for too much."""

    host: Any = None
    """The process of the application's engine, in which its tags run; if none, one that all share."""

    @property
    def over(self) -> bool:
        """Whether the tags' time was all spent."""
        return self.spent > TIME_LIMIT
