"""Tables and dictionaries that want too much memory, or make a spreadsheet do something."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("scipy")

from prima import results
from prima.errors import UsageError
from prima.experiments.table import BATCH_READ, Column, line, read_rows
from prima.results.reading import MOST_LINE
from tests.helpers.swept import runs, write

FORMULAS = ("=1+1", "@SUM(A1)", "+1", "-1 more", " =A1", "'=A1", "''", "'t is", "Yes.", "\uff1dA1")


def test_no_cell_is_a_formula_and_each_is_read_back(tmp_path: Path) -> None:
    column = Column("answer", "string", "factor", "", "")
    (tmp_path / "t.csv").write_text(line(["answer"]) + "".join(line([one]) for one in FORMULAS))
    cells = (tmp_path / "t.csv").read_text().splitlines()[1:]
    assert not [one for one in cells if one.strip('" ')[:1] in "=+-@\uff1d"]
    with (tmp_path / "t.csv").open(newline="") as stream:
        assert [row["answer"] for row in read_rows(stream, [column])] == list(FORMULAS)


def test_a_page_has_the_levels_as_they_were_varied(tmp_path: Path) -> None:
    data = results.read(
        write(tmp_path, [row | {"answer": "=" * (row["run"] % 2)} for row in runs()])
    )
    assert [one.distinct for one in data.varied if one.name == "answer"] == [["", "="]]


def test_a_small_parquet_file_may_not_hold_more_than_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """21 kB of which 100 GB were made."""
    arrow = pytest.importorskip("pyarrow")
    from pyarrow.parquet import write_table

    count = 2 * BATCH_READ
    cells = {
        "run": list(range(count)),
        "exit": [0] * count,
        "order": ["a"] * count,
        "seconds": [1] * count,
    }
    long = arrow.DictionaryArray.from_arrays(
        arrow.array([0] * count, arrow.int32()), ["x" * 1_000_000]
    )
    write_table(
        arrow.table({**cells, "failures": long}), tmp_path / "t.parquet", compression="zstd"
    )
    data = results.read(tmp_path / "t.parquet")
    texts = data.sheet.cells["failures"]
    assert len(texts) == count and len({id(one) for one in texts}) <= 2
    monkeypatch.setattr("prima.results.reading.MOST_BYTES", 1_000_000)
    other = {**cells, "failures": [f"{number:0>200}" for number in range(count)]}
    write_table(arrow.table(other), tmp_path / "t.parquet", compression="zstd")
    with pytest.raises(UsageError, match="it holds more than 1,000,000 bytes"):
        results.read(tmp_path / "t.parquet")


def test_parquet_columns_that_no_sweep_has(tmp_path: Path) -> None:
    arrow = pytest.importorskip("pyarrow")
    from pyarrow.parquet import write_table

    cells = {"run": [0], "exit": [0], "order": ["a"], "seconds": [1.0]}
    for more, why in (
        ({"m": [[1, 2]]}, 'its column "m" holds lists or records'),
        ({f"c{number}": [1] for number in range(1000)}, "1000 are read at most"),
    ):
        write_table(arrow.table({**cells, **more}), tmp_path / "t.parquet")
        with pytest.raises(UsageError, match=why):
            results.read(tmp_path / "t.parquet")
    twice = arrow.Table.from_arrays([[0], [0]], names=["run", "run"])
    write_table(twice, tmp_path / "t.parquet")
    with pytest.raises(UsageError, match='two columns "run"'):
        results.read(tmp_path / "t.parquet")


def test_a_line_without_an_end(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("," * (MOST_LINE + 1))
    with pytest.raises(UsageError, match="line 1 has more than 10,000,000 characters"):
        results.read(tmp_path / "t.csv")


def test_more_rows_than_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    table = write(tmp_path, runs())
    monkeypatch.setattr("prima.results.reading.MOST_ROWS", 60)
    assert len(results.read(table)) == 60
    monkeypatch.setattr("prima.results.reading.MOST_ROWS", 59)
    with pytest.raises(UsageError, match="it has more than 59 rows"):
        results.read(table)


def test_a_file_of_another_kind_is_no_table(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"name a table that ends with \.csv or \.parquet\."):
        results.read(write(tmp_path, runs()).rename(tmp_path / "sweep.txt"))


def test_a_dictionary_that_repeats_itself_makes_no_larger_page(tmp_path: Path) -> None:
    table = write(tmp_path, runs())
    plain = results.make(results.read(table), tmp_path)
    told = tmp_path / "sweep" / "dictionary.json"
    fields = json.loads(told.read_text())
    lost = [{**fields["fields"][0], "name": "x" * 100_000 + str(number)} for number in range(20)]
    fields["fields"] = fields["fields"] * 1000 + lost
    told.write_text(json.dumps(fields))
    assert len(results.make(results.read(table), tmp_path)) < len(plain) + 10_000


def test_a_dictionary_that_takes_an_outcome_for_a_factor(tmp_path: Path) -> None:
    table = write(tmp_path, [one | {"expects_failed": "none"} for one in runs()])
    told = tmp_path / "sweep" / "dictionary.json"
    fields = json.loads(told.read_text())
    outcome = next(one for one in fields["fields"] if one["name"] == "expects_failed")
    outcome |= {"role": "factor", "type": "string"}
    told.write_text(json.dumps(fields))
    assert "With failed expectations" not in results.make(results.read(table), tmp_path)
