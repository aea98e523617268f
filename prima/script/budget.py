"""The budget for one utterance to an application, and the time that its tags see."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

TIME_LIMIT = 0.5
"""Seconds of processor time that the tags of one utterance may take."""
MOST_MATCHING = 400_000
"""Maximum number of steps to match one utterance, in all active grammars."""


@dataclass(slots=True)
class Budget:
    """The work spent on one utterance in all documents, analyses and grammars."""

    now: int = 0
    """The time that tags see (ms since 1970, UTC)."""
    spent: float = 0.0
    """Seconds of processor time that tags have taken."""
    steps: int = MOST_MATCHING
    """Steps of matching that are left; 0 or less if the application listens for too much."""

    host: Any = None
    """The process of the application's engine, in which its tags run; by default a shared one."""

    @property
    def over(self) -> bool:
        """Whether the tags' time was all spent."""
        return self.spent > TIME_LIMIT
