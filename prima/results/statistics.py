"""The numbers of a page: summaries with intervals, tests with effect sizes, Holm's correction.

Values are arrays of floats, in which NaN stands for a missing value. The same values give the
same numbers: random draws use a fixed seed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Values = NDArray[np.float64]
Groups = NDArray[np.int64]

SEED = 1
RESAMPLES = 1_000
MOST_DISTINCT = 500
"""The maximum number of distinct values of a group whose interval is bootstrapped."""
LEVEL = 0.95
LEAST_GROUP = 5
"""Runs per level that a test needs: with fewer, the distribution of H is far from chi squared."""
LEAST_PAIRS = 10
"""Runs that a rank correlation needs."""


@dataclass(frozen=True, slots=True)
class ValueSummary:
    """A summary of values: their mean with its interval, their spread, their quartiles."""

    count: int
    missing: int
    mean: float
    low: float
    high: float
    """The ends of the mean's 95 % interval."""
    deviation: float
    """The standard deviation (n - 1); 0 for a single value."""
    least: float
    lower: float
    median: float
    upper: float
    most: float


@dataclass(frozen=True, slots=True)
class Method:
    """A test: its name, its effect size, and the function of scipy that makes it."""

    name: str
    statistic: str
    effect: str
    function: str


MANN_WHITNEY = Method("Mann-Whitney", "U", "Cliff's δ", "scipy.stats.mannwhitneyu")
KRUSKAL_WALLIS = Method("Kruskal-Wallis", "H", "ε²", "scipy.stats.kruskal")
SPEARMAN = Method("Spearman", "ρ", "ρ", "scipy.stats.spearmanr")


@dataclass(frozen=True, slots=True)
class FactorTest:
    """A test of whether a measure depends on a factor."""

    method: Method
    sizes: tuple[int, ...]
    """Runs of each level; for a rank correlation, the number of pairs."""
    statistic: float
    p: float
    effect: float
    adjusted: float = 1.0
    """p by Holm, among all tests of the page."""


@dataclass(frozen=True, slots=True)
class Untested:
    """Why there is no test."""

    why: str


def summary(values: Values) -> ValueSummary | None:
    """The summary of values; None if all are missing."""
    known = values[~np.isnan(values)]
    if not len(known):
        return None
    low, high = interval(known)
    lower, median, upper = np.quantile(known, [0.25, 0.5, 0.75])
    spread = float(np.std(known, ddof=1)) if len(known) > 1 else 0.0
    return ValueSummary(
        len(known),
        len(values) - len(known),
        float(np.mean(known)),
        low,
        high,
        spread,
        float(known.min()),
        float(lower),
        float(median),
        float(upper),
        float(known.max()),
    )


def interval(known: Values) -> tuple[float, float]:
    """The 95 % interval of a mean.

    It is the percentile bootstrap's. Drawing values with replacement means drawing how often each
    distinct value occurs, so equal values cost nothing. If there are too many distinct ones, the
    normal distribution gives nearly the same result.
    """
    distinct, counts = np.unique(known, return_counts=True)
    size = len(known)
    if len(distinct) == 1:
        return float(distinct[0]), float(distinct[0])
    tail = (1 - LEVEL) / 2
    if len(distinct) > MOST_DISTINCT:
        half = float(stats.norm.ppf(1 - tail) * np.std(known, ddof=1) / np.sqrt(size))
        return float(np.mean(known)) - half, float(np.mean(known)) + half
    drawn = np.random.default_rng(SEED).multinomial(size, counts / size, size=RESAMPLES)
    means = (drawn * distinct).sum(axis=1) / size
    low, high = np.quantile(means, [tail, 1 - tail])
    return float(low), float(high)


def compare(values: Values, groups: Groups, names: Sequence[str]) -> FactorTest | Untested:
    """Whether groups of runs differ: Mann-Whitney for two, Kruskal-Wallis for more.

    Args:
        values: one for each run.
        groups: the group of each run, an index of ``names``; -1 for none.
        names: the groups' names.
    """
    known = ~np.isnan(values)
    parts = [values[known & (groups == index)] for index in range(len(names))]
    for name, part in zip(names, parts, strict=True):
        if len(part) < LEAST_GROUP:
            has = f"“{name}” has {len(part)} of them"
            return Untested(f"too few runs with a value: {has}, and a test needs {LEAST_GROUP}")
    if len(parts) < 2:
        return Untested("the factor has a single level")
    whole = np.concatenate(parts)
    if whole.min() == whole.max():
        return Untested("the measure is the same in all runs")
    sizes = tuple(len(part) for part in parts)
    if len(parts) == 2:
        found = stats.mannwhitneyu(*parts, alternative="two-sided")
        delta = 2 * float(found.statistic) / (sizes[0] * sizes[1]) - 1
        return FactorTest(MANN_WHITNEY, sizes, float(found.statistic), float(found.pvalue), delta)
    found = stats.kruskal(*parts)
    epsilon = float(found.statistic) / (len(whole) - 1)
    return FactorTest(KRUSKAL_WALLIS, sizes, float(found.statistic), float(found.pvalue), epsilon)


def correlate(values: Values, factor: Values) -> FactorTest | Untested:
    """Whether a measure goes up or down with a numeric factor: Spearman's rank correlation."""
    known = ~(np.isnan(values) | np.isnan(factor))
    mine, other = values[known], factor[known]
    if len(mine) < LEAST_PAIRS:
        has = f"{len(mine)} runs have a value"
        return Untested(f"too few runs: {has}, and the test needs {LEAST_PAIRS}")
    if other.min() == other.max():
        return Untested("the factor has a single level")
    if mine.min() == mine.max():
        return Untested("the measure is the same in all runs")
    found = stats.spearmanr(other, mine)
    rho = float(found.statistic)
    return FactorTest(SPEARMAN, (len(mine),), rho, float(found.pvalue), rho)


def holm(p: Sequence[float]) -> list[float]:
    """p-values corrected for their number by Holm's step-down method, in the same order."""
    made, least = [0.0] * len(p), 0.0
    for place, index in enumerate(sorted(range(len(p)), key=p.__getitem__)):
        least = max(least, min(1.0, p[index] * (len(p) - place)))
        made[index] = least
    return made


def corrected(results: Sequence[FactorTest]) -> list[FactorTest]:
    """Tests with their p-values corrected."""
    adjusted = holm([one.p for one in results])
    return [replace(one, adjusted=p) for one, p in zip(results, adjusted, strict=True)]
