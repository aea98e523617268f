"""Files that are too large, missing or badly named: every command reports them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from subprocess import CompletedProcess

import pytest

from tests import ROOT
from tests.helpers import command
from tests.helpers.bad_input import process
from tests.helpers.here import prima

GREETS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="greets"><form id="a">
<block><speak>Hello.</speak><exit/></block></form></prima>"""


def scenario_of(folder: Path, content: str = '<application src="greets.xml"/>') -> None:
    """A scenario in the room that comes along, as s.xml."""
    (folder / "greets.xml").write_text(GREETS)
    for name, kind in (("w", "worlds/room"), ("r", "robots/papero")):
        data = (ROOT / "documents" / f"{kind}.xml").read_bytes()
        (folder / f"{name}.xml").write_bytes(data)
    (folder / "s.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml" robot="r.xml">'
        f'<robot at="middle"/><person x="1" y="0"/>{content}</scenario>'
    )


@pytest.mark.parametrize("command", ["validate", "run", "test"])
def test_a_file_that_is_too_large_is_told_wherever_it_is_named(
    command: str, tmp_path: Path
) -> None:
    scenario_of(tmp_path, '<application src="big.xml"/>')
    (tmp_path / "big.xml").write_text("<prima/>".ljust(2_000_001))
    done = prima(command, "s.xml", cwd=tmp_path)
    assert done.returncode == 1
    assert "[too-large]" in done.stdout + done.stderr


@pytest.mark.parametrize(
    "wrong",
    [["--policy", "pirma"], ["--policy", "prima+x99"], ["--policy", "fixed:nope"], ["--allow-host", "a:b"]],
)  # fmt: skip
def test_wrong_usage_leaves_a_transcript_as_it_was(wrong: list[str], tmp_path: Path) -> None:
    scenario = str(ROOT / "documents" / "scenarios" / "follow-alone.xml")
    (tmp_path / "kept.jsonl").write_text("kept")
    done = prima("run", scenario, "-o", "kept.jsonl", *wrong, cwd=tmp_path)
    assert done.returncode == 2
    assert (tmp_path / "kept.jsonl").read_text() == "kept"


def test_help_for_a_command_of_talk_takes_what_stands_behind_it(tmp_path: Path) -> None:
    scenario_of(tmp_path)
    done = prima("talk", "s.xml", cwd=tmp_path, input="/help touch head\n/help /wait 2s\n/quit\n")
    assert done.returncode == 0
    assert "/touch SENSOR" in done.stdout and "/wait" in done.stdout


def test_an_expectation_of_another_namespace_is_told(tmp_path: Path) -> None:
    scenario_of(tmp_path, '<expect xmlns="urn:x" says="a"/><never xmlns="urn:x" says="a"/>')
    done = prima("validate", "s.xml", cwd=tmp_path)
    assert (done.returncode, done.stdout.count("[wrong-namespace]")) == (1, 2)


@pytest.mark.parametrize("command", ["test", "run"])
def test_what_is_no_file_is_no_scenario_of_a_folder(command: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "p.xml")
    done = prima(command, ".", cwd=tmp_path)
    assert done.returncode == 2 and "contains no scenarios" in done.stderr


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    ("given", "code"),
    [(["validate", "s.xml"], 0), (["run", "nix.xml"], 2), (["validate", "nix.xml"], 2)],
)
def test_the_exit_code_is_right_though_nobody_can_be_told(
    given: list[str], code: int, unbuffered: str, tmp_path: Path
) -> None:
    scenario_of(tmp_path)
    python = f'PYTHONUNBUFFERED={unbuffered} "{sys.executable}"'
    command = f"{python} -m prima {' '.join(given)} 2>/dev/full"
    assert subprocess.run(command, shell=True, cwd=tmp_path, timeout=60).returncode == code


def test_a_file_that_run_is_to_play_and_is_not_there(tmp_path: Path) -> None:
    done = prima("run", "--ea", "nix.xml", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr == "prima: nix.xml: cannot be read: No such file or directory.\n"


def test_a_name_that_is_not_utf8_is_told(tmp_path: Path) -> None:
    scenario_of(tmp_path)
    name = os.fsdecode(b"l\xe9.xml")
    (tmp_path / "s.xml").rename(tmp_path / name)
    (tmp_path / "x.jsonl").write_text("kept")
    done = command.prima("run", name, "-o", "x.jsonl", cwd=tmp_path)
    assert done.returncode == 2 and "is not UTF-8; rename it" in done.stderr
    assert (tmp_path / "x.jsonl").read_text() == "kept"
    shown = command.prima("run", name, "--format", "json", cwd=tmp_path)
    assert (shown.returncode, shown.stdout) == (2, ""), "a program could not read it"
    table = command.prima("sweep", name, cwd=tmp_path)
    assert (table.returncode, table.stdout) == (2, ""), "nor a table that only has a head"
    (tmp_path / name).write_text("<scenario/>", encoding="utf-8")
    problem = json.loads(command.prima("validate", name, "--format", "json", cwd=tmp_path).stdout)
    assert problem[0]["file"] == name
    sarif = command.prima("validate", name, "--format", "sarif", cwd=tmp_path).stdout
    assert "l%E9.xml" in sarif and json.loads(sarif)
    done = command.prima("new", "ea", os.fsdecode(b"m\xe9"), cwd=tmp_path)
    assert done.returncode == 2 and "is not UTF-8. Name another file" in done.stderr


FOREIGN = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ave"><form id="a">
<block><speak>“Café” 日本.</speak><exit/></block></form></prima>"""
NARROW = [
    {"PYTHONIOENCODING": "cp1252"},
    {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"},
]
FOR_PEOPLE = [
    "run s.xml",
    "show t.jsonl",
    "explain t.jsonl 1",
    "diff t.jsonl t.jsonl",
    "talk s.xml",
]
FOR_PROGRAMS = [
    *("run s.xml --format json", "run s.xml -o -", "talk s.xml --format json"),
    *("explain t.jsonl 1 --format json", "diff t.jsonl u.jsonl --format json"),
    *("diff t.jsonl t.jsonl --format html", "report t.jsonl", "replay t.jsonl s.xml -o -"),
    *("export t.jsonl --to csv", "graph t.jsonl --to dot"),
]
SET_BY_PYTHON = ("run s.xml", "talk s.xml --format json")
"""In these Python itself gives stdout the encoding; of a locale it does so in all."""


@pytest.mark.parametrize("env", NARROW, ids=["cp1252", "C"])
def test_what_a_terminal_cannot_show_is_no_failure(
    env: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario_of(tmp_path)
    (tmp_path / "greets.xml").write_text(FOREIGN, encoding="utf-8")
    prima("run", "s.xml", "-o", "t.jsonl", cwd=tmp_path)
    text = (tmp_path / "t.jsonl").read_text(encoding="utf-8")
    (tmp_path / "u.jsonl").write_text(text.replace("Caf", "Surf"), encoding="utf-8")
    usual = {words: prima(*words.split(), cwd=tmp_path).stdout for words in FOR_PROGRAMS}
    for name, value in env.items():
        monkeypatch.setenv(name, value)
    encoding = env.get("PYTHONIOENCODING", "")

    def narrow(words: str) -> CompletedProcess[str]:
        if not encoding or words in SET_BY_PYTHON:
            return command.prima(*words.split(), cwd=tmp_path)
        return prima(*words.split(), cwd=tmp_path, encoding=encoding)

    for words in FOR_PEOPLE:
        done = narrow(words)
        assert (done.returncode, "Caf" in done.stdout) == (0, True), (words, done.stderr)
        assert "\\u65e5\\u672c" in done.stdout, words
    for words in FOR_PROGRAMS:
        done = narrow(words)
        assert done.returncode == ("u.jsonl" in words), (words, done.stderr)
        assert done.stdout == usual[words] and "日本" in done.stdout, words


def test_a_grammar_that_is_ambiguous_over_and_over_comes_to_an_end(tmp_path: Path) -> None:
    rules = "".join(
        f'<rule id="r{n}"><ruleref uri="#r{n + 1}"/><ruleref uri="#r{n + 1}"/></rule>'
        for n in range(40)
    )
    (tmp_path / "g.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="g"><form id="a"><field name="f">'
        "<prompt>Say</prompt><grammar root='r0'>"
        f"{rules}<rule id='r40'><item repeat='0-1'>a</item></rule></grammar>"
        "<noinput><exit/></noinput></field><block><exit/></block></form></prima>"
    )
    done = prima("run", "--ea", "g.xml", "--say", "a " * 900, cwd=tmp_path)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("record", "told"),
    [
        ('"phase":"start","actor":"robot","app":null,"behavior":"x#1","command":"speak"', 'needs "app"'),
        ('"phase":"request","actor":"robot","app":"x","behavior":"x#1","command":"speak","priority":"high"', 'needs "tree"'),
        ('"phase":"collision","actor":"robot","app":"x","behavior":"x#1"', 'needs "by"'),
        ('"phase":"stream-end","actor":"mediator","app":"x"', 'needs "tree"'),
    ],
)  # fmt: skip
@pytest.mark.parametrize("command", ["show", "report", "graph", "diff"])
def test_a_record_that_lacks_something_is_told(
    command: str, record: str, told: str, tmp_path: Path
) -> None:
    (tmp_path / "t.jsonl").write_text(f'{{"time":0,{record}}}\n')
    more = {"graph": ["--what", "streams"], "diff": ["t.jsonl"]}.get(command, [])
    done = prima(command, "t.jsonl", *more, cwd=tmp_path)
    assert done.returncode == 2 and told in done.stderr and "t.jsonl:1" in done.stderr


def test_a_time_beyond_all_is_no_time(tmp_path: Path) -> None:
    (tmp_path / "t.jsonl").write_text('{"time":1e300,"phase":"over","actor":"mediator"}\n')
    done = prima("graph", "t.jsonl", "--what", "streams", cwd=tmp_path)
    assert done.returncode == 2 and "t.jsonl:1" in done.stderr


def test_settings_of_empty_lines(tmp_path: Path) -> None:
    (tmp_path / "greets.xml").write_text(GREETS)
    (tmp_path / "prima.toml").write_text("\n" * 200_000 + "[[ignore]]\n")
    process(tmp_path, "validate", "greets.xml", seconds=10).check(0, "prima.toml:200001:1: warning")
