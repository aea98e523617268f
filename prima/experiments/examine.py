"""Examines runs: when something happened, and what is wrong."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from prima import api
from prima.experiments.scenariotext import Variant
from prima.experiments.variants import Made, Stage, failed_expectations
from prima.invariants import callers, check
from prima.loading import Loaded

OUTSIDE = ("user", "environment")
"""Actors whose records are events of a scenario."""
EXCLUSIVE = "invariant 1 "
"""No device has two tasks: the invariant that the policy none does not keep."""


class Finding(NamedTuple):
    """Something wrong with a run: ``error``, ``expect``, ``invariant`` or ``endless``."""

    kind: str
    where: str
    """The part that is the same in all runs with this finding."""
    text: str


@dataclass(slots=True)
class Seen(Made):
    """The result of a run, with the data that an exploration needs."""

    found: list[Finding] = field(default_factory=list)
    times: list[int] = field(default_factory=list)
    """The time of each record (ms)."""
    outside: list[int] = field(default_factory=list)
    """The indices, among these, of records of the scenario's events."""


class Examiner(Stage):
    """Makes and examines runs."""

    def _run(self, variant: Variant) -> Seen:
        loaded = self.loaded(variant)
        transcript = self.rehearsed(variant, loaded, keep=True)
        made = self.made(loaded, transcript)
        records = transcript.records
        return Seen(
            made.exit,
            made.ended,
            made.failures,
            made.expects_failed,
            made.order,
            {},
            list(_findings(variant, loaded, transcript)),
            [round(record["time"] * 1000) for record in records],
            [
                number
                for number, record in enumerate(records)
                if record.get("inbound") and record["actor"] in OUTSIDE
            ],
        )


def _findings(variant: Variant, loaded: Loaded, transcript: api.Transcript) -> Iterator[Finding]:
    policy = variant.policy or loaded.cast.scenario.policy
    for failure in transcript.failures:
        yield Finding("error", failure, failure)
    if transcript.outcome == "limit":
        yield Finding("endless", "", "the run exceeds a limit")
    for failed in failed_expectations(loaded, transcript):
        where = f"{failed.place.file}:{failed.place.line}"
        yield Finding("expect", where, f"{where}: {failed.message}")
    for broken in check(transcript.records, policy, calling=callers(loaded.cast.documents)):
        if not (policy == "none" and broken.startswith(EXCLUSIVE)):
            yield Finding("invariant", broken.partition(" at ")[0], broken)
