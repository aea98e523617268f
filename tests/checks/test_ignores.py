"""Warnings that authors leave out: comments in documents, prima.toml, and prima validate --strict."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from prima import api
from prima.checks.ignores import comments
from prima.errors import Problem
from prima.lsp import problems as editor
from prima.lsp.workspace import Workspace
from tests import ROOT
from tests.helpers.here import prima

BESIDE = ROOT / "tests" / "mistakes" / "beside"
SILENT = (
    '<field name="{}"><prompt>Tea?</prompt><option>tea</option><filled><exit/></filled></field>'
)
"""A question with the warning no-noinput."""
IGNORE = "<!-- prima-ignore: {} -->"
WHY = "no-noinput The kiosk waits for its next guest."


def write(folder: Path, content: str, name: str = "a.xml", before: str = "") -> Path:
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(
        f'<?xml version="1.0"?>\n{before}\n'
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a">\n'
        f'<form id="f">\n{content}\n</form></prima>'
    )
    return path


def told(*paths: Path) -> list[str]:
    return [problem.code for problem in api.validate(paths)]


# In a document --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("content", "codes"),
    [
        (SILENT.format("x"), ["no-noinput"]),
        (IGNORE.format(WHY) + SILENT.format("x"), []),
        (IGNORE.format(WHY) + SILENT.format("x") + SILENT.format("y"), ["no-noinput"]),
        (SILENT.format("x") + IGNORE.format(WHY), ["no-noinput", "unused-ignore"]),
        (IGNORE.format("no-noinput") + SILENT.format("x"), ["bad-ignore", "no-noinput"]),
        (IGNORE.format("") + SILENT.format("x"), ["bad-ignore", "no-noinput"]),
        (IGNORE.format("no-noinputs Why not.") + SILENT.format("x"), ["bad-ignore", "no-noinput"]),
        ("<!-- prima-ignore " + WHY + " -->" + SILENT.format("x"), ["bad-ignore", "no-noinput"]),
        ("<!-- see prima-ignore: " + WHY + " -->" + SILENT.format("x"), ["no-noinput"]),
        (IGNORE.format("dead-content It is meant so.") + SILENT.format("x"),
         ["unused-ignore", "no-noinput"]),
        (IGNORE.format("unknown-element It is meant so.") + "<block><speek>Hi.</speek><exit/></block>",
         ["unused-ignore", "unknown-element"]),
        (f"<!-- one -->{IGNORE.format(WHY)}<!-- two --> {SILENT.format('x')}", []),
    ],
)  # fmt: skip
def test_a_comment_counts_for_the_element_behind_it(
    tmp_path: Path, content: str, codes: list[str]
) -> None:
    assert sorted(told(write(tmp_path, content))) == sorted(codes)


def test_before_the_root_a_comment_counts_for_the_whole_document(tmp_path: Path) -> None:
    both = SILENT.format("x") + SILENT.format("y")
    assert told(write(tmp_path, both, before=IGNORE.format(WHY))) == []


def test_an_element_is_all_that_it_holds() -> None:
    text = "<a><!-- prima-ignore: x y --><b c='>'><d/><b>1</b></b><e/></a>"
    ((begin, comment, end),) = comments(text)
    assert comment == " prima-ignore: x y " and text[begin:].startswith("<!--")
    assert text[end:] == "<e/></a>"


def test_a_misspelt_code_is_guessed(tmp_path: Path) -> None:
    path = write(tmp_path, IGNORE.format("no-noinptu Why not.") + SILENT.format("x"))
    (problem,) = [one for one in api.validate([path]) if one.code == "bad-ignore"]
    assert problem.remedy == 'Did you mean "no-noinput"?' and problem.place.line == 5


def test_an_ignore_in_voicexml(tmp_path: Path) -> None:
    path = tmp_path / "a.vxml"
    path.write_text(
        '<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1"><form><block>'
        + IGNORE.format("no-such-form It is made by a server.")
        + '<goto next="#gone"/></block></form></vxml>'
    )
    assert told(path) == []


@pytest.mark.parametrize(
    ("content", "codes"),
    [("<block>x</block>", ["unused-ignore"]), ('<block><log expr="x"/></block>', [])],
)
def test_an_ignored_variable_of_voicexml_has_to_be_there_to_be_ignored(
    tmp_path: Path, content: str, codes: list[str]
) -> None:
    path = tmp_path / "a.vxml"
    path.write_text(
        '<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1"><form>'
        + IGNORE.format("undeclared-variable A server writes it.")
        + f"{content}</form></vxml>"
    )
    assert told(path) == codes


# In a project's settings ------------------------------------------------------------------


def settings(folder: Path, *entries: str) -> None:
    (folder / "prima.toml").write_text("".join(f"[[ignore]]\n{entry}\n" for entry in entries))


ENTRY = 'code = "no-noinput"\nreason = "Kiosks wait."\n'


@pytest.mark.parametrize(
    ("entry", "left"),
    [
        (ENTRY, []),
        (f'{ENTRY}files = "ea/*.xml"', ["b.xml"]),
        (f'{ENTRY}files = ["ea/*", "b.xml"]', []),
        (f'{ENTRY}files = "*.vxml"', ["a.xml", "b.xml", "prima.toml"]),
    ],
)
def test_the_settings_count_for_the_files_that_they_name(
    tmp_path: Path, entry: str, left: list[str]
) -> None:
    settings(tmp_path, entry)
    files = [write(tmp_path, SILENT.format("x"), name) for name in ("ea/a.xml", "b.xml")]
    found = sorted(Path(one.place.file).name for one in api.validate(files))
    assert found == left


def test_the_nearest_settings_count_alone(tmp_path: Path) -> None:
    settings(tmp_path, ENTRY)
    path = write(tmp_path, SILENT.format("x"), "ea/a.xml")
    assert told(path) == []
    (tmp_path / "ea" / "prima.toml").write_text("")
    assert told(path) == ["no-noinput"]


def test_an_entry_is_unused_only_when_all_its_files_have_been_checked(tmp_path: Path) -> None:
    settings(tmp_path, ENTRY)
    fine = write(tmp_path, "<block><exit/></block>")
    other = write(tmp_path, "<block><exit/></block>", "b.xml")
    assert told(fine) == []
    (problem,) = api.validate([fine, other])
    assert problem.code == "unused-ignore"
    assert Path(problem.place.file) == tmp_path / "prima.toml" and problem.place.line == 1


def test_beside_an_error_nothing_is_said_to_be_ignored_in_vain(tmp_path: Path) -> None:
    # The error keeps the checks from running whose warning is ignored.
    ignore = "<!-- prima-ignore: no-noinput Next guest, please. -->"
    field = '<field name="a" type="boolean"><prompt>Yes?</prompt><filled>{}</filled></field>'
    for content, codes in (("<exit/>", []), ("<speek/>", ["unknown-element"])):
        path = write(tmp_path, ignore + field.format(content))
        assert told(path) == codes


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[[ignore]\n", "This is not TOML: Expected"),
        ("[ignor]\n", 'Unknown setting "ignor". Write [[ignore]]'),
        ("ignore = 3\n", "ignore holds no entries. Write [[ignore]]"),
        ('[[ignore]]\ncode = "no-noinput"\n', 'Nothing says why "no-noinput" is ignored.'),
        ('[[ignore]]\nreason = "So."\n', "Nothing says which code is ignored."),
        ('[[ignore]]\ncode = "x"\nreason = "So."\n', 'There is no code "x".'),
        (f"[[ignore]]\n{ENTRY}file = 'x'\n", 'has no "file". Did you mean "files"?'),
        (f"[[ignore]]\n{ENTRY}files = 3\n", "files names no files."),
    ],
)
def test_settings_that_are_wrong_are_told(tmp_path: Path, text: str, says: str) -> None:
    path = write(tmp_path, "<block><exit/></block>")
    (tmp_path / "prima.toml").write_text(text)
    (problem,) = api.validate([path])
    assert problem.code == "bad-ignore" and says in f"{problem.message} {problem.remedy}"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"ignore = 3\nx = \n", ":2:5: This is not TOML: Invalid value. Correct it."),
        (b"\xef\xbb\xbf[[ignore]]\r\n# caf\xe9", ":2:6: This is not TOML: it is not UTF-8."),
        (b"x = [", ":1:6: This is not TOML: "),
        (b"\n" + b"a." * 101 + b"a = 1", ":2:1: This is not TOML: it has a key of more than 100"),
    ],
)
def test_settings_that_cannot_be_read_are_told_with_their_place(
    tmp_path: Path, content: bytes, says: str
) -> None:
    path = write(tmp_path, "<block><exit/></block>")
    (tmp_path / "prima.toml").write_bytes(content)
    (problem,) = api.validate([path])
    assert says in f"{problem.place}: {problem.message} {problem.remedy}"


# Scenarios, editors, the command line -------------------------------------------------------


def scenario(folder: Path) -> Path:
    path = folder / "visit.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{BESIDE}/museum.xml" robot="{BESIDE}/mute.xml"><robot at="door"/>'
        '<application src="a.xml"/></scenario>'
    )
    return path


SPEAKS = "<block>{}<speak>Hi.</speak><exit/></block>"
MUTE = IGNORE.format("unsupported-command Some of our robots have no voice.")


def test_what_a_scenario_brings_to_light_is_ignored_in_its_application(tmp_path: Path) -> None:
    path = write(tmp_path, SPEAKS.format(""))
    visit = scenario(tmp_path)
    assert told(visit) == ["unsupported-command"] and len(api.load_scenario(visit).problems) == 1
    write(tmp_path, SPEAKS.format(MUTE))
    assert told(visit) == told(path, visit) == []
    assert told(path) == [], "nobody knows which robots there are"
    assert api.load_scenario(visit).problems == []


def test_settings_without_end_are_read_to_a_limit(tmp_path: Path) -> None:
    path = write(tmp_path, "<block><exit/></block>")
    with (tmp_path / "prima.toml").open("wb") as stream:
        stream.truncate(3_000_000_000)
    (problem,) = api.validate([path])
    assert "it has more than 2,000,000 characters" in problem.message


def test_an_editor_ignores_the_same(tmp_path: Path) -> None:
    path = write(tmp_path, IGNORE.format(WHY) + SILENT.format("x"))
    assert editor.check(Workspace(), path) == {path: []}
    write(tmp_path, SILENT.format("x"))
    (problem,) = editor.check(Workspace(), path)[path]
    assert isinstance(problem, Problem)
    settings(tmp_path, ENTRY)
    assert editor.check(Workspace(), path) == {path: []}


def test_strict_counts_warnings_as_problems(tmp_path: Path) -> None:
    write(tmp_path, SILENT.format("x"))
    assert prima("validate", "a.xml", cwd=tmp_path).returncode == 0
    done = prima("validate", "a.xml", "--strict", cwd=tmp_path)
    assert done.returncode == 1 and "errors: 0, warnings: 1" in done.stderr
    done = prima("validate", "a.xml", "--strict", "--format", "json", cwd=tmp_path)
    assert done.returncode == 1 and len(json.loads(done.stdout)) == 1
    write(tmp_path, IGNORE.format(WHY) + SILENT.format("x"))
    assert prima("validate", "a.xml", "--strict", cwd=tmp_path).returncode == 0
    write(tmp_path, "<iu><block><speak>Hi.</speak></block></iu><block><exit/></block>")
    assert prima("validate", "a.xml", "--strict", "--notes", cwd=tmp_path).returncode == 0


def test_strict_says_nothing_of_a_certificate(tmp_path: Path) -> None:
    done = prima("validate", "--with", "a.xml", "b.xml", "--strict", cwd=tmp_path)
    assert done.returncode == 2


def test_the_command_line_tells_of_idle_settings_once(tmp_path: Path) -> None:
    settings(tmp_path, ENTRY)
    for name in ("a.xml", "b.xml"):
        write(tmp_path, "<block><exit/></block>", name)
    done = prima("validate", ".", "--format", "short", cwd=tmp_path)
    (line,) = done.stdout.splitlines()
    assert line.startswith("prima.toml:1:1: warning: Nothing is ignored here")
