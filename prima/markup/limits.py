"""How much of a stranger's document is read; whoever runs the program may raise it."""

from __future__ import annotations

from dataclasses import dataclass

from prima.errors import MOST_TOLD


@dataclass(slots=True)
class Limits:
    """Limits on one document. Beyond one of them a document is refused."""

    bytes: int = 2_000_000
    elements: int = 200_000
    attributes: int = 64
    """Of one element."""
    depth: int = 100
    """Elements inside each other."""
    problems: int = MOST_TOLD
    """Problems listed; the others are counted. No document is refused for them."""


HIGHEST = Limits(1_000_000_000, 20_000_000, 10_000, 200, 20_000_000)
"""As far as the limits can be raised: beyond, the machine itself gives in."""
LIMITS = Limits()
"""The limits of this process."""
