"""prima validate: source lines, formats, folders, limits, watching."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import jsonschema
import pytest

from prima import api, loading
from prima.errors import DocumentError, Place, Problem, listed
from prima.errors.diagnoses.reading import NOT_XML
from prima.errors.rendering import excerpt, render, sarif
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.validating import wrong

BAD = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">
  <form id="f">
    <block><speek>Hi.</speek><exit/></block>
  </form>
</prima>
"""
GOOD = BAD.replace("speek", "speak")


def test_a_list_of_problems_stops_and_says_how_many_there_are_more(tmp_path: Path) -> None:
    path = tmp_path / "world.xml"
    path.write_text(wrong(1_234), encoding="utf-8")
    told = loading.validate([path])
    assert len(told) == 1_001 and {one.code for one in told[:-1]} == {"bad-value"}
    assert told[-1].code == "more-problems" and told[-1].place.line == 1_004
    assert told[-1].message == "And 234 more problems: 234 errors."
    short = prima("validate", "--format", "short", path.name, cwd=tmp_path)
    assert "And 234 more problems: 234 errors." in short.stdout.splitlines()[-1]
    assert "errors: 1234, warnings: 0" in short.stderr and short.returncode == 1
    data = json.loads(prima("validate", "--format", "json", path.name, cwd=tmp_path).stdout)
    assert len(data) == 1_001 and [one.get("more") for one in data[-2:]] == [None, 234]
    everything = prima(
        "validate", "--format", "short", "--limit", "problems=1234", path.name, cwd=tmp_path
    )
    assert len(everything.stdout.splitlines()) == 1_234


def test_very_long_names_are_cut_in_messages(tmp_path: Path) -> None:
    path, name = tmp_path / "a.xml", "n" * 100_000
    items = '<block name="a"><goto next="#b"/></block>' * 400
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">'
        f'<form id="{name}">{items}</form></prima>'
    )
    told = api.validate([path])
    assert max(len(one.message) for one in told) < 500 > max(len(one.remedy) for one in told)
    twice = next(one for one in told if one.code == "duplicate-name")
    assert re.fullmatch(r'The form "n+ \[\.\.\.\] n+" has two items named "a"\.', twice.message)


def test_errors_are_told_before_warnings_where_not_all_are_told() -> None:
    problems = [
        Problem(Place("a.xml", line), "error" if line % 2 else "warning", "empty", "Empty.")
        for line in range(1, 11)
    ]
    told = listed(problems, 6)
    assert [one.place.line for one in told[:-1]] == [1, 2, 3, 5, 7, 9]
    assert told[-1].severity == "warning" and told[-1].place.line == 4
    assert told[-1].message == "And 4 more problems: 4 warnings."
    assert listed(problems, 10) == problems
    assert str(DocumentError(problems * 200)).count("\n") == 1_000


@pytest.mark.parametrize(
    ("line", "column", "marked"),
    [
        ('  <goto next="#g"/>', 15, "#g"),
        ("  <speek>x", 3, "<speek"),
        ('<a b="c"', 4, "b"),
        ('<a b="c d"', 6, '"c d"'),
        ("x", 9, "x"),
        ("a + undefinedThing + b", 5, "undefinedThing"),
    ],
)
def test_the_token_under_the_place_is_marked(line: str, column: int, marked: str) -> None:
    shown, under = excerpt(line, column)
    assert shown == line
    start = under.index("^")
    if column <= len(line):
        assert line[start : start + len(under.strip())] == marked


def test_tabs_and_wide_letters_keep_their_columns() -> None:
    assert excerpt("\t日本<x", 4) == ("\t日本<x", "\t    ^~")
    assert excerpt("日本x", 1)[1] == "^" + "~" * 4


def test_a_long_line_is_cut_around_its_place() -> None:
    shown, under = excerpt("a " * 500 + "<wrong/>" + " b" * 500, 1001)
    assert len(shown) <= 110
    assert shown[under.index("^") :].startswith("<wrong")


def test_control_characters_of_a_document_never_reach_a_terminal() -> None:
    problem = Problem(Place("a\x1b.xml", 1, 1), "error", "x", "m\x1b[2J", "r\x07")
    text = render(problem, lambda _: ["<a \x1b[2J>"])
    assert "\x1b" not in text and "\x07" not in text


def test_a_place_beyond_the_file_has_no_source_line() -> None:
    problem = Problem(Place("a.xml", 7, 1), "error", "x", "wrong")
    assert render(problem, lambda _: ["one"]) == "a.xml:7:1: error: wrong [x]"


def test_text_has_the_source_line_and_short_has_not(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(BAD)
    done = prima("validate", "a.xml", cwd=tmp_path)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        'a.xml:3:12: error: There is no <speek>. Did you mean "speak"? [unknown-element]',
        "    3 |     <block><speek>Hi.</speek><exit/></block>",
        "      |            ^~~~~~",
    ]
    done = prima("validate", "a.xml", "--format", "short", cwd=tmp_path)
    assert len(done.stdout.splitlines()) == 1


def test_errors_of_a_run_have_their_source_line(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(BAD)
    done = prima("run", "--fa", "a.xml", cwd=tmp_path)
    assert done.returncode == 1
    assert "      |            ^~~~~~" in done.stderr


@pytest.mark.parametrize("verb", ["talk", "run"])
@pytest.mark.parametrize("namespace", ['xmlns="http://www.w3.org/2001/vxml" ', ""])
def test_who_runs_an_application_is_told_how(tmp_path: Path, verb: str, namespace: str) -> None:
    (tmp_path / "main.vxml").write_text(f'<vxml {namespace}version="2.1"><form/></vxml>')
    done = prima(verb, "main.vxml", cwd=tmp_path)
    assert done.returncode == 1
    assert "This is a VoiceXML document; a scenario is needed here." in done.stderr
    assert "prima run, talk and live take it by --ea main.vxml." in done.stderr


def test_sarif_is_complete(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(BAD)
    done = prima("validate", "a.xml", "--format", "sarif", cwd=tmp_path)
    assert done.returncode == 1
    run = json.loads(done.stdout)["runs"][0]
    (result,) = run["results"]
    rule = run["tool"]["driver"]["rules"][result["ruleIndex"]]
    assert rule["id"] == result["ruleId"] == "unknown-element"
    assert result["locations"][0]["physicalLocation"]["region"] == {
        "startLine": 3,
        "startColumn": 12,
    }


def test_sarif_is_valid_by_its_schema(tmp_path: Path) -> None:
    schema = ROOT / "tests/browser/node_modules/@microsoft/jest-sarif/lib/schemas"
    if not schema.exists() and "CI" not in os.environ:
        pytest.skip("npm ci --prefix tests/browser brings the schema")
    shutil.copytree(ROOT / "tests" / "mistakes", tmp_path / "m")
    made = json.loads(prima("validate", "m", "--notes", "--format", "sarif", cwd=tmp_path).stdout)
    assert len(made["runs"][0]["results"]) > 40
    rules = json.loads((schema / "sarif-2.1.0-rtm.5.json").read_text())
    del made["$schema"]
    jsonschema.Draft7Validator(rules).validate(made)
    made["runs"][0]["results"][0]["level"] = "severe"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft7Validator(rules).validate(made)


def test_sarif_names_files_as_uris() -> None:
    problems = [Problem(Place(name), "note", "x", "m") for name in ("/a b.xml", "c/d.xml")]
    results = sarif(problems, "1", {"x": NOT_XML})["runs"][0]["results"]
    uris = [one["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] for one in results]
    assert uris == ["file:///a%20b.xml", "c/d.xml"]


def test_a_folder_stands_for_its_documents(tmp_path: Path) -> None:
    (tmp_path / "d" / "e").mkdir(parents=True)
    (tmp_path / "d" / "a.xml").write_text(GOOD)
    (tmp_path / "d" / "e" / "b.xml").write_text(BAD)
    (tmp_path / "d" / "f.gram").write_text("#ABNF 1.0;\nlanguage en;\n$r = x {out = };")
    (tmp_path / "d" / "notes.txt").write_text("no document")
    done = prima("validate", "d", "--format", "short", cwd=tmp_path)
    assert done.returncode == 1
    first, second = done.stdout.splitlines()
    assert first.startswith("d/e/b.xml:3:12") and second.startswith("d/f.gram:3:8: warning")
    assert "files: 3; errors: 1, warnings: 1" in done.stderr
    bad = tmp_path / "d" / "e" / "b.xml"
    again = prima("validate", "d", "d/e/b.xml", "./d", str(bad), "--format", "short", cwd=tmp_path)
    assert (again.stdout, again.stderr) == (done.stdout, done.stderr)


def test_xml_of_another_purpose_is_no_document_of_a_folder(tmp_path: Path) -> None:
    (tmp_path / "a.vxml").write_text(
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">'
        '<data name="d" src="d.xml"/><form><block>Hello.</block></form></vxml>'
    )
    (tmp_path / "d.xml").write_text('<?xml version="1.0"?><!-- data --><result/>')
    (tmp_path / "e.xml").write_text('<page xmlns="http://www.w3.org/1999/xhtml"/>')
    done = prima("validate", ".", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "files: 1; no problems\n")
    assert prima("validate", "d.xml", cwd=tmp_path).returncode == 1  # named by itself
    (tmp_path / "w.xml").write_text("<world/>")
    (tmp_path / "s.xml").write_text('<scenaro xmlns="urn:prima:scenario:1"/>')
    (tmp_path / "x.xml").write_text("no XML")
    done = prima("validate", ".", "--format", "short", cwd=tmp_path)
    assert [line[:5] for line in done.stdout.splitlines()] == ["s.xml", "w.xml", "x.xml"]


def test_all_documents_that_come_along_are_clean() -> None:
    done = prima("validate", "documents", "--format", "short", cwd=ROOT)
    assert done.returncode == 0
    (line,) = done.stdout.splitlines()  # the situation of rule X6: a robot without arms
    assert line.startswith("documents/ea/navigate.xml:44:9: warning: This robot cannot do point")


def test_a_limit_can_be_raised_and_lowered(tmp_path: Path) -> None:
    (tmp_path / "a.xml").write_text(GOOD)
    (tmp_path / "long.xml").write_text(GOOD + " " * 2_000_000)
    assert prima("validate", "a.xml", "--limit", "elements=3", cwd=tmp_path).returncode == 1
    done = prima("validate", "long.xml", cwd=tmp_path)
    assert done.returncode == 1 and "--limit bytes=" in done.stdout
    remedy = done.stdout.split("--limit ")[1].split(". [")[0]
    assert prima("validate", "long.xml", "--limit", remedy, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize(
    "verb",
    [
        ("graph", "long.xml", "--to", "dot"),
        ("run", "s.xml"),
        ("replay", "s.jsonl", "s.xml"),
        ("study", "s.xml"),
        ("test", "s.xml", "t.xml", "--jobs", "2"),
    ],
)
def test_every_verb_that_reads_documents_has_limits(tmp_path: Path, verb: tuple[str, ...]) -> None:
    (tmp_path / "long.xml").write_text(GOOD + " " * 2_000_000)
    parts = f'world="{ROOT}/documents/worlds/office.xml" robot="{ROOT}/documents/robots/papero.xml"'
    for name in ("s", "t"):
        text = f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="{name}" {parts}>'
        inside = '<robot at="entrance"/><application src="long.xml" kind="fa"/>'
        (tmp_path / f"{name}.xml").write_text(f"{text}{inside}</scenario>")
    raised = ("--limit", "bytes=3000000")
    assert prima("run", "s.xml", "-o", "s.jsonl", *raised, cwd=tmp_path).returncode == 0
    done = prima(*verb, cwd=tmp_path)
    assert done.returncode == 1 and "--limit bytes=" in done.stdout + done.stderr
    assert prima(*verb, *raised, cwd=tmp_path).returncode == 0


@pytest.mark.parametrize(
    "given",
    ["elments=3", "bytes", "bytes=", "bytes=-1", "bytes=1e9", "depth=100000", "=3", "bytes=٣"],
)
def test_a_limit_that_is_none(tmp_path: Path, given: str) -> None:
    (tmp_path / "a.xml").write_text(GOOD)
    done = prima("validate", "a.xml", "--limit", given, cwd=tmp_path)
    assert done.returncode == 2 and done.stderr.startswith("prima: ")


def test_watching_tells_of_every_change_until_it_is_interrupted(tmp_path: Path) -> None:
    file = tmp_path / "a.xml"
    file.write_text(BAD)
    watching = subprocess.Popen(
        [sys.executable, "-m", "prima", "validate", "a.xml", "--watch", "--format", "short"],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert watching.stdout is not None
    os.set_blocking(watching.stdout.fileno(), True)
    assert "unknown-element" in watching.stdout.readline()
    file.write_text(BAD.replace("<speek>", "<speak>"))
    assert "not-xml" in watching.stdout.readline()
    time.sleep(0.1)
    watching.send_signal(signal.SIGINT)
    _, told = watching.communicate(timeout=20)
    assert watching.returncode == 130 and "errors: 1" in told


def test_a_thousand_files_in_one_call(tmp_path: Path) -> None:
    for number in range(1000):
        (tmp_path / f"{number}.xml").write_text(GOOD)
    done = prima("validate", ".", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "")
    assert "files: 1000; no problems" in done.stderr


def test_the_mark_ends_where_a_value_ends() -> None:
    _, under = excerpt('  <value expr="drink +"/> is on the table', 23)
    assert under.strip() == "^"


@pytest.mark.parametrize(
    "given", [["--watch"], ["--notes"], ["--format", "short"], ["--format", "sarif"]]
)
def test_a_certificate_takes_no_option_of_problems(given: list[str]) -> None:
    documents = ROOT / "documents"
    fa, ea = documents / "fa" / "follow.xml", documents / "ea" / "library.xml"
    assert prima("validate", "--with", fa, ea, *given, cwd=ROOT).returncode == 2


def test_a_certificate_compares_an_fa_with_an_ea() -> None:
    fa, ea = ROOT / "documents" / "fa" / "follow.xml", ROOT / "documents" / "ea" / "library.xml"
    done = prima("validate", "--with", ea, fa, cwd=ROOT)
    assert done.returncode == 2 and "library.xml: this is an EA" in done.stderr
    done = prima("validate", "--with", fa, "documents/ea", cwd=ROOT)
    assert done.returncode == 0 and "What pizza can do to follow" in done.stdout


def test_watching_an_empty_folder_is_told(tmp_path: Path) -> None:
    assert prima("validate", ".", "--watch", cwd=tmp_path).returncode == 2


def test_a_language_without_a_voice_is_told(tmp_path: Path) -> None:
    words = '<form id="a"><block><speak>Bonjour.</speak></block></form></prima>'
    for name, lang in (("a", "fr-CA"), ("b", "ja"), ("c", "EN-gb")):
        head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa"'
        text = f'{head}\n id="{name}" xml:lang="{lang}">{words}'
        (tmp_path / f"{name}.xml").write_text(text)
    path = tmp_path / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{ROOT}/documents/worlds/office.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<robot at="entrance"/><application src="a.xml"/><application src="b.xml"/>'
        '<application src="c.xml"/></scenario>'
    )
    (found,) = [one for one in loading.validate([path]) if "voice" in one.message]
    assert (found.severity, found.code) == ("warning", "no-such-name")
    assert (found.place.line, found.place.column) == (2, 19)
    assert (
        f"{found.message} {found.remedy}"
        == 'The robot has no voice for "fr-CA". There is en and ja.'
    )
