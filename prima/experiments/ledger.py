"""The ledger beside a transcript: the inputs of its run, by which it is known to be up to date."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import fields
from pathlib import Path
from typing import Any

from prima.experiments.plan import LEDGER, TRANSCRIPT, BatchRow, Job, Options
from prima.version import __version__

MOST_LEDGER = 1_000_000
"""Maximum length of a ledger (characters)."""
FROM_JOB = frozenset({"scenario", "transcript", "earlier", "full"})
"""The fields of a row that follow from its job."""
KEPT = tuple(one.name for one in fields(BatchRow) if one.name not in FROM_JOB)
"""The others, which a ledger keeps."""


class InputDigests:
    """Records the digest of every file that a run reads; provides none itself."""

    folder = ""

    def __init__(self, scenario: str) -> None:
        self.digests: dict[str, str | None] = {}
        """By paths from the scenario's folder; None if there is no such file."""
        self._beside = os.path.dirname(os.path.abspath(scenario))

    def text(self, path: Path) -> None:
        """Record a file that is read."""
        name = os.path.relpath(path, self._beside)
        if name not in self.digests:
            self.digests[name] = file_digest(path)

    head = text


def file_digest(path: str | Path) -> str | None:
    """A file's SHA-256, or None if there is no such file."""
    try:
        if not os.path.isfile(path):
            return None
        with open(path, "rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (OSError, ValueError):
        return None


def key_of(options: Options, job: Job) -> dict[str, Any]:
    """The settings that determine a run, apart from its files."""
    return {
        "prima": __version__,
        "scenario": job.scenario,
        "policy": job.policy,
        "bound": options.bound,
        "patience": options.patience,
        "seed": options.seed,
        "hosts": list(options.hosts),
        "limits": dict(options.limits),
    }


def earlier_row(options: Options, job: Job) -> BatchRow | None:
    """The row of the same run in an earlier batch, if its inputs and transcript are unchanged."""
    try:
        with open(f"{job.stem}{LEDGER}", encoding="utf-8") as stream:
            ledger = json.loads(stream.read(MOST_LEDGER))
        folder = os.path.dirname(os.path.abspath(job.scenario))
        inputs: dict[str, str | None] = ledger["inputs"]
        if (
            ledger["key"] != key_of(options, job)
            or any(file_digest(os.path.join(folder, one)) != inputs[one] for one in inputs)
            or file_digest(f"{job.stem}{TRANSCRIPT}") != ledger["transcript"]
        ):
            return None
        kept = {name: ledger["row"][name] for name in KEPT}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    fresh = BatchRow(job.scenario, transcript=f"{job.stem}{TRANSCRIPT}", earlier=True, **kept)
    return fresh if _sound(fresh) else None


def _sound(row: BatchRow) -> bool:
    """Whether a row from a ledger has values of the right types."""
    whole = (
        row.exit,
        row.records,
        row.streams_broken,
        row.collisions,
        row.reactions,
        row.responses,
    )
    measures = (row.reaction_mean, row.reaction_max, row.response_mean, row.response_max)
    times = [one for one in measures if one is not None]
    words = (row.policy, row.ended, *(row.messages if isinstance(row.messages, list) else [0]))
    return (
        all(type(one) is int for one in whole)
        and all(type(one) in (int, float) for one in (row.seconds, *times))
        and all(type(one) is str for one in words)
    )
