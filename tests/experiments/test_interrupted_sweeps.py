"""Sweeps that are interrupted or go wrong: what was made stays, and --resume goes on."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from prima.experiments.pools import local
from prima.experiments.scenariotext import Variant
from prima.experiments.sweep import Output, Sweep, SweepQuestion
from prima.experiments.variants import Made, Stage
from prima.pool import Died
from tests.helpers.batches import until
from tests.helpers.here import prima
from tests.helpers.sweeps import write_visit

LEVELS = "touch=0s..8s/100ms"
ARGUMENTS = ("sweep", "visit.xml", "--vary", LEVELS)


@pytest.fixture(autouse=True)
def visit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_visit(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a sweep that was not interrupted."""
    place = tmp_path_factory.mktemp("swept")
    write_visit(place)
    (place / "whole").mkdir()
    assert prima(*ARGUMENTS, "-o", "whole/t.csv", cwd=place).returncode == 0
    return place / "whole"


@pytest.fixture
def whole(visit: Path, swept: Path) -> bytes:
    """The table that an interrupted sweep has to come to, in a folder with all that belongs to it."""
    shutil.copytree(swept, visit / "whole")
    return Path("whole/t.csv").read_bytes()


@pytest.mark.parametrize("cut", [0, 30, 300, 1000, -1, -2, -200])
def test_a_table_cut_anywhere_is_resumed_to_the_same(whole: bytes, cut: int) -> None:
    Path("whole/t.csv").write_bytes(whole[:cut])
    done = prima(*ARGUMENTS, "-o", "whole/t.csv", "--resume")
    assert done.returncode == 0, done.stderr
    assert Path("whole/t.csv").read_bytes() == whole


def test_a_sweep_that_is_done_makes_no_run_again(whole: bytes) -> None:
    done = prima(*ARGUMENTS, "-o", "whole/t.csv", "--resume")
    assert "81 of 81 runs had been made before" in done.stderr
    assert Path("whole/t.csv").read_bytes() == whole


def lasting(*more: str) -> subprocess.Popen[str]:
    """A sweep of many runs, when some are made."""
    command = [sys.executable, "-m", "prima", "sweep", "visit.xml", "-o", "t.csv"]
    made = subprocess.Popen(
        [*command, "--vary", "touch=0s..8s/1ms", *more],
        stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    until(lambda: Path("t.csv").exists() and Path("t.csv").read_bytes().count(b"\n") > 20)
    return made


def test_ctrl_c_keeps_what_is_done() -> None:
    made = lasting()
    made.send_signal(signal.SIGINT)
    out, err = made.communicate(timeout=60)
    assert (made.returncode, out) == (130, "")
    assert "t.csv: the runs made so far are kept; --resume goes on." in err
    begun = Path("t.csv").read_bytes()
    assert begun.count(b"\n") > 20
    made = lasting("--resume")
    made.send_signal(signal.SIGINT)
    made.communicate(timeout=60)
    assert Path("t.csv").read_bytes().startswith(begun)


def test_killed_in_the_middle_it_goes_on() -> None:
    made = lasting()
    made.kill()
    made.communicate(timeout=60)
    begun = Path("t.csv").read_bytes()
    begun = begun[: begun.rindex(b"\n") + 1]
    made = lasting("--resume")
    until(lambda: len(Path("t.csv").read_bytes()) > len(begun))
    made.send_signal(signal.SIGINT)
    made.communicate(timeout=60)
    assert Path("t.csv").read_bytes().startswith(begun)


Run = Callable[[Variant], Made]


def here(work: Callable[[Run, int, Variant], Made | Died]) -> Any:
    """A pool in this process."""

    @contextmanager
    def pool(stage: Stage) -> Iterator[Any]:
        yield lambda variants: ((one, work(stage.run, n, one)) for n, one in enumerate(variants))

    return pool


def test_texts_of_several_lines_are_resumed_wherever_they_are_cut() -> None:
    vary = {"reply": 'Yes,\n"please".|No.\r\nNever.', "touch": "1s|2s"}
    sweep = Sweep(SweepQuestion(("visit.xml",), vary))
    pool = here(lambda run, _number, one: run(one))
    for _ in Output(sweep, "t.csv", pool).write():
        pass
    made = Path("t.csv").read_bytes()
    for cut in range(made.index(b"\r\n") + 2, len(made), 7):
        Path("t.csv").write_bytes(made[:cut])
        for _ in Output(sweep, "t.csv", pool).write(resume=True):
            pass
        assert Path("t.csv").read_bytes() == made, cut


def test_parquet_is_there_after_an_interrupt() -> None:
    parquet = pytest.importorskip("pyarrow.parquet")

    def work(run: Run, number: int, one: Variant) -> Made:
        if number == 3:
            raise KeyboardInterrupt
        return run(one)

    sweep = Sweep(SweepQuestion(("visit.xml",), {"touch": "0s..8s/1s"}))
    with pytest.raises(KeyboardInterrupt):
        list(Output(sweep, "t.parquet", here(work)).write())
    assert parquet.read_table("t.parquet").num_rows == 3
    list(Output(sweep, "t.parquet", local(2)).write(resume=True))
    assert parquet.read_table("t.parquet").num_rows == 9


def test_a_worker_that_dies_costs_its_own_run() -> None:
    def work(run: Run, number: int, one: Variant) -> Made | Died:
        return Died(-9) if number == 1 else run(one)

    sweep = Sweep(SweepQuestion(("visit.xml",), {"touch": "0s..2s/1s"}))
    rows = [dict(zip([one.name for one in sweep.columns], row, strict=True))
            for row in sweep.results(here(work))]  # fmt: skip
    assert [row["exit"] for row in rows] == [0, 3, 0]
    assert rows[1]["failures"] == "its process ended with code -9: no memory left?"
    assert rows[1]["order"] == "" and rows[1]["seconds"] is None


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"prima": "0.9"}, "with another version of PRIMA"),
        ({"files": []}, "with other documents"),
        ({"levels": [["1ms"]]}, "with other factors or options"),
    ],
)
def test_another_sweep_is_not_resumed(whole: bytes, change: dict[str, Any], why: str) -> None:
    plan = Path("whole/t/plan.json")
    plan.write_text(json.dumps({**json.loads(plan.read_text()), **change}))
    done = prima(*ARGUMENTS, "-o", "whole/t.csv", "--resume")
    assert done.returncode == 2 and why in done.stderr, done.stderr
    assert Path("whole/t.csv").read_bytes() == whole


def test_a_document_that_was_changed_since(whole: bytes) -> None:
    Path("guide.xml").write_text(Path("guide.xml").read_text().replace("Welcome", "Hello"))
    done = prima(*ARGUMENTS, "-o", "whole/t.csv", "--resume")
    assert done.returncode == 2 and "with other documents" in done.stderr


@pytest.mark.parametrize("content", ["", "run,other\r\n", "\ufeff\0\r\n", "[" * 10_000])
def test_tables_and_plans_of_others(whole: bytes, content: str) -> None:
    Path("whole/t.csv").write_text(content)
    done = prima(*ARGUMENTS, "-o", "whole/t.csv", "--resume")
    assert done.returncode in (0, 2), done.stderr
    if done.returncode:
        assert "not the table of a sweep" in done.stderr
    Path("whole/t/plan.json").write_text(content)
    done = prima(*ARGUMENTS, "-o", "whole/t.csv", "--resume")
    assert done.returncode == 2 and "cannot be resumed" in done.stderr, done.stderr


def _changed(column: int, cell: str) -> Callable[[list[str]], list[str]]:
    """Changes a cell of the second row."""

    def change(rows: list[str]) -> list[str]:
        cells = rows[1].split(",")
        cells[column] = cell
        return [rows[0], ",".join(cells), *rows[2:]]

    return change


@pytest.mark.parametrize(
    ("change", "why"),
    [
        (lambda rows: [*rows[:1], *rows[2:]], "run 1 is missing"),
        (lambda rows: [*rows[:3], *rows[2:]], "run 3 is missing"),
        (_changed(0, ""), "run 1 is missing"),
        (_changed(9, "../../evil"), "run 1 does not have the signature of an order"),
        (_changed(9, "a,b"), "line 3 has "),
        (_changed(2, 'pri"ma'), "run 1 has a quotation mark too many or too few"),
        (_changed(1, "x" * 200_000), "line 3: field larger than field limit"),
    ],
)
def test_a_damaged_table_is_not_resumed(
    whole: bytes, change: Callable[[list[str]], list[str]], why: str
) -> None:
    head, *rows = whole.decode().splitlines()
    assert head.split(",")[9] == "order"
    damaged = "\r\n".join([head, *change(rows)[:20], ""]).encode()
    Path("whole/t.csv").write_bytes(damaged)
    done = prima(*ARGUMENTS, "-o", "whole/t.csv", "--resume")
    assert done.returncode == 2, done.stderr
    assert f"whole/t.csv: not the table of a sweep: {why}" in done.stderr
    assert Path("whole/t.csv").read_bytes() == damaged


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk() -> None:
    Path("t.csv").symlink_to("/dev/full")
    done = prima(*ARGUMENTS, "-o", "t.csv")
    assert done.returncode == 2
    assert "cannot be written: No space left on device" in done.stderr, done.stderr


def test_a_folder_that_cannot_be_written() -> None:
    Path("t").write_text("a file")
    done = prima(*ARGUMENTS, "-o", "t.csv")
    assert done.returncode == 2 and "t: a file is where a folder is needed" in done.stderr
    done = prima(*ARGUMENTS, "-o", "t.xlsx")
    assert done.returncode == 2 and "ends with .csv or .parquet" in done.stderr
    done = prima(*ARGUMENTS, "-o", "visit.xml")
    assert done.returncode == 2


def test_a_document_without_end_is_a_row() -> None:
    guide = Path("guide.xml").read_text()
    Path("guide.xml").write_text(guide.replace("<exit/>", '<goto next="#tour"/>'))
    Path("pet.xml").write_text(
        Path("pet.xml").read_text().replace("<speak>That tickles!</speak>", '<goto next="#mood"/>')
        .replace("<on event", '<block><goto next="#mood"/></block><on event')
    )  # fmt: skip
    done = prima("sweep", "visit.xml", "--vary", "reply=Yes.|No.", "-o", "t.csv")
    assert done.returncode == 3
    with Path("t.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(row["exit"], row["ended"]) for row in rows] == [("3", "until")] * 2
    assert all(row["failures"].startswith("pet: ") for row in rows)
