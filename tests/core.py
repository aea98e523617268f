"""Which core the tests run with: the one in Python, or the compiled one (``make test-core``)."""

from __future__ import annotations

import pytest

from prima.scheduler import mediator

COMPILED = not str(mediator.__file__).endswith(".py")
in_python = pytest.mark.skipif(
    COMPILED, reason="puts something of its own into the core, which only the one in Python allows"
)
