"""Runs that a command is given: as a transcript, or as a scenario that is run for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from prima.errors import UsageError

if TYPE_CHECKING:
    from prima.api import Transcript
    from prima.loading import Loaded


class Run(NamedTuple):
    """A transcript, and the scenario that was run for it, if one was."""

    transcript: Transcript
    scenario: Loaded | None


def is_markup(path: str) -> bool:
    """Whether a file is XML, as far as its name and its beginning tell."""
    if path.endswith(".jsonl"):
        return False
    try:
        with open(path, "rb") as stream:
            return stream.read(64).removeprefix(b"\xef\xbb\xbf").lstrip()[:1] == b"<"
    except (OSError, ValueError):
        return False


def run_of(path: str, policy: str | None = None, whole: bool = True) -> Run:
    """A transcript, or that of a scenario's run.

    Args:
        path: a transcript or a scenario.
        policy: what a scenario is run under in place of its own.
        whole: whether all records of a transcript are read, or what is compared of it.

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
            raise UsageError(f"{path}: --policy runs a scenario, and this is a transcript.")
        return Run(found, None)
    loaded = api.load_scenario(path)
    made = api.rehearse(loaded, policy)
    made.name = f"{path} ({policy})" if policy else path
    if made.outcome == "limit":
        raise RunError(f"{path}: {TOO_MUCH}")
    return Run(made, loaded)
