"""PRIMA: two robot applications written as XML documents, mediated into one robot.

The package's functions are imported when used; see :mod:`prima.api`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from prima.version import __version__

if TYPE_CHECKING:
    from typing import Any

    from prima.api import (
        Document,
        DocumentError,
        Loaded,
        Problem,
        RunError,
        Transcript,
        UsageError,
        diff,
        documents_folder,
        explain,
        explain_row,
        export,
        load,
        load_scenario,
        read,
        rehearse,
        replay,
        run_live,
        stage,
        validate,
    )
    from prima.experiments.functions import explore, sweep
    from prima.transcript.diff import Difference

__all__ = [
    "Difference", "Document", "DocumentError", "Loaded", "Problem", "RunError", "Transcript",
    "UsageError", "__version__", "diff", "documents_folder", "explain", "explain_row", "explore",
    "export", "load", "load_scenario", "read", "rehearse", "replay", "run_live", "stage", "sweep",
    "validate",
]  # fmt: skip


ELSEWHERE = {
    "Difference": "prima.transcript.diff",
    "explore": "prima.experiments.functions",
    "sweep": "prima.experiments.functions",
}
"""Modules of names that are not in :mod:`prima.api`."""


def __getattr__(name: str) -> Any:
    if name in __all__:
        from importlib import import_module

        return getattr(import_module(ELSEWHERE.get(name, "prima.api")), name)
    raise AttributeError(f"module 'prima' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
