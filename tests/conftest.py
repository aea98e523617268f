"""What holds for all tests."""

from __future__ import annotations

import gc


def pytest_collection_finish() -> None:
    """Leave the tests themselves, 11,000, out of every search for garbage that they make."""
    gc.collect()
    gc.freeze()
