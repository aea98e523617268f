"""prima report with a sweep's table: pages, figures, and what is told of wrong tables."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

pytest.importorskip("scipy")

from lxml import etree

from tests.helpers.here import prima
from tests.helpers.swept import runs, write

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def desk(tmp_path: Path) -> Path:
    write(tmp_path, runs())
    return tmp_path


def test_a_table_becomes_a_page(desk: Path) -> None:
    done = prima("report", "sweep.csv", "-o", "page.html", cwd=desk)
    assert (done.returncode, done.stdout) == (0, "") and "page.html:" in done.stderr
    page = (desk / "page.html").read_text(encoding="utf-8")
    for folder in (".", "sweep"):
        again = prima("report", folder, "-o", "-", cwd=desk)
        assert (again.returncode, again.stderr) == (0, "")
        assert again.stdout == page


def test_figures_are_written_as_svg(desk: Path) -> None:
    done = prima("report", "sweep.csv", "--to", "svg", "-o", "figures", cwd=desk)
    assert (done.returncode, done.stderr) == (0, "figures: 5 figures\n")
    names = ["broken.svg", "orders.svg", "reaction_max.svg", "reaction_mean.svg", "seconds.svg"]
    assert sorted(one.name for one in (desk / "figures").iterdir()) == names
    for name in names:
        root = etree.parse(str(desk / "figures" / name)).getroot()
        assert root.findtext(f"{SVG}title") and root.findtext(f"{SVG}desc")
        assert "prefers-color-scheme: dark" in (desk / "figures" / name).read_text(encoding="utf-8")
        width, height = float(root.get("width", "")), float(root.get("height", ""))
        for one in root.iter(f"{SVG}rect", f"{SVG}text"):
            x, y = float(one.get("x", "")), float(one.get("y", ""))
            assert 0 <= x <= x + float(one.get("width", "0")) <= width, (name, one.attrib)
            assert 0 <= y <= y + float(one.get("height", "0")) <= height, (name, one.attrib)


def test_counts_have_whole_numbers_on_their_axis(desk: Path) -> None:
    words = ("report", "sweep.csv", "--to", "svg", "--figure", "broken")
    drawn = etree.fromstring(prima(*words, cwd=desk).stdout.encode())
    texts = [one.text or "" for one in drawn.iter(f"{SVG}text")]
    assert texts[-3:] == ["0", "1", "broken"]


def test_one_figure_may_be_named(desk: Path) -> None:
    done = prima(
        "report", "sweep.csv", "--to", "svg", "--figure", "seconds", "-o", "s.svg", cwd=desk
    )
    assert (done.returncode, done.stderr) == (0, "s.svg: written\n")
    printed = prima("report", "sweep.csv", "--to", "svg", "--figure", "seconds", cwd=desk)
    assert printed.stdout == (desk / "s.svg").read_text(encoding="utf-8")
    words = ("--to", "svg", "--figure", "orders", "--by", "policy", "--by", "when.at")
    drawn = etree.fromstring(prima("report", "sweep.csv", *words, cwd=desk).stdout.encode())
    texts = [one.text or "" for one in drawn.iter(f"{SVG}text")]
    assert texts[0] == "policy by when.at" and {"prima", "fifo", "9"} <= set(texts)
    assert texts.count("1") == 11 and texts.count("3") == 3
    assert "1: aaaaaaaaaaaa, 30 runs (50.0%)" in texts


HEAD = "run,scenario,policy,seed,exit,ended,failures,expects_failed,order,transcript,seconds\r\n"
ROW = "0,s.xml,prima,1,0,quiet,,0,abc,,1.5\r\n"
WRONG = [
    ("", "not the table of a sweep: it is empty."),
    (HEAD, "the table has no rows; make its runs by prima sweep."),
    (HEAD + ROW[:20], "the table has no rows (line 2 has no end, so it is left out)"),
    ("a,b\r\n1,2\r\n", 'it has no column "run".'),
    (HEAD.replace("order", "ordre") + ROW, 'it has no column "order". Did you mean "ordre"?'),
    (HEAD.replace(",seconds", "") + ROW.replace(",1.5", ""), "it has no column of a measure"),
    (HEAD.replace(",seed", ",run") + ROW, 'it has two columns "run"'),
    ((HEAD + ROW).replace(",", ";"), "its cells are separated by ';'; save it with ','"),
    (HEAD + "1,2\r\n" + ROW, "line 2 has 2 cells, and its head has 11"),
    (HEAD + ROW.replace("1.5", "long"), 'row 1, column "seconds": "long" is not a number'),
    (HEAD + ROW.replace("1.5", "1e300"), "or is too large; mend the table."),
    (HEAD + ROW.replace("1.5", "inf"), '"inf" is not a number'),
    (HEAD + ROW.replace("quiet", "q" * 200_000), "line 2: field larger than field limit"),
    (HEAD + ROW.replace("quiet", "\udcff"), "it is not UTF-8."),
    ("x," * 2000 + "\r\n", "it has 2001 columns, and 1000 are read at most"),
]


@pytest.mark.parametrize(("text", "told"), WRONG)
def test_what_is_no_table_is_told(tmp_path: Path, text: str, told: str) -> None:
    data = text.encode("utf-8", "surrogateescape")
    (tmp_path / "bad.csv").write_bytes(data)
    done = prima("report", "bad.csv", "-o", "page.html", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("prima: bad.csv: ") and told in done.stderr, done.stderr
    assert done.stderr.count("\n") == 1 and not (tmp_path / "page.html").exists()


def test_a_table_that_was_cut_off_is_shown_as_far_as_it_goes(desk: Path) -> None:
    whole = (desk / "sweep.csv").read_bytes()
    (desk / "sweep.csv").write_bytes(whole[:-10])
    done = prima("report", "sweep.csv", "-o", "page.html", cwd=desk)
    assert done.returncode == 2
    assert (
        "sweep.csv: the table is not whole: line 61 has no end, so it is left out." in done.stderr
    )
    page = (desk / "page.html").read_text(encoding="utf-8")
    assert "<dt>Runs</dt><dd>59</dd>" in page and "The table is not whole: line 61" in page


def test_a_table_whose_sweep_was_broken_off_is_shown_as_far_as_it_goes(desk: Path) -> None:
    whole = (desk / "sweep.csv").read_bytes().split(b"\r\n")
    (desk / "sweep.csv").write_bytes(b"\r\n".join(whole[:41]) + b"\r\n")
    done = prima("report", "sweep.csv", "-o", "page.html", cwd=desk)
    told = "the table is not whole: it has 40 of 60 runs; make the others by --resume."
    assert (done.returncode, told in done.stderr) == (2, True), done.stderr
    page = (desk / "page.html").read_text(encoding="utf-8")
    assert "<dt>Runs</dt><dd>40</dd>" in page and "it has 40 of 60 runs" in page


def test_a_spreadsheets_mark_at_the_beginning_is_no_part_of_a_name(desk: Path) -> None:
    (desk / "sweep.csv").write_bytes(b"\xef\xbb\xbf" + (desk / "sweep.csv").read_bytes())
    assert prima("report", "sweep.csv", "-o", "page.html", cwd=desk).returncode == 0


def test_folders_without_one_table_are_told(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    done = prima("report", "empty", "-o", "page.html", cwd=tmp_path)
    assert done.returncode == 2
    assert "empty: no table in this folder (.csv or .parquet). Name a transcript" in done.stderr
    for name in ("a.csv", "b.parquet"):
        (tmp_path / name).write_text("")
    done = prima("report", ".", "-o", "page.html", cwd=tmp_path)
    assert done.returncode == 2 and "2 tables here; name one: a.csv, b.parquet." in done.stderr


def test_parquet_that_is_none_and_a_file_that_is_not_there(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    (tmp_path / "bad.parquet").write_text("PAR1 nothing")
    done = prima("report", "bad.parquet", "-o", "page.html", cwd=tmp_path)
    assert done.returncode == 2 and "it is not a readable Parquet file" in done.stderr
    for gone in ("gone.csv", "gone.parquet"):
        done = prima("report", gone, "-o", "page.html", cwd=tmp_path)
        assert done.returncode == 2 and f"{gone}: cannot be read: No such file" in done.stderr


@pytest.mark.parametrize(
    ("missing", "name", "told"),
    [
        ("pyarrow", "sweep.parquet", "Parquet needs pyarrow: pip install 'prima[experiments]'"),
        ("scipy", "sweep.csv", "a sweep's page needs scipy: pip install 'prima[experiments]'."),
    ],
)
def test_a_library_that_is_not_there_is_named(
    desk: Path, monkeypatch: pytest.MonkeyPatch, missing: str, name: str, told: str
) -> None:
    from prima import results
    from prima.errors import UsageError

    (desk / "sweep.parquet").write_bytes(b"PAR1")
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(UsageError, match=r"pip install") as raised:
        results.read(desk / name)
    assert told in str(raised.value)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("sweep.csv --policy fifo -o p.html", "name its table alone"),
        ("sweep.csv sweep.csv -o p.html", "name its table alone"),
        ("sweep.csv --by policy --by answer --by seed -o p.html", "at most two factors"),
        ("sweep.csv --by polcy -o p.html", 'Did you mean "policy"?'),
        ("sweep.csv --by seed -o p.html", '"seed" is not a factor with several levels'),
        ("sweep.csv --figure seconds -o p.html", "--figure needs --to svg"),
        ("sweep.csv --to svg", "Name the folder for the figures"),
        ("sweep.csv --to svg --figure second -o p.svg", 'Did you mean "seconds"?'),
        ("sweep.csv --to svg -o sweep.csv", "write elsewhere"),
        ("sweep.csv --to svg -o other.txt", "other.txt: a file is where a folder is needed."),
        ("sweep.csv -o sweep.csv", "write elsewhere"),
        ("sweep -o sweep.csv", "write elsewhere"),
        ("sweep.csv -o sweep/dictionary.json", "write elsewhere"),
        ("sweep.csv -o nowhere/p.html", "cannot be written"),
        ("t.jsonl --by policy -o p.html", "are for the table of a sweep"),
        ("t.jsonl --to svg -o p.html", "are for the table of a sweep"),
    ],
)
def test_wrong_words_are_told(desk: Path, words: str, told: str) -> None:
    (desk / "other.txt").write_text("")
    before = {path: path.read_bytes() for path in desk.rglob("*") if path.is_file()}
    done = prima("report", *words.split(), cwd=desk)
    assert done.returncode == 2 and told in done.stderr, done.stderr
    assert {path: path.read_bytes() for path in desk.rglob("*") if path.is_file()} == before
