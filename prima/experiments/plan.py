"""The plan of a batch: which runs it makes, and their rows."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from prima.errors import UsageError
from prima.experiments.settings import ExperimentSettings

TRANSCRIPT, LEDGER = ".jsonl", ".run.json"
"""Suffixes of a run's files."""


@dataclass(slots=True)
class BatchRow:
    """The result of one run."""

    scenario: str
    policy: str | None
    """None if none is named and the scenario cannot be read."""
    exit: int = 0
    """0 fine; 1 documents have errors; 2 unreadable or unwritable; 3 an error or a limit."""
    ended: str | None = None
    """How the run ended: ``over``, ``quiet``, ``until`` or ``limit``; None if it did not."""
    records: int = 0
    seconds: float = 0.0
    streams_broken: int = 0
    collisions: int = 0
    reactions: int = 0
    reaction_mean: float | None = None
    reaction_max: float | None = None
    responses: int = 0
    response_mean: float | None = None
    response_max: float | None = None
    transcript: str | None = None
    messages: list[str] = field(default_factory=list)
    """Problems and errors."""
    earlier: bool = False
    """Whether the run was made by an earlier batch."""
    full: bool = False
    """Whether nothing more can be written."""


@dataclass(frozen=True, slots=True)
class Job:
    """A run to make: a scenario, a policy (None for its own), its files without suffix."""

    scenario: str
    policy: str | None
    stem: str = ""


@dataclass(frozen=True, slots=True)
class Options(ExperimentSettings):
    """Options shared by all runs of a batch."""

    resume: bool = False
    parts: str = ""
    """The folder for unfinished transcripts."""


class BatchPlan(Iterable[Job]):
    """The runs of a batch: each scenario under each policy, in order."""

    def __init__(
        self, paths: Iterable[str], policies: Iterable[str] = (), output: str = ""
    ) -> None:
        """Plan a batch.

        Args:
            paths: scenarios, and folders of scenarios.
            policies: policies; by default each scenario's own.
            output: the folder for the transcripts, if they are written.

        Raises:
            UsageError: a policy is unknown, a folder has no scenario, or two
                transcripts would have the same name.
        """
        self.policies: list[str | None] = list(dict.fromkeys(policies)) or [None]
        self.output = output
        _check_policies(self.policies)
        self.scenarios = _gathered(paths)
        if output:
            self._check_names()

    def __len__(self) -> int:
        return len(self.scenarios) * len(self.policies)

    def __iter__(self) -> Iterator[Job]:
        for scenario in self.scenarios:
            for policy in self.policies:
                yield Job(scenario, policy, self._stem(scenario, policy))

    def _stem(self, scenario: str, policy: str | None) -> str:
        """The path of a run's files, without suffix."""
        if not self.output:
            return ""
        stem = os.path.join(self.output, stem_of(scenario))
        return stem if policy is None else stem + re.sub(r"[^\w+.-]", "-", f".{policy}")

    def _check_names(self) -> None:
        taken: dict[str, str] = {}
        for scenario in self.scenarios:
            other = taken.setdefault(stem_of(scenario), scenario)
            if other != scenario:
                name = os.path.join(self.output, stem_of(scenario))
                raise UsageError(
                    f"{scenario}: its transcript has the same name as that of {other}, {name}{TRANSCRIPT}."
                    " Run one of them with another folder after -o."
                )


def stem_of(scenario: str) -> str:
    """The path of a scenario's transcript in the output folder, without suffix.

    It is the scenario's path from the current folder, or else from the file system's root.
    """
    path, here = os.path.abspath(scenario), os.getcwd()
    with suppress(ValueError):  # on different drives
        if os.path.commonpath([path, here]) == here:
            path = os.path.relpath(path, here)
    return os.path.splitext(os.path.splitdrive(path)[1].lstrip(os.sep))[0]


def _check_policies(policies: Sequence[str | None]) -> None:
    from prima.scheduler.policy import policy_named

    for policy in policies:
        if policy is not None:
            policy_named(policy)


def _gathered(paths: Iterable[str]) -> list[str]:
    """The scenarios named, and those in folders named; each file once."""
    found: dict[str, str] = {}
    for path in paths:
        inside = [path]
        if os.path.isdir(path):
            from prima.testing.finding import find

            inside = find([path])
        for one in inside:
            found.setdefault(os.path.realpath(one), os.path.normpath(one))
    return list(found.values())
