"""A sweep's table as it was written, and the dictionary beside it.

The files are not trusted: they may be cut off, edited in a spreadsheet, or not tables at all.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

from prima.errors import UsageError, did_you_mean, one_of
from prima.errors.visible import unharmed
from prima.experiments.sweep import PLAN, ROWS
from prima.experiments.table import FIXED, HEAD, Column, check_names, parquet_columns
from prima.loading.files import readable

DICTIONARY = "dictionary.json"
SUFFIXES = (".csv", ".parquet")
REQUIRED = ("run", "exit", "order")
ROLES = ("id", "factor", "outcome", "measure")
MOST_ROWS = 1_000_000
MOST_COLUMNS = 1_000
MOST_BYTES = 1_000_000_000
"""Maximum size of a Parquet file's content, where equal texts count once."""
MOST_LINE = 10_000_000
"""Maximum length of a line of a CSV file (characters)."""
MOST_BESIDE = 10_000_000
"""Maximum length of a dictionary or plan (characters)."""
MOST_NAMED = 20
"""The number of columns that a note lists."""


@dataclass(slots=True)
class Sheet:
    """A table: its known columns, and their cells."""

    path: Path
    columns: list[Column]
    cells: dict[str, list[Any]]
    """By column: texts from a CSV file, values from a Parquet file."""
    plan: dict[str, Any] = field(default_factory=dict)
    """The settings of the sweep, from the file beside it; empty if there is none."""
    cut: str = ""
    """Why the table is incomplete."""
    notes: list[str] = field(default_factory=list)

    def __len__(self) -> int:
        return len(self.cells["run"])


def read(path: str | Path) -> Sheet:
    """Read a sweep's table, or the one in a folder, or beside it.

    Raises:
        UsageError: it is not such a table, or cannot be read.
    """
    table = table_of(Path(path))
    cells, cut = _cells(table)
    _check(table, cells)
    sheet = Sheet(table, [], cells, _beside(table, PLAN) or {}, cut)
    sheet.cut = cut or _broken_off(sheet)
    sheet.columns = _columns(sheet)
    if not any(one.role == "measure" for one in sheet.columns):
        raise UsageError(f"{table}: not the table of a sweep: it has no column of a measure.")
    if not len(sheet):
        more = f" ({cut})" if cut else ""
        raise UsageError(f"{table}: the table has no rows{more}; make its runs by prima sweep.")
    return sheet


def _cells(table: Path) -> tuple[dict[str, list[Any]], str]:
    """The cells of a table by column, and the error in the row at which it is cut off.

    Raises:
        UsageError: it cannot be read.
    """
    if table.exists() and not table.is_file():
        raise UsageError(f"{table}: cannot be read: it is not a file.")
    with readable(table):
        try:
            if table.suffix == ".parquet":
                return parquet_columns(table, MOST_ROWS, MOST_COLUMNS, MOST_BYTES), ""
            return _read_csv(table)
        except UnicodeDecodeError:
            raise UsageError(f"{table}: not the table of a sweep: it is not UTF-8.") from None
        except ValueError as error:
            raise UsageError(f"{table}: not the table of a sweep: {error}.") from None


def _broken_off(sheet: Sheet) -> str:
    """The note that a table is incomplete because its sweep has not made all runs."""
    planned = sheet.plan.get("runs")
    if not isinstance(planned, int) or planned <= len(sheet):
        return ""
    return f"it has {len(sheet):,} of {planned:,} runs; make the others by --resume"


def table_of(path: Path) -> Path:
    """The table denoted by a path: itself, the one in a folder, or the one beside it.

    Raises:
        UsageError: there is none, or more than one.
    """
    if not path.is_dir():
        if path.suffix not in SUFFIXES:
            raise UsageError(f"{path}: name a table that ends with {one_of(SUFFIXES)}.")
        return path
    beside = _table_beside(path) if (path / DICTIONARY).is_file() else None
    return beside or _table_in(path)


def _table_beside(folder: Path) -> Path | None:
    """The table whose folder this is: as its dictionary says, or by the folder's name."""
    beside = [folder.with_suffix(one) for one in SUFFIXES]
    named = (_beside(folder, DICTIONARY) or {}).get("path")
    if isinstance(named, str) and Path(named).name == named:
        beside.insert(0, folder.parent / named)
    return next((one for one in beside if one.suffix in SUFFIXES and one.is_file()), None)


def _table_in(path: Path) -> Path:
    """The only table in a folder.

    Raises:
        UsageError: there is none, or more than one.
    """
    with readable(path):
        found = sorted(one for one in path.iterdir() if one.suffix in SUFFIXES)
    found = [one for one in found if one.is_file() and one.name != ROWS]
    if not found:
        what = f"no table in this folder ({one_of(SUFFIXES)})"
        remedy = "Name a transcript or a scenario in it, or make a table"
        raise UsageError(f"{path}: {what}. {remedy}: prima sweep SCENARIO -o sweep.csv.")
    if len(found) > 1:
        listed = ", ".join(one.name for one in found[:5])
        raise UsageError(f"{path}: there are {len(found)} tables here; name one: {listed}.")
    return found[0]


def files_of(table: Path) -> list[Path]:
    """The files that a page of a table is made from."""
    folder = table.with_suffix("")
    return [table, folder / DICTIONARY, folder / PLAN, folder / ROWS]


def _read_csv(path: Path) -> tuple[dict[str, list[Any]], str]:
    """The cells of a CSV file, and why it is incomplete.

    Raises:
        ValueError: it is not a table.
    """
    ended = _is_ended(path)
    with path.open(encoding="utf-8-sig", newline="") as stream:
        rows = _rows(stream)
        head = next(rows, (0, []))[1]
        if len(head) > MOST_COLUMNS:
            raise ValueError(f"it has {len(head)} columns, and {MOST_COLUMNS} are read at most")
        if len(head) == 1 and ";" in head[0]:
            raise ValueError("its cells are separated by ';'; save it with ','")
        check_names(head)
        columns: list[list[str]] = [[] for _ in head]
        last: tuple[int, list[str]] | None = None
        for line, row in rows:
            if last is not None:
                _append(columns, *last)
            last = (line, row)
            if len(columns[0]) >= MOST_ROWS:
                raise ValueError(f"it has more than {MOST_ROWS} rows")
        cut = ""
        if last is not None and ended:
            _append(columns, *last)
        elif last is not None:
            cut = f"line {last[0]} has no end, so it is left out"
    return dict(zip(head, columns, strict=True)), cut


def _append(columns: list[list[str]], line: int, row: list[str]) -> None:
    if len(row) != len(columns):
        raise ValueError(f"line {line} has {len(row)} cells, and its head has {len(columns)}")
    for column, text in zip(columns, row, strict=True):
        column.append(unharmed(text))


def _rows(stream: IO[str]) -> Iterator[tuple[int, list[str]]]:
    """The rows that are not empty, with their lines."""
    reader = csv.reader(_lines(stream))
    try:
        for row in reader:
            if row:
                yield reader.line_num, row
    except csv.Error as error:
        raise ValueError(f"line {reader.line_num}: {error}") from None


def _lines(stream: IO[str]) -> Iterator[str]:
    """The lines of a file.

    Raises:
        ValueError: one is longer than a row can be.
    """
    number = 0
    while text := stream.readline(MOST_LINE):
        number += 1
        if len(text) == MOST_LINE:
            raise ValueError(f"line {number} has more than {MOST_LINE:,} characters")
        yield text


def _is_ended(path: Path) -> bool:
    """Whether a file's last line has an end."""
    with path.open("rb") as stream:
        if stream.seek(0, 2) == 0:
            raise ValueError("it is empty")
        stream.seek(-1, 2)
        return stream.read(1) in (b"\n", b"\r")


def _check(table: Path, cells: dict[str, list[Any]]) -> None:
    """Check that a table has what every sweep's table has.

    Raises:
        UsageError: a column is missing.
    """
    for name in REQUIRED:
        if name not in cells:
            guess = did_you_mean(name, [one[:100] for one in cells])
            message = f'not the table of a sweep: it has no column "{name}".'
            raise UsageError(f"{table}: {f'{message} {guess}'.strip()}")


def _beside(table: Path, name: str) -> dict[str, Any] | None:
    """A file of JSON in the folder beside a table, or in a folder; None if it has no object."""
    folder = table if table.is_dir() else table.with_suffix("")
    try:
        with (folder / name).open(encoding="utf-8") as stream:
            text = stream.read(MOST_BESIDE + 1)
        read = json.loads(text) if len(text) <= MOST_BESIDE else None
    except (OSError, ValueError, RecursionError):
        return None
    return read if isinstance(read, dict) else None


def _columns(sheet: Sheet) -> list[Column]:
    """The types of the columns: from the dictionary, or from their names."""
    known = {one.name: one for one in (*HEAD, *FIXED)}
    data = _beside(sheet.path, DICTIONARY)
    own = {one.name: one for one in _told(data or {})}
    if not own:
        sheet.notes.append(
            "There is no data dictionary beside the table: columns are known by their names, and"
            " those that no measure has are taken for factors."
        )
        return [known.get(name) or _guessed(name, sheet.cells[name]) for name in sheet.cells]
    described = own | known | own
    _note_missing(sheet, "The table lacks columns of its dictionary", own, sheet.cells)
    _note_missing(
        sheet, "Columns that no dictionary describes are left out", sheet.cells, described
    )
    return [one for name, one in described.items() if name in sheet.cells]


def _note_missing(sheet: Sheet, what: str, names: Iterable[str], there: Container[str]) -> None:
    """Note the names of columns that are not there, if any."""
    if missing := [name for name in names if name not in there]:
        more = f" and {len(missing) - MOST_NAMED} more" if len(missing) > MOST_NAMED else ""
        named = ", ".join(one[:100] for one in missing[:MOST_NAMED])
        sheet.notes.append(f"{what}: {named}{more}.")


def _told(data: dict[str, Any]) -> Iterator[Column]:
    """The columns of a dictionary; invalid entries are omitted."""
    fields = data.get("fields")
    for one in fields if isinstance(fields, list) else []:
        if not isinstance(one, dict) or one.get("role") not in ROLES:
            continue
        words = {key: one.get(key, "") for key in ("name", "type", "role", "description", "unit")}
        if all(isinstance(word, str) for word in words.values()):
            yield Column(**words)


def _guessed(name: str, cells: list[Any]) -> Column:
    numeric = all(
        isinstance(one, int | float) or one in (None, "") or is_number(one) for one in cells
    )
    return Column(name, "number" if numeric else "string", "factor", "value of the scenario")


def is_number(text: Any) -> bool:
    """Whether a cell is written as a number."""
    try:
        float(text)
    except (TypeError, ValueError):
        return False
    return True
