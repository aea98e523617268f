"""A table as factors, measures and orders: arrays of numbers, and levels with their names."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from prima.errors import UsageError
from prima.errors.visible import visible
from prima.experiments.table import Column
from prima.results.reading import Sheet
from prima.results.statistics import Groups, Values

NOTHING = "(nothing)"
"""The level of runs in which a factor has no value."""
LONGEST = 80
"""The number of letters of a level's or a column's name that are shown."""
MOST_VALUE = 1e15
"""Largest value of a measure or a factor."""
MOST_DIGITS = 17
"""Digits that tell any two floats apart."""
MOST_FACTORS = 10
"""Maximum number of factors in figures, tests and maps."""
REPETITION = "seed"
"""The factor that repeats runs with other draws."""
LINK = re.compile(r"(?!\.\.?/)[^/\\\x00-\x1f]+/orders/[0-9a-f]{1,64}\.jsonl")
"""The form of the path of an order's transcript; nothing else becomes a link."""


@dataclass(frozen=True, slots=True)
class Levels:
    """The levels of a factor, or ranges of its values, and which of them each run has."""

    names: list[str]
    codes: Groups


class FactorColumn:
    """A factor: its column, and its value in each run."""

    def __init__(self, column: Column, cells: Sequence[Any]) -> None:
        self.column = column
        self.name = shown(column.name)
        self.numeric = column.type != "string"
        self.values: Values = _numbers(column, cells) if self.numeric else np.empty(0)
        self.words: list[str] = [] if self.numeric else [str(one or "") for one in cells]

    @cached_property
    def distinct(self) -> list[Any]:
        """Its values: numbers in numeric order, words in the order of the runs."""
        if not self.numeric:
            return list(dict.fromkeys(self.words))
        known = self.values[~np.isnan(self.values)]
        return [float(one) for one in np.unique(known)]

    @cached_property
    def missing(self) -> int:
        """The number of runs in which it has no value."""
        return int(np.isnan(self.values).sum()) if self.numeric else self.words.count("")

    @property
    def count(self) -> int:
        """The number of its levels, including the missing value."""
        return len(self.distinct) + (1 if self.numeric and self.missing else 0)

    def levels(self, most: int, ranges: int) -> Levels:
        """Its levels; for a numeric factor with more than ``most``, that many ranges.

        For words with more levels, the rest is one level.
        """
        if not self.numeric:
            return self._worded(most)
        absent = np.isnan(self.values)
        if len(self.distinct) > most:
            edges = np.unique(np.quantile(self.values[~absent], np.linspace(0, 1, ranges + 1)))
            codes = np.searchsorted(edges[1:-1], self.values, side="right")
            ends = numbers(edges.tolist())
            names = [f"{low} to {high}" for low, high in pairwise(ends)]
        else:
            codes = np.searchsorted(np.array(self.distinct), self.values)
            names = numbers(self.distinct)
        codes = np.where(absent, len(names), codes).astype(np.int64)
        if self.missing:
            names.append(NOTHING)
        return Levels(names, codes)

    def _worded(self, most: int) -> Levels:
        names = self.distinct
        place = {name: index for index, name in enumerate(names)}
        codes = np.array([place[one] for one in self.words], dtype=np.int64)
        labels = [shown(one) or NOTHING for one in names]
        if len(names) > most:
            labels = [*labels[: most - 1], f"{len(names) - most + 1} others"]
            codes = np.minimum(codes, most - 1)
        return Levels(labels, codes)


@dataclass(slots=True)
class MeasureColumn:
    """A measure, and its value in each run."""

    column: Column
    values: Values
    name: str = ""

    def __post_init__(self) -> None:
        self.name = shown(self.column.name)

    @property
    def unit(self) -> str:
        """Its unit, with a space before it; empty for a count."""
        return f" {shown(self.column.unit)}" if self.column.unit else ""

    @property
    def constant(self) -> bool:
        """Whether all its known values are the same, or there is none."""
        known = self.values[~np.isnan(self.values)]
        return not len(known) or bool(known.min() == known.max())


@dataclass(frozen=True, slots=True)
class OrderRow:
    """An order of events: its rank by frequency, and its transcript."""

    number: int
    signature: str
    runs: int
    first: str
    """The number of the first run that had it."""
    transcript: str
    """Its path from the table's folder; empty if there is none."""

    @property
    def label(self) -> str:
        """Its label in the map."""
        return str(self.number) if self.signature else "–"


@dataclass
class Data:
    """The data from which a page is made."""

    sheet: Sheet
    factors: list[FactorColumn]
    """All of them."""
    measures: list[MeasureColumn]
    orders: list[OrderRow]
    """The most frequent first."""
    order_codes: Groups
    """The place of each run's order among them."""
    varied: list[FactorColumn]
    """The first factors that have more than one level; seeds are repetitions."""
    notes: list[str]

    def __len__(self) -> int:
        return len(self.sheet)


def data_of(sheet: Sheet) -> Data:
    """The data of a table.

    Raises:
        UsageError: a cell does not hold a number where there should be one.
    """
    factors, measures = [], []
    try:
        for column in sheet.columns:
            cells = sheet.cells[column.name]
            if column.role == "factor":
                factors.append(FactorColumn(column, cells))
            elif column.role == "measure" or column.name == "expects_failed":
                measures.append(MeasureColumn(column, _numbers(column, cells)))
    except ValueError as error:
        raise UsageError(f"{sheet.path}: {error}") from None
    orders, codes = _orders(sheet)
    varied = [one for one in factors if one.count > 1 and one.column.name != REPETITION]
    notes = list(sheet.notes)
    if len(varied) > MOST_FACTORS:
        notes.append(f"Of {len(varied)} factors the first {MOST_FACTORS} are shown and tested.")
    return Data(sheet, factors, measures, orders, codes, varied[:MOST_FACTORS], notes)


def _numbers(column: Column, cells: Sequence[Any]) -> Values:
    """The numbers of a column; NaN for what is missing.

    Raises:
        ValueError: a cell holds none, with its place.
    """
    made = np.empty(len(cells))
    for index, cell in enumerate(cells):
        if cell is None or cell == "":
            made[index] = np.nan
            continue
        try:
            made[index] = value = float(cell)
        except (TypeError, ValueError, OverflowError):
            value = np.inf
        if not abs(value) <= MOST_VALUE:
            wrong = f'"{shown(str(cell))}" is not a number, or is too large'
            name = visible(column.name[:LONGEST])
            raise ValueError(f'row {index + 1}, column "{name}": {wrong}; mend the table.')
    return made


def _orders(sheet: Sheet) -> tuple[list[OrderRow], Groups]:
    """The orders of a table, and that of each run."""
    cells = [str(one or "") for one in sheet.cells["order"]]
    runs, paths = sheet.cells["run"], sheet.cells.get("transcript", [""] * len(cells))
    counts = Counter(cells)
    firsts = {one: index for index, one in reversed(list(enumerate(cells)))}
    ranked = sorted(counts, key=lambda one: (one == "", -counts[one], firsts[one]))
    made = []
    for place, signature in enumerate(ranked, 1):
        first = firsts[signature]
        path = str(paths[first] or "")
        safe = signature and LINK.fullmatch(path)
        count = counts[signature]
        first_run = shown(str(runs[first]))
        made.append(OrderRow(place, signature, count, first_run, path if safe else ""))
    places = {one: index for index, one in enumerate(ranked)}
    return made, np.array([places[one] for one in cells], dtype=np.int64)


def shown(text: str) -> str:
    """A name as shown: cut, and without characters that would reorder or hide other text."""
    return visible(text if len(text) <= LONGEST else text[:LONGEST] + "…")


def with_unit(name: str, unit: str) -> str:
    """A name with a unit in brackets, if there is one."""
    return f"{name} ({shown(unit)})" if unit else name


def number(value: float, digits: int = 4) -> str:
    """A number with four digits, or with all digits before the point."""
    if value == 0 or not np.isfinite(value):
        return "0" if value == 0 else "–"
    if abs(value) >= 10 ** (digits - 1):
        return f"{value:.0f}"
    text = f"{value:.{digits}g}"
    return text if "e" in text or "." not in text else text.rstrip("0").rstrip(".")


def numbers(values: Sequence[float]) -> list[str]:
    """Different numbers with as many digits as it takes to tell them apart, at least four."""
    texts = [number(one) for one in values]
    for digits in range(5, MOST_DIGITS + 1):
        if len(set(texts)) == len(values):
            break
        texts = [number(one, digits) for one in values]
    return texts


def probability(p: float) -> str:
    """A p-value with two digits."""
    return "< 1e-300" if p < 1e-300 else f"{p:.2g}"
