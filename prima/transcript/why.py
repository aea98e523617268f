"""Why a row of the table came where it did, from the records alone."""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from prima.messages import Record
from prima.transcript.table import Row

TOLD = frozenset({"request", "interrupt", "hold", "resume", "starve"})
"""Phases of records that say something of when an AB came."""


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


class Reasons:
    """The records of one run that say why, found by AB; takes time and memory linear in them."""

    def __init__(self, records: Iterable[Record]) -> None:
        self._about: dict[str, list[tuple[float, int, Record]]] = defaultdict(list)
        for index, record in enumerate(records):
            phase = record["phase"]
            if phase == "decision":
                name = record["winner"]  # one of the loops, where there are loops
            elif phase in TOLD or (phase == "start" and record.get("unit")):
                name = _base(record.get("behavior") or "")
            else:
                continue
            self._about[name].append((record["time"], index, record))

    def of(self, row: Row, most: int = 0) -> list[Reason]:
        """What led to a row, in order; with ``most``, of each kind only so many, the latest."""
        base = _base(row.behavior)
        if not base:
            return []
        found: list[tuple[float, int, Record]] = []
        for name in {base, row.behavior, row.unit} - {""}:
            about = self._about.get(name, [])
            end = bisect_right(about, row.time, key=lambda held: held[0])
            found += about[max(end - most, 0) if most else 0 : end]
        found.sort(key=lambda held: held[1])
        made = (_reason(record, row) for _, _, record in found)
        return [reason for reason in made if reason is not None]


def _base(behavior: str) -> str:
    return behavior.partition(".")[0]


def _reason(record: Record, row: Row) -> Reason | None:
    """What a record has to do with when a row came, if it has; or with the unit around it."""
    phase, time, base = record["phase"], record["time"], _base(row.behavior)
    if phase == "decision":
        return _selected(record, row) if record["winner"] in (row.behavior, row.unit) else None
    about = _base(record.get("behavior") or "")
    it = f"the unit {about} is " if about == row.unit else ""
    by, rule = record.get("by") or "", record.get("rule") or ""
    match phase:
        case "request" if record.get("inserted") and not it:
            rule = record["inserted"]
            return Reason(time, f"put in before {record.get('before')} (rule {rule}).", rule)
        case "interrupt":
            way = f"the unit {about} gives way" if it else "it gives way"
            return Reason(time, f"{way} to {by} (rule X2).", "X2", by=by)
        case "request":
            flag = ", reactive" if record.get("reactive") else ""
            asked = f"{it}requested" if it else f"requested as {base}"
            return Reason(time, f"{asked} ({record['priority']} priority{flag}).")
        case "hold":
            return Reason(time, f"{it}held back by {by} (rule {rule}).", rule, by=by)
        case "starve" if not record.get("loop"):
            waited = (record.get("data") or {}).get("waited", 0)
            return Reason(
                time, f"{it}kept waiting by {by} for {waited:g} s (rule {rule}).", rule, by=by
            )
        case "resume":
            stream = f"the stream of {about}" if it else f"its stream {record.get('tree')}"
            return Reason(time, f"{stream} resumes (rule C2).", "C2")
        case "start" if not it:
            return Reason(
                time, f"started inside the unit {record['unit']} (rule {record.get('rule')}).", rule
            )
    return None


def _selected(record: Record, row: Row) -> Reason:
    """The mediator's decision for a row's AB, or for the unit around it."""
    unit = f"the unit {row.unit} is " if record["winner"] == row.unit else ""
    lost, rule = record["losers"], record["rule"]
    names = ", ".join(lost)
    count = record["losers_count"]
    before = (
        f" before {names} ({count} in all)" if names else "; nothing else could start in its place"
    )
    return Reason(
        record["time"], f"{unit}selected by rule {rule}{before}.", rule, lost=tuple(lost[:8])
    )
