"""Which combinations of levels are run, with which seeds."""

from __future__ import annotations

import pytest

from prima.errors import UsageError
from prima.experiments.design import Design
from prima.experiments.levels import Factor

SPEED = Factor("speed", "number", ("0.5", "1", "2"))
WORLD = Factor("world", "path", ("a.xml", "b.xml"))
DELAY = Factor("delay", "number", (), lambda share: 10 * share)
ALL = (SPEED, WORLD, DELAY)


def test_all_combinations_with_each_seed() -> None:
    rows = list(Design("full", (SPEED, WORLD), 2, None))
    assert rows[:4] == [
        (1, ("0.5", "a.xml")), (2, ("0.5", "a.xml")), (1, ("0.5", "b.xml")), (2, ("0.5", "b.xml")),
    ]  # fmt: skip
    assert len(rows) == len(set(rows)) == 12


def test_a_seed_is_the_same_user_at_every_level() -> None:
    rows = list(Design("full", ALL, 5, None))
    users = {seed: {values[2] for one, values in rows if one == seed} for seed, _ in rows}
    assert [len(delays) for delays in users.values()] == [1] * 5
    assert len(set.union(*users.values())) == 5


def test_nothing_varied_is_one_run_for_each_seed() -> None:
    assert list(Design("full", (), 3, None)) == [(1, ()), (2, ()), (3, ())]


def test_a_random_design_draws_all_factors_and_is_repeatable() -> None:
    rows = list(Design("random", ALL, 1, 300))
    assert rows == list(Design("random", ALL, 1, 300))
    assert rows != list(Design("random", ALL, 2, 300))
    for index, factor in enumerate((SPEED, WORLD)):
        counts = [sum(values[index] == level for _, values in rows) for level in factor.levels]
        assert min(counts) > 0.7 * 300 / len(counts)


@pytest.mark.parametrize("kind", ["random", "lhs"])
def test_the_first_seed_of_a_drawn_design_is_given(kind: str) -> None:
    """The seed draws what the scenario leaves to chance, too: other seeds are other users."""
    assert [seed for seed, _ in Design(kind, ALL, 1000, 3)] == [1000, 1001, 1002]
    with pytest.raises(UsageError, match="seed above 999,999,999"):
        Design(kind, ALL, 999_999_998, 3)


def test_a_latin_hypercube_meets_each_slice_once() -> None:
    rows = list(Design("lhs", (DELAY, SPEED), 1, 100))
    slices = sorted(int(float(values[0]) * 10) for _, values in rows)
    assert slices == list(range(100))
    assert [sum(values[1] == level for _, values in rows) for level in ("0.5", "2")] == [
        pytest.approx(33, abs=2)
    ] * 2


@pytest.mark.parametrize(
    ("kind", "runs", "factors", "why"),
    [
        ("fill", None, ALL, 'no design "fill"'),
        ("full", 10, ALL, "--runs is for --design random or lhs"),
        ("lhs", None, ALL, "needs the number of runs"),
        ("lhs", 5_000_000, ALL, "at most 10,000,000 values"),
        ("random", 10**4000, ALL, "far too many runs"),
        ("random", 10, (), "needs something to vary"),
        ("random", 10**9, ALL, "1,000,000,000 runs; a sweep has at most 100,000,000"),
    ],
)
def test_designs_that_do_not_go(
    kind: str, runs: int | None, factors: tuple[Factor, ...], why: str
) -> None:
    with pytest.raises(UsageError, match=why):
        Design(kind, factors, 1, runs)


def test_a_hypercube_without_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "scipy.stats", None)
    with pytest.raises(UsageError, match=r"pip install 'prima\[experiments\]'"):
        list(Design("lhs", ALL, 1, 10))
