"""The package's functions: load, validate, rehearse, read, replay, diff, explain.

The command line does nothing beyond these functions. They open files;
everything below them works on text and values.
"""

from __future__ import annotations

from prima.api.live import replay, run_live
from prima.api.rehearsing import Sink, rehearse
from prima.api.transcripts import Transcript, read, skim
from prima.api.views import diff, explain, explain_row, export
from prima.errors import DocumentError, Problem, RunError, UsageError
from prima.interpreter.elements import Document
from prima.loading import Loaded, documents_folder, load, load_scenario, stage, validate

__all__ = [
    "Document", "DocumentError", "Loaded", "Problem", "RunError", "Sink", "Transcript",
    "UsageError", "diff", "documents_folder", "explain", "explain_row", "export", "load", "load_scenario",
    "read", "rehearse", "replay", "run_live", "skim", "stage", "validate",
]  # fmt: skip
