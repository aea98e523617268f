"""The tests: a folder for each room of the package, and some beside them (`tests/house`)."""

from pathlib import Path

from hypothesis import settings

ROOT = Path(__file__).resolve().parent.parent
"""The checkout."""

settings.register_profile("untimed", deadline=None)  # a busy machine is no fault
settings.load_profile("untimed")
