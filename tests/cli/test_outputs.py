"""Output files never replace files written by hand, or the input."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from prima.cli.outputs import check_output
from prima.errors import UsageError
from tests import ROOT
from tests.helpers.here import prima

SCENARIO = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" title="s"
  world="world.xml" robot="robot.xml" until="5s">
  <robot at="middle"/>
  <application src="app.xml" kind="ea"/>
</scenario>
"""
APP = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app" xml:lang="en">
  <form id="a"><block><speak>Hello.</speak><exit/></block></form>
</prima>
"""
VOICE = """<?xml version="1.0"?><!-- another's -->
<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1">
  <form><block>Hello.</block></form>
</vxml>
"""


def write(folder: Path) -> None:
    shutil.copy(ROOT / "documents" / "worlds" / "room.xml", folder / "world.xml")
    shutil.copy(ROOT / "documents" / "robots" / "papero.xml", folder / "robot.xml")
    (folder / "s.xml").write_text(SCENARIO, encoding="utf-8")
    (folder / "app.xml").write_text(APP, encoding="utf-8")
    (folder / "other.vxml").write_text(VOICE, encoding="utf-8")
    (folder / "voice.xml").write_text(
        SCENARIO.replace("app.xml", "other.vxml").replace('id="s"', 'id="voice"'), encoding="utf-8"
    )


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("outputs")
    write(folder)
    assert prima("run", "s.xml", "-o", "t.jsonl", cwd=folder).returncode == 0
    assert prima("test", "s.xml", "--update", "--yes", cwd=folder).returncode == 0
    assert (folder / "s.txt").exists()
    shutil.copy(folder / "t.jsonl", folder / "other.jsonl")
    os.link(folder / "t.jsonl", folder / "linked.jsonl")
    (folder / "pointed.txt").symlink_to("s.txt")
    return folder


@pytest.mark.parametrize(
    "words",
    [
        "test s.xml --junit s.xml",
        "test s.xml --junit s.txt",
        "test s.xml --junit pointed.txt",
        "test s.xml --coverage-xml s.xml",
        "test s.xml --coverage-xml app.xml",
        "test s.xml --coverage-xml other.vxml",
        "test s.xml --junit new.xml --coverage-xml new.xml",
        "test s.xml --junit new.xml --coverage-xml ./new.xml",
        "replay t.jsonl s.xml -o t.jsonl",
        "replay t.jsonl s.xml -o linked.jsonl",
        "replay t.jsonl s.xml -o s.xml",
        "replay t.jsonl s.xml -o s.txt",
        "replay t.jsonl s.xml -o robot.xml",
        "run s.xml -o s.txt",
        "run s.xml -o s.xml",
        "run s.xml -o other.vxml",
        "run voice.xml -o s.txt",
        "run voice.xml -o voice.txt",
        "run --ea app.xml -o app.xml",
        "run --ea app.xml -o s.txt",
        "report t.jsonl -o t.jsonl",
        "report t.jsonl -o linked.jsonl",
        "report other.jsonl -o t.jsonl",
        "report t.jsonl -o s.xml",
        "report t.jsonl -o s.txt",
        "report t.jsonl --scenario s.xml -o world.xml",
        "graph app.xml -o app.xml --to svg",
        "graph app.xml -o other.vxml --to svg",
        "graph t.jsonl -o s.txt --to dot",
        "export t.jsonl -o t.jsonl --to csv",
        "export other.jsonl -o t.jsonl --to csv",
        "export t.jsonl -o app.xml --to eaf",
        "export t.jsonl -o s.txt --to csv",
        "diff t.jsonl t.jsonl --format html -o t.jsonl",
        "diff t.jsonl t.jsonl --format html -o app.xml",
        "diff t.jsonl s.xml --format html -o s.txt",
    ],
)
def test_an_output_that_would_replace_a_file_of_the_author_is_refused(
    made: Path, words: str
) -> None:
    before = {path: path.read_bytes() for path in made.iterdir()}
    done = prima(*words.split(), cwd=made)
    assert {path: path.read_bytes() for path in made.iterdir()} == before
    assert done.returncode == 2
    assert done.stdout == "", "refused before it is run"
    assert done.stderr.count("\n") == 1 and "Traceback" not in done.stderr


def test_what_earlier_runs_wrote_is_replaced(tmp_path: Path) -> None:
    write(tmp_path)
    assert prima("test", "s.xml", "--update", "--yes", cwd=tmp_path).returncode == 0
    for words in (
        "run s.xml -o t.jsonl",
        "run s.xml -o t.txt",
        "replay t.jsonl s.xml -o again.jsonl",
        "report t.jsonl --scenario s.xml -o t.html",
        "graph app.xml -o app.svg",
        "export t.jsonl -o t.eaf",
        "test s.xml --junit junit.xml --coverage-xml cover.xml",
        "run s.xml -o /dev/null",
        "test s.xml --junit /dev/null --coverage-xml /dev/null",
    ):
        for _ in range(2):
            done = prima(*words.split(), cwd=tmp_path)
            assert (done.returncode, "elsewhere" in done.stderr) == (0, False), words


@pytest.mark.parametrize(
    "text",
    [
        APP,
        SCENARIO,
        VOICE,
        "<!-- " + "long " * 1000 + "-->" + APP,
        "<prima",
        "<world version='1.0'",
        '<!DOCTYPE vxml SYSTEM "vxml.dtd">\n<vxml>',
        "<grammar version='1.0'>",
        "#ABNF 1.0;\n",
    ],
)
@pytest.mark.parametrize("code", ["utf-8", "utf-8-sig", "utf-16"])
def test_documents_are_known_by_their_beginning(tmp_path: Path, text: str, code: str) -> None:
    path = tmp_path / "f"
    path.write_text(text, encoding=code)
    with pytest.raises(UsageError, match=r"f: .*write elsewhere"):
        check_output(path, "page")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "text",
        '<svg xmlns="http://www.w3.org/2000/svg"><prima/></svg>',
        "<!DOCTYPE html><html>",
        "<?xml version='1.0'?><ANNOTATION_DOCUMENT>",
        "<worldly>",
        '{"time":0}',
    ],
)
def test_other_files_may_be_replaced(tmp_path: Path, text: str) -> None:
    path = tmp_path / "f.txt"
    path.write_text(text, encoding="utf-8")
    check_output(path, "page")


def test_a_transcript_may_be_replaced_by_another(made: Path) -> None:
    for kind in ("run", "replay"):
        check_output(made / "t.jsonl", kind)


def test_only_a_scenario_has_an_expected_table(tmp_path: Path) -> None:
    write(tmp_path)
    check_output(tmp_path / "app.txt", "page", tmp_path / "app.xml")
    shutil.copy(tmp_path / "s.xml", tmp_path / "named.scenario")
    with pytest.raises(UsageError, match=r"expected table of .*named\.scenario"):
        check_output(tmp_path / "named.txt", "page", tmp_path / "named.scenario")
    os.mkfifo(tmp_path / "pipe.xml")
    check_output(tmp_path / "pipe.txt", "page")  # nothing waits for a pipe


def test_a_record_that_is_no_object_is_told_plainly(tmp_path: Path) -> None:
    for text in ("[]", "3", '"word"', "null"):
        (tmp_path / "t.jsonl").write_text(f"{text}\n", encoding="utf-8")
        done = prima("show", "t.jsonl", cwd=tmp_path)
        assert done.returncode == 2
        assert "t.jsonl:1: " in done.stderr
        assert "write an object such as" in done.stderr and "dictionary" not in done.stderr


def test_talk_is_not_saved_to_a_folder(tmp_path: Path) -> None:
    write(tmp_path)
    (tmp_path / "adir").mkdir()
    done = prima("talk", "s.xml", "--save", "adir", cwd=tmp_path)
    assert done.returncode == 2
    assert "adir: this is a folder; name a file, as adir/visit.xml." in done.stderr


@pytest.mark.parametrize(
    ("words", "begins"),
    [
        ("run s.xml -o -", '{"time":'),
        ("replay t.jsonl s.xml -o -", '{"time":'),
        ("export t.jsonl --to csv -o -", "tier,kind,"),
        ("graph app.xml --to dot -o -", "digraph"),
        ("report t.jsonl -o -", "<!DOCTYPE html>"),
        ("diff t.jsonl t.jsonl --format html -o -", "<!DOCTYPE html>"),
    ],
)
def test_a_dash_is_stdout(made: Path, words: str, begins: str) -> None:
    done = prima(*words.split(), cwd=made)
    assert done.returncode == 0 and done.stdout.startswith(begins), done
    assert not (made / "-").exists()


def test_several_transcripts_do_not_go_to_stdout(made: Path) -> None:
    done = prima("run", "s.xml", "--policy", "prima", "--policy", "fifo", "-o", "-", cwd=made)
    assert done.returncode == 2 and "go into a folder" in done.stderr
    assert not (made / "-").exists()


@pytest.mark.parametrize("output", ["/dev/stdout", ">(cat)"])
def test_a_pipe_is_written_to_directly(made: Path, output: str) -> None:
    words = f"{sys.executable} -m prima report t.jsonl -o {output} | cat"
    done = subprocess.run(["bash", "-c", words], cwd=made, capture_output=True, check=False)
    assert done.stdout.startswith(b"<!DOCTYPE html>") and done.stdout.endswith(b"</html>\n")


@pytest.mark.parametrize(
    ("output", "why"), [("new/", "Is a directory"), ("loop", "Too many levels of symbolic links")]
)
def test_what_names_no_file_is_not_written(made: Path, output: str, why: str) -> None:
    (made / "loop").unlink(missing_ok=True)
    (made / "loop").symlink_to("loop")
    done = prima("report", "t.jsonl", "-o", output, cwd=made)
    assert done.returncode == 2 and f"{output}: cannot be written: {why}." in done.stderr
    assert not (made / "new").exists() and (made / "loop").is_symlink()


def test_a_link_to_a_file_that_is_not_there_yet_is_written_through(made: Path) -> None:
    (made / "ahead.html").symlink_to("page.html")
    assert prima("report", "t.jsonl", "-o", "ahead.html", cwd=made).returncode == 0
    assert (made / "ahead.html").is_symlink() and (made / "page.html").is_file()
