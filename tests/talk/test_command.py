"""prima talk from a pipe, with files, and with wrong usage."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from prima import api
from prima.devices import loop
from tests import ROOT
from tests.helpers import here
from tests.helpers.talking import ASKS, DOCUMENTS, TICKS, TOUCHED, room, start


def prima(
    folder: Path, given: bytes, *words: str, timeout: float = 60
) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "prima", "talk", *words],
        cwd=folder,
        input=given,
        capture_output=True,
        timeout=timeout,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )


def test_a_pipe_plays_the_user(tmp_path: Path) -> None:
    done = prima(tmp_path, b"/back 5s\n/touch head\nNever mind.", str(TOUCHED), "--save", "v.xml")
    assert done.returncode == 0, done.stderr
    text = done.stdout.decode()
    assert "touches the robot's head" in text
    assert "\x1b" not in text
    assert "> " not in text
    assert (tmp_path / "v.xml").read_text(encoding="utf-8").count("<when") == 2
    assert "Saved v.xml." in done.stderr.decode()


def test_json_is_a_transcript_that_the_saved_session_repeats(tmp_path: Path) -> None:
    done = prima(
        tmp_path, b"/touch head\nNever mind.\n/undo\n", str(TOUCHED), "--format", "json",
        "--save", "v.xml",
    )  # fmt: skip
    assert done.returncode == 1
    assert b"cannot be undone" in done.stderr
    (tmp_path / "t.jsonl").write_bytes(done.stdout)
    played = api.read(tmp_path / "t.jsonl")
    again = api.rehearse(tmp_path / "v.xml")
    assert played.records[1:] == again.records[1:]
    assert api.replay(played, tmp_path / "v.xml").records == played.records
    assert json.loads(done.stdout.splitlines()[0])["phase"] == "run"


def test_applications_alone_are_played_in_a_room(tmp_path: Path) -> None:
    (tmp_path / "ea.xml").write_text(
        f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ea">{ASKS}</prima>',
        encoding="utf-8",
    )
    done = prima(tmp_path, b"Yes.\n", "--ea", "ea.xml", "--save", "v.xml")
    assert done.returncode == 0, done.stderr
    assert b'"Thanks."' in done.stdout
    assert 'src="ea.xml"' in (tmp_path / "v.xml").read_text(encoding="utf-8")
    assert [row.what for row in api.rehearse(tmp_path / "v.xml").rows()][-1] == "ends ea: exit"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "Name a scenario, or applications with --fa and --ea."),
        ([str(TOUCHED), "--step", "--real-time"], "Write --step or --real-time, not both."),
        ([str(TOUCHED), "--policy", "prma"], "prma"),
        ([str(TOUCHED), "--save", str(TOUCHED)], "one of the run's own documents"),
        ([str(TOUCHED), "--save", "nowhere/x.xml"], "there is no folder nowhere"),
        ([str(TOUCHED), "--save", "x" * 300], "x: cannot be written: File name too long."),
        ([str(TOUCHED), "--save", os.devnull], "exists and is not a saved session"),
        (["nothing.xml"], "nothing.xml: cannot be read"),
    ],
)
def test_wrong_usage_is_refused(tmp_path: Path, words: list[str], message: str) -> None:
    done = here.prima("talk", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr


def test_what_is_piped_may_come_from_windows(tmp_path: Path) -> None:
    given = b"\xef\xbb\xbf/back 5s\r\n/touch head\r\nNever mind.\r\n"
    done = prima(tmp_path, given, str(TOUCHED))
    assert (done.returncode, b"invalid" in done.stderr) == (0, False), done.stderr
    assert "touches the robot's head" in done.stdout.decode()


def test_what_is_piped_may_be_anything(tmp_path: Path) -> None:
    done = prima(tmp_path, b"\xff\xfe\n" + b"x" * 3_000_000 + b"\n\0\n/who\n", str(TOUCHED))
    assert done.returncode == 1
    errors = done.stderr.decode()
    assert "not UTF-8" in errors
    assert "2000 characters" in errors
    assert "U+0000" in errors
    assert b"working memory" in done.stdout


def test_an_application_that_failed_gives_exit_code_3(tmp_path: Path) -> None:
    path = room(tmp_path, '<form id="f"><on event="touch"><throw event="oh.dear"/></on></form>')
    done = prima(tmp_path, b"/touch head\n/who\n", str(path))
    assert done.returncode == 3
    assert b"The session goes on." in done.stderr


def test_real_time_takes_its_time(tmp_path: Path) -> None:
    path = room(tmp_path, ASKS.replace("<prompt>", '<prompt timeout="700ms">'))
    process = subprocess.Popen(
        [sys.executable, "-m", "prima", "talk", str(path), "--real-time"],
        cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert process.stdin and process.stdout
    process.stdout.readline()
    began, seen = time.monotonic(), b""
    while b"Nothing heard" not in seen:
        seen = process.stdout.readline()
        assert seen
    assert time.monotonic() - began > 0.8
    process.stdin.close()
    assert process.wait(30) == 0
    process.stdout.close()


def test_what_nobody_listens_to_is_told(tmp_path: Path) -> None:
    talk, paper = start(room(tmp_path, TICKS))
    talk.line("Hello?")
    assert 'Nobody listens: "Hello?" is lost.' in paper.told
    talk.line("/undo")
    talk.line("/wait 1s")
    assert sum("Nobody listens" in told for told in paper.told) == 1, "it is not told again"
    long = ASKS.replace("<prompt>Well?", '<prompt bargein="false">How are you all today, friends?')
    asks, paper = start(room(tmp_path, long), real=True)
    asks.pass_time(100)
    asks.line("Now")
    asks.pass_time(2000)
    assert "ea is still asking; it listens when it has finished." in paper.told[-1]
    answered, paper = start(room(tmp_path, ASKS))
    answered.line("Yes.")
    assert not any("Nobody listens" in told for told in paper.told)


def test_applications_are_talked_to_in_another_world_and_on_another_robot(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        (DOCUMENTS / "robots" / "papero.xml")
        .read_text(encoding="utf-8")
        .replace('id="papero"', 'id="arm"'),
        encoding="utf-8",
    )
    path = room(tmp_path, '<form id="f"><block><topological-move to="lab"/><exit/></block></form>')
    world = DOCUMENTS / "worlds" / "office.xml"
    words = ["--ea", "ea.xml", "--world", str(world), "--robot", "arm.xml"]
    saved = tmp_path / "visit.xml"
    done = prima(tmp_path, b"/wait 60s\n", *words, "--save", "visit.xml")
    assert b"reaches lab" in done.stdout, done.stderr
    text = saved.read_text(encoding="utf-8")
    assert "office.xml" in text and "arm.xml" in text
    assert any(row.what == "reaches lab" for row in api.rehearse(saved).rows())
    (tmp_path / "void.xml").write_text(
        '<world xmlns="urn:prima:world:1" version="1.0" id="void"/>', encoding="utf-8"
    )
    for more, told in (
        (["--world", "nowhere.xml"], "No such file"),
        (["--world", "ea.xml"], "ea.xml"),
        (["--world", "void.xml"], "has no place for the robot"),
        (["--robot", str(world)], "office.xml"),
    ):
        refused = here.prima("talk", "--ea", "ea.xml", *more, cwd=tmp_path)
        assert refused.returncode in (1, 2) and told in refused.stderr, refused.stderr
    refused = here.prima("talk", path, "--world", world, cwd=tmp_path)
    assert refused.returncode == 2 and "a scenario names its own" in refused.stderr


def test_lines_of_a_pipe_come_in_real_time_too(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "prima", "talk", str(TOUCHED), "--real-time"],
        cwd=tmp_path, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert process.stdin and process.stdout
    process.stdout.readline()
    time.sleep(1.2)
    lines = b"\xff\n/back 100ms\n/touch head\n/save v.xml\n/quit\n"
    out, errors = process.communicate(lines, 30)
    assert process.returncode == 1 and b"The line is not UTF-8." in errors
    assert b"Back at 0.1s, after row" in out
    [touched] = [one for one in api.rehearse(tmp_path / "v.xml").rows() if "touches" in one.what]
    assert 0.1 <= touched.time < 1


@pytest.mark.parametrize(
    ("command", "words", "told"),
    [
        ("talk", [], "the run made more records than allowed; the session is over."),
        ("report", ["-o", "r.html"], "records"),
    ],
)
def test_a_run_of_too_many_records_gives_exit_code_3(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str, words: list[str], told: str
) -> None:
    monkeypatch.setattr(loop, "MAX_RECORDS", 10)
    done = here.prima(command, TOUCHED, *words, cwd=tmp_path, input="/wait 60s\n")
    assert done.returncode == 3 and told in done.stderr
    assert not (tmp_path / "r.html").exists()
