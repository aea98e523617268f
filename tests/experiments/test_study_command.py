"""``prima study``: its formats, its exit code, and the tables that scenarios expect."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from prima import api
from prima.errors import UsageError
from prima.experiments.study import situations, study
from tests.helpers.bad_input import app
from tests.helpers.here import prima


def test_the_command_prints_json() -> None:
    done = prima("study", situations()[4], "--policy", "prima", "--format", "json")
    assert done.returncode == 0
    [result] = json.loads(done.stdout)
    assert (result["situation"], result["broken_waiting"], result["distance"]) == ("s05", 1, 0)


def scenario_of(path: Path, folder: Path) -> Path:
    """A scenario in a home with one application."""
    world = api.documents_folder() / "worlds" / "home.xml"
    robot = api.documents_folder() / "robots" / "papero.xml"
    (folder / "s.xml").write_text(
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="{world}"'
        f' robot="{robot}"><robot at="charger"/><application src="{path}"/></scenario>'
    )
    return folder / "s.xml"


def test_a_failed_application_is_marked_and_determines_the_exit_code(tmp_path: Path) -> None:
    path = tmp_path / "app.xml"
    path.write_text(app('<form id="f"><block><throw event="error.x"/></block></form>'))
    done = prima("study", scenario_of(path, tmp_path), "--policy", "fifo")
    assert (done.returncode, done.stdout.splitlines()[-1].split()[:3]) == (3, ["s", "fifo", "!"])


def test_a_folder_stands_for_its_scenarios(tmp_path: Path) -> None:
    path = tmp_path / "app.xml"
    path.write_text(app('<form id="f"><block><exit/></block></form>'))
    twice = ("--policy", "fifo", "--policy", "fifo")
    done = prima("study", tmp_path, scenario_of(path, tmp_path), *twice)
    told = [line.split()[:2] for line in done.stdout.splitlines() if line]
    assert (done.returncode, told[1:]) == (0, [["s", "fifo"]])
    (tmp_path / "s.xml").unlink()
    assert "contains no scenarios" in prima("study", tmp_path).stderr


def test_scenarios_with_the_same_id_can_be_told_apart(tmp_path: Path) -> None:
    path = tmp_path / "app.xml"
    path.write_text(app('<form id="f"><block><exit/></block></form>'))
    first = scenario_of(path, tmp_path)
    second = first.with_name("second.xml")
    second.write_text(first.read_text())
    done = prima("study", first, second, "--policy", "fifo", "--format", "csv")
    assert [line.split(",")[0] for line in done.stdout.splitlines()[1:]] == ["s", str(second)]


def test_an_expected_table_that_is_none_is_told(tmp_path: Path) -> None:
    scenario = scenario_of(api.documents_folder() / "fa" / "emotions.xml", tmp_path)
    (tmp_path / "s.txt").write_text("nothing\n")
    with pytest.raises(UsageError, match="not a table"):
        list(study([scenario]))


def test_a_table_that_begins_within_a_row_is_told(tmp_path: Path) -> None:
    scenario = scenario_of(api.documents_folder() / "fa" / "emotions.xml", tmp_path)
    head, row = "       No.  Time    Who  App  Behavior  Event\n", f'{"":30}"a text"\n'
    (tmp_path / "s.txt").write_text(head + row)
    with pytest.raises(UsageError, match="not a table of a transcript"):
        list(study([scenario]))


def test_an_expected_table_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    scenario = scenario_of(api.documents_folder() / "fa" / "emotions.xml", tmp_path)
    table = api.rehearse(scenario, isolate="none").table().replace("\n", "\r\n")
    (tmp_path / "s.txt").write_bytes(b"\xef\xbb\xbf" + table.encode())
    [result] = study([scenario], ["prima"])
    assert (result.distance, result.missing) == (0, 0)
