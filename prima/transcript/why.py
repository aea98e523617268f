"""Why a row of the table came where it did."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

from prima.transcript.record import Entry
from prima.transcript.run import Run
from prima.transcript.spans import base
from prima.transcript.table import Row


@dataclass(frozen=True, slots=True)
class Reason:
    """One thing that had to do with when a row came: its time (s), and what it was."""

    time: float
    text: str
    rule: str = ""
    lost: tuple[str, ...] = ()
    """ABs that were not selected: the first eight."""
    by: str = ""
    """The AB or stream that held it back, or that it gave way to."""


def reasons(run: Run, row: Row, most: int = 0) -> list[Reason]:
    """What led to a row, in order; with ``most``, of each kind only so many, the latest."""
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


def told(run: Run, row: Row) -> list[str]:
    """A row with what led to it, in lines."""
    lines = [f"Row {row.number}, {row.time:.3f} s: " + " ".join(filter(None, (row.app, row.what)))]
    if row.source:
        lines.append(f"Requested at {row.source}.")
    if row.actor != "R":
        lines.append("It came from outside; no rule decided when.")
    return lines + [f"{reason.time:.3f} s: {reason.text}" for reason in reasons(run, row)]


def _reason(entry: Entry, row: Row) -> Reason | None:
    """What an entry has to do with when a row came, if it has; or with the unit around it."""
    phase, time = entry.phase, entry.time
    if phase == "decision":
        return _selected(entry, row) if entry.winner in (row.behavior, row.unit) else None
    about = base(entry.behavior)
    it = f"the unit {about} is " if about == row.unit else ""
    by, rule = entry.by, entry.rule
    match phase:
        case "request" if entry.inserted and not it:
            rule = entry.inserted
            return Reason(time, f"put in before {entry.before} (rule {rule}).", rule)
        case "interrupt":
            way = f"the unit {about} gives way" if it else "it gives way"
            return Reason(time, f"{way} to {by} (rule X2).", "X2", by=by)
        case "request":
            flag = ", reactive" if entry.reactive else ""
            asked = f"{it}requested" if it else f"requested as {base(row.behavior)}"
            return Reason(time, f"{asked} ({entry.priority} priority{flag}).")
        case "hold":
            return Reason(time, f"{it}held back by {by} (rule {rule}).", rule, by=by)
        case "starve" if not entry.loop:
            waited = entry.data.get("waited", 0)
            return Reason(
                time, f"{it}kept waiting by {by} for {waited:g} s (rule {rule}).", rule, by=by
            )
        case "resume":
            stream = f"the stream of {about}" if it else f"its stream {entry.tree}"
            return Reason(time, f"{stream} resumes (rule C2).", "C2")
        case "start" if not it:
            return Reason(time, f"started inside the unit {entry.unit} (rule {entry.rule}).", rule)
    return None


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
