"""The compiled core, as ``make core`` builds it."""

from __future__ import annotations

import sys

from bench.fresh import ROOT, check

FOLDER = ROOT / "build" / "core"
SUFFIXES = (".so", ".pyd")


def built() -> bool:
    """Whether a core is there, and is made of the Python files that are here now."""
    made = FOLDER / "prima"
    if not any(path.suffix in SUFFIXES for path in (made / "scheduler").glob("mediator.*")):
        return False
    source = ROOT / "prima"
    pairs = [(made / path.relative_to(source), path) for path in source.rglob("*.py")]
    return all(one.exists() and one.read_bytes() == path.read_bytes() for one, path in pairs)


def use() -> None:
    """Let this process import PRIMA with the compiled core.

    Raises:
        WrongAnswer: it has the one in Python.
    """
    sys.path.insert(0, str(FOLDER))
    from prima.scheduler import mediator

    check(str(mediator.__file__).endswith(SUFFIXES), f"the core is not compiled: {mediator}")
