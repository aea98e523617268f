"""The facts of a run that a scenario can expect, and when they may happen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from prima.testing.tracing import StateHistory
from prima.transcript.record import Entry
from prima.transcript.row import Row
from prima.transcript.spans import base


@dataclass(slots=True)
class Fact:
    """Something that happened: its number among the facts, its time (ms), and its record."""

    number: int
    time: int
    phase: str
    record: Entry
    request: Entry
    """The request of the Behavior, if there is one."""
    said: str = ""
    """The Behavior's text."""


@dataclass(slots=True)
class Window:
    """When something is expected: from a time (ms) and after a fact, until a time."""

    opens: int = 0
    behind: int = -1
    closes: int | None = None
    ahead: int | None = None
    """The number of the fact before which it must happen."""
    why: str = ""
    """Its beginning, as a phrase."""

    def holds(self, fact: Fact) -> bool:
        """Whether a fact is in the window."""
        return not self.early(fact) and not self.late(fact)

    def early(self, fact: Fact) -> bool:
        """Whether a fact comes before the window."""
        return fact.time < self.opens or fact.number <= self.behind

    def late(self, fact: Fact) -> bool:
        """Whether a fact comes after the window."""
        past = self.closes is not None and fact.time > self.closes
        return past or (self.ahead is not None and fact.number >= self.ahead)


@dataclass(slots=True)
class RunFacts:
    """A run as it is checked: facts, rows, and the states of applications."""

    facts: list[Fact]
    rows: list[Row]
    states: StateHistory
    end: int
    """When it ended (ms)."""
    ended: dict[str, str] = field(default_factory=dict)
    """Why applications ended."""


def make_run(entries: Sequence[Entry], rows: list[Row], states: StateHistory) -> RunFacts:
    """Collect the facts of a run from its records."""
    unloads = [one for one in entries if one.phase == "unload" and one.actor == "mediator"]
    ended = {one.app: one.outcome for one in unloads}
    end = round(entries[-1].time * 1000) if entries else 0
    return RunFacts(list(_facts(entries)), rows, states, end, ended)


def _facts(entries: Iterable[Entry]) -> Iterable[Fact]:
    """The facts that can be expected or waited for: of loops only the first, and no decisions."""
    asked: dict[str, Entry] = {}
    texts: dict[str, str] = {}
    number = 0
    for entry in entries:
        phase, name = entry.phase, base(entry.behavior)
        if phase == "request":
            asked.setdefault(name, entry)
        if phase == "start" and entry.text:
            texts[name] = entry.text
        ended = phase == "end" and entry.outcome != "again"
        gone = phase == "unload" and entry.actor == "mediator"
        first = phase == "start" and entry.first
        if first or ended or gone or phase in ("listening", "event", "log", "send"):
            request = asked.get(name, entry)
            time = round(entry.time * 1000)
            yield Fact(number, time, phase, entry, request, texts.get(name, ""))
            number += 1
