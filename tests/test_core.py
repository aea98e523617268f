"""The tests run with the core that they are said to run with."""

from __future__ import annotations

import os

from tests.core import COMPILED


def test_the_core_is_the_one_asked_for() -> None:
    """A compiled module that is left in a checkout would hide its source."""
    assert (os.environ.get("PRIMA_CORE") == "compiled") is COMPILED
