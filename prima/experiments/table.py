"""The table of an experiment: its columns, its data dictionary, CSV and Parquet."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from prima.errors import UsageError
from prima.errors.visible import harmless, unharmed
from prima.experiments.levels import Factor
from prima.experiments.variants import ORDER
from prima.messages import Json
from prima.sim.paths import ScenarioValue
from prima.transcript.criteria import CRITERIA, MEANINGS
from prima.version import __version__

if TYPE_CHECKING:
    import pyarrow
    from pyarrow.parquet import ParquetFile

BATCH = 10_000
"""The number of rows converted at once."""
BATCH_READ = 100_000
"""The number of rows read at once."""
TYPES = {"duration": "number", "number": "number", "integer": "integer"}
"""Types of columns by kinds of values; others are strings."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its type (``string``, ``integer`` or ``number``), role and unit."""

    name: str
    type: str
    role: str
    """``id``, ``factor``, ``outcome`` or ``measure``."""
    description: str
    unit: str = ""


HEAD = (
    Column("run", "integer", "id", "number of the run in the plan, from 0"),
    Column("scenario", "string", "factor", "path of the scenario"),
    Column("policy", "string", "factor", "the mediator's policy"),
    Column("seed", "integer", "factor", "seed of what is drawn"),
)
OUTCOMES = (
    Column("exit", "integer", "outcome", "exit code that the run alone would have; 0 is fine"),
    Column("ended", "string", "outcome", "over, quiet, until or limit; empty if it did not end"),
    Column("failures", "string", "outcome", "what went wrong"),
    Column("expects_failed", "integer", "outcome", "expectations of the scenario that failed"),
    Column("order", "string", "outcome", "signature of the rows without their times"),
    Column("transcript", "string", "outcome", "transcript of the first run with this order"),
)
MEASURES = (
    Column("seconds", "number", "measure", "duration of the run", "s"),
    Column("records", "integer", "measure", "records of the transcript"),
    Column("collisions", "integer", "measure", "devices lost, by loop and device (policy none)"),
    Column("starved", "integer", "measure", "behaviors that waited too long (E4, E6)"),
)


def _criterion(name: str) -> Column:
    timed = name.endswith(("_mean", "_max"))
    kind, unit = ("number", "s") if timed else ("integer", "")
    return Column(name, kind, "measure", MEANINGS[name], unit)


FIXED = (*OUTCOMES, *MEASURES, *map(_criterion, CRITERIA))
"""The columns of every table that do not depend on what is varied, behind its factors."""


def check_name(value: ScenarioValue) -> None:
    """Check that a table can have a column with a value's path for its name.

    Raises:
        UsageError: another column has this name.
    """
    path = value.path
    if path == "policy":
        how = 'in a study file policies = ["prima", "fifo"]'
        raise UsageError(f"policy: write --policy prima --policy fifo, {how}.")
    is_seed = path == "seed" and value.node.tag == "scenario"
    if any(one.name == path for one in (*HEAD, *FIXED)) and not is_seed:
        message = f'{path}: each table has a column "{path}" of its own.'
        raise UsageError(f"{message} Name the value by its place, as when[2].at, or change its id.")


def columns(factors: Sequence[Factor]) -> list[Column]:
    """The columns of a table; a factor that is also in HEAD, such as the seed, occurs once."""
    varied = [
        Column(
            one.path,
            TYPES.get(one.kind, "string"),
            "factor",
            "value of the scenario",
            "s" if one.kind == "duration" else "",
        )
        for one in factors
    ]
    paths = {one.path for one in factors}
    head = [one for one in HEAD if one.name not in paths]
    return [*head, *varied, *FIXED]


def dictionary(path: str, made: Iterable[Column]) -> str:
    """The data dictionary: a Frictionless Table Schema, with ``role`` and ``unit`` added."""
    fields = [
        {
            "name": one.name,
            "type": one.type,
            "title": one.name.replace("_", " "),
            "description": one.description,
            "role": one.role,
            "unit": one.unit,
        }
        for one in made
    ]
    data = {"prima": __version__, "path": path, "fields": fields, "missingValues": [""]}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


def line(cells: Iterable[Json]) -> str:
    """A row of CSV (RFC 4180); None is an empty cell, and no text can be a spreadsheet formula."""
    made = io.StringIO()
    row = [harmless(one) if isinstance(one, str) else one for one in cells]
    csv.writer(made, lineterminator="\r\n").writerow(["" if one is None else one for one in row])
    return made.getvalue()


def read_rows(stream: IO[str], made: Sequence[Column]) -> Iterator[dict[str, Json]]:
    """The rows of a table written by :func:`line`, after its head.

    Raises:
        ValueError: it is another table, or is damaged.
    """
    rows = csv.reader(stream)
    try:
        if next(rows, []) != [one.name for one in made]:
            raise ValueError("its columns are others")
        for row in rows:
            if len(row) != len(made):
                raise ValueError(f"line {rows.line_num} has {len(row)} cells")
            yield {one.name: _value(one.type, text) for one, text in zip(made, row, strict=True)}
    except csv.Error as error:
        raise ValueError(f"line {rows.line_num}: {error}") from None


def whole_rows(path: Path, made: Sequence[Column]) -> int:
    """The number of rows of a table that was cut off; anything after the last whole one is removed.

    Raises:
        OSError: it cannot be read or written.
        UsageError: it is another table, or is damaged.
    """
    end = size = quotes = rows = 0
    with path.open("rb+") as stream:
        for data in stream:
            size += len(data)
            quotes += data.count(b'"')
            if data.endswith(b"\r\n") and quotes % 2 == 0:  # else a cell goes on in the next line
                end, rows = size, rows + 1
            elif rows and data.startswith(b"%d," % rows):  # only the last row may be incomplete
                message = f"run {rows - 1} has a quotation mark too many or too few"
                raise UsageError(f"{path}: not the table of a sweep: {message}.")
        stream.truncate(end)
    if not end:
        return 0
    with path.open(encoding="utf-8", newline="") as text:
        try:
            return count_runs(read_rows(text, made))
        except ValueError as error:
            raise UsageError(f"{path}: not the table of a sweep: {error}.") from None


def count_runs(rows: Iterable[Mapping[str, Json]]) -> int:
    """The number of rows of a sweep's table; they have to be those of its runs, in order.

    Raises:
        ValueError: one is not, or has something else for the signature of an order.
    """
    count = 0
    for row in rows:
        if row["run"] != count:
            raise ValueError(f"run {count} is missing")
        if not re.fullmatch(f"({ORDER})?", str(row["order"])):
            raise ValueError(f"run {count} does not have the signature of an order")
        count += 1
    return count


def _value(kind: str, text: str) -> Json:
    if kind == "string":
        return unharmed(text)
    if not text:
        return None
    return int(text) if kind == "integer" else float(text)


def arrow_schema(made: Sequence[Column]) -> pyarrow.Schema:
    """The types of a table's columns for Arrow.

    Raises:
        UsageError: pyarrow is not installed.
    """
    arrow = pyarrow_module()
    types = {"string": arrow.string(), "integer": arrow.int64(), "number": arrow.float64()}
    return arrow.schema([(one.name, types[one.type]) for one in made])


def pyarrow_module() -> Any:
    """The library that writes Parquet.

    Raises:
        UsageError: it is not installed.
    """
    try:
        import pyarrow as arrow
    except ImportError:
        message = "Parquet needs pyarrow: pip install 'prima[experiments]', or write a .csv."
        raise UsageError(message) from None
    return arrow


def arrow_table(rows: Iterable[dict[str, Json]], made: Sequence[Column]) -> pyarrow.Table:
    """A table in memory.

    Raises:
        UsageError: pyarrow is not installed.
    """
    schema = arrow_schema(made)
    return pyarrow_module().Table.from_batches(_batches(rows, schema), schema)


def write_parquet(source: Path, target: Path, made: Sequence[Column]) -> None:
    """Write a table of CSV as Parquet, in pieces.

    Raises:
        UsageError: pyarrow is not installed, or nothing can be written.
    """
    schema = arrow_schema(made)
    from pyarrow.parquet import ParquetWriter

    from prima.loading.writing import whole

    with (
        source.open(encoding="utf-8", newline="") as stream,
        whole(target) as out,
        ParquetWriter(out, schema, compression="zstd") as writer,
    ):
        for batch in _batches(read_rows(stream, made), schema):
            writer.write_batch(batch)


def _batches(
    rows: Iterable[dict[str, Json]], schema: pyarrow.Schema
) -> Iterator[pyarrow.RecordBatch]:
    from pyarrow import RecordBatch

    left = iter(rows)
    while batch := list(islice(left, BATCH)):
        yield RecordBatch.from_pylist(batch, schema=schema)


def parquet_columns(path: Path, rows: int, columns: int, size: int) -> dict[str, list[Any]]:
    """The columns of a Parquet file, as Python values.

    Args:
        path: the file's.
        rows: how many it may have.
        columns: how many it may have.
        size: how many bytes it may have uncompressed, where equal texts count once.

    Raises:
        UsageError: pyarrow is not installed.
        OSError: it cannot be opened.
        ValueError: it is not such a file, or exceeds a limit.
    """
    arrow = pyarrow_module()
    from pyarrow.parquet import ParquetFile

    try:
        with path.open("rb") as stream, ParquetFile(stream) as file:
            schema, count = file.schema_arrow, file.metadata.num_rows
        for number, most, what in ((count, rows, "rows"), (len(schema), columns, "columns")):
            if number > most:
                raise ValueError(f"it has {number} {what}, and {most} are read at most")
        for one in schema:
            if arrow.types.is_nested(one.type):
                raise ValueError(f'its column "{one.name[:100]}" holds lists or records')
        texts = [one.name for one in schema if arrow.types.is_string(one.type)]
        with path.open("rb") as stream, ParquetFile(stream, read_dictionary=texts) as file:
            return _cells(file, schema.names, size)
    except (arrow.ArrowException, KeyError) as error:
        raise ValueError(f"it is not a readable Parquet file: {error}") from None


def check_names(names: Sequence[str]) -> None:
    """Check that a table's columns have different names.

    Raises:
        ValueError: two have one name.
    """
    twice = next((one for one in names if names.count(one) > 1), None)
    if twice is not None:
        raise ValueError(f'it has two columns "{twice[:100]}"')


def _cells(file: ParquetFile, names: Sequence[str], size: int) -> dict[str, list[Any]]:
    """The cells of an open file, piece by piece: a small file may expand to very much data.

    Raises:
        ValueError: it holds more than ``size`` bytes, or two columns of one name.
    """
    check_names(names)
    cells: dict[str, list[Any]] = {name: [] for name in names}
    held = 0
    for batch in file.iter_batches(BATCH_READ):
        held += batch.nbytes
        if held > size:
            raise ValueError(f"it holds more than {size:,} bytes")
        for name in names:
            cells[name] += _values(batch.column(name))
    return cells


def _values(column: Any) -> list[Any]:
    """Values of Python; of a dictionary's each is made once."""
    from pyarrow import DictionaryArray

    if not isinstance(column, DictionaryArray):
        made: list[Any] = column.to_pylist()
        return made
    words = [*column.dictionary.to_pylist(), None]
    return [words[-1 if one is None else one] for one in column.indices.to_pylist()]
