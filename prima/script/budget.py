"""How much time the tags of one utterance may take, and what time it is for them."""

from __future__ import annotations

from prima.deferred import dataclass

TIME_LIMIT = 0.5
"""Seconds of processor time that the tags of one utterance may take."""


@dataclass(slots=True)
class Budget:
    """The time that the tags of one utterance have taken, in all documents and analyses."""

    now: int = 0
    """The time that they are told (ms since 1970, UTC)."""
    spent: float = 0.0

    @property
    def over(self) -> bool:
        """Whether it was all spent."""
        return self.spent > TIME_LIMIT
