"""The reasons for the time of a row of the table."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass

from prima.errors.visible import visible
from prima.transcript.record import Entry
from prima.transcript.row import Row
from prima.transcript.rules import RULES
from prima.transcript.run import Run
from prima.transcript.spans import base


@dataclass(frozen=True, slots=True)
class Reason:
    """One reason for the time of a row: when it arose (s), and a sentence."""

    time: float
    text: str
    rule: str = ""
    lost: tuple[str, ...] = ()
    """The first eight ABs that were not selected."""
    by: str = ""
    """The AB or stream that held it back, or that it gave way to."""


def reasons(run: Run, row: Row, most: int = 0) -> list[Reason]:
    """The reasons for a row, in order; with ``most``, only the latest ones of each kind."""
    found = _recorded(run, row, most)
    if row.rule and all(one.rule != row.rule for one in found):  # of an end, which needs none
        meaning = RULES.get(row.rule)
        found.append(Reason(row.time, f"rule {row.rule}" + (f": {meaning}." if meaning else ".")))
    return found


def _recorded(run: Run, row: Row, most: int) -> list[Reason]:
    """The reasons that records about a row's AB or its unit give."""
    name = base(row.behavior)
    if not name:
        return []
    found: list[tuple[int, Entry]] = []
    for one in {name, row.behavior, row.unit} - {""}:
        about = run.about.get(one, [])
        end = bisect_right(about, row.time, key=lambda held: held[1].time)
        found += about[max(end - most, 0) if most else 0 : end]
    found.sort(key=lambda held: held[0])
    made = (_reason(entry, row) for _, entry in found)
    return [reason for reason in made if reason is not None]


def explained(run: Run, row: Row) -> list[str]:
    """A row and its reasons, as lines."""
    lines = [f"Row {row.number}, {row.time:.3f} s: " + " ".join(filter(None, (row.app, row.what)))]
    if row.source:
        lines.append(f"Requested at {row.source}.")
    if text := origin(row):
        lines.append(text)
    lines += [f"{reason.time:.3f} s: {reason.text}" for reason in reasons(run, row)]
    return [visible(line) for line in lines]


def origin(row: Row) -> str:
    """Where an event came from whose time no rule decided; empty for what the robot does."""
    if row.actor == "R":
        return ""
    source = f"{row.app} raised it itself" if row.own else "It came from outside"
    return f"{source}; no rule decided its time."


def _reason(entry: Entry, row: Row) -> Reason | None:
    """The reason that an entry is for the time of a row, or of the unit around it."""
    if entry.phase == "decision":
        return _selected(entry, row) if entry.winner in (row.behavior, row.unit) else None
    make = REASONS.get(entry.phase)
    return make(entry, row, base(entry.behavior) == row.unit) if make else None


def _requested(entry: Entry, row: Row, unit: bool) -> Reason:
    if entry.inserted and not unit:
        text = f"put in before {entry.before} (rule {entry.inserted})."
        return Reason(entry.time, text, entry.inserted)
    flag = ", reactive" if entry.reactive else ""
    asked = f"{_it(entry, unit)}requested" if unit else f"requested as {base(row.behavior)}"
    return Reason(entry.time, f"{asked} ({entry.priority} priority{flag}).")


def _interrupted(entry: Entry, _: Row, unit: bool) -> Reason:
    way = f"the unit {base(entry.behavior)} gives way" if unit else "it gives way"
    return Reason(entry.time, f"{way} to {entry.by} (rule X2).", "X2", by=entry.by)


def _held(entry: Entry, _: Row, unit: bool) -> Reason:
    text = f"{_it(entry, unit)}held back by {entry.by} (rule {entry.rule})."
    return Reason(entry.time, text, entry.rule, by=entry.by)


def _starved(entry: Entry, _: Row, unit: bool) -> Reason | None:
    if entry.loop:
        return None
    waited = f"{entry.data.get('waited', 0):g} s"
    text = f"{_it(entry, unit)}kept waiting by {entry.by} for {waited} (rule {entry.rule})."
    return Reason(entry.time, text, entry.rule, by=entry.by)


def _resumed(entry: Entry, _: Row, unit: bool) -> Reason:
    stream = f"the stream of {base(entry.behavior)}" if unit else f"its stream {entry.tree}"
    return Reason(entry.time, f"{stream} resumes (rule C2).", "C2")


def _started(entry: Entry, _: Row, unit: bool) -> Reason | None:
    if unit:
        return None
    text = f"started inside the unit {entry.unit} (rule {entry.rule})."
    return Reason(entry.time, text, entry.rule)


def _it(entry: Entry, unit: bool) -> str:
    return f"the unit {base(entry.behavior)} is " if unit else ""


REASONS: dict[str, Callable[[Entry, Row, bool], Reason | None]] = {
    "request": _requested,
    "interrupt": _interrupted,
    "hold": _held,
    "starve": _starved,
    "resume": _resumed,
    "start": _started,
}
"""Sentences about a row, or about the unit around it, by the phases of records."""


def _selected(entry: Entry, row: Row) -> Reason:
    """The mediator's decision for a row's AB, or for the unit around it."""
    unit = f"the unit {row.unit} is " if entry.winner == row.unit else ""
    lost, rule = tuple(entry.losers), entry.rule
    names = ", ".join(lost)
    count = entry.losers_count
    before = (
        f" before {names} ({count} in all)" if names else "; nothing else could start in its place"
    )
    return Reason(entry.time, f"{unit}selected by rule {rule}{before}.", rule, lost=lost[:8])
