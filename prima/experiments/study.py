"""``prima study``: situations under every policy, measured by the thesis's criteria."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from prima.api import Transcript, documents_folder, load_scenario, rehearse
from prima.errors import UsageError
from prima.errors.visible import visible
from prima.messages import Json
from prima.scheduler import policy as known
from prima.testing.golden import golden_of, read_golden
from prima.transcript.criteria import CRITERIA, HEADINGS, Criteria, shown_time
from prima.transcript.diff import compare
from prima.transcript.observer import observe
from prima.transcript.row import Row
from prima.transcript.table import read_table

POLICIES = (
    *reversed(known.POLICIES),
    *(f"prima+{extension}" for extension in (*known.EXTENSIONS, "all")),
)
"""The policies that a study compares by default."""


@dataclass(slots=True)
class StudyResult:
    """One situation under one policy."""

    situation: str
    """The scenario's id, or its path if an earlier one has the same id."""
    policy: str
    criteria: Criteria
    distance: int | None
    """Number of rows of the expected table that come in another order."""
    missing: int | None
    """Number of rows of the expected table that this run lacks."""
    seconds: float
    failures: list[str]


def situations() -> list[Path]:
    """The ten situations of the thesis's Table 5.2, as scenarios in the package."""
    folder = documents_folder() / "scenarios"
    found = {path.stem: path for path in (folder / "situations").glob("*.xml")}
    found["s03"] = folder / "follow-during-navigation.xml"
    return [found[name] for name in sorted(found)]


def study(
    scenarios: Iterable[str | Path] = (), policies: Iterable[str] = POLICIES
) -> Iterator[StudyResult]:
    """Run scenarios, by default the ten situations, under policies, and measure each run.

    Raises:
        DocumentError: documents are wrong.
        UsageError: a file or policy is unknown.
    """
    chosen = list(policies)
    named: set[str] = set()
    for path in scenarios or situations():
        loaded = load_scenario(path)
        own = loaded.cast.scenario.id
        name = str(path) if own in named else own
        named.add(name)
        expected = _expected(Path(path))
        for policy in chosen:
            transcript = rehearse(loaded, policy)
            distance, missing = _distance(expected, transcript)
            yield StudyResult(
                name,
                policy,
                observe(transcript.records),
                distance,
                missing,
                transcript.records[-1]["time"],
                transcript.failures,
            )


def _expected(path: Path) -> list[Row] | None:
    """The rows of the table beside a scenario; None if there is none.

    Raises:
        UsageError: it is no table.
    """
    table = golden_of(path)
    if not table.is_file():
        return None
    try:
        return read_table(read_golden(table))
    except (ValueError, IndexError):
        raise UsageError(f"{table}: not a table of a transcript, as prima run prints it.") from None


def _distance(expected: list[Row] | None, transcript: Transcript) -> tuple[int | None, int | None]:
    """The distance of a run's order from the expected one."""
    if expected is None:
        return None, None
    rows = read_table(transcript.table())
    counts = compare(expected, rows).counts
    return counts["moved"], counts["lost"] + counts["joined"] + counts["changed"]


COUNTED = {"reaction_mean": "reactions", "response_mean": "responses"}
"""The count over which each mean is taken."""


def result_data(result: StudyResult) -> dict[str, Json]:
    """A result as data for JSON, with its criteria among its fields."""
    data = asdict(result)
    criteria = data.pop("criteria")
    return {**data, **criteria}


def format_csv(results: Iterable[StudyResult]) -> str:
    """Results as CSV: a line for each situation and policy."""
    made = io.StringIO()
    names = [one.name for one in fields(StudyResult) if one.name != "criteria"]
    writer = csv.DictWriter(made, [*names, *CRITERIA], lineterminator="\n", extrasaction="ignore")
    writer.writeheader()
    for result in results:
        writer.writerow({**result_data(result), "failures": visible("; ".join(result.failures))})
    return made.getvalue()


def format_table(results: list[StudyResult]) -> str:
    """The table: situations by policies, then the sums of each policy."""
    heads = ["situation", "policy", *HEADINGS.values(), "moved", "missing"]
    lines = [_cells(result) for result in results]
    policies = list(dict.fromkeys(result.policy for result in results))
    if len({result.situation for result in results}) > 1:
        lines += [_sums(policy, [r for r in results if r.policy == policy]) for policy in policies]
    return _aligned([heads, *lines])


def _aligned(lines: list[list[str]]) -> str:
    """Lines of cells in columns, with an empty line before each other first cell."""
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    made: list[str] = []
    before = lines[0][0]
    for line in lines:
        if line[0] != before:
            made.append("")
        before = line[0]
        cells = [cell.ljust(wide) for cell, wide in zip(line[:2], widths, strict=False)]
        cells += [cell.rjust(wide) for cell, wide in zip(line[2:], widths[2:], strict=True)]
        made.append("  ".join(cells).rstrip())
    return "\n".join(made) + "\n"


def _cells(result: StudyResult) -> list[str]:
    values = [_shown(getattr(result.criteria, name)) for name in CRITERIA]
    return [
        result.situation,
        result.policy + (" !" if result.failures else ""),
        *values,
        _shown(result.distance),
        _shown(result.missing),
    ]


def _sums(policy: str, results: list[StudyResult]) -> list[str]:
    """A policy in all situations: counts are added, means are taken over all runs."""
    values = [_shown(_sum(name, [result.criteria for result in results])) for name in CRITERIA]
    known = [r for r in results if r.distance is not None]
    distance = sum(r.distance or 0 for r in known) if known else None
    missing = sum(r.missing or 0 for r in known) if known else None
    return ["all", policy, *values, _shown(distance), _shown(missing)]


def _sum(name: str, criteria: list[Criteria]) -> float | None:
    """One criterion of all runs: the sum, the maximum, or the mean over all reactions."""
    some = [one for one in criteria if getattr(one, name) is not None]
    values: list[float] = [getattr(one, name) for one in some]
    if name.endswith("_max"):
        return max(values, default=None)
    if name not in COUNTED:
        return sum(values)
    weights: list[int] = [getattr(one, COUNTED[name]) for one in some]
    total = sum(mean * weight for mean, weight in zip(values, weights, strict=True))
    return total / sum(weights) if weights else None


def _shown(value: float | None) -> str:
    return str(value) if isinstance(value, int) else shown_time(value)
