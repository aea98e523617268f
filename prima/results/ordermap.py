"""The map of orders: which order most runs have, at each level of one factor or of two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from prima.results.data import Data, Levels
from prima.results.statistics import Groups

MOST_LEVELS = 40
"""The number of levels of a factor that the map shows individually."""
RANGES = 20
MOST_LINKED = 500
"""The number of frequent orders that have links and are distinguished by the page."""

Cell = tuple[int, int, int, int]
"""The most frequent order's place, its runs, all runs, and the number of orders."""


@dataclass(frozen=True, slots=True)
class OrderMap:
    """Cells by two factors, row by row; None where no run was made."""

    rows: Levels
    columns: Levels | None
    """None if there is one factor."""
    cells: list[Cell | None]


def order_map(data: Data, levels: Sequence[Levels]) -> OrderMap:
    """The map of orders over the levels of one factor or of two."""
    rows, columns = levels[0], levels[1] if len(levels) > 1 else None
    wide = len(columns.names) if columns else 1
    places = rows.codes * wide + (columns.codes if columns else 0)
    return OrderMap(rows, columns, _cells(places, data.order_codes, len(rows.names) * wide))


def _cells(places: Groups, orders: Groups, count: int) -> list[Cell | None]:
    """The most frequent order of each place; of two, the one more frequent overall."""
    many = int(orders.max()) + 1
    pairs, runs = np.unique(places * many + orders, return_counts=True)
    found: list[Cell | None] = [None] * count
    for pair, times in zip(pairs.tolist(), runs.tolist(), strict=True):
        place, order = divmod(pair, many)
        earlier = found[place]
        if earlier is None:
            found[place] = (order, times, times, 1)
            continue
        best, most, total, distinct = earlier
        if times > most:
            best, most = order, times
        found[place] = (best, most, total + times, distinct + 1)
    return found


def map_levels(data: Data) -> list[Levels]:
    """The levels of each varied factor, as shown in the map."""
    return [one.levels(MOST_LEVELS, RANGES) for one in data.varied]
