"""Python's cycle collector, slowed down while documents are read and many short runs are made."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

OBJECTS, YOUNG, OLDER = 100_000, 20, 2
"""New objects until a collection, and collections until one of the next older generation.

A document of 2 MB makes up to two million objects, nearly all of which stay: with Python's own
thresholds the work grows faster than the document. A short run makes some
ten thousand, most of which are freed without the collector.
"""


@contextmanager
def seldom_collected() -> Iterator[None]:
    """Collect cycles less often within the context."""
    before = gc.get_threshold()
    if not 0 < before[0] < OBJECTS:  # turned off, or slowed down already
        yield
        return
    gc.set_threshold(OBJECTS, YOUNG, OLDER)
    try:
        yield
    finally:
        gc.set_threshold(*before)
