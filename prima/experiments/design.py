"""Designs of experiments: which combinations of levels are run, with which seeds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

from prima.errors import UsageError, one_of
from prima.experiments.levels import Factor
from prima.language.distributions import share
from prima.language.values import MOST_SEED

DESIGNS = ("full", "random", "lhs")
MOST_RUNS = 100_000_000
"""Maximum number of runs of a sweep."""
MOST_POINTS = 10_000_000
"""Maximum number of values of a Latin hypercube, which is made in one go."""


class Design:
    """Values of factors, run by run.

    ``full`` combines all levels, with each seed; random values depend only on the seed and the
    factor, so that the same user meets every other level. ``random`` and ``lhs`` (Latin
    hypercube) draw all factors, including the levels of lists, for a number of runs.
    """

    def __init__(self, kind: str, factors: Sequence[Factor], seeds: int, runs: int | None) -> None:
        """Plan it.

        Args:
            kind: one of DESIGNS.
            factors: the factors to vary.
            seeds: for ``full``, the number of runs of each combination; else the first seed.
            runs: for ``random`` and ``lhs``, how many.

        Raises:
            UsageError: these cannot be combined, or are too many.
        """
        self.kind = kind
        self.factors = factors
        self.seeds = seeds
        if kind not in DESIGNS:
            raise UsageError(f'There is no design "{kind}". Write {one_of(DESIGNS)}.')
        if kind == "full":
            if runs is not None:
                raise UsageError("--runs is for --design random or lhs; full has --seeds.")
            self.count = seeds
            for factor in factors:
                self.count *= len(factor.levels) or 1
        else:
            if runs is None:
                raise UsageError(f"--design {kind} needs the number of runs: --runs 1000.")
            if not factors:
                raise UsageError(f"--design {kind} needs something to vary: --vary PATH=LEVELS.")
            self.count = runs
        self._check_size()

    def _check_size(self) -> None:
        """Reject too many runs, seeds that no scenario has, and a hypercube that is too large."""
        if self.count > MOST_RUNS:
            these = f"{self.count:,}" if self.count < 10**20 else "far too many"  # else too long
            message = f"These are {these} runs; a sweep has at most {MOST_RUNS:,}."
            raise UsageError(f"{message} Take fewer levels or seeds, or --design lhs --runs 10000.")
        if self.kind != "full" and self.seeds + self.count - 1 > MOST_SEED:
            raise UsageError(f"--seeds: the last run has a seed above {MOST_SEED:,}.")
        if self.kind == "lhs" and self.count * len(self.factors) > MOST_POINTS:
            message = f"A Latin hypercube has at most {MOST_POINTS:,} values."
            raise UsageError(f"{message} Take fewer runs or factors, or --design random.")

    def __len__(self) -> int:
        return self.count

    def __iter__(self) -> Iterator[tuple[int, tuple[str, ...]]]:
        """Seeds and values in the order of the factors."""
        return map(self.at, range(self.count))

    def at(self, number: int) -> tuple[int, tuple[str, ...]]:
        """The seed and the values of one run, counted from 0."""
        if self.kind == "full":
            return self._combined(number)
        seed = number + self.seeds
        lhs = self.kind == "lhs"
        drawn = (share(seed, one.path) for one in self.factors)
        shares: list[float] = self._points[number].tolist() if lhs else list(drawn)
        pairs = zip(self.factors, shares, strict=True)
        return seed, tuple(one.drawn(share) for one, share in pairs)

    def _combined(self, number: int) -> tuple[int, tuple[str, ...]]:
        """One run of all combinations: seeds change first, then the levels of the last factor."""
        number, seed = divmod(number, self.seeds)
        values: list[str] = []
        for one in reversed(self.factors):
            number, level = divmod(number, len(one.levels) or 1)
            drawn = one.drawn(share(seed + 1, one.path)) if one.quantile else one.levels[level]
            values.append(drawn)
        return seed + 1, tuple(reversed(values))

    @cached_property
    def _points(self) -> Any:
        return _hypercube(len(self.factors), self.count, self.seeds)


def _hypercube(factors: int, runs: int, seed: int) -> Any:
    """The points of a Latin hypercube, as an array of NumPy: millions of lists need too much.

    Raises:
        UsageError: scipy is not installed.
    """
    try:
        from scipy.stats import qmc
    except ImportError:
        message = "--design lhs needs scipy: pip install 'prima[experiments]'."
        raise UsageError(message) from None
    return qmc.LatinHypercube(d=factors, rng=seed).random(runs)
