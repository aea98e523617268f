"""prima test: scenarios in folders, processes, exit codes, reports for machines, settings."""

from __future__ import annotations

import json
import multiprocessing
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest

from prima import api
from prima.errors import DocumentError, RunError, UsageError
from prima.testing.finding import find, is_scenario
from prima.testing.junit import junit
from prima.testing.running import TestOptions, run_all
from prima.testing.summary import format_result
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.testing import DEMOS, DESK, FIRST, outcome, write


# Finding and running ---------------------------------------------------------------
def test_scenarios_are_found_in_folders(tmp_path: Path) -> None:
    inner = tmp_path / "a" / "b"
    inner.mkdir(parents=True)
    path = write(inner, "")
    hidden = tmp_path / ".git"
    hidden.mkdir()
    write(hidden, "")
    (tmp_path / "other.xml").write_text("<scenario/>")
    (tmp_path / "comment.xml").write_text('<!-- <scenario xmlns="urn:prima:scenario:1"> --><a/>')
    assert find([str(tmp_path)]) == [str(path)]
    assert find([str(path), str(tmp_path)]) == [str(path)]
    with pytest.raises(UsageError, match="no such file"):
        find([str(tmp_path / "none")])
    with pytest.raises(UsageError, match="contains no scenarios"):
        find([str(ROOT / "docs")])
    assert not is_scenario(tmp_path)


def test_all_demo_scenarios_are_as_they_expect() -> None:
    for result in run_all([str(path) for path in DEMOS], TestOptions()):
        assert result.status == "passed", format_result(result)


def test_processes_give_the_same_results_in_the_same_order() -> None:
    paths = [str(path) for path in DEMOS if path.stem.startswith("s0")][:4]
    choice = TestOptions(coverage=True)
    one, several = list(run_all(paths, choice)), list(run_all(paths, choice, 2))
    for result in (*one, *several):
        result.seconds = 0.0
    assert one == several


def test_a_process_that_is_ended_ends_the_tests(tmp_path: Path) -> None:
    endless(tmp_path)

    def end_one() -> None:
        started = multiprocessing.active_children()
        min(started, key=lambda one: one.pid or 0).kill()  # whose result is the next to be told

    threading.Timer(2, end_one).start()
    with pytest.raises(RunError, match="was killed"):
        list(run_all([str(tmp_path / "a.xml"), str(tmp_path / "b.xml")], TestOptions(), 2))


def test_what_a_process_cannot_read_is_told(tmp_path: Path) -> None:
    paths = [str(DEMOS[0]), str(tmp_path / "gone.xml")]
    with pytest.raises(UsageError, match=r"gone\.xml: cannot be read"):
        list(run_all(paths, TestOptions(), 2))


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_an_interrupt_ends_all_of_it(jobs: str, tmp_path: Path) -> None:
    for number in range(12):
        shutil.copytree(DEMOS[0].parent.parent, tmp_path / str(number))
    running = subprocess.Popen(
        [sys.executable, "-m", "prima", "test", str(tmp_path), "-j", jobs],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    maps = Path(f"/proc/{running.pid}/maps")
    end = time.monotonic() + 30
    while b"pyexpat" not in maps.read_bytes() and time.monotonic() < end:
        time.sleep(0.05)  # before, the interrupt is Python's own
    time.sleep(1)
    os.killpg(running.pid, signal.SIGINT)
    _, told = running.communicate(timeout=30)
    assert running.returncode == 130 and told.lstrip() == b"prima: interrupted\n"


def test_exit_codes(tmp_path: Path) -> None:
    write(tmp_path, '<expect says="Going up"/>')
    assert prima("test", cwd=tmp_path).returncode == 0
    assert prima("test", "-k", "nothing", cwd=tmp_path).returncode == 2
    assert prima("test", "none.xml", cwd=tmp_path).returncode == 2
    assert prima("test", "--policy", "fair", cwd=tmp_path).returncode == 0
    wrong = prima("test", "--policy", "fare", cwd=tmp_path)
    assert wrong.returncode == 2 and "fair" in wrong.stderr
    assert prima("test", "--fail-under", "100", cwd=tmp_path).returncode == 0
    assert prima("test", "--fail-under", "nan", cwd=tmp_path).returncode == 2
    assert prima("live", "scenario.xml", "--speed", "nan", cwd=tmp_path).returncode == 2
    write(tmp_path, "", DESK.replace("</form>\n</prima>", "<help/></form></prima>"))
    under = prima("test", "--fail-under", "100", cwd=tmp_path)
    assert under.returncode == 1 and "less than 100%" in under.stderr
    write(tmp_path, '<expect says="Going down"/>')
    assert prima("test", cwd=tmp_path).returncode == 1
    write(tmp_path, "", DESK.replace("Going up.", '<value expr="[][0].x"/>'))
    assert prima("test", cwd=tmp_path).returncode == 3
    (tmp_path / "lift.xml").write_text('<scenario xmlns="urn:prima:scenario:1"')
    broken = prima("test", "lift.xml", cwd=tmp_path)
    assert broken.returncode == 1 and "lift.xml:1:" in broken.stdout
    assert "Traceback" not in broken.stdout + broken.stderr


def test_json_tells_all(tmp_path: Path) -> None:
    write(tmp_path, '<expect says="Going down"/>')
    done = prima("test", "--format", "json", "--coverage", cwd=tmp_path)
    told = json.loads(done.stdout)
    assert told["counts"] == {"passed": 0, "failed": 1, "error": 0, "invalid": 0}
    failure = told["scenarios"][0]["failures"][0]
    assert (failure["file"], failure["line"], failure["column"]) == ("lift.xml", FIRST, 9)
    assert told["coverage"]["documents"][0]["percent"] == 100.0


def test_junit_is_what_common_readers_read(tmp_path: Path) -> None:
    reader = pytest.importorskip("junitparser")
    strange = DESK.replace("Going up.", "Going \u202e up &lt;b&gt; ]]&gt;.")
    results = [
        outcome(tmp_path, '<expect says="&lt;script&gt;alert(1)&lt;/script&gt;"/>', strange),
        outcome(tmp_path, ""),
        outcome(tmp_path, "<expect/>"),
        outcome(tmp_path, "", DESK.replace("Going up.", '<value expr="[][0].x"/>')),
    ]
    # What is told may hold what XML cannot, too:
    results[0].difference, results[0].golden = "a\x00\x1b[31mb\ufffe", "differs"
    data = junit(results)
    (tmp_path / "out.xml").write_bytes(data)
    read = reader.JUnitXml.fromfile(str(tmp_path / "out.xml"))
    assert (read.tests, read.failures, read.errors) == (4, 1, 2)
    assert b"\x1b" not in data and b"<script>" not in data
    suite = next(iter(ElementTree.fromstring(data)))
    assert suite.get("tests") == "4"
    assert suite[0].get("line") == str(FIRST)


def test_validation_errors_are_document_errors(tmp_path: Path) -> None:
    with pytest.raises(DocumentError):
        api.load_scenario(write(tmp_path, "<expect/>"))


# What is left out ----------------------------------------------------------------------------
@pytest.fixture
def workshop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with three scenarios, two of them in folders of their own."""
    for name in ("own.xml", "drafts/a.xml", "more/wrong-b.xml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text('<scenario xmlns="urn:prima:scenario:1"/>')
    monkeypatch.chdir(tmp_path)
    return tmp_path


def ignoring(workshop: Path, settings: str) -> None:
    (workshop / "pyproject.toml").write_text(f"[tool.prima]\n{settings}\n")


def test_a_project_says_what_is_no_test(workshop: Path) -> None:
    assert find(["."]) == ["own.xml", "drafts/a.xml", "more/wrong-b.xml"]
    ignoring(workshop, 'ignore = ["drafts/", "*/wrong-*.xml"]')
    assert find(["."]) == ["own.xml"]
    assert find([str(workshop)]) == [str(workshop / "own.xml")]
    assert find(["drafts", "more/wrong-b.xml"]) == ["drafts/a.xml", "more/wrong-b.xml"]
    with pytest.raises(
        UsageError, match=r"more: contains no scenarios.*pyproject\.toml excludes some"
    ):
        find(["more"])


@pytest.mark.parametrize("way", ["./drafts", "more/../drafts", "./drafts/*.xml"])
def test_a_path_of_any_spelling_is_no_test(way: str, workshop: Path) -> None:
    ignoring(workshop, f'ignore = ["{way}"]')
    assert find(["."]) == ["own.xml", "more/wrong-b.xml"]


def test_only_a_star_matches_other_letters(workshop: Path) -> None:
    for name in ("hall[1]", "hall?", "hall1"):
        (workshop / "drafts").joinpath(name).mkdir()
        shutil.copyfile("own.xml", workshop / "drafts" / name / "a.xml")
    ignoring(workshop, 'ignore = ["more", "own.xml", "drafts/a.xml", "*/hall[1]", "*/hall?"]')
    assert find(["."]) == ["drafts/hall1/a.xml"]


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ('ingore = ["a"]', r'has no "ingore"\. Did you mean "ignore"\?'),
        ('ignore = "drafts"', r'write ignore = \["drafts"\]'),
        ("ignore = [1]", r"must be a list of paths"),
        ("ignore = [", r"pyproject\.toml:3:1: not TOML: Invalid value"),
    ],
)
def test_wrong_settings_of_a_project_are_told(workshop: Path, settings: str, told: str) -> None:
    ignoring(workshop, settings)
    with pytest.raises(UsageError, match=told):
        find(["."])


@pytest.mark.parametrize("settings", ["tool = 3", "tool = [3]", "[tool]\nprima = 3"])
def test_settings_that_are_no_table_are_told(workshop: Path, settings: str) -> None:
    (workshop / "pyproject.toml").write_text(settings)
    with pytest.raises(UsageError, match=r"tool\.prima must be a table: write \[tool\.prima\]"):
        find(["."])


def test_the_nearest_settings_count(workshop: Path) -> None:
    ignoring(workshop, 'ignore = ["*"]')
    ignoring(workshop / "drafts", "")
    assert find(["drafts"]) == ["drafts/a.xml"]


ENDLESS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="loop"><form id="a">
<block><send event="x" delay="1ms"/></block><on event="x">
<script>for (var i = 0; i &lt; 1000000; i++);</script><send event="x" delay="1ms"/></on></form></prima>"""


def endless(folder: Path) -> None:
    """Two scenarios, a.xml and b.xml, that take hours."""
    (folder / "loop.xml").write_text(ENDLESS)
    for name in "ab":
        (folder / f"{name}.xml").write_text(
            '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml" robot="r.xml">'
            '<robot at="middle"/><application src="loop.xml"/></scenario>'
        )
    for name, kind in (("w", "worlds/room"), ("r", "robots/papero")):
        data = (ROOT / "documents" / f"{kind}.xml").read_bytes()
        (folder / f"{name}.xml").write_bytes(data)


def test_a_run_that_makes_too_many_records_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prima.devices.loop.MAX_RECORDS", 20)
    done = prima("test", write(tmp_path, '<expect says="Which floor?"/>'), cwd=tmp_path)
    assert done.returncode == 3 and "lift.xml:1:1: The run made more records" in done.stdout


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="needs groups of processes")
def test_interrupted_tests_leave_no_process_behind(tmp_path: Path) -> None:
    endless(tmp_path)
    command = [sys.executable, "-m", "prima", "test", "a.xml", "b.xml", "--jobs", "2"]
    done = subprocess.Popen(
        command, cwd=tmp_path, start_new_session=True, stderr=subprocess.PIPE, text=True
    )
    time.sleep(3)
    os.killpg(done.pid, signal.SIGINT)
    assert done.wait(10) == 130
    for _ in range(100):
        try:
            os.killpg(done.pid, 0)
        except ProcessLookupError:
            break
        time.sleep(0.1)
    else:
        pytest.fail("a process is left")
