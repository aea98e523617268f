"""Python's collector of cycles while a document is read: it looks at all objects again and again."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

OBJECTS, YOUNG, OLDER = 100_000, 20, 2
"""Objects after which it looks at the new ones, and how often it does before it looks at older ones.

A document of 2 MB makes up to two million objects, nearly all of which stay: with Python's own
thresholds the work grows faster than the document.
"""


@contextmanager
def seldom_collected() -> Iterator[None]:
    """Let the collector look less often, as long as a document is read and checked."""
    before = gc.get_threshold()
    if not 0 < before[0] < OBJECTS:  # somebody has turned it off, or this has been done
        yield
        return
    gc.set_threshold(OBJECTS, YOUNG, OLDER)
    try:
        yield
    finally:
        gc.set_threshold(*before)
