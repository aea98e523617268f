"""Expectations of scenarios: found in the run, or reported where they are missing."""

from __future__ import annotations

import json
from html import escape
from itertools import pairwise
from pathlib import Path

import pytest

from prima import api
from prima.sim.scenario import read_scenario
from prima.testing.checking import check
from prima.testing.facts import make_run
from prima.testing.running import Result, TestOptions, run_one
from prima.testing.summary import format_result
from prima.testing.tracing import states_of
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.testing import DEMOS, DESK, FIRST, outcome, write

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
    '<expect state="ask" before="x"/>',
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
    '<expect says="Bonjour" times="2"/>': "twice. It never does.",
    '<expect says="Going up" within="1s"/>': "too late",
    '<expect says="Going up" within="1001ms"/>': "within 1.001 s. It does",
    '<expect says="Which floor?" at="2s"/>': "too early",
    '<expect does="gesture"><data name="name" value="bow"/></expect>': "with name nod",
    '<expect does="gesture"><data name="nome" value="nod"/></expect>': "with name nod",
    '<expect does="q-and-a"><data name="timeout" value="soon"/></expect>': "timeout 5000",
    '<expect does="q-and-a" says="Going up"/>': "It never does. Nearest",
    '<expect does="speak" says="Which floor"/>': (
        'the robot does Speak, saying "Which floor". It never does. Nearest: desk asks "Which floor?"'
    ),
    '<never does="q-and-a" says="Which floor"/>': 'the robot does Q&A, saying "Which floor". It does',
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
    '<expect event="touch" by="desk"/>': "It does for all, at",
}


DATA = [
    ("does", "gesture", "nome", 'gesture has no argument "nome". Did you mean "name"?'),
    ("finishes", "turn", "volume", 'turn has no argument "volume". It has angle.'),
    ("does", "stop-moving", "speed", 'stop-moving has no argument "speed". Remove it.'),
    ("event", "reply.lift", "flor", 'reply.lift has no value "flor". Did you mean "floor"?'),
    *(("does", "gesture", "name", ""), ("event", "reply.lift", "floor", "")),
    *(("event", "reply.lift", "other", ""), ("sends", "lift", "flor", "")),
]


@pytest.mark.parametrize("tag", ["expect", "never"])
@pytest.mark.parametrize(("subject", "what", "name", "told"), DATA)
def test_a_value_that_is_misspelt_is_reported(
    tag: str, subject: str, what: str, name: str, told: str, tmp_path: Path
) -> None:
    data = f'<data name="{name}" value="3"/>'
    path = write(tmp_path, f'<{tag} {subject}="{what}">{data}</{tag}>')
    found = [one for one in api.validate(path) if one.code == "no-such-name"]
    assert [f"{one.message} {one.remedy}" for one in found] == [told] * bool(told)


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


BEFORE = {
    '<never says="Going up" before="x"/>': 'the robot says "Going up", before "x". It does at',
    '<never state="ride" before="x"/>': "desk is in it from 2.699 s on.",
    '<expect says="Going down" before="x"/>': 'before "x". It never does.',
}


@pytest.mark.parametrize(("expected", "told"), BEFORE.items())
def test_what_is_expected_before_something_else(expected: str, told: str, tmp_path: Path) -> None:
    found = outcome(tmp_path, '<expect id="x" says="Mind the step"/>\n' + expected)
    assert [told in one.message for one in found.failures] == [True]


def test_a_state_that_comes_later_is_not_before(tmp_path: Path) -> None:
    never = '<expect id="x" says="Which floor?"/><never state="ride" before="x"/>'
    assert outcome(tmp_path, never).status == "passed"


@pytest.mark.parametrize(
    ("expected", "told"),
    [
        ('<expect state="ask" by="late" at="0s" within="0s"/>', "late has not begun then."),
        ('<expect logs="floor 3" by="late"/>', "desk does, at 2.699 s"),
    ],
)
def test_where_another_application_is_is_told(expected: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "late.xml").write_text(DESK.replace('"desk"', '"late"').replace("Which", "What"))
    found = outcome(tmp_path, '<application src="late.xml" start="5s"/>\n' + expected)
    assert [told in one.message for one in found.failures] == [True]


@pytest.mark.parametrize(("value", "status"), [("true", "passed"), ("false", "failed")])
def test_a_value_may_be_true_or_false(value: str, status: str, tmp_path: Path) -> None:
    sure = DESK.replace("</send>", '<param name="sure" expr="floor == 3"/></send>')
    data = f'<data name="sure" value="{value}"/>'
    found = outcome(tmp_path, f'<expect sends="lift">{data}</expect>', sure)
    assert found.status == status, format_result(found)


def test_a_trigger_that_never_comes_is_a_failure_of_a_never_too(tmp_path: Path) -> None:
    assert outcome(tmp_path, '<never says="x" on="touch.back"/>').status == "failed"


def test_one_error_for_what_follows_something_that_is_not_found(tmp_path: Path) -> None:
    found = outcome(
        tmp_path,
        '<expect id="a" says="Going down"/>\n'
        '<expect says="Floor 3" after="a"/><expect says="Floor 3" before="a"/>\n'
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
    '<never says=" ... "/>': ("bad-value", 'says "..." is empty: it has no letter and no digit'),
    '<expect logs="--"/>': ("bad-value", 'logs "--" is empty'),
    '<expect does="speek"/>': ("no-such-name", 'Did you mean "speak"?'),
    '<expect says="x" doing="speek"/>': ("no-such-name", 'Did you mean "speak"?'),
    '<expect does="field"/>': ("no-such-name", 'Did you mean "q-and-a"?'),
    '<when done="field"><touch sensor="head"/></when>': ("no-such-name", 'Did you mean "q-and-a"?'),
    '<expect state="rid" by="desk"/>': ("no-such-name", 'Did you mean "ride"?'),
    '<expect ends="desc"/>': ("no-such-name", 'Did you mean "desk"?'),
    '<expect sends="left"/>': ("no-such-name", 'Did you mean "lift"?'),
    '<expect sends="service:left"/>': ("no-such-name", 'Did you mean "service:lift"?'),
    "<expect>Going up.</expect>": ("stray-text", 'Write it as says="..."'),
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
    '<in-order><expect state="ask"/></in-order>': ("exclusive", "is not allowed in <in-order>"),
    "<in-order/>": ("empty", "Put <expect>"),
    '<in-order><never says="x"/></in-order>': ("misplaced-element", "is not allowed in"),
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
    found = run_one(str(path), TestOptions())
    assert found.status == "invalid" and found.failures


def test_a_run_takes_no_notice_of_expectations(tmp_path: Path) -> None:
    plain = api.rehearse(write(tmp_path, "")).records[1:]
    assert api.rehearse(write(tmp_path, "".join(FALSE))).records[1:] == plain


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
        run = make_run(transcript.run().entries, transcript.rows(), {})
        return len(check(scenario, run))

    assert failures(said) == 0
    if len(set(said)) > 1 and said != said[::-1]:
        assert failures(said[::-1]) == 1


# States ----------------------------------------------------------------------------
def test_states_of_subdialogs_and_of_applications_that_end() -> None:
    scenario = ROOT / "documents" / "scenarios" / "museum-alone.xml"
    transcript = api.rehearse(scenario, visits=True)
    states = states_of(transcript.visits)
    names = [change.state for change in states["museum"]]
    assert names[:6] == ["welcome", "go", "explain", "find", "explain", "find"]
    assert not transcript.failures


def test_after_a_subdialog_that_returns_at_once_the_state_is_its_callers(tmp_path: Path) -> None:
    (tmp_path / "calls.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="calls" xml:lang="en">'
        '<form id="a"><subdialog name="s" src="#c"/><block><speak>Back.</speak></block></form>'
        '<form id="c"><block><return/></block></form></prima>'
    )
    path = tmp_path / "visit.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<robot at="middle"/><application src="calls.xml"/></scenario>'
    )
    states = states_of(api.rehearse(path, visits=True).visits)
    assert [change.state for change in states["calls"]] == ["a", "c", "a"]


def test_states_of_voicexml() -> None:
    scenario = ROOT / "documents" / "scenarios" / "pizza-and-follow.xml"
    states = states_of(api.rehearse(scenario, visits=True).visits)
    assert [change.state for change in states["pizza"]] == ["order", ""]
    assert [change.state for change in states["follow"]][-1] == "sleep"


LOOKED = {
    # The rows show what came instead, though the nearest came long before.
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
