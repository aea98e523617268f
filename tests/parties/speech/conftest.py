"""The environment of the speech driver, for its tests."""

from __future__ import annotations

import pytest

from tools.environments import install, python_of


@pytest.fixture(scope="module")
def python() -> str:
    install("speech")
    return str(python_of("speech"))
