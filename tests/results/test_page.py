"""The page of a sweep: what it says, what it links to, and that strangers' text stays text."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from urllib.parse import quote

import pytest

pytest.importorskip("scipy")

from prima import results
from prima.errors import UsageError
from prima.experiments.table import read_rows, write_parquet
from prima.results.data import MOST_FACTORS, number
from tests import ROOT
from tests.helpers.swept import Tables, known_columns, runs, write

EVIL = "</script><!--<b onclick='x'>\u202e\u2028\"&amp;\x1b[31m"


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("sweep"), runs())


@pytest.fixture(scope="module")
def page(table: Path) -> str:
    return results.make(results.read(table), table.parent)


def test_the_page_is_whole_and_needs_nothing_beside_it(page: str) -> None:
    found = Tables(page)
    assert not {"link", "img", "iframe"} & set(found.tags)
    assert not re.search(r"<[^>]* (style|src|on\w+)=", page)
    assert "http://" not in page and "https://" not in page
    assert "default-src 'none'" in page and "unsafe" not in page
    ids = re.findall(r' id="([^"]*)"', page)
    assert len(ids) == len(set(ids))
    assert all(re.search(f' id="{one[1:]}"', page) for one in found.links if one[:1] == "#")


def test_the_head_and_the_factors(page: str) -> None:
    for told in ("<dt>Runs</dt><dd>60</dd>", "<dt>Orders</dt><dd>3</dd>", "<dd>60 (100.0%)</dd>"):
        assert told in page
    assert "<dt>Version of PRIMA</dt><dd>1.0.0</dd>" in page and "0123456789ab" in page
    factors = {row["Factor"]: row for row in Tables(page).by_name("factors")}
    assert factors["when.at (s)"]["Levels"] == "0 to 9"
    assert (factors["when.at (s)"]["Number"], factors["scenario"]["Number"]) == ("10", "1")
    assert factors["answer"]["Levels"] == "“Yes.”, “No.”, (nothing)"
    assert next(Tables(page).by_name("outcomes"))["Runs"] == "60 (100.0%)"


def test_measures_have_their_means_and_what_does_not_differ_is_told(page: str) -> None:
    measures = {row["Measure"]: row for row in Tables(page).by_name("measures")}
    assert list(measures) == ["seconds (s)", "broken", "reaction_mean (s)", "reaction_max (s)"]
    assert measures["seconds (s)"]["Mean"] == "29.5" and measures["seconds (s)"]["Most"] == "39"
    assert measures["broken"]["Mean"] == "0.5"
    assert float(measures["broken"]["95 % from"]) == pytest.approx(0.37, abs=0.03)
    reaction = measures["reaction_mean (s)"]
    assert (reaction["Runs"], reaction["Missing"], reaction["Median"]) == ("54", "6", "0.5")
    assert "6 runs without a value." in page
    constant = re.search(r'<p id="constant">(.*?)</p>', page)
    assert constant and "collisions (0)" in constant[1] and "response_mean (0 s)" in constant[1]
    assert page.count("<figure>") == 4


def test_a_value_that_is_the_same_where_there_is_one_is_told_so(tmp_path: Path) -> None:
    made = [{**row, "response_mean": 0.0 if row["run"] else None} for row in runs()]
    page = results.make(results.read(write(tmp_path, made)), tmp_path)
    constant = re.search(r'<p id="constant">(.*?)</p>', page)
    assert constant and constant[1].startswith("The same in all runs that have a value, so")
    assert "response_mean (0 s; 1 run without a value)" in constant[1]


def test_each_level_has_its_row(page: str) -> None:
    rows = [row for row in Tables(page).by_name("levels-0") if row["Factor"] == "policy"]
    assert [(row["Level"], row["Mean"], row["Runs"]) for row in rows] == [
        ("prima", "24.5", "30"),
        ("fifo", "34.5", "30"),
    ]
    assert "n 30</text>" in page and 'aria-label="seconds (s): duration of the run.' in page


def test_tests_have_sizes_effects_and_functions(page: str) -> None:
    found = {
        (row["Measure"], row["Factor"], row["Test"]): row for row in Tables(page).by_name("tests")
    }
    broken = found["broken", "policy", "Mann-Whitney"]
    assert broken["Effect"] == "Cliff's δ = -1" and broken["Runs"] == "prima: 30, fifo: 30"
    assert broken["Function"] == "scipy.stats.mannwhitneyu"
    late = found["seconds", "when.at", "Spearman"]
    assert (late["Runs"], late["Function"]) == ("60", "scipy.stats.spearmanr")
    answers = found["reaction_mean", "answer", "Kruskal-Wallis"]
    assert (answers["Runs"], answers["Statistic"]) == ("18, 18, 18", "H = 53")
    assert answers["Effect"] == "ε² = 1"
    assert found["seconds", "answer", "Kruskal-Wallis"]["p (Holm)"] == "1"
    untested = list(Tables(page).by_name("untested"))
    assert {row["Factor"] for row in untested} == {"when.at"}
    assert "“0” has 0 of them, and a test needs 5" in untested[0]["Why"]
    for formula in ("<mi>δ</mi>", "<mi>ε</mi>", "<mi>ρ</mi>", "Holm's method"):
        assert formula in page


def test_the_map_has_an_order_in_each_cell_and_links_where_there_is_a_transcript(
    page: str, table: Path
) -> None:
    head, *rows = Tables(page).found["map"]
    assert head == ["when.at \\ answer", "Yes.", "No.", "(nothing)"]
    assert [row[0] for row in rows] == [str(one) for one in range(10)]
    assert {row[1] for row in rows} == {"1 +1"}
    other = Tables(results.make(results.read(table), table.parent, ["policy", "when.at"]))
    head, first, second = other.found["map"]
    assert head[0] == "policy \\ when.at" and first == ["prima", *["1"] * 10]
    assert second == ["fifo", *["2"] * 8, "3", "3"]
    assert other.links.count("./sweep/orders/aaaaaaaaaaaa.jsonl") == 11
    assert not [one for one in other.links if "bbbb" in one], "there is no such file"
    orders = list(other.by_name("orders"))
    assert [row["Transcript"] for row in orders] == ["transcript", "none", "none"]
    strip = Tables(results.make(results.read(table), table.parent, ["policy"]))
    assert strip.found["map"] == [["policy", "Order"], ["prima", "1"], ["fifo", "2 +1"]]


def test_the_map_has_a_level_for_no_value_and_tells_which_cells_have_no_runs(
    tmp_path: Path,
) -> None:
    made = [row | {"when.at": None} if row["when.at"] == 3 else row for row in runs()]
    made = [row for row in made if (row["policy"], row["when.at"]) != ("prima", 9)]
    data = results.read(write(tmp_path, made))
    head, *rows = Tables(results.make(data, tmp_path, ["policy", "when.at"])).found["map"]
    assert head[1:] == ["0", "1", "2", "4", "5", "6", "7", "8", "9", "(nothing)"]
    assert rows == [["prima", *["1"] * 8, "–", "1"], ["fifo", *["2"] * 7, "3", "3", "2"]]
    drawn = results.draw(data, ["policy", "when.at"])
    (orders,) = (one.inline() for one in drawn if one.name == "orders")
    assert orders.count('class="frame"') == 1, "the cell without runs is empty"


def test_of_many_outcomes_the_most_frequent_are_listed(tmp_path: Path) -> None:
    made = [row | {"failures": f"f{max(row['run'], 5)}"} for row in runs()]
    page = results.make(results.read(write(tmp_path, made)), tmp_path)
    rows = list(Tables(page).by_name("outcomes"))
    assert len(rows) == 51 and rows[0]["Runs"] == "6 (10.0%)"
    assert [*rows[-1].values()] == ["others", "–", "5 other outcomes", "5 (8.3%)"]


def test_where_all_measures_differ_nothing_is_told_to_be_the_same(tmp_path: Path) -> None:
    head = "run,scenario,policy,seed,exit,ended,failures,order,transcript,seconds\r\n"
    rows = "".join(f"{at},s.xml,prima,1,0,quiet,,abc,,{at}.5\r\n" for at in range(4))
    (tmp_path / "t.csv").write_text(head + rows, newline="")
    page = results.make(results.read(tmp_path / "t.csv"), tmp_path)
    assert [row["Measure"] for row in Tables(page).by_name("measures")] == ["seconds (s)"]
    assert 'id="constant"' not in page


@pytest.mark.parametrize(
    "field", ["weather", {"name": "weather", "role": "factr"}, {"name": "weather"}]
)
def test_what_a_dictionary_tells_wrongly_is_left_out(tmp_path: Path, field: object) -> None:
    table = write(tmp_path, [row | {"weather": "sun"} for row in runs()])
    path = tmp_path / "sweep" / "dictionary.json"
    told = json.loads(path.read_text())
    path.write_text(json.dumps(told | {"fields": [field, *told["fields"]]}))
    note = "Columns that no dictionary describes are left out: weather."
    assert results.read(table).notes == [note]


def test_links_begin_at_the_page(table: Path) -> None:
    page = results.make(results.read(table), table.parent / "pages" / "new")
    assert "../../sweep/orders/aaaaaaaaaaaa.jsonl" in Tables(page).links


def test_without_transcripts_the_page_says_so(tmp_path: Path) -> None:
    table = write(tmp_path, runs())
    for path in (tmp_path / "sweep" / "orders").iterdir():
        path.unlink()
    page = results.make(results.read(table), tmp_path)
    assert "There are no transcripts of the orders beside the table" in page
    assert not [one for one in Tables(page).links if one[:1] != "#"]


def test_the_maps_of_the_script_are_those_of_the_page(page: str) -> None:
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page)
    assert found
    data = json.loads(found[1])
    assert [one["name"] for one in data["factors"]] == ["policy", "when.at", "answer"]
    assert data["maps"]["0"] == [[0, 30, 30, 1], [1, 24, 30, 2]]
    assert data["maps"]["0,1"][10:] == [[1, 3, 3, 1]] * 8 + [[2, 3, 3, 1]] * 2
    assert data["orders"] == [["1", "./sweep/orders/aaaaaaaaaaaa.jsonl"], ["2", ""], ["3", ""]]


def test_nothing_that_a_table_says_becomes_markup(tmp_path: Path) -> None:
    made = runs()
    for row in made:
        row.update(scenario=EVIL, failures=EVIL, ended=EVIL, answer=row["answer"] + EVIL)
        row.update(order=EVIL, transcript=f"javascript:{EVIL}", run=EVIL)
    table = write(tmp_path, made)
    beside = tmp_path / "sweep" / "dictionary.json"
    told = json.loads(beside.read_text())
    for one in told["fields"]:
        one.update(description=EVIL, unit=EVIL)
    beside.write_text(json.dumps(told))
    (tmp_path / "sweep" / "plan.json").write_text(
        json.dumps(
            {"prima": EVIL, "question": {"scenarios": [EVIL], "design": EVIL}, "files": [EVIL]}
        )
    )
    data = results.read(table)
    page = results.make(data, tmp_path)
    found = Tables(page)
    assert "b" not in found.tags and found.tags.count("script") == 2
    assert not [one for one in found.links if one[:1] != "#"]
    for made_text in (page, *(one.whole() for one in results.draw(data))):
        assert not re.search("[\x00-\x09\x0b-\x1f\u202e\u2028]", made_text)


def test_paths_that_lead_elsewhere_are_no_links(tmp_path: Path) -> None:
    (tmp_path / "orders").mkdir()
    (tmp_path / "orders" / "aa.jsonl").write_text("")
    (tmp_path / "in").mkdir()
    for path in ("../orders/aa.jsonl", "x/../../orders/aa.jsonl", f"{tmp_path}/orders/aa.jsonl"):
        table = write(
            tmp_path / "in", [row | {"order": "aa", "transcript": path} for row in runs()]
        )
        page = results.make(results.read(table), tmp_path)
        assert not [one for one in Tables(page).links if one[:1] != "#"]


@pytest.mark.parametrize("name", ["a,b", "it's", "#1", "50% & more", ".hidden", "v1..2", "日本"])
def test_tables_of_any_name_have_links(tmp_path: Path, name: str) -> None:
    orders = tmp_path / name / "orders"
    orders.mkdir(parents=True)
    (orders / "aa.jsonl").write_text("")
    path = f"{name}/orders/aa.jsonl"
    table = write(tmp_path, [row | {"order": "aa", "transcript": path} for row in runs()])
    links = Tables(results.make(results.read(table), tmp_path)).links
    assert f"./{quote(path)}" in links


def test_parquet_gives_the_same_page(table: Path, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    write(tmp_path, runs())
    write_parquet(tmp_path / "sweep.csv", tmp_path / "sweep.parquet", known_columns())
    with (tmp_path / "sweep.csv").open(newline="") as stream:
        assert len(list(read_rows(stream, known_columns()))) == 60
    csv, parquet = (
        results.make(results.read(tmp_path / f"sweep.{one}"), tmp_path).replace(one, "csv")
        for one in ("csv", "parquet")
    )
    assert csv == parquet


def test_the_same_table_gives_the_same_bytes(table: Path) -> None:
    code = (
        "import sys; from prima import results;"
        f"sys.stdout.write(results.make(results.read({str(table)!r}), {str(table.parent)!r}))"
    )
    pages = {
        subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            check=True,
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONIOENCODING": "utf-8"},
            cwd=ROOT,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(pages) == 1 and len(pages.pop()) > 20_000


def test_a_single_run_has_a_page(tmp_path: Path) -> None:
    page = results.make(results.read(write(tmp_path, runs()[:1])), tmp_path)
    assert "No factor has more than one level" in page and "No measure differs" in page
    assert Tables(page).links == [one for one in Tables(page).links if "bbbb" not in one]


def test_without_a_dictionary_columns_are_known_by_their_names(tmp_path: Path) -> None:
    table = write(
        tmp_path, [row | {"weather": "sun" if row["run"] % 2 else "rain"} for row in runs()]
    )
    page = results.make(results.read(table), tmp_path)
    assert "Columns that no dictionary describes are left out: weather." in page
    many = write(tmp_path, [row | {f"w{n}": "1" for n in range(25)} for row in runs()])
    (note,) = (one for one in results.read(many).notes if "dictionary" in one)
    assert note.endswith("w18, w19 and 5 more.")
    table = write(
        tmp_path, [row | {"weather": "sun" if row["run"] % 2 else "rain"} for row in runs()]
    )
    (tmp_path / "sweep" / "dictionary.json").unlink()
    data = results.read(table)
    assert [one.name for one in data.varied] == ["policy", "when.at", "answer", "weather"]
    assert [one.numeric for one in data.varied] == [False, True, False, False]
    assert "There is no data dictionary beside the table" in results.make(data, tmp_path)


def test_large_tables_have_pages_of_bounded_size(tmp_path: Path) -> None:
    """Thirty thousand runs; each factor has a value, and each run an order, of its own."""
    import numpy as np

    from prima.experiments.table import HEAD, MEASURES, OUTCOMES, line

    rng, count = np.random.default_rng(1), 30_000
    drawn = [f"x{index}" for index in range(MOST_FACTORS + 2)]
    names = [*(one.name for one in (*HEAD, *OUTCOMES, *MEASURES)), *drawn]
    values = rng.random((count, len(drawn))).round(6)
    with (tmp_path / "big.csv").open("w", newline="") as stream:
        stream.write(line(names))
        for index, row in enumerate(values.tolist()):
            fixed = [index, "s", f"p{index % 99}", 1, 0, "quiet", "", 0, f"{index:x}", ""]
            stream.write(line([*fixed, index % 977, index % 13, 0, 0, *row]))
    page = results.make(results.read(tmp_path / "big.csv"), tmp_path)
    assert len(page) < 1_000_000
    assert f"Of {MOST_FACTORS + 3} factors the first {MOST_FACTORS} are shown and tested." in page
    assert "60 others" in page and "the factor has 99 levels, and 12 are compared" in page


def test_an_unknown_factor_is_told(table: Path) -> None:
    with pytest.raises(UsageError, match=r'"answr" is not a factor .*Did you mean "answer"'):
        results.make(results.read(table), table.parent, ["answr"])


@pytest.mark.parametrize(
    ("value", "told"),
    [(0.0, "0"), (12345.6, "12346"), (0.12345, "0.1235"), (1.5, "1.5"), (100.0, "100"), (1e-7, "1e-07")],
)  # fmt: skip
def test_numbers_have_four_digits(value: float, told: str) -> None:
    assert number(value) == told
