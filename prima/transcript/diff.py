"""Compares two transcripts by behaviour, not by line."""

from __future__ import annotations

import json
from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Literal

from prima.errors import brief
from prima.errors.visible import escaped, visible
from prima.transcript.criteria import shown_times
from prima.transcript.measures import Summary
from prima.transcript.row import Row
from prima.transcript.table import LONGEST_SHOWN

DELAY = 0.5
"""Seconds by which a behaviour must be delayed more than its predecessors to count."""

Kind = Literal["same", "moved", "added", "lost", "split", "joined", "changed", "delayed"]
MARKS: dict[Kind, str] = {
    "same": " ",
    "moved": ">",
    "added": "+",
    "lost": "-",
    "split": "/",
    "joined": "\\",
    "changed": "~",
    "delayed": "t",
}


@dataclass(slots=True)
class Change:
    """One row of a diff: the rows compared (None if missing) and what changed."""

    kind: Kind
    before: Row | None
    after: Row | None
    delay: float = 0.0


@dataclass(slots=True)
class Difference:
    """A whole diff, in the order of the second transcript."""

    changes: list[Change] = field(default_factory=list)
    """All rows of both transcripts, also those that are the same."""
    before: Summary | None = None
    """The measures of the first transcript."""
    after: Summary | None = None
    """The measures of the second."""

    @property
    def counts(self) -> dict[str, int]:
        """How many rows changed in each way."""
        counts: dict[str, int] = {kind: 0 for kind in MARKS if kind != "same"}
        for change in self.changes:
            if change.kind != "same":
                counts[change.kind] += 1
        return counts

    @property
    def differs(self) -> bool:
        """Whether anything changed at all."""
        return any(change.kind != "same" for change in self.changes)


def compare(before: Sequence[Row], after: Sequence[Row]) -> Difference:
    """Align two transcripts' rows: the n-th occurrence of the same behaviour is the same row.

    Of the matched rows the longest sequence that keeps its order is unmoved;
    time is O(n log n), memory linear.
    """
    pairs, lost, added = _match(before, after)
    unmoved = _longest_increasing([j for _, j in pairs])
    changed = _pair_changed(before, after, lost, added)
    kinds: dict[int, Change] = {}
    shift = 0.0
    for position, (i, j) in enumerate(pairs):
        if position not in unmoved:
            kinds[j] = Change("moved", before[i], after[j])
            continue
        delay = round(after[j].time - before[i].time - shift, 3)
        shift += delay
        kind: Kind = "delayed" if abs(delay) >= DELAY else "same"
        kinds[j] = Change(kind, before[i], after[j], delay)
    for i, j in changed:
        kinds[j] = Change("changed", before[i], after[j])
    for j in added:
        if j not in kinds:
            kinds[j] = Change("split" if after[j].resumed else "added", None, after[j])
    gone = sorted(set(lost) - {i for i, _ in changed})
    return Difference(_interleave(before, after, kinds, gone, pairs))


def _match(
    before: Sequence[Row], after: Sequence[Row]
) -> tuple[list[tuple[int, int]], list[int], list[int]]:
    places: dict[object, list[int]] = defaultdict(list)
    for j, row in enumerate(after):
        places[row.key].append(j)
    for held in places.values():
        held.reverse()
    pairs: list[tuple[int, int]] = []
    lost: list[int] = []
    for i, row in enumerate(before):
        held = places.get(row.key) or []
        if held:
            pairs.append((i, held.pop()))
        else:
            lost.append(i)
    matched = {j for _, j in pairs}
    return pairs, lost, [j for j in range(len(after)) if j not in matched]


def _longest_increasing(values: list[int]) -> set[int]:
    """Positions of a longest increasing subsequence (patience sorting)."""
    tails: list[int] = []
    tops: list[int] = []
    before = [-1] * len(values)
    for position, value in enumerate(values):
        pile = bisect_left(tails, value)
        if pile == len(tails):
            tails.append(value)
            tops.append(position)
        else:
            tails[pile] = value
            tops[pile] = position
        before[position] = tops[pile - 1] if pile else -1
    chosen: set[int] = set()
    position = tops[-1] if tops else -1
    while position >= 0:
        chosen.add(position)
        position = before[position]
    return chosen


def _pair_changed(
    before: Sequence[Row], after: Sequence[Row], lost: list[int], added: list[int]
) -> list[tuple[int, int]]:
    """Rows that are in both but differ."""
    places: dict[object, list[int]] = defaultdict(list)
    for j in reversed(added):
        row = after[j]
        if not row.resumed:
            places[(row.actor, row.app, row.kind)].append(j)
    pairs = []
    for i in lost:
        row = before[i]
        held = places.get((row.actor, row.app, row.kind))
        if held and not row.resumed:
            pairs.append((i, held.pop()))
    return pairs


def _interleave(
    before: Sequence[Row],
    after: Sequence[Row],
    kinds: dict[int, Change],
    gone: list[int],
    pairs: list[tuple[int, int]],
) -> list[Change]:
    """The second transcript's order, with lost rows placed after their predecessors."""
    to, missing = dict(pairs), set(gone)
    behind: dict[int, list[int]] = defaultdict(list)
    previous = -1
    for i in range(len(before)):
        previous = to.get(i, previous)
        if i in missing:
            behind[previous].append(i)
    changes: list[Change] = []
    for j in range(-1, len(after)):
        if j >= 0:
            changes.append(kinds[j])
        for i in behind.get(j, ()):
            kind: Kind = "joined" if before[i].resumed else "lost"
            changes.append(Change(kind, before[i], None))
    return changes


def summary_line(difference: Difference) -> str:
    """One line: rows changed, streams broken, reaction and response times in both runs."""
    counts = [f"{n} {kind}" for kind, n in difference.counts.items() if n]
    line = "rows: " + (", ".join(counts) if counts else "all the same")
    before, after = difference.before, difference.after
    if before is not None and after is not None:
        line += (
            f"; streams broken: {before.streams_broken} -> {after.streams_broken}"
            f"; reaction mean/max: {shown_times(before.reaction_mean, before.reaction_max)}"
            f" -> {shown_times(after.reaction_mean, after.reaction_max)}"
            f"; response mean/max: {shown_times(before.response_mean, before.response_max)}"
            f" -> {shown_times(after.response_mean, after.response_max)}"
            f"; collisions: {before.collisions} -> {after.collisions}"
        )
    return line


def format_difference(difference: Difference, colour: bool = False) -> str:
    """The diff as text, with a mark before each row that changed."""
    codes = {"added": "32", "lost": "31", "moved": "33", "changed": "36", "split": "35", "joined": "35", "delayed": "34"}  # fmt: skip
    lines = []
    for change in difference.changes:
        row = change.after or change.before
        assert row is not None
        what = brief(row.what, LONGEST_SHOWN)
        text = f"{MARKS[change.kind]} {row.time:>8.2f} {row.actor} {row.app:<12} {what}"
        text = visible(text + (f"  ({note})" if (note := remark(change)) else ""))
        if colour and change.kind != "same":
            text = f"\x1b[{codes[change.kind]}m{text}\x1b[0m"
        lines.append(text)
    return "\n".join([*lines, summary_line(difference), ""])


def remark(change: Change) -> str:
    """How a row changed, in words; empty if its kind says everything."""
    before = change.before
    match change.kind:
        case "moved":
            assert before is not None
            return f"moved: was row {before.number}, at {before.time:.2f} s"
        case "changed":
            assert before is not None
            return f"was: {brief(before.what, LONGEST_SHOWN)}"
        case "delayed":
            return f"{'later' if change.delay > 0 else 'earlier'} by {abs(change.delay):.2f} s"
        case "split":
            return "split: goes on here"
        case "joined":
            return "no longer split here"
    return ""


def difference_json(difference: Difference) -> Iterator[str]:
    """The diff as lines of JSON for people and programs, piece by piece."""
    figures = {
        "differs": difference.differs,
        "counts": difference.counts,
        "before": asdict(difference.before) if difference.before else None,
        "after": asdict(difference.after) if difference.after else None,
    }
    yield escaped(json.dumps(figures, ensure_ascii=False, indent=2)).removesuffix("\n}")
    yield ',\n  "changes": ['
    before = "\n    "
    for change in difference.changes:
        if change.kind != "same":
            yield (
                f'{before}{{\n      "kind": "{change.kind}",\n'
                f'      "before": {_row_json(change.before)},\n'
                f'      "after": {_row_json(change.after)},\n'
                f'      "delay": {json.dumps(change.delay)}\n    }}'
            )
            before = ",\n    "
    yield "]\n}\n" if before == "\n    " else "\n  ]\n}\n"


_ROW = tuple(one.name for one in fields(Row))
_encode = json.JSONEncoder(ensure_ascii=False, separators=(",\n        ", ": ")).encode


def _row_json(row: Row | None) -> str:
    """A row in lines of JSON, indented like those of a change."""
    if row is None:
        return "null"
    held = {name: getattr(row, name) for name in _ROW}
    return f"{{\n        {escaped(_encode(held)[1:-1])}\n      }}"
