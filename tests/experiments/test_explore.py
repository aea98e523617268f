"""Explorations: the orders that other timings bring, compared with all runs of a sweep."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import prima as package
from prima.errors import UsageError
from prima.experiments.examine import Examiner, Seen
from prima.experiments.explore import MOST_MOVES, Exploration, ExplorationPlan
from prima.experiments.scenariotext import Variant
from prima.experiments.settings import ExperimentSettings
from prima.experiments.sweep import Sweep, SweepQuestion
from tests import ROOT
from tests.helpers.batches import files, until
from tests.helpers.here import prima
from tests.helpers.sweeps import VISIT, write_visit

TWO = VISIT.replace("<expect", '<when id="again" at="4s"><touch sensor="head"/></when>\n  <expect')


@pytest.fixture(autouse=True)
def visit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_visit(tmp_path)
    return tmp_path


def swept(**vary: str) -> list[dict[str, Any]]:
    sweep = Sweep(SweepQuestion(("visit.xml",), vary))
    names = [one.name for one in sweep.columns]
    return [
        dict(zip(names, sweep.row(one, sweep.stage.run(one), ""), strict=True)) for one in sweep
    ]


def test_the_boundaries_are_those_of_all_runs() -> None:
    found = package.explore("visit.xml", workers=1)
    orders = {round(row["touch"] * 1000): row["order"] for row in swept(touch="0s..6s/20ms")}
    for piece in found["boundaries"]["when[1]"]:
        inside = [t for t in orders if piece["from"] * 1000 <= t <= piece["to"] * 1000]
        assert {orders.pop(t) for t in inside} <= {piece["order"]}
    assert not orders
    ends = [round(piece["to"] * 1000) for piece in found["boundaries"]["when[1]"][:-1]]
    for end in ends:
        before, behind = swept(touch=f"{end}ms|{end + 1}ms")
        assert before["order"] != behind["order"], "to 1 ms"
    assert found["complete"] and not found["problems"]
    assert found["runs"] < 150


def test_two_events_at_once_bring_all_orders_of_a_grid() -> None:
    Path("visit.xml").write_text(TWO)
    found = package.explore("visit.xml", ["touch", "again"], within=3_000)
    orders = {one["order"] for one in found["orders"]}
    grid = swept(touch="0s..4s/250ms", again="1s..7s/250ms")
    assert {row["order"] for row in grid} <= orders
    assert len(orders) > 10
    alone = package.explore("visit.xml", ["touch", "again"], within=3_000, depth=1)
    assert {one["order"] for one in alone["orders"]} < orders
    assert all(len(one["at"]) <= 1 for one in alone["orders"])


def test_every_order_s_smallest_shift_is_a_run_of_it() -> None:
    Path("visit.xml").write_text(TWO)
    for one in package.explore("visit.xml", ["touch", "again"], within=3_000)["orders"]:
        at = {"touch": 1.0, "again": 4.0, **one["at"]}
        (row,) = swept(**{path: f"{round(time * 1000)}ms" for path, time in at.items()})
        assert row["order"] == one["order"]


def test_what_it_prints() -> None:
    done = prima("explore", "visit.xml", "--move", "touch")
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["order", "runs", "smallest", "shift", "first", "difference"]
    assert lines[1].endswith("as written")
    assert "2: U touches the robot's head" in lines[2]
    assert "touch at 2.158 s (+1.158 s)" in done.stdout
    assert "  0.001 s to 2.157 s        " in done.stdout
    assert lines[-1].endswith("complete for 1 event moved at once by up to 5 s")


def test_a_broken_expectation_is_a_case() -> None:
    never = '<never says="That tickles!" said="Shall I go on?"/>'
    Path("visit.xml").write_text(VISIT.replace("</scenario>", f"{never}</scenario>"))
    done = prima("explore", "visit.xml", "-o", "out", "--format", "json")
    assert done.returncode == 1
    found = json.loads(done.stdout)
    assert found == json.loads(Path("out/explored.json").read_text())
    (problem,) = found["problems"]
    assert (problem["kind"], problem["at"]) == ("expect", {"when[1]": 2.158})
    assert "visit.xml:12" in problem["text"] and problem["scenario"] == "problems/1-expect.xml"
    assert prima("test", "out/problems/1-expect.xml").returncode == 1
    assert prima("test", "visit.xml").returncode == 0
    table = prima("show", "out/problems/1-expect.jsonl").stdout
    assert prima("run", "out/problems/1-expect.xml").stdout == table


def test_a_policy_that_cuts_is_told_by_the_invariants(visit: Path) -> None:
    done = prima("explore", "visit.xml", "--policy", "none", "--format", "json")
    assert done.returncode == 0, done.stdout
    done = prima("explore", "visit.xml", "--policy", "nun")
    assert done.returncode == 2 and 'There is no policy "nun"' in done.stderr


def test_a_run_that_goes_wrong_is_a_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    """In this process, as another one would not have so few records."""
    Path("visit.xml").write_text(VISIT.replace("Welcome", "Bonjour"))
    guide = Path("guide.xml").read_text().replace("<exit/>", '<throw event="bored"/>')
    Path("guide.xml").write_text(guide)
    stage = Examiner.of(["visit.xml"], ["touch"], ExperimentSettings())
    seen = stage.run(Variant(0, 0, "", 0, ("1s",)))
    assert isinstance(seen, Seen)
    error, expect = seen.found
    assert (error.kind, expect.kind) == ("error", "expect") and "bored" in error.text
    assert expect.where == f"visit.xml:{VISIT[: VISIT.index('<expect')].count(chr(10)) + 1}"
    monkeypatch.setattr("prima.devices.loop.MAX_RECORDS", 5)
    seen = stage.run(Variant(0, 0, "", 0, ("1s",)))
    assert isinstance(seen, Seen)
    assert ("endless", "the run exceeds a limit") in [(one.kind, one.text) for one in seen.found]


def test_a_broken_rule_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the checker of all rules says of a run is a problem of it."""
    late = "invariant 6 (F2)"

    def check(records: Any, *_: object, **__: object) -> list[str]:
        touched = [one["time"] for one in records if one.get("event") == "touch.head"]
        return [f"{late} at {touched[0]}: a reaction waits"] if touched[0] > 3 else []

    monkeypatch.setattr("prima.experiments.examine.check", check)
    exploration = Exploration(ExplorationPlan("visit.xml"))
    from tests.experiments.test_interrupted_sweeps import here

    for _ in exploration.explore(here(lambda run, _number, one: run(one))):
        pass
    (problem,) = exploration.problems
    assert problem.finding == ("invariant", late, f"{late} at 3.001: a reaction waits")
    assert problem.point == (3001,)


def test_no_more_runs_than_allowed() -> None:
    done = prima("explore", "visit.xml", "--runs", "20")
    assert done.returncode == 0
    assert "not complete: raise --runs (20), or move less" in done.stdout


def test_orders_met_while_shifts_are_made_small_are_reported() -> None:
    scenario = ROOT / "documents" / "rules" / "unwound.xml"
    made: Any = package.explore(
        scenario, within=1_000, runs=10, policy="none", workers=1, output="found"
    )
    runs = [
        json.loads(one)["order"] for one in Path("found/runs.jsonl").read_text().split("\n")[1:-1]
    ]
    assert not made["complete"] and made["runs"] == len(runs)
    assert {one["order"] for one in made["orders"]} == set(runs)


def test_runs_are_used_again(visit: Path) -> None:
    first = prima("explore", "visit.xml", "-o", "out")
    kept = files("out")
    lines = Path("out/runs.jsonl").read_bytes().splitlines(keepends=True)
    for cut in (len(lines), len(lines) // 2, 1):
        whole = b"".join(lines[:cut]) + (b'{"at":[5' if cut < len(lines) else b"")
        Path("out/runs.jsonl").write_bytes(whole)
        again = prima("explore", "visit.xml", "-o", "out", "--resume")
        assert again.stdout == first.stdout
        assert f"{cut - 1} run" in again.stderr
        assert {name: data for name, data in files("out").items() if name != "runs.jsonl"} == {
            name: data for name, data in kept.items() if name != "runs.jsonl"
        }
        assert sorted(Path("out/runs.jsonl").read_bytes().splitlines(keepends=True)) == sorted(
            lines
        )


def test_a_new_exploration_replaces_the_cases_of_the_one_before() -> None:
    prima("explore", "visit.xml", "-o", "out")
    Path("out/orders/notes.txt").write_text("Mine.")
    Path("out/problems").mkdir(exist_ok=True)
    for name in ("1-expect.xml", "1-expect.jsonl", "1-expect.robot.xml"):
        Path("out/problems", name).write_text("of another exploration")
    prima("explore", "visit.xml", "-o", "out", "--runs", "1")
    (order,) = json.loads(Path("out/explored.json").read_text())["orders"]
    names = sorted(path.name for path in Path("out/orders").iterdir())
    assert names == [f"{order['order']}.jsonl", f"{order['order']}.xml", "notes.txt"]
    assert list(Path("out/problems").iterdir()) == []


@pytest.mark.parametrize("content", ["", "[" * 10_000, '{"prima": "0.1"}\n', "\0\n"])
def test_runs_of_something_else(content: str) -> None:
    Path("out").mkdir()
    Path("out/runs.jsonl").write_text(content)
    done = prima("explore", "visit.xml", "-o", "out", "--resume")
    assert done.returncode == 2
    assert "it is of another exploration, version or document" in done.stderr
    assert Path("out/runs.jsonl").read_text() == content


@pytest.mark.parametrize(
    "line", ["{}", "[]", '{"at":[]}', '{"at":["x"]}', '{"at":[1],"found":3}', "7"]
)
def test_kept_runs_that_are_none_are_made_again(line: str) -> None:
    first = prima("explore", "visit.xml", "-o", "out")
    head = Path("out/runs.jsonl").read_text().splitlines()[0]
    Path("out/runs.jsonl").write_text(f"{head}\n{line}\n")
    again = prima("explore", "visit.xml", "-o", "out", "--resume")
    assert again.stdout == first.stdout, again.stderr
    assert "0 runs had been made before" in again.stderr


@pytest.mark.parametrize(
    "change",
    [
        {"order": "../../evil"},
        {"order": None},
        {"times": ["x"]},
        {"times": None},
        {"outside": ["a"]},
        {"exit": "x"},
        {"found": [["../x", "", ""]]},
        {"found": [["expect", [], {}]]},
        {"at": [float("inf")]},
    ],
)
def test_kept_runs_that_are_damaged_are_made_again(change: dict[str, Any]) -> None:
    first = prima("explore", "visit.xml", "-o", "out", "--depth", "1")
    kept = files("out")
    head, base, *others = Path("out/runs.jsonl").read_text().splitlines()
    base = json.dumps({**json.loads(base), **change})
    Path("out/runs.jsonl").write_text("\n".join([head, base, *others, ""]))
    again = prima("explore", "visit.xml", "-o", "out", "--depth", "1", "--resume")
    assert again.stdout == first.stdout, again.stderr
    assert f"{len(others)} runs had been made before" in again.stderr
    assert {**files("out"), "runs.jsonl": b""} == {**kept, "runs.jsonl": b""}


LONG = [sys.executable, "-m", "prima", "explore", "visit.xml", "--step", "20ms", "--within", "20s"]


def interrupted(made: subprocess.Popen[str]) -> tuple[str, str]:
    made.send_signal(signal.SIGINT)
    out, err = made.communicate(timeout=60)
    assert made.returncode == 130 and "Traceback" not in err, err
    return out, err


def test_ctrl_c_keeps_the_runs_and_prints_what_they_show() -> None:
    Path("visit.xml").write_text(TWO)
    made = subprocess.Popen(
        [*LONG, "-o", "out"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    until(lambda: Path("out/runs.jsonl").exists() and os.path.getsize("out/runs.jsonl") > 20_000)
    out, err = interrupted(made)
    assert "out: the runs made so far are kept; --resume goes on." in err
    assert out.splitlines()[1].endswith("as written")
    assert re.search(r"^[1-9]\d* runs: .* not complete: it was interrupted$", out, re.M), out


@pytest.mark.skipif(os.name == "nt", reason="no pseudo-terminals")
def test_ctrl_c_prints_what_was_found_without_a_folder() -> None:
    Path("visit.xml").write_text(TWO)
    main, side = os.openpty()
    made = subprocess.Popen(
        [*LONG, "--format", "json"], stdout=subprocess.PIPE, stderr=side, text=True
    )
    os.close(side)
    shown = b""
    while not re.search(rb"\r([2-9]\d|\d{3,}) ", shown):  # progress: 20 runs have been made
        shown += os.read(main, 1_000)
    made.send_signal(signal.SIGINT)
    found = json.loads(made.communicate(timeout=60)[0])
    os.close(main)
    assert made.returncode == 130
    assert found["orders"] and not found["complete"]
    assert 20 <= found["runs"] == sum(one["runs"] for one in found["orders"])


@pytest.mark.parametrize(
    ("words", "why"),
    [
        (["--move", "toch"], 'Did you mean "touch"'),
        (["--move", "person.speed"], "only times can be moved; vary others by prima sweep"),
        (["--move", "touch", "--move", "touch.at"], "are the same value"),
        (["--within", "soon"], "--within"),
        (["--within", "0s"], "write a time above 0"),
        (["--step", "0s"], "write a time above 0"),
        (["--depth", "9"], "--depth"),
        (["--resume"], "--resume needs the folder"),
        (["-o", "visit.xml"], "visit.xml: a file is where a folder is needed. Name another."),
    ],
)
def test_mistakes(words: list[str], why: str) -> None:
    done = prima("explore", "visit.xml", *words)
    assert done.returncode == 2 and done.stdout == "", done.stdout
    assert why in done.stderr, done.stderr


def test_scenarios_that_cannot_be_explored() -> None:
    touches = '<when at="2s"><touch sensor="head"/></when>' * MOST_MOVES
    Path("many.xml").write_text(VISIT.replace("<expect", f"{touches}<expect"))
    done = prima("explore", "many.xml")
    assert done.returncode == 2 and "33 events are too many to move; name some" in done.stderr
    Path("drawn.xml").write_text(VISIT.replace('after="1s"', 'after="normal(2s,1s)"'))
    done = prima("explore", "drawn.xml", "--move", "reply.after")
    assert done.returncode == 2 and '"normal(2s,1s)" is drawn' in done.stderr, done.stderr
    with pytest.raises(UsageError, match="depth: write a number from 1 to 4"):
        package.explore("visit.xml", depth=9)
    with pytest.raises(UsageError, match="within: write a time above 0, at most 86400s"):
        package.explore("visit.xml", within=86_400_001)
    with pytest.raises(UsageError, match="on=8786: write a text"):
        package.explore("visit.xml", on=8786)  # type: ignore[arg-type]
    Path("none.xml").write_text(VISIT.replace("<when", "<!--").replace("</when>", "-->"))
    done = prima("explore", "none.xml")
    assert done.returncode == 2 and "nothing to move" in done.stderr, done.stderr
    assert "Name other times: --move" in done.stderr
    Path("wrong.xml").write_text(VISIT.replace("<robot ", "<robbot "))
    assert prima("explore", "wrong.xml").returncode == 1
    assert "cannot be read" in prima("explore", "no.xml").stderr
    with pytest.raises(UsageError, match="resume needs the output"):
        package.explore("visit.xml", resume=True)
