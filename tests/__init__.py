"""The tests: a folder for each room of the package, and some beside them (`tests/house`)."""

from pathlib import Path

import pytest
from hypothesis import settings

ROOT = Path(__file__).resolve().parent.parent
"""The checkout."""

pytest.register_assert_rewrite("tests.helpers")
settings.register_profile("untimed", deadline=None)  # a busy machine is not a fault
settings.load_profile("untimed")
