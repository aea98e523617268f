"""The numbers of a page against values computed by hand."""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, isclose, sqrt

import pytest

pytest.importorskip("scipy")

import numpy as np

from prima.experiments.table import Column
from prima.results.data import FactorColumn
from prima.results.figures import Scale
from prima.results.statistics import (
    KRUSKAL_WALLIS,
    MANN_WHITNEY,
    MOST_DISTINCT,
    SPEARMAN,
    FactorTest,
    Untested,
    Values,
    compare,
    corrected,
    correlate,
    holm,
    interval,
    summary,
)


def array(*values: float) -> Values:
    return np.array(values, dtype=np.float64)


def groups(*sizes: int) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    return np.repeat(np.arange(len(sizes)), sizes)


def result_of(found: FactorTest | Untested) -> FactorTest:
    assert isinstance(found, FactorTest), found
    return found


def why(found: FactorTest | Untested) -> str:
    assert isinstance(found, Untested)
    return found.why


def test_two_levels_apart_are_told_by_mann_whitney() -> None:
    found = result_of(compare(array(*range(10)), groups(5, 5), ["a", "b"]))
    assert found.method is MANN_WHITNEY and found.sizes == (5, 5)
    assert found.statistic == 0 and found.effect == -1
    assert isclose(found.p, 2 / 252), "of the 252 ways to deal ten ranks, two are as extreme"


def test_cliffs_delta_is_the_share_of_pairs() -> None:
    values = array(1, 2, 2, 3, 9, 2, 2, 4, 5, 6)
    pairs = [(a, b) for a in values[:5] for b in values[5:]]
    share = sum(int(a > b) - int(a < b) for a, b in pairs) / 25
    assert isclose(result_of(compare(values, groups(5, 5), ["a", "b"])).effect, share)
    swapped = result_of(compare(values, 1 - groups(5, 5), ["a", "b"]))
    assert isclose(swapped.effect, -share)


def test_three_levels_are_told_by_kruskal_wallis() -> None:
    found = result_of(compare(array(*range(15)), groups(5, 5, 5), ["a", "b", "c"]))
    assert found.method is KRUSKAL_WALLIS and found.sizes == (5, 5, 5)
    # H = 12 / (15 * 16) * (15² + 40² + 65²) / 5 - 3 * 16
    assert isclose(found.statistic, 12.5)
    assert isclose(found.p, exp(-12.5 / 2)), "chi squared with two degrees of freedom"
    assert isclose(found.effect, 12.5 / 14)


def test_a_numeric_factor_is_told_by_spearman() -> None:
    order = [*range(8), 9, 8]
    found = result_of(correlate(array(*order), array(*range(10))))
    assert found.method is SPEARMAN and found.sizes == (10,)
    assert isclose(found.effect, 1 - 6 * 2 / (10 * 99)) and found.statistic == found.effect
    falling = result_of(correlate(-array(*range(10)), array(*range(10))))
    assert isclose(falling.effect, -1)


def test_missing_values_are_left_out() -> None:
    nan = float("nan")
    values = array(0, 1, 2, 3, 4, nan, 5, 6, 7, 8, 9, nan)
    found = result_of(compare(values, groups(6, 6), ["a", "b"]))
    assert found.sizes == (5, 5) and found.effect == -1
    told = summary(values)
    assert told and (told.count, told.missing, told.mean, told.median) == (10, 2, 4.5, 4.5)
    assert summary(array(nan, nan)) is None
    assert result_of(correlate(values, np.arange(12.0))).sizes == (10,)
    assert result_of(correlate(np.arange(12.0), values)).sizes == (10,)


@pytest.mark.parametrize(
    ("values", "sizes", "told"),
    [
        ([1, 2, 3, 4, 5, 6], (5, 1), "too few runs with a value: “b” has 1 of them"),
        ([2] * 10, (5, 5), "the measure is the same in all runs"),
        ([1, 2, 3, 4, 5], (5,), "the factor has a single level"),
    ],
)
def test_what_cannot_be_tested_is_told(
    values: Sequence[float], sizes: tuple[int, ...], told: str
) -> None:
    names = [chr(ord("a") + index) for index in range(len(sizes))]
    assert told in why(compare(array(*values), groups(*sizes), names))


def test_what_cannot_be_correlated_is_told() -> None:
    line = np.arange(10.0)
    assert "9 runs have a value, and the test needs 10" in why(correlate(line[:9], line[:9]))
    assert why(correlate(line * 0, line)) == "the measure is the same in all runs"
    assert why(correlate(line, line * 0)) == "the factor has a single level"


def test_holm_multiplies_the_smallest_most_and_never_falls() -> None:
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1.0, 1.0]
    assert holm([]) == []
    first = result_of(compare(array(*range(10)), groups(5, 5), ["a", "b"]))
    assert [one.adjusted for one in corrected([first, first])] == pytest.approx([4 / 252] * 2)


def test_an_interval_of_shares_is_that_of_the_binomial_distribution() -> None:
    """A mean of zeros and ones is drawn from it: its 2.5 % quantile is 40 of 100."""
    low, high = interval(array(*[0, 1] * 50))
    assert [low, high] == pytest.approx([0.4, 0.6], abs=0.011)
    assert interval(array(*[0, 1] * 50)) == (low, high), "the same values, the same ends"
    assert interval(array(3, 3, 3)) == (3, 3)


def test_many_values_have_the_normal_interval() -> None:
    count = MOST_DISTINCT + 1
    low, high = interval(np.arange(float(count)))
    half = 1.959963985 * sqrt(count * (count + 1) / 12) / sqrt(count)
    assert isclose(low, (count - 1) / 2 - half) and isclose(high - low, 2 * half)
    low, high = interval(np.arange(float(MOST_DISTINCT)))
    assert high - low == pytest.approx(2 * half, rel=0.05), "fewer have one that is alike"
    assert not isclose((low + high) / 2, (MOST_DISTINCT - 1) / 2), "and is drawn"


@pytest.mark.parametrize(
    ("values", "names"),
    [
        ((12.5, 12.501, 12.502), ["12.5", "12.501", "12.502"]),
        ((1000.5, 1001.5, 1000.25), ["1000.2", "1000.5", "1001.5"]),
        ((1 / 3, 2), ["0.3333", "2"]),
        ((0.1, 0.1 + 2**-54), ["0.1", "0.1000000000000001"]),
    ],
)
def test_levels_are_told_apart(values: Sequence[float], names: list[str]) -> None:
    factor = FactorColumn(Column("when.at", "number", "factor", ""), values)
    assert factor.levels(12, 8).names[:3] == names


def test_ranges_are_told_apart() -> None:
    column = Column("when.at", "number", "factor", "")
    names = FactorColumn(column, (1000 + np.arange(100) / 1000).tolist()).levels(12, 8).names
    assert len(set(names)) == 8 and names[0].startswith("1000 to 1000.01")


def test_a_scale_of_the_least_numbers_has_ticks() -> None:
    assert Scale(0.0, 5e-324, 0, 100).ticks() == [0]
    assert Scale(0.0, 10.0, 0, 100).ticks() == [0, 2, 4, 6, 8, 10]
