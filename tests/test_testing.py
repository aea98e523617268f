"""Tests of tests: what scenarios expect, expected tables, coverage, and all their messages."""

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
from collections.abc import Iterator
from html import escape
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import pytest

from prima import api
from prima.errors import DocumentError, RunError, UsageError
from prima.sim.happenings import When
from prima.sim.person import PHASES, Person
from prima.sim.scenario import read_scenario
from prima.testing.checking import check
from prima.testing.coverage import Coverage, merge, total
from prima.testing.facts import make_run
from prima.testing.finding import find, is_scenario
from prima.testing.golden import difference
from prima.testing.junit import cobertura, junit
from prima.testing.matching import triggers
from prima.testing.running import Choice, Result, run_all, run_one
from prima.testing.summary import format_result
from prima.testing.tracing import States, states_of
from prima.transcript.run import run_of
from prima.transcript.table import format_rows

ROOT = Path(__file__).parent.parent
DEMOS = sorted((ROOT / "documents" / "scenarios").rglob("*.xml"))
WORLD = ROOT / "documents" / "worlds" / "room.xml"
ROBOT = ROOT / "documents" / "robots" / "papero.xml"
DESK = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="desk" xml:lang="en">
  <form id="ask">
    <field name="floor" type="number">
      <prompt>Which floor?</prompt>
      <filled>
        <log>floor <value expr="floor"/></log>
        <send to="lift"><param name="floor" expr="floor"/></send>
        <goto next="#ride"/>
      </filled>
    </field>
  </form>
  <form id="ride">
    <block><speak>Going up.</speak></block>
    <on event="reply.lift">
      <gesture name="nod"/>
      <speak>Floor <value expr="event.data.floor"/>. Mind the step.</speak>
      <exit/>
    </on>
    <on event="touch"><speak>Please do not push.</speak></on>
  </form>
</prima>
"""
SCENE = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="lift" title="Up"
  world="{world}" robot="{robot}" until="60s">
  <robot at="middle"/>
  <person x="1" y="0"/>
  <application src="desk.xml"/>
  <answer to="Which floor?">Three.</answer>
  <when said="Going up" after="1s"><touch sensor="head"/></when>
  <service name="lift"><reply after="6s"><data name="floor" value="3"/></reply></service>
{expected}
</scenario>
"""
FIRST = SCENE[: SCENE.index("{expected}")].count("\n") + 1
"""The line of the first expectation."""


def write(folder: Path, expected: str, desk: str = DESK) -> Path:
    (folder / "desk.xml").write_text(desk, encoding="utf-8")
    path = folder / "lift.xml"
    text = SCENE.format(world=escape(str(WORLD)), robot=escape(str(ROBOT)), expected=expected)
    path.write_text(text, encoding="utf-8")
    return path


def outcome(folder: Path, expected: str, desk: str = DESK) -> Result:
    return run_one(str(write(folder, expected, desk)), Choice())


def prima(*args: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "prima", *map(str, args)],
        capture_output=True,
        encoding="utf-8",
        timeout=60,
        cwd=cwd,
        check=False,
        stdin=subprocess.DEVNULL,
    )


# Expectations ----------------------------------------------------------------------

TRUE = [
    '<expect says="going UP"/>',
    '<expect says="Going up." by="desk" times="1"/>',
    '<expect does="gesture"><data name="name" value="nod"/></expect>',
    '<expect does="q-and-a" says="Which floor?"/>',
    '<expect does="q-and-a"><data name="timeout" value="5s"/></expect>',
    '<expect finishes="gesture" by="desk"/>',
    '<expect event="touch"><data name="sensor" value="head"/></expect>',
    '<expect event="reply.lift" by="desk"><data name="floor" value="3"/></expect>',
    '<expect logs="floor 3"/>',
    '<expect sends="lift"><data name="floor" value="3"/></expect>',
    '<expect state="ride"/>',
    '<expect state="ride" by="desk" at="5s"/>',
    '<expect state="ask" by="desk" at="0s" within="0s"/>',
    '<expect state="ride" on="touch" within="1s"/>',
    '<expect ends="desk"/>',
    '<expect ends="desk" reason="exit"/>',
    '<expect says="Please do not push." on="touch.head" within="2s"/>',
    '<expect says="Floor 3" said="Please do not push" within="10s"/>',
    '<expect says="Going up" asked="Which floor?"/>',
    '<expect says="Mind the step." done="gesture" within="0s"/>',
    '<expect says="Floor 3" doing="speak" count="1" before="x"/>',
    '<never says="Going up" doing="speak"/>',
    '<never says="Going down"/>',
    '<never says="Going up" on="touch"/>',
    '<never state="ask" on="touch"/>',
    '<never ends="desk" reason="error"/>',
    '<never event="touch.back"/>',
    '<never says="Floor 3" within="1s"/>',
]
FALSE = {
    '<expect says="Going down"/>': 'Nearest: desk says "Going up." at',
    '<expect says="Bonjour"/>': "It never does.",
    '<expect says="Going up" times="2"/>': "It does once, at",
    '<expect says="Going up" within="1s"/>': "too late",
    '<expect says="Which floor?" at="2s"/>': "too early",
    '<expect does="gesture"><data name="name" value="bow"/></expect>': "with name nod",
    '<expect does="gesture"><data name="nome" value="nod"/></expect>': "with name nod",
    '<expect does="q-and-a"><data name="timeout" value="soon"/></expect>': "timeout 5000",
    '<expect does="q-and-a" says="Going up"/>': "It never does. Nearest",
    '<expect logs="flour"/>': 'Nearest: desk logs "floor 3"',
    '<expect sends="lift"><data name="floor" value="4"/></expect>': "with floor 3",
    '<expect state="ask" by="desk" on="touch"/>': 'desk is in "ride" then',
    '<expect state="ride" at="end"/>': "desk has ended then: exit",
    '<expect state="ride" at="1s" within="0s"/>': 'desk is in "ask" then',
    '<expect ends="desk" reason="unloaded"/>': "It ends with exit",
    '<expect says="Floor 3" on="touch.back"/>': "never happens: the event touch.back",
    '<expect says="Floor 3" on="touch" count="2"/>': "happens only once: the event touch",
    '<never says="Floor 3" on="touch.back"/>': "never happens",
    '<never says="Floor 3"/>': "It does at",
    '<never state="ride"/>': "desk is in it from",
    '<never finishes="gesture" on="reply"/>': "It does at",
}


@pytest.mark.parametrize("expected", TRUE)
def test_what_happens_is_found(expected: str, tmp_path: Path) -> None:
    if 'before="x"' in expected:
        expected = '<expect id="x" ends="desk"/>' + expected
    found = outcome(tmp_path, expected)
    assert found.status == "passed", format_result(found)
    assert found.expectations == 1 + ('id="x"' in expected)


@pytest.mark.parametrize(("expected", "told"), FALSE.items())
def test_what_does_not_happen_is_told_where_it_is_expected(
    expected: str, told: str, tmp_path: Path
) -> None:
    found = outcome(tmp_path, expected)
    assert found.status == "failed"
    assert len(found.failures) == 1
    failure = found.failures[0]
    assert failure.place.file == str(tmp_path / "lift.xml")
    assert failure.place.line == FIRST
    assert failure.place.column == expected.index(" ") + 2  # at the subject
    assert told in failure.message
    assert "Behavior" in failure.rows and len(failure.rows.splitlines()) > 2
    shown = format_result(found)
    assert expected in shown and "^~~" in shown


def test_a_trigger_that_never_comes_is_a_failure_of_a_never_too(tmp_path: Path) -> None:
    assert outcome(tmp_path, '<never says="x" on="touch.back"/>').status == "failed"


def test_one_error_for_what_follows_something_that_is_not_found(tmp_path: Path) -> None:
    found = outcome(
        tmp_path,
        '<expect id="a" says="Going down"/>\n<expect says="Floor 3" after="a"/>\n'
        '<in-order><expect says="Nothing like it"/><expect says="Floor 3"/></in-order>',
    )
    assert [one.place.line - FIRST for one in found.failures] == [0, 2]


def test_in_order_is_the_order(tmp_path: Path) -> None:
    parts = [
        '<expect says="Which floor?"/>',
        '<expect sends="lift"/>',
        '<expect says="Going up"/>',
        '<expect event="touch.head"/>',
        '<expect says="do not push"/>',
        '<expect event="reply.lift"/>',
        '<expect does="gesture"/>',
        '<expect says="Floor 3"/>',
    ]

    def ordered(parts: list[str]) -> Result:
        return outcome(tmp_path, "<in-order>" + "\n".join(parts) + "</in-order>")

    assert ordered(parts).status == "passed"
    for index in range(len(parts) - 1):
        swapped = [*parts[:index], parts[index + 1], parts[index], *parts[index + 2 :]]
        found = ordered(swapped)
        assert found.status == "failed", swapped
        assert "too early" in found.failures[0].message or "too late" in found.failures[0].message
        assert found.failures[0].place.line == FIRST + index + 1


def test_an_error_that_is_expected_is_none(tmp_path: Path) -> None:
    broken = DESK.replace("Going up.", '<value expr="[][0].x"/>')
    found = outcome(tmp_path, '<expect ends="desk" reason="error.semantic"/>', broken)
    assert found.status == "passed", format_result(found)
    found = outcome(tmp_path, "", broken)
    assert found.status == "error"
    assert "error.semantic" in found.failures[0].message


MISTAKES = {
    "<expect/>": ("missing-attribute", "It needs one of says, does"),
    '<expect by="desk"/>': ("missing-attribute", "does not say what"),
    '<expect says="x" by="dusk"/>': ("no-such-name", 'Did you mean "desk"?'),
    '<expect says=""/>': ("bad-value", "is empty"),
    '<expect does="speek"/>': ("no-such-name", 'Did you mean "speak"?'),
    '<expect says="x" doing="speek"/>': ("no-such-name", 'Did you mean "speak"?'),
    '<expect state="rid" by="desk"/>': ("no-such-name", 'Did you mean "ride"?'),
    '<expect ends="desc"/>': ("no-such-name", 'Did you mean "desk"?'),
    '<expect sends="left"/>': ("no-such-name", 'Did you mean "lift"?'),
    '<expect says="x" logs="x"/>': ("exclusive", "Write an element for each"),
    '<expect says="x" at="1s" on="touch"/>': ("exclusive", "Keep one of them"),
    '<expect says="x" after="2s"/>': ("no-such-name", 'For a time write within="2s".'),
    '<expect says="x" after="b"/><expect id="b" says="y"/>': (
        "no-such-name",
        "No expectation above",
    ),
    '<expect id="b" says="x"/><expect id="b" says="y"/>': ("duplicate-id", "twice"),
    '<expect says="x" at="soon"/>': ("bad-value", 'Or write "end".'),
    '<expect says="x" at="end"/>': ("exclusive", "is for a state"),
    '<expect says="x" reason="exit"/>': ("exclusive", "Name the application with ends"),
    '<expect ends="desk" by="desk"/>': ("exclusive", "Remove by"),
    '<expect state="ask" times="2"/>': ("exclusive", "A state lasts"),
    '<expect says="x" count="2"/>': ("exclusive", "which time"),
    '<expect says="x"><data name="a" value="b"/></expect>': ("misplaced-element", "no values"),
    '<in-order><expect state="ask"/></in-order>': ("exclusive", "cannot stand in <in-order>"),
    "<in-order/>": ("empty", "Put <expect>"),
    '<in-order><never says="x"/></in-order>': ("misplaced-element", "cannot stand in"),
    '<expect say="x"/>': ("unknown-attribute", 'Did you mean "says"?'),
    '<expects says="x"/>': ("unknown-element", 'Did you mean "expect"?'),
    '<expect says="x" times="0"/>': ("out-of-range", "1"),
    '<never says="x" times="1"/>': ("unknown-attribute", "times"),
    '<expect says="x"/>' * 1001: ("too-large", "Divide the scenario"),
}


@pytest.mark.parametrize(("expected", "told"), MISTAKES.items(), ids=lambda one: str(one)[:40])
def test_mistakes_in_expectations_are_found_before_the_run(
    expected: str, told: tuple[str, str], tmp_path: Path
) -> None:
    path = write(tmp_path, expected)
    problems = [one for one in api.validate([path]) if one.severity == "error"]
    assert [one.code for one in problems][:1] == [told[0]]
    assert told[1] in f"{problems[0].message} {problems[0].remedy}"
    found = run_one(str(path), Choice())
    assert found.status == "invalid" and found.failures


def test_a_run_takes_no_notice_of_expectations(tmp_path: Path) -> None:
    plain = api.rehearse(write(tmp_path, "")).records[1:]
    assert api.rehearse(write(tmp_path, "".join(FALSE))).records[1:] == plain


@pytest.mark.parametrize("path", DEMOS, ids=lambda path: path.stem)
def test_triggers_are_those_of_when(path: Path) -> None:
    records = api.rehearse(path).records
    run = make_run(run_of(records), [], States())
    begun = [one for one in records if one["phase"] == "start"]
    words = {("doing", one["command"]) for one in begun} | {
        ("done", one["command"]) for one in begun
    }
    words |= {("on", one["event"]) for one in records if one["phase"] == "event"}
    words |= {(name, one["text"]) for one in begun if one.get("text") for name in ("said", "asked")}
    for name, what in sorted(words):
        person, when = Person.__new__(Person), When(name, what, 0, 1, 1, [])
        person._texts = {}
        theirs = []
        for one in records:
            if one["phase"] == "start" and one.get("text"):
                person._texts[one["behavior"].partition(".")[0]] = one["text"]
            seen = one["phase"] in PHASES[name]
            if seen and person._is(when, one["phase"], one):
                theirs.append(round(one["time"] * 1000))
        assert [fact.time for fact in run.facts if triggers(name, what, fact)] == theirs, name


@pytest.mark.parametrize("path", DEMOS[::3], ids=lambda path: path.stem)
def test_what_a_run_has_said_is_what_it_is_expected_to_say(path: Path, tmp_path: Path) -> None:
    """Any run fulfils the expectation of its own words in order, and not in the reverse order."""
    loaded = api.load_scenario(path)
    transcript = api.rehearse(loaded)
    said = [
        (row.app, one["text"])
        for row in transcript.rows()
        for one in transcript.records
        if one["phase"] == "start" and one["behavior"] == row.behavior and one.get("text")
        if not row.event and row.kind != "interrupt" and not row.resumed
    ]
    assert said

    def failures(said: list[tuple[str, str]]) -> int:
        parts = "".join(f'<expect says="{escape(text)}" by="{app}"/>' for app, text in said)
        text = path.read_text(encoding="utf-8")
        end = text.rindex("</scenario>")
        added = f"{text[:end]}<in-order>{parts}</in-order></scenario>"
        scenario = read_scenario(str(path), added.encode())
        last = scenario.node.all("in-order")[-1]
        own = set(map(id, last.nodes))
        scenario.expectations = [one for one in scenario.expectations if id(one.node) in own]
        run = make_run(transcript.run(), transcript.rows(), States())
        return len(check(scenario, run))

    assert failures(said) == 0
    if len(set(said)) > 1 and said != said[::-1]:
        assert failures(said[::-1]) == 1


# States ----------------------------------------------------------------------------


def test_states_of_subdialogs_and_of_applications_that_end() -> None:
    scenario = ROOT / "documents" / "scenarios" / "museum-alone.xml"
    transcript = api.rehearse(scenario, visits=True)
    states = states_of(transcript.visits)
    names = [change.state for change in states.changes["museum"]]
    assert names[:6] == ["welcome", "go", "explain", "find", "explain", "find"]
    assert not transcript.failures


def test_states_of_voicexml() -> None:
    scenario = ROOT / "documents" / "scenarios" / "pizza-and-follow.xml"
    states = states_of(api.rehearse(scenario, visits=True).visits)
    assert [change.state for change in states.changes["pizza"]] == ["order", ""]
    assert [change.state for change in states.changes["follow"]][-1] == "sleep"


LOOKED = {
    # What came instead stands in the window, though what is nearest came long before it.
    '<expect says="Going up" on="reply.lift" within="2s"/>': ["reply.lift", "Going up", "Floor 3"],
    '<expect does="gesture" on="touch" within="1s"/>': ["touches", "do not push", "Gesture"],
    # It waits for something that never comes: both ends of the run.
    '<expect says="x" on="sound"/>': ["starts desk", "Which floor", "ends desk"],
    '<expect says="zzzzz"/>': ["starts desk", "ends desk"],
    '<never event="touch"/>': ["touches"],
    '<expect says="zzzzz" at="50s"/>': ["ends desk"],
    '<expect logs="floor 3" times="2"/>': ["floor 3", "starts desk", "ends desk"],
}


@pytest.mark.parametrize(("expected", "rows"), LOOKED.items())
def test_a_failure_shows_the_rows_where_it_looked(
    expected: str, rows: list[str], tmp_path: Path
) -> None:
    path = write(tmp_path, expected)
    text = prima("test", path, cwd=tmp_path).stdout
    data = json.loads(prima("test", path, "--format", "json", cwd=tmp_path).stdout)
    (failure,) = data["scenarios"][0]["failures"]
    for row in rows:
        assert any(row in line for line in failure["rows"]), (row, failure["rows"])
    assert "\n".join(failure["rows"]) in text
    assert len(failure["rows"]) <= 16


def test_rows_between_those_shown_are_dots(tmp_path: Path) -> None:
    found = outcome(tmp_path, '<expect says="Which floor" on="reply.lift" within="1s"/>')
    lines = found.failures[0].rows.splitlines()
    at = lines.index("       ...")
    shown = [int(line.split()[0]) for line in lines[1:] if line.strip("* ")[:1].isdigit()]
    assert 0 < at < len(lines) - 1 and shown == sorted(set(shown))
    assert any(after - before > 1 for before, after in pairwise(shown))


# Expected tables -------------------------------------------------------------------


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
    assert run_one(str(path), Choice(policy="fifo")).golden == "skipped"
    assert run_one(str(path), Choice(policy="prima")).golden == "differs"


def test_a_table_that_is_no_text_is_told(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    (tmp_path / "lift.txt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UsageError, match="not UTF-8"):
        run_one(str(path), Choice())


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
    for result in run_all([str(path) for path in DEMOS], Choice()):
        assert result.status == "passed", format_result(result)


def test_processes_give_the_same_results_in_the_same_order() -> None:
    paths = [str(path) for path in DEMOS if path.stem.startswith("s0")][:4]
    choice = Choice(coverage=True)
    one, several = list(run_all(paths, choice)), list(run_all(paths, choice, 2))
    for result in (*one, *several):
        result.seconds = 0.0
    assert one == several


def test_a_process_that_is_ended_ends_the_tests(tmp_path: Path) -> None:
    endless(tmp_path)

    def end_one() -> None:
        (first, *_) = multiprocessing.active_children()
        first.kill()

    threading.Timer(2, end_one).start()
    with pytest.raises(RunError, match="was killed"):
        list(run_all([str(tmp_path / "a.xml"), str(tmp_path / "b.xml")], Choice(), 2))


def test_what_a_process_cannot_read_is_told(tmp_path: Path) -> None:
    write(tmp_path, "")
    (tmp_path / "lift.txt").write_bytes(b"\xff")
    paths = [str(DEMOS[0]), str(tmp_path / "lift.xml")]
    with pytest.raises(UsageError, match="not UTF-8"):
        list(run_all(paths, Choice(), 2))


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


# Coverage --------------------------------------------------------------------------

EVERYTHING = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="desk" xml:lang="en">
  <form id="ask">
    <var name="n" expr="0"/>
    <block name="a" cond="n == 0"><assign name="n" expr="1"/></block>
    <block cond="n == 5"><speak>Never.</speak></block>
    <field name="floor" type="number">
      <prompt>Which floor?</prompt>
      <prompt count="2">Well?</prompt>
      <nomatch>What?</nomatch>
      <filled>
        <if cond="floor == 1">
          <speak>One.</speak>
          <elseif cond="floor == 3"/>
          <if cond="n"><speak>Three.</speak></if>
          <else/>
          <speak>Other.</speak>
        </if>
      </filled>
    </field>
    <block>
      <speak>Wait.<on event="end.speak"><log>said</log></on></speak>
      <goto next="#done"/>
    </block>
    <link next="#done"><grammar>stop</grammar></link>
    <on event="touch" cond="n == 1"><log>touched</log></on>
  </form>
  <form id="done"><block><exit/></block></form>
  <form id="never"><block><exit/></block><on event="touch"><exit/></on></form>
</prima>
""".replace("<nomatch>What?</nomatch>", "<nomatch><speak>What?</speak></nomatch>")


def coverage_of(folder: Path, desk: str, name: str = "desk.xml") -> dict[tuple[int, str], bool]:
    """The points of a document, by line and kind, with whether they were reached."""
    choice = Choice(coverage=True)
    found = run_one(str(write(folder, "", desk)), choice).coverage
    one = found[str(folder / name)]
    return {
        (point.line, point.kind): number in one.reached for number, point in enumerate(one.points)
    }


def test_what_is_covered_of_a_document(tmp_path: Path) -> None:
    found = coverage_of(tmp_path, EVERYTHING)
    assert found == {
        (2, "in"): True,
        (4, "in"): True,
        (4, "true"): True,
        (4, "false"): False,
        (5, "in"): False,
        (5, "true"): False,
        (5, "false"): True,
        (6, "in"): True,
        (9, "in"): False,
        (10, "in"): True,
        (11, "true"): False,
        (13, "true"): True,
        (14, "true"): True,
        (14, "else"): False,
        (15, "else"): False,
        (20, "in"): True,
        (21, "in"): True,
        (24, "in"): False,
        (25, "in"): False,
        (25, "true"): False,
        (25, "false"): False,
        (27, "in"): False,
        (28, "in"): False,
    } | {key: value for key, value in found.items() if key[0] in (27, 28)}
    assert found[(27, "in")] and not found[(28, "in")]


VOICE = """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">
  <link event="help"><grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">
    <rule id="r">help me</rule></grammar></link>
  <form id="ask">
    <block cond="true">Hello.</block>
    <field name="floor" type="number">
      <prompt cond="false">Never.</prompt>
      <prompt>Which floor?</prompt>
      <nomatch count="1">What?</nomatch>
      <filled>
        <if cond="floor == 1">One.<elseif cond="floor == 3"/>Three.<else/>Other.</if>
        <goto next="#choose"/>
      </filled>
    </field>
  </form>
  <menu id="choose">
    <prompt>Stop or go?</prompt>
    <choice next="#over">stop</choice>
    <choice next="#never">go</choice>
  </menu>
  <form id="over"><block><exit/></block></form>
  <form id="never">
    <block><exit/></block>
  </form>
</vxml>
"""


def test_what_is_covered_of_voicexml(tmp_path: Path) -> None:
    (tmp_path / "lift.vxml").write_text(VOICE, encoding="utf-8")
    path = write(tmp_path, '<answer to="Stop or go?">stop</answer>\n<expect state="over"/>')
    path.write_text(path.read_text().replace('src="desk.xml"', 'src="lift.vxml"'))
    found = run_one(str(path), Choice(coverage=True))
    assert found.status == "passed", format_result(found)
    one = found.coverage[str(tmp_path / "lift.vxml")]
    missing = {(point.line, point.kind) for point in one.missing}
    assert missing == {
        (2, "in"),
        (5, "false"),
        (7, "true"),
        (9, "in"),
        (11, "true"),
        (11, "else"),
        (19, "in"),
        (22, "in"),
        (23, "in"),
    }


def test_runs_add_up(tmp_path: Path) -> None:
    path = write(tmp_path, "", EVERYTHING)
    other = tmp_path / "other.xml"
    other.write_text(path.read_text().replace(">Three.<", ">One.<").replace('"lift"', '"other"', 1))
    coverage: Coverage = {}
    shares = []
    for result in run_all([str(path), str(other)], Choice(coverage=True)):
        merge(coverage, result.coverage)
        shares.append(total(coverage))
    assert shares[0] < shares[1] < 100
    missing = {(one.line, one.kind) for one in coverage[str(tmp_path / "desk.xml")].missing}
    assert (11, "true") not in missing and (15, "else") in missing
    read = ElementTree.fromstring(cobertura(coverage))
    hits = {line.get("number"): line.get("hits") for line in read.iter("line")}
    assert hits["2"] == "1" and hits["9"] == "0"


def test_documents_that_no_run_loads_are_counted(tmp_path: Path) -> None:
    path = write(tmp_path, "")
    path.write_text(
        path.read_text().replace('"desk.xml"', '"desk.xml" start="50s"').replace("60s", "1s")
    )
    found = run_one(str(path), Choice(coverage=True)).coverage
    assert found[str(tmp_path / "desk.xml")].reached == set()


# pytest ----------------------------------------------------------------------------


def run_pytest(folder: Path, *args: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-p",
            "prima.pytest_plugin",
            "-p",
            "no:cacheprovider",
            *args,
        ],
        capture_output=True,
        encoding="utf-8",
        cwd=folder,
        timeout=60,
        check=False,
    )


@pytest.fixture
def project(tmp_path: Path) -> Iterator[Path]:
    for name, expected in (("good", "Going up"), ("bad", "Going down"), ("plain", "")):
        folder = tmp_path / name
        folder.mkdir()
        write(folder, f'<expect says="{expected}"/>' if expected else "")
    (tmp_path / "other.xml").write_text("<a/>")
    (tmp_path / "broken.xml").write_text("<a")
    yield tmp_path


def test_scenarios_are_tests_of_pytest(project: Path) -> None:
    done = run_pytest(project)
    assert "1 failed, 1 passed" in done.stdout
    assert f"lift.xml:{FIRST}:9: Expected: " in done.stdout
    assert "Traceback" not in done.stdout


def test_pytest_leaves_scenarios_alone_where_it_is_told(project: Path) -> None:
    (project / "pytest.ini").write_text("[pytest]\nprima_scenarios = false\n")
    assert "no tests ran" in run_pytest(project).stdout


def test_the_plugin_imports_prima_only_for_scenarios(tmp_path: Path) -> None:
    (tmp_path / "some.xml").write_text("<a/>")
    (tmp_path / "test_it.py").write_text(
        "import sys\n"
        "def test_it():\n"
        "    assert not {'prima.api', 'prima.testing', 'lxml', 'click'} & set(sys.modules)\n"
    )
    done = run_pytest(tmp_path)
    assert "1 passed" in done.stdout, done.stdout


def test_a_scenario_that_cannot_be_read_is_a_failing_test(tmp_path: Path) -> None:
    write(tmp_path, "<expect")
    done = run_pytest(tmp_path)
    assert "1 failed" in done.stdout and "Traceback" not in done.stdout


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


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ('ingore = ["a"]', r'has no "ingore"\. Did you mean "ignore"\?'),
        ('ignore = "drafts"', r'write ignore = \["drafts"\]'),
        ("ignore = [1]", r"must be a list of paths"),
        ("ignore = [", r"pyproject\.toml: cannot be read"),
    ],
)
def test_wrong_settings_of_a_project_are_told(workshop: Path, settings: str, told: str) -> None:
    ignoring(workshop, settings)
    with pytest.raises(UsageError, match=told):
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
