"""The first record of a run, and the policy that it names."""

from __future__ import annotations

from collections.abc import Mapping

from prima.errors import UsageError
from prima.language.commands import ABSENCE_MS, PATIENCE_MS
from prima.loading import Loaded, favourite_problem
from prima.messages import Json, Record
from prima.scheduler.policy import Policy, policy_named
from prima.version import __version__


def chosen_policy(name: str, loaded: Loaded) -> Policy:
    """The policy with a name, for the applications of a run.

    Raises:
        UsageError: there is none, or it names a missing application.
    """
    if not isinstance(name, str):
        raise UsageError(f"policy={name!r:.80}: write the name of one policy.")
    chosen = policy_named(name)
    if problem := favourite_problem(name, loaded.cast.documents):
        raise UsageError(f"{problem[0]} {problem[1].text}")
    return chosen


def run_record(
    loaded: Loaded, policy: str, bound: int | None, patience: int, more: Mapping[str, Json] = {}
) -> Record:
    """The first record of a run: everything needed to run it again.

    Args:
        loaded: what is run.
        policy: the policy's name.
        bound: rule E4's bound on loops.
        patience: rule E6's bound (ms).
        more: further data.
    """
    cast = loaded.cast
    absence = cast.robot.absence
    return {
        "time": 0,
        "phase": "run",
        "actor": "mediator",
        "data": {
            "version": __version__,
            "scenario": cast.scenario.id,
            "policy": policy,
            "bound": bound,
            **({} if absence == ABSENCE_MS else {"absence": absence / 1000}),
            **({} if patience == PATIENCE_MS else {"patience": patience / 1000}),
            **({"seed": cast.scenario.seed} if cast.scenario.drawn else {}),
            "date": cast.scenario.date,
            "applications": [doc.id for doc in cast.documents],
            "files": loaded.files,
            **more,
        },
    }


def check_files(head: Record, loaded: Loaded, name: str) -> None:
    """Check that files are those that a transcript was made with.

    Args:
        head: its first record.
        loaded: what was loaded to run it again.
        name: the transcript's.

    Raises:
        UsageError: a file differs or is missing.
    """
    files = head["data"].get("files", {})
    for file, digest in files.items():
        if file in loaded.files and loaded.files[file] != digest:
            raise UsageError(f"{file} is not the file that the transcript was made with.")
        if file not in loaded.files and digest not in loaded.files.values():
            message = f'it was made with "{file}", which is not a file of this run, or has changed.'
            raise UsageError(f"{name}: {message}")
