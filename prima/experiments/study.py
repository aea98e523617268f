"""``prima study``: the same situations under every policy, measured by the thesis's criteria."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from prima.api import Transcript, documents_folder, load_scenario, rehearse
from prima.errors import UsageError
from prima.messages import Json
from prima.scheduler import policy as known
from prima.transcript.criteria import Criteria
from prima.transcript.diff import compare
from prima.transcript.observer import observe
from prima.transcript.row import Row
from prima.transcript.table import read_table

POLICIES = (
    *reversed(known.POLICIES),
    *(f"prima+{extension}" for extension in (*known.EXTENSIONS, "all")),
)
"""All that a study compares unless it is told otherwise."""
EXPECTED = ".txt"
"""The suffix of the table beside a scenario that its author expects."""


@dataclass(slots=True)
class Result:
    """One situation under one policy."""

    situation: str
    policy: str
    criteria: Criteria
    distance: int | None
    """Rows to move, of those that the expected table has and this run has, too."""
    missing: int | None
    """Rows of the expected table that this run lacks."""
    seconds: float
    failures: list[str]


def situations() -> list[Path]:
    """The ten situations of the thesis's Table 5.2, as scenarios that come with the package."""
    folder = documents_folder() / "scenarios"
    found = {path.stem: path for path in (folder / "situations").glob("*.xml")}
    found["s03"] = folder / "follow-during-navigation.xml"
    return [found[name] for name in sorted(found)]


def study(
    scenarios: Iterable[str | Path] = (), policies: Iterable[str] = POLICIES
) -> Iterator[Result]:
    """Run scenarios, by default the ten situations, under policies, and measure each run.

    Raises:
        DocumentError: documents are wrong.
        UsageError: no such file or policy.
    """
    chosen = list(policies)
    for path in scenarios or situations():
        loaded = load_scenario(path)
        expected = _expected(Path(path))
        for policy in chosen:
            transcript = rehearse(loaded, policy)
            distance, missing = _distance(expected, transcript)
            yield Result(
                loaded.cast.scenario.id,
                policy,
                observe(transcript.records),
                distance,
                missing,
                transcript.records[-1]["time"],
                transcript.failures,
            )


def _expected(path: Path) -> list[Row] | None:
    table = path.with_suffix(EXPECTED)
    if not table.is_file():
        return None
    try:
        return read_table(table.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UsageError(f"{table}: this is no table of a transcript: {error}.") from None


def _distance(expected: list[Row] | None, transcript: Transcript) -> tuple[int | None, int | None]:
    """How far a run's order is from the expected one."""
    if expected is None:
        return None, None
    rows = read_table(transcript.table())
    counts = compare(expected, rows).counts
    return counts["moved"], counts["lost"] + counts["changed"]


COLUMNS = (
    ("units cut", "units_cut"),
    ("restarts", "restarts"),
    ("broken", "broken"),
    ("waiting", "broken_waiting"),
    ("unfaced", "unfaced"),
    ("left", "left"),
    ("reactions", "reactions"),
    ("mean s", "reaction_mean"),
    ("max s", "reaction_max"),
    ("responses", "responses"),
    ("mean s", "response_mean"),
    ("max s", "response_max"),
)
"""Headings and the criteria beneath them; times belong to the count before them."""
COUNTED = {"reaction_mean": "reactions", "response_mean": "responses"}
"""How many times each mean is made of."""


def result_data(result: Result) -> dict[str, Json]:
    """A result as plain data, criteria beside the rest."""
    data = asdict(result)
    criteria = data.pop("criteria")
    return {**data, **criteria}


def format_csv(results: Iterable[Result]) -> str:
    """One line for each situation and policy."""
    made = io.StringIO()
    names = [one.name for one in fields(Result) if one.name != "criteria"]
    writer = csv.DictWriter(
        made,
        [*names, *(one.name for one in fields(Criteria) if one.name != "delays")],
        lineterminator="\n",
        extrasaction="ignore",
    )
    writer.writeheader()
    for result in results:
        writer.writerow({**result_data(result), "failures": "; ".join(result.failures)})
    return made.getvalue()


def format_table(results: list[Result]) -> str:
    """The table that people read: situations by policies, then the sums of each policy."""
    heads = ["situation", "policy", *(head for head, _ in COLUMNS), "moved", "missing"]
    lines = [_cells(result) for result in results]
    policies = list(dict.fromkeys(result.policy for result in results))
    if len({result.situation for result in results}) > 1:
        lines += [_sums(policy, [r for r in results if r.policy == policy]) for policy in policies]
    widths = [
        max(len(head), *(len(line[index]) for line in lines)) for index, head in enumerate(heads)
    ]
    made: list[str] = []
    before = ""
    for line in [heads, *lines]:
        if line[0] != before and made:
            made.append("")
        before = line[0]
        cells = [
            cell.ljust(wide) if index < 2 else cell.rjust(wide)
            for index, (cell, wide) in enumerate(zip(line, widths, strict=True))
        ]
        made.append("  ".join(cells).rstrip())
    return "\n".join(made) + "\n"


def _cells(result: Result) -> list[str]:
    values = [_shown(getattr(result.criteria, name)) for _, name in COLUMNS]
    return [
        result.situation,
        result.policy + (" !" if result.failures else ""),
        *values,
        _shown(result.distance),
        _shown(result.missing),
    ]


def _sums(policy: str, results: list[Result]) -> list[str]:
    """A policy in all situations: counts are added, means are those of all of its runs."""
    values = []
    for _, name in COLUMNS:
        counts = [getattr(result.criteria, name) for result in results]
        if name in COUNTED:
            weights = [getattr(result.criteria, COUNTED[name]) for result in results]
            total = sum(mean * weight for mean, weight in zip(counts, weights, strict=True))
            values.append(_shown(total / sum(weights) if sum(weights) else 0.0))
        else:
            values.append(_shown(max(counts) if name.endswith("_max") else sum(counts)))
    known = [r for r in results if r.distance is not None]
    distance = sum(r.distance or 0 for r in known) if known else None
    missing = sum(r.missing or 0 for r in known) if known else None
    return ["all", policy, *values, _shown(distance), _shown(missing)]


def _shown(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.2f}" if isinstance(value, float) else str(value)
