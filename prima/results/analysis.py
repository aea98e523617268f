"""The analysis of each measure: its distribution, whole and by factor, and its tests."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from prima.results.data import Data, FactorColumn, Levels, MeasureColumn
from prima.results.statistics import (
    FactorTest,
    Untested,
    Values,
    ValueSummary,
    compare,
    corrected,
    correlate,
    summary,
)

MOST_LEVELS = 12
"""Maximum number of levels of a factor that are shown and compared individually."""
RANGES = 8
"""The number of ranges into which a numeric factor with more is divided."""
MOST_BINS = 30


@dataclass(frozen=True, slots=True)
class Panel:
    """A measure by a factor: a summary for each level; None if it has no value."""

    factor: FactorColumn
    levels: Levels
    summaries: list[ValueSummary | None]


@dataclass(frozen=True, slots=True)
class Distribution:
    """A measure over all runs, and by each factor."""

    measure: MeasureColumn
    whole: ValueSummary
    edges: list[float]
    counts: list[int]
    """The number of runs between each two edges."""
    panels: list[Panel]

    @property
    def whole_numbers(self) -> bool:
        """Whether each bin is a whole number."""
        return self.edges[0] % 1 == 0.5 and self.edges[1] - self.edges[0] == 1


@dataclass(slots=True)
class Analysis:
    """The whole analysis of a table."""

    distributions: list[Distribution] = field(default_factory=list)
    constant: list[MeasureColumn] = field(default_factory=list)
    """Measures that are the same in all runs, or missing in all."""
    tests: list[tuple[MeasureColumn, FactorColumn, FactorTest]] = field(default_factory=list)
    untested: list[tuple[MeasureColumn, FactorColumn, Untested]] = field(default_factory=list)


def analyse(data: Data) -> Analysis:
    """Analyse a table's measures."""
    made = Analysis()
    levels = {one.name: one.levels(MOST_LEVELS, RANGES) for one in data.varied}
    for measure in data.measures:
        whole = None if measure.constant else summary(measure.values)
        if whole is None:
            made.constant.append(measure)
            continue
        edges, counts = bins(measure.values)
        panels = [_panel(measure, one, levels[one.name]) for one in data.varied]
        made.distributions.append(Distribution(measure, whole, edges, counts, panels))
        for factor in data.varied:
            _test(made, measure, factor, levels[factor.name])
    results = corrected([result for _, _, result in made.tests])
    made.tests = [
        (measure, factor, result)
        for (measure, factor, _), result in zip(made.tests, results, strict=True)
    ]
    return made


def _test(made: Analysis, measure: MeasureColumn, factor: FactorColumn, levels: Levels) -> None:
    """Test a measure for a factor; what cannot be tested is noted as well."""
    for found in _tests(measure, factor, levels):
        if isinstance(found, Untested):
            made.untested.append((measure, factor, found))
        else:
            made.tests.append((measure, factor, found))


def bins(values: Values) -> tuple[list[float], list[int]]:
    """A histogram: a bin for each whole number if they are few, else bins of the same width."""
    known = values[~np.isnan(values)]
    low, high = float(known.min()), float(known.max())
    whole = bool((known == np.round(known)).all())
    if whole and high - low < MOST_BINS:
        edges = np.arange(low - 0.5, high + 1)
    else:
        edges = np.linspace(low, high, MOST_BINS + 1)
    counts, _ = np.histogram(known, edges)
    return [float(one) for one in edges], [int(one) for one in counts]


def _panel(measure: MeasureColumn, factor: FactorColumn, levels: Levels) -> Panel:
    summaries = [
        summary(measure.values[levels.codes == index]) for index in range(len(levels.names))
    ]
    return Panel(factor, levels, summaries)


def _tests(
    measure: MeasureColumn, factor: FactorColumn, levels: Levels
) -> Iterator[FactorTest | Untested]:
    """The tests of a measure by a factor.

    Levels are compared with each other. Numbers, if there are more than two, are also correlated,
    which finds measures that go up or down with them, even if each level has few runs.
    """
    ordered = factor.numeric and len(factor.distinct) > 2
    if ordered:
        yield correlate(measure.values, factor.values)
    if factor.count <= MOST_LEVELS:
        yield compare(measure.values, levels.codes, levels.names)
    elif not ordered:
        yield Untested(f"the factor has {factor.count} levels, and {MOST_LEVELS} are compared")
