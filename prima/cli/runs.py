"""Runs for a command: a transcript, or a scenario that is run first."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

from prima.cli.printing import tell_line
from prima.errors import UsageError

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded


class GivenRun(NamedTuple):
    """A transcript, and the scenario that was run for it, if any."""

    transcript: Transcript
    scenario: Loaded | None


def is_markup(path: str) -> bool:
    """Whether a file is XML, by its name and its beginning."""
    if path.endswith(".jsonl") or not os.path.isfile(path):
        return False  # what a pipe gives can be read once
    try:
        with open(path, "rb") as stream:
            return stream.read(64).removeprefix(b"\xef\xbb\xbf").lstrip()[:1] == b"<"
    except (OSError, ValueError):
        return False


def tell_failures(transcripts: Iterable[Transcript]) -> bool:
    """Print what failed in runs, each message once; whether anything did.

    Raises:
        Exception: a defect of PRIMA that ended an application, with ``PRIMA_DEBUG``.
    """
    made = list(transcripts)
    defects = [defect for one in made for defect in one.defects]
    if defects and "PRIMA_DEBUG" in os.environ:
        raise defects[0]
    failures = dict.fromkeys(failure for one in made for failure in one.failures)
    if failures:
        from prima.experiments.batch import told_failure

        for failure in failures:
            tell_line(f"prima: {told_failure(failure)}")
    return bool(failures)


def run_of(path: str, policy: str | None = None, whole: bool = True) -> GivenRun:
    """A transcript, or that of a scenario's run.

    Args:
        path: a transcript or a scenario.
        policy: replaces the scenario's own.
        whole: read all records of a transcript, not only those that a diff needs.

    Raises:
        DocumentError: the scenario is wrong.
        RunError: the run ended by a limit.
        UsageError: it cannot be read, or a transcript is to be run under a policy.
    """
    from prima import api
    from prima.errors import TOO_MUCH, RunError

    if not is_markup(path):
        found = api.read(path, partial=True) if whole else api.skim(path)
        if policy is not None:
            raise UsageError(f"{path}: --policy works only with a scenario; this is a transcript.")
        return GivenRun(found, None)
    loaded = api.load_scenario(path)
    made = api.rehearse(loaded, policy)
    made.name = f"{path} ({policy})" if policy else path
    if made.outcome == "limit":
        raise RunError(f"{path}: {TOO_MUCH}")
    return GivenRun(made, loaded)
