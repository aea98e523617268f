"""A sweep's table as one page: distributions, intervals, tests and a map of orders.

:func:`read` reads a table; :func:`make` and :func:`draw` show it. The page is self-contained.
The same table gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from prima.errors import UsageError, did_you_mean, one_of

if TYPE_CHECKING:
    from prima.results.data import Data
    from prima.results.figures import Figure


def read(path: str | Path) -> Data:
    """Read a sweep's table, or the one in a folder.

    Raises:
        UsageError: it is not such a table, cannot be read, or a library is missing.
    """
    try:
        import scipy  # noqa: F401 (it brings numpy)
    except ImportError:
        message = "a sweep's page needs scipy: pip install 'prima[experiments]'."
        raise UsageError(f"{path}: {message}") from None
    from prima.results.data import data_of
    from prima.results.reading import read as read_sheet

    return data_of(read_sheet(path))


def files(path: str | Path) -> list[Path]:
    """The files that the page of a table is made from.

    Raises:
        UsageError: there is no table, or more than one.
    """
    from prima.results.reading import files_of, table_of

    return files_of(table_of(Path(path)))


def make(data: Data, folder: str | Path, by: Sequence[str] = ()) -> str:
    """The page of a table.

    Args:
        data: the table.
        folder: where the page will be, for its links to transcripts.
        by: the factors of the map of orders, one or two; by default those with most levels.

    Raises:
        UsageError: there is no such factor.
    """
    from prima.results.page import page

    return page(data, Path(folder), _chosen(data, by))


def draw(data: Data, by: Sequence[str] = ()) -> list[Figure]:
    """The figures of a table: one of each measure that differs between runs, and the map.

    Raises:
        UsageError: there is no such factor.
    """
    from prima.results.analysis import analyse
    from prima.results.figures import distribution, orders
    from prima.results.ordermap import map_levels, order_map

    factors = _chosen(data, by)
    made = [distribution(one) for one in analyse(data).distributions]
    if factors:
        levels = map_levels(data)
        drawn = order_map(data, [levels[one] for one in factors])
        made.append(orders(data, drawn, [data.varied[one] for one in factors]))
    return made


def _chosen(data: Data, by: Sequence[str]) -> tuple[int, ...]:
    """The factors of the map, as indices among those that are varied.

    By default they are the two with most levels, the first down the page, which is longer than wide.

    Raises:
        UsageError: there is no such factor.
    """
    names = [one.column.name for one in data.varied]
    if not by:
        by_count = sorted(range(len(names)), key=lambda one: -data.varied[one].count)
        return tuple(by_count[:2])
    for one in by:
        if one not in names:
            guess = did_you_mean(one, names)
            known = f"the table has {one_of(names)}" if names else "the table has none"
            message = f'--by: "{one}" is not a factor with several levels; {known}. {guess}'
            raise UsageError(message.strip())
    return tuple(dict.fromkeys(names.index(one) for one in by))[:2]


__all__ = ["draw", "files", "make", "read"]
