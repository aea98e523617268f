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
from prima.interpreter.reader import read_document
from prima.messages import Ended
from tests import ROOT
from tests.helpers.robot import Bench
from tests.helpers.voice import Call

BAD = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">
  <form id="f">
    <block><speek>Hi.</speek><exit/></block>
  </form>
</prima>
"""
GOOD = BAD.replace("speek", "speak")


def prima(*args: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "prima", *map(str, args)],
        capture_output=True, text=True, timeout=60, cwd=cwd, check=False,
    )  # fmt: skip


def wrong(places: int) -> str:
    """A world with a warning, and an error in each of so many places."""
    wall = '  <way from="a" to="b"/><wall x1="0.5" y1="-1" x2="0.5" y2="1"/>\n'
    good = '  <place id="a" x="0" y="0"/><place id="b" x="1" y="0"/>\n'
    bad = "".join(f'  <place id="p{index}" x="zero" y="0"/>\n' for index in range(places))
    return f'<world xmlns="urn:prima:world:1" version="1.0" id="w">\n{good}{wall}{bad}</world>\n'


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
    assert "prima run and prima talk take it by --ea main.vxml." in done.stderr


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


PAGE = """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">
<form id="f"><field name="a"><prompt>A?</prompt>
<grammar src="g/towns.gram" type="application/srgs"/>
<grammar src="g/towns.gram#r" type="application/srgs+xml"/>
<grammar src="g/tags.gram" type="application/abnf"/>
</field></form></vxml>
"""
TAGS = """#ABNF 1.0;
language en;
root $r;
tag-format <semantics/1.0>;
public $r = a
  {out = nope};
"""


def test_grammars_in_files_that_a_page_names_are_checked(tmp_path: Path) -> None:
    (tmp_path / "g").mkdir()
    (tmp_path / "page.vxml").write_text(PAGE)
    (tmp_path / "g" / "tags.gram").write_text(TAGS)
    towns = tmp_path / "g" / "towns.gram"
    towns.write_text("#ABNF 1.0;\nlanguage en;\npublic $r = Rome;\n")
    done = prima("validate", "page.vxml", "--format", "short", cwd=tmp_path)
    assert [line.partition(" W")[0] for line in done.stdout.splitlines()] == [
        'g/tags.gram:6:3: warning: The tag uses "nope", which nothing in the grammar declares:'
        " what needs it is not taken. For the text itself write 'nope' in quotes."
        " [undeclared-variable]",
        'page.vxml:3:15: warning: The grammar "g/towns.gram" names no root rule.'
        " Name a rule: #name.",
        'page.vxml:4:15: warning: The type "application/srgs+xml" contradicts "g/towns.gram",'
        " which is in the ABNF form.",
        'page.vxml:5:15: warning: The type "application/abnf" is none of SRGS;'
        " it is read as application/srgs.",
    ]
    towns.write_text("language en;\npublic $r = Rome;\n")  # an error of the file is told once
    done = prima("validate", "page.vxml", "g", "--format", "short", cwd=tmp_path)
    told = [line for line in done.stdout.splitlines() if "towns.gram:" in line]
    assert told == [
        "g/towns.gram:1:1: error: The header of the ABNF form is missing."
        ' Begin with "#ABNF 1.0 UTF-8;" in the first line. [not-abnf]'
    ]


@pytest.mark.parametrize(
    ("name", "text", "told"),
    [
        ("g.txt", "root $r;\n$r = a;", 'Begin with "#ABNF 1.0 UTF-8;" in the first line.'),
        ("g.gram", "towns: Rome", "Begin with <grammar ...> for the XML form, or with #ABNF"),
        ("g.txt", "towns: Rome", "Begin with a root element, such as <prima> or <vxml>."),
    ],
)
def test_a_grammar_without_its_beginning_is_told_how_grammars_begin(
    tmp_path: Path, name: str, text: str, told: str
) -> None:
    (tmp_path / name).write_text(text)
    done = prima("validate", name, "--format", "short", cwd=tmp_path)
    assert done.returncode == 1 and told in done.stdout


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
    assert done.returncode == 2 and "library.xml: is an EA" in done.stderr
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


@pytest.mark.parametrize(
    ("content", "warned"),
    [
        ('<script src="a.js"/><form><block/></form>', False),
        ('<script src="b.js"/><form><block/></form>', True),
        ('<form><block><goto next="#x"/></block></form><form id="x"><block/></form>', False),
        ('<form><block><goto next="a%20b.vxml#x"/></block></form>', False),
        ('<form><block><goto next="c.vxml?y=1#x"/></block></form>', True),
        ('<form><block><goto next="../d/a.js"/></block></form>', True),
        ('<form><block><submit next="http://h.example/c"/></block></form>', False),
        ('<form><block><submit next="service:shop"/></block></form>', False),
        ('<form><block><audio src="none.wav">Hello.</audio></block></form>', False),
        ('<form xml:base="e/"><subdialog name="s" src="f.vxml"/></form>', True),
    ],
)
def test_files_of_a_voicexml_document_that_are_not_there_are_warned_of(
    content: str, warned: bool, tmp_path: Path
) -> None:
    (tmp_path / "d").mkdir()
    for name in ("a.js", "a b.vxml"):
        (tmp_path / "d" / name).write_text(
            '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"><form id="x"/></vxml>'
        )
    (tmp_path / "d" / "m.vxml").write_text(
        f'<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">{content}</vxml>'
    )
    done = prima("validate", "d/m.vxml", cwd=tmp_path)
    assert ("[no-such-file]" in done.stdout) == warned, done.stdout
    assert "error:" not in done.stdout


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<form id="m"><block><log expr="event.name"/><exit/></block></form>', "event"),
        ('<form id="m"><block><log expr="1 + _event.name"/><exit/></block></form>', "_event"),
        ('<form id="m"><block><speak>A<value expr="_message"/></speak><exit/></block></form>', "_message"),
        ('<form id="m"><block><speak>A<on event="failed"><log expr="event.name"/></on></speak><exit/></block></form>', ""),
        ('<form id="m"><block><exit/></block></form><on event="touch" cond="event.data"><log expr="event"/></on>', ""),
        ('<form id="m"><block><log expr="[1].map(event => event)"/><exit/></block></form>', ""),
        ("""<form id="m"><block><log expr="'event'"/><exit/></block></form>""", ""),
        ('<var name="event" expr="1"/><form id="m"><block><log expr="event"/><exit/></block></form>', ""),
        ('<form id="m"><block><foreach item="event" array="[1]"><log expr="event"/></foreach><exit/></block></form>', ""),
        ('<form id="m"><block><log expr="typeof event"/><exit/></block></form>', ""),
    ],
)  # fmt: skip
def test_an_event_is_known_in_its_handlers_alone(content: str, name: str, tmp_path: Path) -> None:
    text = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">{content}</prima>'
    (tmp_path / "a.xml").write_text(text)
    done = prima("validate", "a.xml", "--format", "json", cwd=tmp_path)
    found = [one for one in json.loads(done.stdout) if one["severity"] == "error"]
    assert [one["column"] for one in found] == ([text.index(name) + 1] if name else [])
    assert all(f'"{name}" is there in a handler only' in one["message"] for one in found)


SCENARIO = f"""<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"
 world="{ROOT}/documents/worlds/library.xml" robot="{ROOT}/documents/robots/papero.xml">
  <application src="{{}}"/>
  {{}}
  <robot at="nowhere"/>
  <person at="there" spede="1"/>
  <when at="3s"><touch sensor="haed"/><unload application="librari"/></when>
  <when at="3x"><fail device="wheel"/></when>
</scenario>
"""


@pytest.mark.parametrize("missing", [False, True])
def test_all_that_is_wrong_with_a_scenario_is_told_at_once(missing: bool, tmp_path: Path) -> None:
    documents = ROOT / "documents" / "ea"
    src = documents / ("libary.xml" if missing else "library.xml")
    path = tmp_path / "s.xml"
    path.write_text(SCENARIO.format(src, "<application/>" if missing else ""), encoding="utf-8")
    with pytest.raises(DocumentError) as caught:
        loading.load_scenario(path)
    own = [one for one in caught.value.problems if one.place.file == str(path)]
    places = {
        (3, 21): "no-such-file",
        (4, 3): "missing-attribute",
        (5, 14): "no-such-name",
        (6, 15): "no-such-name",
        (6, 22): "unknown-attribute",
        (7, 32): "no-such-name",
        (7, 60): "no-such-name",
        (8, 13): "bad-value",
        (8, 31): "no-such-name",
    }
    for unknown in [(7, 60)] if missing else [(3, 21), (4, 3)]:  # which ids there are is not known
        del places[unknown]
    assert {(one.place.line, one.place.column): one.code for one in own} == places


def test_a_scenario_with_any_attribute_wrong_is_looked_at() -> None:
    looked = 0
    for path in sorted((ROOT / "documents" / "scenarios").glob("*.xml"))[::6]:
        text = path.read_text(encoding="utf-8")
        for written in re.finditer(r'([\w-]+)="([^"]*)"', text):
            for wrong in ("", f'{written[1]}=""', f'{written[1]}="?!"', f'{written[1]}x="1"'):
                try:
                    loading._load(
                        path, (text[: written.start()] + wrong + text[written.end() :]).encode()
                    )
                except DocumentError as error:
                    assert error.problems
                looked += 1
    assert looked > 200


@pytest.mark.parametrize(
    ("person", "doing", "told"),
    [
        ("", '<walk to="aisle"/><look at="robot"/>', ["<walk> does nothing"]),
        ("", '<look at="robot"/>', ["<look> does nothing"]),
        ("", "<say>Hello.</say>", []),
        ('<person at="aisle"/>', '<walk to="entrance"/>', []),
    ],
)
def test_nobody_walks_where_nobody_is(
    person: str, doing: str, told: list[str], tmp_path: Path
) -> None:
    path = tmp_path / "s.xml"
    head = SCENARIO.partition("<application")[0]
    application = f'<application src="{ROOT}/documents/ea/library.xml"/>'
    when = f'<when at="3s">{doing}</when></scenario>'
    path.write_text(f"{head}{application}{person}{when}", encoding="utf-8")
    problems = loading.load_scenario(path).problems
    found = [one for one in problems if one.message.startswith("Nobody")]
    assert [one.message.partition(" without")[0].partition(": ")[2] for one in found] == told
    assert {(one.severity, one.code) for one in found} <= {("warning", "missing-element")}


# What is told a second time (O3) -------------------------------------------------------------

ASKS = """<form id="a"><field name="x" type="boolean"><prompt>Well?</prompt>{}</field>{}</form>"""
THEN = """<form id="b">{}</form>"""
BACK = '<block><goto next="#a"/></block>'


@pytest.mark.parametrize(
    "first, then",
    [
        (ASKS.format("", '<on event="touch"><goto next="#a"/></on>'), ""),
        (ASKS.format("", '<on event="touch"><goto next="#b"/></on>'), THEN.format(BACK)),
        (ASKS.format('<on event="touch"><speak>Oh.</speak><goto next="#a"/></on>', ""), ""),
        ('<form id="a"><block><speak>Hi.</speak></block><on event="touch"><if cond="true"><goto next="#a"/></if></on></form>', ""),
        (ASKS.format("", ""), '<on event="message"><goto next="#b"/></on>' + THEN.format(BACK)),
    ],
    ids=["at once", "by way of another", "behind a Command", "a sentence", "of the document"],
)  # fmt: skip
def test_what_an_event_makes_it_tell_twice_is_warned_of(first: str, then: str) -> None:
    (problem,) = told_twice_in(first + then)
    assert problem.severity == "warning" and problem.remedy.startswith("Leave out the <goto>")
    assert "it is told twice" in problem.message and "(line 1)" in problem.message


@pytest.mark.parametrize(
    "first, then",
    [
        (ASKS.format("", '<on event="touch"><gesture name="bow"/></on>'), ""),
        (ASKS.format("", '<on event="touch"><goto next="#b"/></on>'), THEN.format("")),
        (ASKS.format("<noinput><goto next='#a'/></noinput>", ""), ""),
        (ASKS.format("", '<on event="touch"><goto next="#b"/></on>'),
         THEN.format('<field name="y" type="boolean"><prompt>So?</prompt></field>' + BACK)),
        (ASKS.replace("<prompt>", '<prompt cond="first">').format("", '<on event="touch"><goto next="#a"/></on>'), ""),
        (ASKS.format("", '<on event="message"><assign name="n" expr="event.data.text"/><goto next="#a"/></on>'), ""),
        (ASKS.format("", '<link event="again"><grammar>again</grammar></link><on event="again"><goto next="#a"/></on>'), ""),
        ('<form id="a"><block><send event="late" delay="9s"/><speak>Hi.</speak></block><on event="late"><goto next="#a"/></on></form>', ""),
        ('<form id="a"><block><move-head pan="9"/></block><on event="touch"><goto next="#a"/></on></form>', ""),
    ],
    ids=["stays", "goes and waits", "own event", "asks between", "cond", "news", "asked for", "timer", "silent"],
)  # fmt: skip
def test_what_is_meant_to_be_told_again_is_not_warned_of(first: str, then: str) -> None:
    assert told_twice_in(first + then) == []


SAYS = '<block name="h"><speak>Hello there, and welcome.</speak></block>'
TO = "<on event='touch'>{}</on>"
BY = '<goto next-expr="{}"/>'
CALLS = """<form id="b"><subdialog name="s" src="#c">{}</subdialog><block>{}</block></form>
<form id="c">{}</form>"""
BACK_THEN, RETURNS = '<goto next="#a"/>', "<block><gesture name='nod'/><return/></block>"
CALLED_BACK = ASKS.format("", TO.format('<goto next="#b"/>'))
END = '<form id="end"><block><exit/></block></form>'


def form_of(inside: str, form: str = "a") -> str:
    return f'<form id="{form}">{inside}</form>'


ANSWERED = '<field name="x" type="boolean"><prompt>Well?</prompt>{}<filled><exit/></filled></field>'
AGAIN = {
    "a text": (form_of(SAYS + TO.format(BY.format("'#a'"))), "this leads back to"),
    "one of two": (form_of(SAYS + TO.format(BY.format("n ? 'end' : (first ? 'a' : 'end')"))) + END, "leads back"),
    "anywhere": (form_of(SAYS + TO.format(BY.format("n"))), "it may be told twice: where this leads depends"),
    "begins so": (form_of(SAYS + TO.format(BY.format("'#a' + n"))), "may be told twice"),
    "anywhere from elsewhere": (
        CALLED_BACK + THEN.format(f"<block>{BY.format('n')}</block>"), "may be told twice"),
    "anywhere, of the document": (form_of(SAYS) + TO.format(BY.format("n")), "may be told twice"),
    "a subdialog returns with an event": (
        '<form id="s"><subdialog name="d" src="#a"><on event="bang"><log>x</log></on></subdialog></form>'
        + ASKS.format("", TO.format('<return event="bang"/>')), "calls it again"),
    "a subdialog": (CALLED_BACK + CALLS.format("", BACK_THEN, RETURNS), "leads back"),
    "what was called is over": (
        CALLED_BACK + CALLS.format(f"<filled>{BACK_THEN}</filled>", "", RETURNS), "leads back"),
    "the form's filled": (
        CALLED_BACK + CALLS.format("", "", RETURNS).replace("<block></block>", f"<filled>{BACK_THEN}</filled>"),
        "leads back"),
    "an event of a subdialog": (
        CALLED_BACK + CALLS.format(f"<on event='over'>{BACK_THEN}</on>", "",
                                   "<block><return event='over'/></block>"), "leads back"),
    "a subdialog by way of others": (
        CALLED_BACK + CALLS.format("", BACK_THEN, "<subdialog name='s' src='#d'/><block><return/></block>")
        + '<form id="d"><block><goto next="#e"/></block></form><form id="e"><block><return/></block></form>',
        "leads back"),
    "in a subdialog": (CALLED_BACK + CALLS.format("", "", f"<block>{BACK_THEN}</block>"), "leads back"),
    "thrown on the way": (
        CALLED_BACK + THEN.format(f"<on event='over'>{BACK_THEN}</on><block><throw event='over'/></block>"),
        "leads back"),
    "its item": (form_of(ANSWERED.format("") + TO.format('<clear/><goto nextitem="x"/>')), "asks this (line 1), it is"),
    "its item, not cleared": (form_of(ANSWERED.format("") + TO.format('<goto nextitem="x"/>')), "visits it again"),
    "its item, by a text": (form_of(SAYS + TO.format("<goto nextitem-expr=\"'h'\"/>")), "says this (line 1), it is"),
    "any item": (form_of(SAYS + TO.format('<goto nextitem-expr="n"/>')), "which item is next depends"),
    "its first item, then it": (
        form_of('<block name="s"/>' + ANSWERED.format("") + TO.format('<goto nextitem="s"/>')), "asks this"),
    "cleared": (
        form_of(SAYS + '<block name="s"/>' + TO.format('<clear namelist="h"/><goto nextitem="s"/>')), "says this"),
    "all cleared": (
        form_of(SAYS + '<block name="s"/>' + TO.format('<clear/><goto nextitem="s"/>')), "says this"),
    "round and round": (
        form_of('<block><speak>Hello.</speak><goto next="#b"/></block>' + TO.format('<goto next="#b"/>'))
        + THEN.format('<block><gesture name="nod"/><goto next="#a"/></block>'), "leads back"),
    "an item, of the document": (form_of(SAYS) + TO.format('<clear/><goto nextitem="h"/>'), "says this"),
    "tapered, cleared": (
        form_of(ANSWERED.format('<prompt count="2">Yes or no?</prompt>')
                     + TO.format('<clear namelist="x"/><goto nextitem="x"/>')), "asks this"),
}  # fmt: skip


@pytest.mark.parametrize("name", AGAIN)
def test_all_ways_back_are_warned_of(name: str) -> None:
    body, says = AGAIN[name]
    (problem,) = told_twice_in(body)
    assert problem.severity == "warning" and says in problem.message
    assert ("in the expression" in problem.remedy) == ("may be" in problem.message)


VALUES = {"begins so": "''", "one of two": "0", "any item": "'h'"}
"""What the variable ``n`` is where its form is not "a"."""


@pytest.mark.parametrize("name", AGAIN)
def test_what_is_warned_of_is_said_twice_in_a_run(name: str) -> None:
    variables = f"""<var name="first" expr="1"/><var name="n" expr="{VALUES.get(name, "'a'")}"/>"""
    assert_said_twice(Bench(AGAIN[name][0] + variables))


def assert_said_twice(bench: Bench) -> None:
    """A touch while the first sentence is said makes an application say it again."""
    (first,) = bench.said()
    bench.event("touch")
    for _ in range(9):
        if bench.said().count(first) == 1:
            bench.step(*[Ended(one, data={"outcome": "noinput"}) for one in bench.running()])
    assert bench.said()[1:] in ([first], ["Oh.", first])


CALLER = '<form id="s"><subdialog name="d" src="#a"><on event="bang">{}</on></subdialog></form>'
BANG = ASKS.format("", TO.format('<return event="bang"/>'))
NEVER_AGAIN = {
    "who called goes elsewhere": CALLER.format("<goto next='#end'/>") + END + BANG,
    "who called ends": CALLER.format("<exit/>") + BANG,
    "who called takes it for answered": CALLER.format("<assign name='d' expr='1'/>") + BANG,
    "who called handles another event": CALLER.replace("bang", "other").format("") + BANG,
    "returns with no event": CALLER.format("") + ASKS.format("", TO.format("<return/>")),
    "a text": form_of(SAYS + TO.format(BY.format("'#end'"))) + END,
    "one of two": form_of(SAYS + TO.format(BY.format("n ? 'end' : 'other'"))) + END + form_of(SAYS, "other"),
    "begins otherwise": form_of(SAYS + TO.format(BY.format("'#en' + n"))) + END,
    "asks before it goes anywhere": CALLED_BACK
    + THEN.format('<field name="y" type="boolean"><prompt>So?</prompt></field>' + f"<block>{BY.format('n')}</block>"),
    "a subdialog that asks": CALLED_BACK + CALLS.format("", BACK_THEN, ANSWERED.format("") + RETURNS),
    "a subdialog that never returns": CALLED_BACK + CALLS.format("", BACK_THEN, "<block><gesture name='nod'/></block>"),
    "subdialogs of each other": CALLED_BACK + CALLS.format("", BACK_THEN, "<subdialog name='s' src='#b'/>" + RETURNS),
    "waits for more than a subdialog": CALLED_BACK
    + CALLS.format("", "", RETURNS).replace(
        "<block></block>", f"<field name='y' type='boolean'/><filled>{BACK_THEN}</filled>"),
    "an event that nobody takes": CALLED_BACK + CALLS.format("", BACK_THEN, "<block><return event='over'/></block>"),
    "ends before": CALLED_BACK + THEN.format("<block><exit/></block>" + BACK),
    "another item": form_of(SAYS + '<block name="s"/>' + TO.format('<goto nextitem="s"/>')),
    "a text of another item": form_of(SAYS + '<block name="s"/>' + TO.format("<goto nextitem-expr=\"'s'\"/>")),
    "an item that asks, then what is cleared": form_of(
        '<block name="h"><speak>Hello.</speak></block><field name="y" type="boolean"><prompt cond="n">So?</prompt></field>'
        + TO.format('<clear namelist="h"/><goto nextitem="y"/>')),
    "a question between, cleared": form_of(
        '<field name="y" type="boolean"><prompt cond="n">So?</prompt></field>' + SAYS + '<block name="s"/>'
        + TO.format('<clear/><goto nextitem="s"/>')),
    "an item, taken by the form": form_of(SAYS + TO.format("<gesture name='nod'/>"))
    + TO.format('<goto nextitem="h"/>'),
    "leaves the form": form_of(SAYS + '<block name="s" expr="true"><goto next="#end"/></block>'
                                    + TO.format('<clear/><goto nextitem="s"/>')) + END,
    "tapered": form_of(ANSWERED.format('<prompt count="2">Yes or no?</prompt>') + TO.format('<goto nextitem="x"/>')),
    "the handler of another item": form_of(
        SAYS + '<field name="y" type="boolean"><prompt cond="n">So?</prompt>' + TO.format('<goto nextitem="h"/>') + "</field>"),
    "taken by the form": form_of(SAYS + TO.format("<gesture name='nod'/>")) + TO.format(BY.format("'a'")),
}  # fmt: skip


@pytest.mark.parametrize("name", NEVER_AGAIN)
def test_other_ways_are_not_warned_of(name: str) -> None:
    assert told_twice_in(NEVER_AGAIN[name]) == []


def test_of_a_goto_that_may_lead_anywhere_one_example_is_told() -> None:
    forms = "".join(form_of(SAYS, name) for name in "abcd")
    (problem,) = told_twice_in(forms + TO.format(BY.format("n")))
    assert 'the form "a" says this' in problem.message


def told_twice_in(body: str) -> list[Problem]:
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="x"><var name="first"/><var name="n"/>'
    _, problems = read_document("x.xml", f"{head}{body}</prima>".encode())
    assert [one for one in problems if one.severity == "error"] == []
    return [one for one in problems if one.code == "told-twice"]


ASKS_VOICE = "<form id='a'><field name='x' type='boolean'><prompt>Well?</prompt>{}</field>{}</form>"
BACK_VOICE = "<form id='b'>{}<block><goto next='#a'/></block></form>"
TOUCHED = "<catch event='touch'>{}<goto next='#{}'/></catch>"
HANDLED = "<catch event='message'>{}<goto next='#a'/></catch>"


@pytest.mark.parametrize(
    ("body", "says"),
    [
        (ASKS_VOICE.format("", TOUCHED.format("", "a")), 'the form "a" asks this (line 2)'),
        (ASKS_VOICE.format("", TOUCHED.format("Oh.", "b")) + BACK_VOICE.format(""), "asks this"),
        (ASKS_VOICE.format("<catch event='touch.head'><goto next='#a'/></catch>", ""), "touch.head"),
        (ASKS_VOICE.format("", "") + TOUCHED.format("", "a"), 'If "touch" comes'),
        ("<form id='a'><block>Hi.</block>" + TOUCHED.format("", "a") + "</form>", "says this (line 2)"),
        ("<form id='a'><block>Hi.</block><catch event='touch'><if cond='true'><goto next='#a'/></if>"
         "</catch></form>", "says this"),
        ("<form><block><prompt>Hi.</prompt></block><catch event='touch'><goto next='main.vxml'/></catch>"
         "</form>", "the form #1 says this (line 2), it is told twice: this leads back to the form's"),
        ("<menu id='a'>Well? <choice next='#a'>yes</choice>" + TOUCHED.format("", "a") + "</menu>",
         'the menu "a" asks this (line 2), it is told twice: this leads back to the menu\'s beginning'),
        ("<form id='a'><p:iu xmlns:p='urn:prima:dialogue:1'><block>Hi.</block></p:iu>"
         + TOUCHED.format("", "a") + "</form>", "says this"),
        (ASKS_VOICE.format("", "<catch event='touch'><submit next='service:s#a'/></catch>"), "asks"),
    ],
    ids=["at once", "by way of another", "in a field", "of the document", "a sentence", "in an if",
         "by its file", "a menu", "in a unit", "by a submit"],
)  # fmt: skip
def test_voicexml_is_warned_of_what_it_tells_twice(tmp_path: Path, body: str, says: str) -> None:
    (problem,) = told_twice_by(tmp_path, body)
    assert problem.severity == "warning" and says in problem.message
    assert problem.remedy.startswith("Leave out the <goto>: the dialog goes on then.")
    at = f"<vxml>\n{body}".splitlines()[problem.place.line - 1][problem.place.column - 1 :]
    assert at.startswith(("<goto", "<submit"))


@pytest.mark.parametrize(
    "body",
    [
        ASKS_VOICE.format("", "<catch event='touch'>Oh. <reprompt/></catch>"),
        ASKS_VOICE.format("", TOUCHED.format("", "b")) + "<form id='b'/>",
        ASKS_VOICE.format("<noinput><goto next='#a'/></noinput>", ""),
        ASKS_VOICE.format("<catch><goto next='#a'/></catch>", ""),
        ASKS_VOICE.format("<error><goto next='#a'/></error>", ""),
        ASKS_VOICE.format("<catch event='connection.disconnect'><goto next='#a'/></catch>", ""),
        ASKS_VOICE.format("", TOUCHED.format("", "b"))
        + BACK_VOICE.format("<field name='y' type='boolean'><prompt>So?</prompt></field>"),
        ASKS_VOICE.replace("<prompt>", "<prompt cond='!first'>").format("", TOUCHED.format("", "a")),
        ASKS_VOICE.format("", HANDLED.format("<assign name='n' expr='session.event.data.text'/>")),
        ASKS_VOICE.format("", "<link event='again' dtmf='1'/><catch event='again'><goto next='#a'/></catch>"),
        ASKS_VOICE.format("<filled><throw event='touch'/></filled>", TOUCHED.format("", "a")),
        "<form id='a'><block><log>Hi.</log></block>" + TOUCHED.format("", "a") + "</form>",
        "<form id='a'><block cond='!first'>Hi.</block>" + TOUCHED.format("", "a") + "</form>",
    ],
    ids=["stays", "goes and ends", "own event", "any event", "error", "hangup", "asks between", "cond",
         "news", "asked for", "thrown", "silent", "a condition"],
)  # fmt: skip
def test_voicexml_may_tell_again_what_is_meant_so(tmp_path: Path, body: str) -> None:
    assert told_twice_by(tmp_path, body) == []


H = "<block name='h'>Hello there, and welcome.</block>"
TOUCH = "<catch event='touch'>{}</catch>"
VOICE_CALLS = """<form id='b'><subdialog name='s' src='{}'>{}</subdialog><block>{}</block></form>
<form id='c'>{}</form>"""
TO_B, TO_A, NODS = "<goto next='#b'/>", "<goto next='#a'/>", "<block>Oh.<return/></block>"
VX = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"{}>{}</vxml>'
OVER_THERE = VX.format("", "<form id='b'><block>Oh.<goto next='main.vxml#a'/></block></form>")
Q = "<field name='x' type='boolean'><prompt>Well?</prompt>{}</field>"
HQ = H + Q.format("")
VOICE_AGAIN: dict[str, tuple[str, str, dict[str, str]]] = {
    "a text": (form_of(HQ + TOUCH.format("<goto expr=\"'#a'\"/>")), "leads back", {}),
    "one of two": (
        form_of(HQ + TOUCH.format("<goto expr=\"n ? 'other.vxml' : '#a'\"/>")), "leads back", {}),
    "anywhere": (form_of(HQ + TOUCH.format("<goto expr='n'/>")), "where this leads depends", {}),
    "begins so": (form_of(HQ + TOUCH.format("<goto expr=\"'#' + n.substring(1)\"/>")), "may be told", {}),
    "begins with a file's name": (
        form_of(HQ + TOUCH.format("<goto expr=\"'mai' + n\"/>")), "may be told", {}),
    "another document": (
        form_of(HQ + TOUCH.format("<goto next='other.vxml'/>")), "leads back", {"other": OVER_THERE}),
    "a dialog of another document": (
        form_of(Q.format("") + TOUCH.format("<submit next='other.vxml#b'/>")), "leads back",
        {"other": OVER_THERE}),
    "two other documents": (
        form_of(HQ + TOUCH.format("<goto next='third.vxml'/>")), "leads back",
        {"other": OVER_THERE,
         "third": VX.format("", "<form><block><goto next='other.vxml'/></block></form>")}),
    "a subdialog of another document": (
        form_of(HQ + TOUCH.format(TO_B)) + VOICE_CALLS.format("other.vxml#c", "", TO_A, ""), "leads back",
        {"other": VX.format("", form_of(NODS, "c"))}),
    "a subdialog": (
        form_of(HQ + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", "", TO_A, NODS), "leads back", {}),
    "a subdialog's filled": (
        form_of(HQ + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", f"<filled>{TO_A}</filled>", "", NODS),
        "leads back", {}),
    "an event of a subdialog": (
        form_of(HQ + TOUCH.format(TO_B))
        + VOICE_CALLS.format("#c", f"<catch event='over'>{TO_A}</catch>", "",
                             "<block><return event='over'/></block>"), "leads back", {}),
    "its item": (form_of(HQ + TOUCH.format("<clear/><goto nextitem='h'/>")), "visits it again", {}),
    "its item, not cleared": (form_of(HQ + TOUCH.format("<goto nextitem='h'/>")), "says", {}),
    "in the question behind it": (
        form_of(H + Q.format(TOUCH.format("<clear/><goto nextitem='h'/>"))), "says", {}),
    "a silent item": (
        form_of("<block name='s'/>" + Q.format("") + TOUCH.format("<goto nextitem='s'/>")), "asks", {}),
    "any item": (form_of(HQ + TOUCH.format("<goto expritem=\"'h' + n.slice(9)\"/>")), "may be this one", {}),
    "tapered, cleared": (
        form_of("<block name='s'/>" + Q.format("<prompt count='2'>So?</prompt>")
                + TOUCH.format("<clear namelist='dialog.x'/><goto nextitem='s'/>")), "asks", {}),
}  # fmt: skip


@pytest.mark.parametrize("name", VOICE_AGAIN)
def test_all_ways_back_in_voicexml_are_warned_of(tmp_path: Path, name: str) -> None:
    body, says, others = VOICE_AGAIN[name]
    for other, text in others.items():
        (tmp_path / f"{other}.vxml").write_text(text)
    (problem,) = told_twice_by(tmp_path, body)
    assert says in problem.message and problem.place.file.endswith("main.vxml")
    assert ("in the expression" in problem.remedy) == ("may be" in problem.message)
    value = {"one of two": "", "begins with a file's name": "n.vxml"}.get(name, "#a")
    main = VX.format("", f"""{body}<var name="n" expr="'{value}'"/>""")
    assert_said_twice(Call(main, **{"app": main, "main": main, **others}))


VOICE_NEVER_AGAIN: dict[str, tuple[str, dict[str, str]]] = {
    "another dialog": (form_of(H + TOUCH.format("<goto expr=\"'#e' + n\"/>")), {}),
    "an answer of a service": (form_of(H + TOUCH.format("<submit next='service:main.vxml'/>")), {}),
    "a service's document": (form_of(H + TOUCH.format("<goto expr=\"'service:s' + n\"/>")), {}),
    "another host": (form_of(H + TOUCH.format("<goto expr=\"'http://x.example/main.vxml'\"/>")), {}),
    "another document that ends": (
        form_of(H + TOUCH.format("<goto next='other.vxml'/>")),
        {"other": VX.format("", "<form><block>Oh.<exit/></block><block><goto next='main.vxml'/></block></form>")}),
    "another document that asks": (
        form_of(H + TOUCH.format("<goto next='other.vxml'/>")),
        {"other": VX.format("", "<form><field name='y' type='boolean'/><block><goto next='main.vxml'/></block></form>")}),
    "another dialog of another document": (
        form_of(H + TOUCH.format("<goto next='other.vxml#c'/>")),
        {"other": OVER_THERE.replace("</form>", "</form><form id='c'><block>Bye.</block></form>")}),
    "a dialog of that name in another document": (
        form_of(H + TOUCH.format("<goto next='other.vxml#a'/>")),
        {"other": VX.format("", form_of("<block>Bye.</block>"))}),
    "a subdialog that asks": (
        form_of(H + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", "", TO_A, Q.format("") + NODS), {}),
    "a subdialog without an end": (
        form_of(H + TOUCH.format(TO_B)) + VOICE_CALLS.format("#c", "", TO_A, "<block>Oh.</block>"), {}),
    "a call": (
        form_of(H + TOUCH.format(TO_B))
        + "<form id='b'><transfer dest='tel:1' type='bridge'/><block><goto next='#a'/></block></form>", {}),
    "a question is not asked again": (
        form_of(Q.format("") + TOUCH.format("<clear/><goto nextitem='x'/>")), {}),
    "a prompt with a condition": (
        form_of("<block><prompt cond='!n'>Hi.</prompt></block>" + TOUCH.format(TO_A)), {}),
    "other words": (
        form_of("<block name='s'/>" + Q.format("<prompt count='2'>So?</prompt>")
                + TOUCH.format("<goto nextitem='s'/>")), {}),
}  # fmt: skip


@pytest.mark.parametrize("name", VOICE_NEVER_AGAIN)
def test_other_ways_in_voicexml_are_not_warned_of(tmp_path: Path, name: str) -> None:
    body, others = VOICE_NEVER_AGAIN[name]
    for other, text in others.items():
        (tmp_path / f"{other}.vxml").write_text(text)
    assert told_twice_by(tmp_path, body) == []


def test_a_handler_of_the_application_root_makes_its_leaf_tell_twice(tmp_path: Path) -> None:
    (tmp_path / "root.vxml").write_text(VXML.format("", TOUCHED.format("", "a")))
    leaf = VXML.format(' application="root.vxml"', ASKS_VOICE.format("", ""))
    (tmp_path / "leaf.vxml").write_text(leaf)
    found = loading.validate([tmp_path / "leaf.vxml"])
    (problem,) = [one for one in found if one.code == "told-twice"]
    assert problem.place.file.endswith("root.vxml")


def told_twice_by(folder: Path, body: str) -> list[Problem]:
    """What a VoiceXML document is warned of; its content stands in line 2."""
    head = "<var name='first'/><var name='n'/>"
    (folder / "main.vxml").write_text(VXML.format("", f"\n{body}{head}"))
    found = loading.validate([folder / "main.vxml"])
    assert [str(one) for one in found if one.severity == "error"] == []
    return [one for one in found if one.code == "told-twice"]


# Documents of VoiceXML together ---------------------------------------------------------

VXML = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"{}>{}</vxml>'
CALLED = VXML.format(
    "", '<form id="call"><var name="order"/><block><return namelist="order"/></block></form>'
)


def told(folder: Path, content: str, attributes: str = "", **others: str) -> list[str]:
    """What is told of an application of several documents."""
    for name, text in others.items():
        (folder / f"{name}.vxml").write_text(text)
    (folder / "main.vxml").write_text(VXML.format(attributes, content))
    found = loading.validate([folder / "main.vxml"])
    return [f"{Path(one.place.file).name} {one.code} {one.message} {one.remedy}" for one in found]


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<form><block><log expr="x"/></block></form>', "x"),
        ('<var name="a" expr="b"/><form/>', "b"),
        ('<form><block><assign name="x" expr="1"/></block></form>', "x"),
        ('<form><block><assign name="x.y" expr="1"/></block></form>', "x"),
        (
            '<form><var name="a"/><block><submit next="service:s" namelist="a b"/></block></form>',
            "b",
        ),
        ('<form><block cond="ready"/></form>', "ready"),
        ('<form id="a"><var name="x"/></form><form><block><log expr="x"/></block></form>', "x"),
        ('<catch event="e"><log expr="x"/></catch><form/>', "x"),
        (
            '<form xmlns:p="urn:prima:dialogue:1"><block><p:turn angle-expr="x"/></block></form>',
            "x",
        ),
        ("<form><block><script>var y = x;</script></block></form>", "x"),
        ("<script>function f(y) { return x + y; }</script><form><var name='x'/></form>", "x"),
        ("<form><block><script>x++;</script></block></form>", "x"),
        ('<form><block><disconnect namelist="x"/></block></form>', "x"),
        ('<form><block><data src="service:s" namelist="x"/></block></form>', "x"),
        ('<form><block><var name="x"/></block><block><log expr="x"/></block></form>', "x"),
        ('<form><block><script>x = 1;</script></block><block><log expr="x"/></block></form>', "x"),
        ('<form><filled><var name="x"/></filled><catch><log expr="x"/></catch></form>', "x"),
        ('<catch event="e"><var name="x"/></catch><form><block><log expr="x"/></block></form>', "x"),
        ('<form><subdialog name="s" src="#a"><filled><log expr="s$.y"/></filled></subdialog></form>'
         '<form id="a"><block><return/></block></form>', "s$"),
        ('<var name="x"/><form><block><log expr="x$"/></block></form>', "x$"),
    ],
)  # fmt: skip
def test_a_variable_that_nothing_declares_is_told(tmp_path: Path, content: str, name: str) -> None:
    (one,) = told(tmp_path, content)
    assert f'undeclared-variable The variable "{name}" is not declared' in one


ASKS = '<field name="a"{}><prompt>Q?</prompt>{}</field>'
RULES = '<grammar version="1.0" root="r"{}><rule id="r">a</rule></grammar>'
UNIVERSALS = '<property name="universals" value="all"/>'


@pytest.mark.parametrize(
    "content",
    [
        f"<form>{ASKS.format('', '')}</form>",
        f'<form><p:iu xmlns:p="urn:prima:dialogue:1">{ASKS.format("", "")}</p:iu></form>',
        "<form>" + ASKS.format(' modal="true"', "") + "</form><link event='e' dtmf='1'/>",
        f"<form>{ASKS.format('', '')}</form><form>{RULES.format('')}</form>",
    ],
)
def test_a_question_of_voicexml_at_which_no_grammar_listens_is_told(
    tmp_path: Path, content: str
) -> None:
    (one,) = told(tmp_path, content)
    assert one.startswith("main.vxml no-answer No grammar listens at the <field> a: ")


@pytest.mark.parametrize(
    "content",
    [
        "<form>" + ASKS.format(' type="boolean"', "") + "</form>",
        f"<form>{ASKS.format('', '<option>tea</option>')}</form>",
        f"<form>{ASKS.format('', RULES.format(''))}</form>",
        f"<form>{RULES.format('')}<initial/>{ASKS.format('', '')}</form>",
        f"<form>{ASKS.format('', '')}<link event='e' dtmf='1'/></form>",
        f"<form>{ASKS.format('', '')}</form><link event='e' dtmf='1'/>",
        f"<form>{ASKS.format('', '')}</form><form scope='document'>{RULES.format('')}</form>",
        f"<form>{ASKS.format('', '')}</form><form>" + RULES.format(' scope="document"') + "</form>",
        f"{UNIVERSALS}<form>{ASKS.format('', '')}</form>",
        f"<form>{ASKS.format('', UNIVERSALS)}</form>",
        "<form>" + ASKS.format(' expr="1"', "") + "</form>",
        f"<form><block><assign name='a' expr='1'/></block>{ASKS.format('', '')}</form>",
    ],
)
def test_a_question_of_voicexml_at_which_something_listens_is_fine(
    tmp_path: Path, content: str
) -> None:
    assert [one for one in told(tmp_path, content) if "no-answer" in one] == []


def test_what_listens_in_an_application_root_listens_in_its_leaves(tmp_path: Path) -> None:
    root, leaf = (
        VXML.format("", "<link event='e' dtmf='1'/>"),
        f"<form>{ASKS.format('', '')}</form>",
    )
    assert told(tmp_path, leaf, ' application="root.vxml"', root=root) == []
    assert (
        "no-answer" in told(tmp_path, leaf, ' application="root.vxml"', root=VXML.format("", ""))[0]
    )


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<var name="session"/><form/>', "session"),
        ("<script>var session = 5;</script><form/>", "session"),
        ("<form><block><script>function dialog() {}</script></block></form>", "dialog"),
        ('<form><field name="document" type="boolean"/></form>', "document"),
        ("<script>function f(session) { var application; return session; }</script><form/>", ""),
    ],
)
def test_a_variable_that_hides_a_scope_is_told(tmp_path: Path, content: str, name: str) -> None:
    found = [one for one in told(tmp_path, content) if " hides " in one]
    assert len(found) == bool(name)
    assert all(f'bad-value The variable "{name}" hides the ' in one for one in found)


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        *(("nogr.grxml", ""), ("cro.grxml", "cor.grxml"), ("c.xml", "")),
        *(("tea-menus.grxml", "tea-menu.grxml"), ("sor.grxml", ""), ("cor.vxml", "cor.xml")),
    ],
)
def test_a_file_is_guessed_only_where_it_is_near(tmp_path: Path, name: str, meant: str) -> None:
    for there in ("cor.xml", "cor.grxml", "tea-menu.grxml", "other.xml"):
        (tmp_path / there).write_text("")
    field = f'<form><field name="a"><grammar src="{name}"/></field></form>'
    (one,) = [one for one in told(tmp_path, field) if "no-such-file" in one]
    assert one.rpartition("badfetch.")[2].strip() == (f'Did you mean "{meant}"?' if meant else "")


MEMBERS = """<form><var name="own"/><block>{}</block></form>"""


@pytest.mark.parametrize(
    ("content", "holder", "name"),
    [
        (MEMBERS.format('<assign name="document.q" expr="1"/>'), "document", "q"),
        (MEMBERS.format('<assign name="application.q" expr="1"/>'), "application", "q"),
        (MEMBERS.format('<assign name="dialog.q.z" expr="1"/>'), "dialog", "q"),
        (MEMBERS.format('<clear namelist="own dialog.q"/>'), "dialog", "q"),
        (MEMBERS.format('<value expr="dialog.q.foo"/>'), "dialog", "q"),
        (MEMBERS.format('<value expr="document.own.length"/>'), "document", "own"),
        (MEMBERS.format("<script>var a = dialog.q.z;</script>"), "dialog", "q"),
        (
            '<catch event="e"><assign name="application.q" expr="1"/></catch><form/>',
            "application",
            "q",
        ),
        (
            '<form><var name="q"/></form>' + MEMBERS.format('<value expr="dialog.q.z"/>'),
            "dialog",
            "q",
        ),
    ],
)
def test_a_member_of_a_scope_that_nothing_declares_there_is_told(
    tmp_path: Path, content: str, holder: str, name: str
) -> None:
    (one,) = told(tmp_path, content)
    says = f'undeclared-variable The scope "{holder}" declares no variable "{name}": this will be'
    assert says in one


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<var name="a" expr="x"/><var name="x" expr="1"/><form/>', "x"),
        ('<form><var name="a" expr="x"/><var name="x" expr="1"/></form>', "x"),
        ('<form><var name="a" expr="x"/><field name="x" type="boolean"/></form>', "x"),
        ('<form><field name="a" type="boolean" expr="x"/><var name="x"/></form>', "x"),
        ('<form><script>var a = x;</script><var name="x"/></form>', "x"),
        ('<form><var name="a" expr="x()"/><script>function x() {}</script></form>', "x"),
        ('<form><block><log expr="x"/><var name="x"/></block></form>', "x"),
        ('<form><block><assign name="x" expr="1"/><var name="x"/></block></form>', "x"),
    ],
)
def test_a_variable_that_is_used_before_it_is_declared_is_told(
    tmp_path: Path, content: str, name: str
) -> None:
    (one,) = told(tmp_path, content)
    assert f'undeclared-variable The variable "{name}" is declared after this: this will be' in one
    assert one.endswith("Declare it before.")


@pytest.mark.parametrize(
    "content",
    [
        '<var name="x"/><form><block><log expr="x + document.x + application.y"/></block></form>',
        MEMBERS.format('<log expr="dialog.q"/><log expr="dialog.q &amp;&amp; dialog.q.z"/>'),
        MEMBERS.format('<if cond="dialog.q"><log expr="dialog.q.z"/></if>'),
        MEMBERS.format('<log expr="dialog.q?.z + application.lastresult$.confidence"/>'),
        MEMBERS.format('<script>dialog.q = {};</script><log expr="dialog.q.z"/>'),
        MEMBERS.format(
            '<script>f(dialog); function f(a) { a.q = 1; }</script><log expr="dialog.q.z"/>'
        ),
        MEMBERS.format('<assign name="dialog.own" expr="1"/><clear namelist="dialog.own"/>'),
        '<catch event="e"><log expr="document.q.z + dialog.own.z"/></catch>' + MEMBERS.format(""),
        '<var name="a" expr="function() { return x; }"/><var name="x"/><form/>',
        '<script>function f() { return x; }</script><var name="x"/><form/>',
        """<var name="a" expr="typeof x == 'undefined' ? 1 : x"/><var name="x"/><form/>""",
        '<form><block name="x"/><field name="a" type="boolean" expr="x"/></form>',
        '<form><block name="x"/><block><clear namelist="x dialog.x"/></block></form>',
        '<form><block cond="x"><log expr="x"/></block><var name="x"/></form>',
        '<form><block><foreach item="i" array="[1, 2]"><if cond="i == 2"><log expr="x"/></if>'
        '<var name="x"/></foreach></block></form>',
        '<form><block><if cond="true"><var name="x"/></if><log expr="x"/></block></form>',
        '<form><grammar version="1.0" root="r"><rule id="r">a</rule></grammar>'
        '<subdialog name="s" src="#a"><filled><log expr="s$.utterance"/></filled></subdialog></form>'
        '<form id="a"><block><return/></block></form>',
        '<form><field name="x" type="boolean"><filled><log expr="x$.utterance"/></filled></field></form>',
        '<form><block><log expr="typeof x"/></block></form>',
        '<form><block><script>var x = 1; y = 2;</script><log expr="x + y"/></block></form>',
        '<script src="x.js"/><form><block><log expr="fromfile(1)"/></block></form>',
        '<script src="gone.js"/><form><block><log expr="anything"/></block></form>',
        '<form><block><foreach item="x" array="[1]"><log expr="x"/></foreach></block></form>',
        '<form><block><log expr="session.connection + lastresult$.length"/></block></form>',
        '<catch event="e"><log expr="_event + x"/></catch><form><var name="x"/></form>',
        '<form><var name="x"/><block><script>y = x; a: while (y--) break a;</script></block></form>',
        "<script>with (Math) { var y = floor(PI); } function f() { return g() + y; }"
        "function g() { try { f(); } catch (e) { return e; } }</script><form/>",
        "<script>if (typeof x != 'undefined') eval('x');</script><form/>",
    ],
)
def test_a_variable_that_something_declares_is_none_to_tell(tmp_path: Path, content: str) -> None:
    (tmp_path / "x.js").write_text("function fromfile(a) { return a; }")
    assert [one for one in told(tmp_path, content) if "undeclared-variable" in one] == []


def test_variables_of_the_application_root_are_declared(tmp_path: Path) -> None:
    root = VXML.format("", '<var name="shared"/>')
    content = '<form><block><log expr="shared + own"/></block></form>'
    (one,) = told(tmp_path, content, ' application="root.vxml"', root=root)
    assert '"own"' in one
    assert 'no file "gone.vxml"' in told(tmp_path, content, ' application="gone.vxml"')[0]
    assert len(told(tmp_path, content, ' application="gone.vxml"')) == 1, "nobody knows the rest"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ('<subdialog name="s" src="second.vxml#call"><param name="size" expr="1"/></subdialog>',
         'undeclared-variable The form "call" has no <var name="size"/>'),
        ('<subdialog name="s" src="second.vxml"><param name="oder" expr="1"/></subdialog>',
         'Did you mean "order"?'),
        ('<block><goto next="second.vxml#cal"/></block>',
         'no-such-form There is no dialog "cal" in second.vxml: this will be error.badfetch.'
         ' Did you mean "call"?'),
    ],
)  # fmt: skip
def test_what_another_document_lacks_is_told(tmp_path: Path, content: str, says: str) -> None:
    (one,) = told(tmp_path, f"<form>{content}</form>", second=CALLED)
    assert one.startswith("main.vxml") and says in one


def test_what_another_document_takes_is_fine(tmp_path: Path) -> None:
    call = '<subdialog name="s" src="second.vxml#call"><param name="order" expr="1"/></subdialog>'
    content = f'<form>{call}<block><goto next="second.vxml#call"/></block></form>'
    assert told(tmp_path, content, second=CALLED) == []


ROBOT = ' xmlns:p="urn:prima:dialogue:1" xml:lang="en"'
STANDING = [
    "<form><block>{}</block></form>",
    "<form><block><prompt>Look {}</prompt></block></form>",
    "<form><field name='f' type='boolean'><prompt>Well? {}</prompt></field></form>",
    "<form><field name='f' type='boolean'><filled>{}</filled></field></form>",
    "<catch event='e'>{}</catch><form/>",
    "<form><block><if cond='true'>{}</if></block></form>",
    "<form><block><foreach item='i' array='[1]'>{}</foreach></block></form>",
    "<form><block><p:par>{}</p:par></block></form>",
    "<form><block><p:seq>{}</p:seq></block></form>",
    "<form><block><p:iu><p:seq>{}</p:seq></p:iu></block></form>",
]


@pytest.mark.parametrize("around", STANDING)
@pytest.mark.parametrize(
    ("command", "code", "at"),
    [
        ("<p:gesture/>", "missing-attribute", "<p:gesture"),
        ("<p:pause/>", "missing-attribute", "<p:pause"),
        ("<p:point-by-hand/>", "missing-attribute", "<p:point"),
        ("<p:point-by-hand angle='900'/>", "out-of-range", "900"),
        ("<p:turn angle='far'/>", "bad-value", "far"),
        ("<p:gesture><param name='name' value='4 2'/></p:gesture>", "bad-value", "4 2"),
        ("<p:point-by-hand angle='3' toward='a'/>", "exclusive", "<p:point"),
        ("<p:gesture name='nod'>Hi.</p:gesture>", "stray-text", "<p:gesture"),
        ("<p:speak/>", "nothing-to-say", "<p:speak"),
    ],
)
def test_wrong_arguments_of_commands_in_voicexml_are_told(
    tmp_path: Path, around: str, command: str, code: str, at: str
) -> None:
    path = tmp_path / "main.vxml"
    path.write_text(text := VXML.format(ROBOT, around.format(command)))
    [one] = [one for one in loading.validate([path]) if one.code == code]
    assert one.severity == "warning", "at run time it is an event, which may be handled"
    assert one.place.column == text.index(at) + 1


@pytest.mark.parametrize(
    "command",
    [
        "<p:gesture name='nod'/>",
        "<p:gesture name-expr='1 + 1'/>",
        "<p:gesture><param name='name' expr='1 + 1'/></p:gesture>",
        "<p:point-by-hand angle-expr='900'/>",
        "<p:point-by-hand toward='door'/>",
        "<p:pause time='1s'/>",
        "<p:speak><value expr='1'/></p:speak>",
    ],
)
def test_right_arguments_of_commands_in_voicexml_are_none_to_tell(
    tmp_path: Path, command: str
) -> None:
    assert told(tmp_path, f"<form><block>{command}<exit/></block></form>", ROBOT) == []


def test_the_name_of_a_gesture_is_no_variable(tmp_path: Path) -> None:
    content = '<form><block><p:gesture name="zz1"/><log expr="zz1 + zz2"/><exit/></block></form>'
    first, second = told(tmp_path, content, ROBOT)
    assert '"zz1" is not declared' in first
    assert 'Declare it: <var name="zz2"/>.' in second


SECOND = VXML.format(
    "", '<form><field name="x"><grammar src="gone.grxml"/><prompt>Hm?</prompt></field></form>'
)


@pytest.mark.parametrize(
    "content",
    [
        '<form><block><goto next="second.vxml"/></block></form>',
        '<menu><choice next="second.vxml">two</choice></menu>',
        '<form><subdialog name="s" src="second.vxml"/></form>',
        '<form><block><submit next="second.vxml"/></block></form>',
    ],
)
def test_further_documents_of_an_application_are_looked_into(tmp_path: Path, content: str) -> None:
    (one,) = told(tmp_path, content, second=SECOND)
    assert one.startswith("second.vxml no-such-file") and "gone.grxml" in one
    beside = ROOT / "tests" / "mistakes" / "beside"
    (tmp_path / "visit.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{beside}/museum.xml" robot="{beside}/robot.xml"><robot at="door"/>'
        '<application src="main.vxml"/></scenario>'
    )
    (problem,) = loading.validate([tmp_path / "visit.xml"])
    assert problem.code == "no-such-file" and problem.place.file.endswith("second.vxml")


def test_further_documents_are_no_business_of_a_run(tmp_path: Path) -> None:
    broken = SECOND.replace("</vxml>", "")
    content = '<form><block><goto next="second.vxml"/></block></form>'
    (one,) = told(tmp_path, content, second=broken)
    assert one.startswith("second.vxml not-xml")
    assert loading.stage([], [str(tmp_path / "main.vxml")]).problems == []


def test_documents_that_lead_to_each_other_are_read_once(tmp_path: Path) -> None:
    second = VXML.format("", '<form><block><goto next="main.vxml"/></block></form>')
    content = '<form><block><goto next="second.vxml"/></block></form>'
    assert told(tmp_path, content, second=second) == []


# Worlds ---------------------------------------------------------------------------------

WORLD = """<world xmlns="urn:prima:world:1" version="1.0" id="w">
<place id="a" x="0" y="0"/><place id="b" x="4" y="0"/>
<way from="a" to="b"/>
{}
</world>"""
WALKS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f"><block>
<topological-move to="b"/><exit/></block></form></prima>"""


def test_a_way_through_a_wall_is_told_beside_other_errors(tmp_path: Path) -> None:
    path = tmp_path / "w.xml"
    wall = '<wall x1="2" y1="-2" x2="2" y2="2"/>'
    path.write_text(WORLD.format(f'<way from="a" to="q"/>{wall}'))
    found = [(one.code, one.place.line) for one in loading.validate([path])]
    assert found == [("blocked-way", 3), ("no-such-name", 4)]
    path.write_text(WORLD.format(wall.replace('"2"', '"far"', 1)))
    assert [one.code for one in loading.validate([path])] == ["bad-value"], (
        "nobody knows where it is"
    )


@pytest.mark.parametrize("y", ["0.1", "-0.18", "0.2", "0.4"])
def test_a_way_that_is_too_narrow_for_the_robot_is_told(tmp_path: Path, y: str) -> None:
    (tmp_path / "w.xml").write_text(WORLD.format(f'<wall x1="1" y1="{y}" x2="5" y2="{y}"/>'))
    (tmp_path / "a.xml").write_text(WALKS)
    (tmp_path / "s.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml"'
        f' robot="{ROOT}/documents/robots/papero.xml"><robot at="a"/>'
        '<application src="a.xml"/></scenario>'
    )
    assert loading.validate([tmp_path / "w.xml"]) == [], "it is wide enough for some robot"
    told = [one.message for one in loading.validate([tmp_path / "s.xml"])]
    blocked = bool(api.rehearse(api.load_scenario(tmp_path / "s.xml")).failures)
    assert blocked == (abs(float(y)) < 0.19)
    right = (
        'The way from "a" to "b" is too narrow for the robot: the wall in line 4 is'
        f" {abs(float(y)):.2f} m beside it."
    )
    assert told == [right] * blocked


# What a scenario waits for ----------------------------------------------------------------


ASKING = (
    '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f">'
    '<field name="x" type="boolean"><prompt>{}</prompt><noinput><exit/></noinput>'
    "<filled><exit/></filled></field></form></prima>"
)
VOICE = VXML.format(
    "",
    '<form><field name="x" type="boolean"><prompt>{}</prompt><filled>{}</filled></field></form>',
)


@pytest.mark.parametrize(
    ("name", "document", "words", "remedy"),
    [
        ("a.xml", ASKING.format("Tea or coffee?"), "tea", None),
        ("a.xml", ASKING.format("Tea or coffee?"), "juice", ""),
        ("a.xml", ASKING.format('Tea or <value expr="1"/>?'), "tea", None),
        ("a.xml", ASKING.format('<value expr="1"/>?'), "juice", None),
        ("a.xml", ASKING.format('Tea or <value expr="1"/>?'), "juice", None),
        ("a.xml", ASKING.format('Coffeine <value expr="1"/>?'), "Cofeine ?", "Coffeine ?"),
        ("a.vxml", VOICE.format("<emphasis>Tea</emphasis> or coffee?", "<exit/>"), "Tea or", None),
        ("a.vxml", VOICE.format('<phoneme ph="x">Tea</phoneme> or coffee?', ""), "Tea or", None),
        ("a.vxml", VOICE.format('<sub alias="Tea">T</sub> or coffee?', ""), "Tea or", None),
        ("a.vxml", VOICE.format('<sub alias="Tea">T</sub> or coffee?', ""), "T or", ""),
        ("a.vxml", VOICE.format("Tea or coffee?", "<exit/>"), "Tea or cofee?", "Tea or coffee?"),
        ("a.vxml", VOICE.format("Tea or coffee?", '<goto expr="x"/>'), "Tea or cofee?", None),
    ],
)
def test_an_answer_that_no_question_contains_is_told(
    tmp_path: Path, name: str, document: str, words: str, remedy: str | None
) -> None:
    (tmp_path / name).write_text(document)
    beside = ROOT / "tests" / "mistakes" / "beside"
    (tmp_path / "visit.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{beside}/museum.xml" robot="{beside}/robot.xml"><robot at="door"/>'
        f'<application src="{name}"/><answer to="{words}">Yes.</answer></scenario>'
    )
    found = loading.validate([tmp_path / "visit.xml"])
    assert [one.code for one in found] == ["never-said"] * (remedy is not None)
    assert all((remedy or "") in one.remedy for one in found)


PASSAGE = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit" world="{0}/passage.xml"'
    ' robot="{0}/robot.xml"><robot at="door"/><application src="{1}"/>{2}</scenario>'
)
CATCHES = VXML.format("", '<catch event="{}"><exit/></catch><form><block>{}</block></form>')


def in_the_passage(folder: Path, name: str, more: str = "") -> list[str]:
    """What is told of an application and a scenario with it, and where."""
    beside = ROOT / "tests" / "mistakes" / "beside"
    (folder / "visit.xml").write_text(PASSAGE.format(beside, name, more))
    found = loading.validate([folder / "visit.xml"])
    assert {one.code for one in found} <= {"unknown-event", "no-such-name"}
    return [f"{Path(one.place.file).name} {one.message} {one.remedy}" for one in found]


@pytest.mark.parametrize("name", ["a.xml", "a.vxml"])
@pytest.mark.parametrize(
    ("more", "says"),
    [
        (
            '<when on="corner.trun"><say>Yes.</say></when>',
            '"corner.trun". Did you mean "corner.turn"?',
        ),
        ('<expect event="corner.crosing"/>', 'the event "corner.crosing".'),
        ('<never event="pasage.beds"/>', '"pasage.beds". Did you mean "passage.beds"?'),
        ('<expect event="corner.turn"/><when on="corner"><say>Yes.</say></when>', ""),
        (
            '<when at="1s"><event name="corner.own"/></when><when on="corner.own"><say>Yes.</say></when>',
            "",
        ),
        ('<expect event="passage.beds"/><when on="passage"><say>Yes.</say></when>', ""),
    ],
)
def test_a_corner_that_a_scenario_misspells_is_told(
    tmp_path: Path, name: str, more: str, says: str
) -> None:
    asking = ASKING.replace('id="f">', 'id="f"><on event="corner.own"><exit/></on>', 1)
    (tmp_path / "a.xml").write_text(asking.format("Tea?"))
    (tmp_path / "a.vxml").write_text(VOICE.format("Tea?", "<exit/>"))
    told = [one for one in in_the_passage(tmp_path, name, more) if "a.xml" not in one]
    assert len(told) == bool(says)
    assert all(one.startswith("visit.xml No corner of the world raises") for one in told)
    assert says in "".join(told)


@pytest.mark.parametrize(
    ("event", "meant"),
    [
        *(("tuch", "touch"), ("tuch.head", "touch.head"), ("human.fuond", "human.found")),
        *(("conection.disconnect.hangup", "connection.disconnect.hangup"), ("no-input", "noinput")),
        *(("error.badfetsh", "error.badfetch"), ("order.cancled", "order.cancelled")),
        *(
            ("touch", ""),
            ("touch.head", ""),
            ("order", ""),
            ("order.cancelled", ""),
            ("menu.left", ""),
        ),
        *(
            ("error.badfetch.http.404", ""),
            ("error.mine", ""),
            (".", ""),
            ("exit", ""),
        ),
        *(("error.unsupported.fly", ""), ("maxspeechtimeout", ""), ("connection", "")),
    ],
)
def test_a_handler_of_voicexml_whose_event_is_a_slip_is_told(
    tmp_path: Path, event: str, meant: str
) -> None:
    thrown = '<throw event="order.cancelled"/>'
    path = tmp_path / "main.vxml"
    path.write_text(text := CATCHES.format(event, thrown))
    told = [(one.message, one.remedy, one.place.column) for one in loading.validate([path])]
    right = f'Nothing raises an event "{event}".', f'Did you mean "{meant}"?', text.index(event) + 1
    assert told == ([right] if meant else [])


def test_a_handler_may_take_what_another_document_throws(tmp_path: Path) -> None:
    content = '<form><subdialog name="s" src="second.vxml"><catch event="tuch"/></subdialog></form>'
    thrown = '<form><block><return event="{}"/></block></form>'
    assert told(tmp_path, content, second=VXML.format("", thrown.format("tuch"))) == []
    (one,) = told(tmp_path, content, second=VXML.format("", thrown.format("other")))
    assert one.startswith("main.vxml unknown-event")


def test_a_touch_sensor_that_voicexml_misspells_is_told(tmp_path: Path) -> None:
    thrown = '<throw event="touch.own"/>'
    (tmp_path / "a.vxml").write_text(CATCHES.format("touch.hed touch.head touch.own", thrown))
    (one,) = in_the_passage(tmp_path, "a.vxml")
    assert one == 'a.vxml The robot has no touch sensor "hed". Did you mean "head"?'


def test_a_grammar_in_the_place_of_a_document_is_told_to_be_one(tmp_path: Path) -> None:
    (tmp_path / "g.gram").write_text("#ABNF 1.0;\nlanguage en;\nroot $r;\n$r = yes;\n")
    told = r"This is a grammar, not XML\. Name it in a VoiceXML"
    with pytest.raises(DocumentError, match=told):
        api.stage([], [str(tmp_path / "g.gram")])
    with pytest.raises(DocumentError, match=told):
        api.load_scenario(tmp_path / "g.gram")


def test_an_argument_of_a_command_in_voicexml_that_is_given_twice(tmp_path: Path) -> None:
    path = tmp_path / "a.vxml"
    path.write_text(
        '<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1" xmlns:p="urn:prima:dialogue:1">'
        '<form><block><p:turn angle="30" angle-expr="40"/></block></form></vxml>'
    )
    (problem,) = api.validate([str(path)])
    assert problem.code == "exclusive"
    assert problem.message == '<p:turn> has both "angle" and "angle-expr".'


@pytest.mark.parametrize("thrown", ["x.y", "z"])
def test_a_way_back_that_goes_by_a_thrown_event_is_told_too(tmp_path: Path, thrown: str) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">\n'
        f'<on event="touch"><throw event="{thrown}"/></on>'
        '<on event="x.y"><goto next="#g"/></on><on event="z"><log>z</log></on>\n'
        '<form id="f"><field name="q"><prompt>Well?</prompt><option>yes</option>'
        '<noinput count="3"><exit/></noinput><filled><exit/></filled></field></form>'
        '<form id="g"><block><goto next="#f"/></block></form></prima>'
    )
    told = [one.message for one in api.validate([str(path)]) if one.code == "told-twice"]
    assert [message for message in told if 'If "touch" comes' in message] == (
        [told[0]] if thrown == "x.y" else []
    )
