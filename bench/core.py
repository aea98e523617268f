"""The compiled core, as ``make core`` builds it."""

from __future__ import annotations

import sys

from bench.fresh import ROOT, check

FOLDER = ROOT / "build" / "core"
SUFFIXES = (".so", ".pyd")


def built() -> bool:
    """Whether a core is there, and is made of the Python files that are here now."""
    made = FOLDER / "prima" / "scheduler"
    sources = [*(ROOT / "prima" / "scheduler").glob("*.py")]
    return any(path.suffix in SUFFIXES for path in made.glob("mediator.*")) and all(
        (made / path.name).read_bytes() == path.read_bytes() for path in sources
    )


def use() -> None:
    """Let this process import PRIMA with the compiled core.

    Raises:
        WrongAnswer: it has the one in Python.
    """
    sys.path.insert(0, str(FOLDER))
    from prima.scheduler import mediator

    check(str(mediator.__file__).endswith(SUFFIXES), f"the core is not compiled: {mediator}")
