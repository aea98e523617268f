"""Tables that a run is compared with."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.testing.golden import difference
from prima.testing.running import TestOptions, run_one
from prima.transcript.table import format_rows
from tests.helpers.here import prima
from tests.helpers.testing import DESK, write


def table_of(path: Path) -> str:
    return api.rehearse(path).table()


def test_a_table_is_compared_by_text_or_by_behavior(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    run = api.rehearse(path)
    table, rows = run.table(), run.rows()
    assert difference(table, rows, "text") == ""
    late = run.rows()
    for row in late[3:]:
        row.time += 0.2
    later = format_rows(late)
    assert later != table
    assert difference(later, rows, "behavior") == ""
    assert difference(later, rows, "text").startswith("--- expected")
    other = table.replace("Going up.", "Going down.")
    assert "(was: " in difference(other, rows, "behavior")
    assert difference("no table at all\n", rows, "text").startswith("--- expected")
    assert difference("", rows, "behavior")


@pytest.mark.parametrize("columns", [60, 80, 116, 300])
def test_a_table_may_be_as_wide_as_it_was_written(columns: int) -> None:
    run = api.rehearse(api.documents_folder() / "scenarios" / "follow-during-navigation-ja.xml")
    assert difference(run.table(columns=columns), run.rows(), "text") == ""


def test_update_shows_asks_and_never_writes_a_failed_run(tmp_path: Path) -> None:
    path = write(tmp_path, '<expect says="Going up"/>')
    golden = tmp_path / "lift.txt"
    shown = prima("test", "lift.xml", "--update", cwd=tmp_path)
    assert shown.returncode == 0 and not golden.exists()
    assert "not written" in shown.stderr and "Going up." in shown.stdout
    written = prima("test", "lift.xml", "--update", "--yes", cwd=tmp_path)
    assert written.returncode == 0
    assert golden.read_text(encoding="utf-8") == table_of(path)
    (tmp_path / "desk.xml").write_text(DESK.replace("Please do", "Do"), encoding="utf-8")
    differs = prima("test", cwd=tmp_path)
    assert differs.returncode == 1 and "(was: " in differs.stdout
    refused = prima("test", "--update", cwd=tmp_path)
    assert refused.returncode == 1 and "--yes" in refused.stderr
    before = golden.read_bytes()
    write(tmp_path, '<expect says="Going down"/>', DESK.replace("Please do", "Do"))
    failed = prima("test", "--update", "--yes", cwd=tmp_path)
    assert failed.returncode == 1 and golden.read_bytes() == before
    assert "not as expected" in failed.stderr
    write(tmp_path, "", DESK.replace("Please do", "Do"))
    assert prima("test", "--update", "--yes", cwd=tmp_path).returncode == 0
    assert "Do not push." in golden.read_text(encoding="utf-8")
    assert prima("test", cwd=tmp_path).returncode == 0


def test_a_table_is_that_of_the_scenarios_own_policy(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    (tmp_path / "lift.txt").write_text("anything", encoding="utf-8")
    assert run_one(str(path), TestOptions(policy="fifo")).golden == "skipped"
    assert run_one(str(path), TestOptions(policy="prima")).golden == "differs"


def test_a_table_that_is_no_text_is_told(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    (tmp_path / "lift.txt").write_bytes(b"\xff\xfe\x00")
    result = run_one(str(path), TestOptions())
    assert (result.status, result.golden) == ("failed", "differs")
    assert result.difference.endswith("lift.txt: not a transcript's table: it is not UTF-8.")
    assert run_one(str(path), TestOptions(policy="fifo")).golden == "skipped"
