"""Transcripts that are cut off, edited, or no transcripts at all."""

from __future__ import annotations

import itertools
import os
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from prima.errors import UsageError
from prima.transcript import lines
from tests.helpers.bad_input import (
    GIGABYTE,
    Prima,
    app,
    block,
    form,
    head,
    process,
    record,
    scenario,
    stage,
    write,
)

NOT_TRANSCRIPTS: list[Any] = [
    ("empty", b"", "it has no records"),
    ("blank", b"\n\n", "it has no records"),
    ("binary", bytes(range(256)), "t.jsonl:1: this is not a line of JSON"),
    ("utf-16", record("run").encode("utf-16"), "it is not UTF-8"),
    ("xml", b"<a/>\n", "t.jsonl:1: this is not a line of JSON"),
    ("foreign", b'{"a":1}\n', "t.jsonl:1: not a transcript's record: time"),
    ("list", b"[1]\n", "t.jsonl:1: not a transcript's record"),
    ("phase", record("zzz").encode(), "t.jsonl:1: not a transcript's record: phase"),
    ("second-line", (record("over") + "x\n").encode(), "t.jsonl:2: this is not a line"),
    ("deep", b"[" * 100_000 + b"\n", "t.jsonl:1: this is not a line of JSON"),
    ("number", b'{"time":' + b"9" * 5000 + b"}\n", "t.jsonl:1: a number is too large"),
    ("negative", record("over", time=-1).encode(), "t.jsonl:1: not a transcript's record"),
    ("nan", b'{"time":NaN,"phase":"over","actor":"user"}\n', "t.jsonl:1: this is no"),
    ("field", record("run", colour="red").encode(), "t.jsonl:1: not a transcript's record"),
    ("infinite", b'{"time":1e999,"phase":"over","actor":"mediator"}\n', "t.jsonl:1: "),
    ("long-line", b'{"a":"' + b"x" * 20_000_000 + b'"}\n', "t.jsonl:1: the line is too long"),
    *(
        (f"{phase}-without-its-fields", record(phase, goal=True).encode(), "t.jsonl:1: ")
        for phase in ("start", "end", "event", "note", "log", "emergency", "load")
    ),
    ("time-as-text", record("note", time="0", text="x").encode(), "t.jsonl:1: "),
    ("half-a-pair", record("note", text="\ud800").encode(), "t.jsonl:1: "),
]  # fmt: skip


@pytest.mark.parametrize(("name", "data", "message"), NOT_TRANSCRIPTS)
@pytest.mark.parametrize("command", ["show", "diff", "explain"])
def test_not_transcripts(
    prima: Prima, tmp_path: Path, transcript: str, name: str, data: bytes, message: str, command: str
) -> None:  # fmt: skip
    write(tmp_path, "t.jsonl", data)
    given = {"show": ["t.jsonl"], "diff": ["good.jsonl", "t.jsonl"], "explain": ["t.jsonl", "0"]}
    prima(command, *given[command]).check(2, "prima: t.jsonl", message)


def test_a_transcript_cut_off(prima: Prima, tmp_path: Path, transcript: str) -> None:
    write(tmp_path, "t.jsonl", transcript[:-20])
    for arguments in (["show", "t.jsonl"], ["replay", "t.jsonl", "s.xml"]):
        prima(*arguments).check(2, "t.jsonl:", "the record is cut off")


def test_what_stands_before_the_cut_is_shown(prima: Prima, tmp_path: Path, transcript: str) -> None:
    write(tmp_path, "t.jsonl", transcript[:-20])
    assert '"Hello there."' in prima("show", "t.jsonl").out


HOLLOW = [
    record("send", app="a", data={}),
    record("transferred", app="a", serial=1, outcome="busy", data={}),
    record("fetched", app="a", data={}),
    record("halted", behavior="a#1", data={}),
    record("held", app="a", tree="a:1", data={}),
]
"""Records that lack something inside them, which only some of the commands look at."""


READERS = {
    "show": ["show", "bad.jsonl", "--why"],
    "explain": ["explain", "bad.jsonl", "0"],
    "diff": ["diff", "good.jsonl", "bad.jsonl"],
    "diff-json": ["diff", "bad.jsonl", "good.jsonl", "--format", "json"],
    "diff-html": ["diff", "bad.jsonl", "good.jsonl", "--format", "html", "-o", "page.html"],
    "report": ["report", "bad.jsonl", "-o", "page.html"],
    "graph-tree": ["graph", "bad.jsonl", "--what", "tree", "-o", "tree.svg"],
    "graph-streams": ["graph", "bad.jsonl", "--what", "streams", "-o", "streams.svg"],
    "export": ["export", "bad.jsonl", "--to", "csv"],
    "replay": ["replay", "bad.jsonl", "s.xml"],
}


@pytest.mark.parametrize("reader", READERS)
def test_a_record_that_lacks_something_is_no_defect_of_prima(
    prima: Prima, tmp_path: Path, transcript: str, reader: str
) -> None:
    lines = transcript.splitlines(keepends=True)
    for lacking in HOLLOW:
        write(tmp_path, "bad.jsonl", "".join([lines[0], lacking, *lines[1:]]))
        done = prima(*READERS[reader])
        assert done.check(done.code).code in (0, 1, 2), lacking
        assert done.code < 2 or " lacks a field of its phase." in done.err, lacking


def inbound(phase: str, **fields: object) -> Callable[[str], str]:
    made = record(phase, inbound=True, **fields)
    return lambda good: good.splitlines(keepends=True)[0] + made


REPLAYS: list[Any] = [
    ("same", lambda good: good, 0, "the same"),
    ("crlf", lambda good: good.replace("\n", "\r\n"), 0, "the same"),
    ("edited", lambda good: good.replace("Hello", "Hullo"), 1, "differs"),
    ("shuffled", lambda good: good.splitlines(True)[0] + "".join(reversed(good.splitlines(True)[1:])), 2, "the time goes back"),
    ("no-head", lambda good: "".join(good.splitlines(True)[1:]), 2, "does not begin with its run"),
    ("policy", head(policy="zz"), 2, 'There is no policy "zz"'),
    ("other-file", lambda good: re.sub(r'"app.xml":"\w+"', '"app.xml":"0"', good), 2, "not the file"),
    ("unknown-app", inbound("load", app="zz"), 2, 'loads an application that is not there: "zz"'),
    ("unknown-ab", inbound("end", behavior="zz#1", command="speak", app="a"), 1, "differs"),
    ("head-empty", lambda good: record("run"), 2, "t.jsonl"),
    ("head-no-policy", head(), 2, "t.jsonl"),
    ("head-policy-5", head(policy=5), 2, "t.jsonl"),
    ("head-files", head(policy="prima", files=[1]), 2, "t.jsonl"),
    *(
        (f"bare-{phase}", inbound(phase), 2, "t.jsonl")
        for phase in ("end", "event", "load", "emergency", "note", "fail", "listening")
    ),
]  # fmt: skip


@pytest.mark.parametrize(("name", "edit", "code", "message"), REPLAYS)
def test_edited_transcripts(
    prima: Prima, tmp_path: Path, transcript: str, name: str, edit: Callable[[str], str],
    code: int, message: str,
) -> None:  # fmt: skip
    (tmp_path / "t.jsonl").write_bytes(edit(transcript).encode())
    prima("replay", "t.jsonl", "s.xml").check(code, message)


def test_a_transcript_of_other_applications(prima: Prima, tmp_path: Path, transcript: str) -> None:
    write(tmp_path, "other.xml", app(block("<exit/>")))
    write(tmp_path, "s2.xml", scenario('<application src="other.xml"/>'))
    prima("replay", "good.jsonl", "s2.xml").check(2, 'made with "s.xml"')


def test_an_event_that_nothing_handles(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, app(block('<throw event="bored"/>')))
    prima("run", path).check(3, "prima: a: bored", 'write <on event="bored">')


def test_a_time_far_away(prima: Prima, tmp_path: Path) -> None:
    loop = form('<block><send event="e"/></block><on event="e"><send event="e"/></on>')
    prima("run", stage(tmp_path, app(loop), attributes='until="1s"'), "-o", "t").check(0)
    lines = (tmp_path / "t").read_text().splitlines(keepends=True)
    lines[-1] = re.sub(r'"time":[\d.]+', '"time":1e8', lines[-1])
    write(tmp_path, "t", "".join(lines))
    process(tmp_path, "replay", "t", "s.xml").check(2, "more than 366 days")


def test_a_transcript_without_an_end(tmp_path: Path) -> None:
    process(tmp_path, "show", "/dev/zero", memory=GIGABYTE).check(2, "/dev/zero:1")


def test_a_transcript_of_very_many_values_is_read_to_a_limit(tmp_path: Path) -> None:
    write(tmp_path, "t.jsonl", record("note", text="x", data={"a": [{}] * 150_000}) * 100)
    found = process(tmp_path, "explain", "t.jsonl", "0", memory=2 * GIGABYTE)
    found.check(2, "t.jsonl:27:", "it has more than 20,000,000 values; no run writes so many.")


@pytest.mark.parametrize("limit", ["MAX_LINES", "MAX_CHARACTERS", "MAX_VALUES"])
def test_a_transcript_without_end_is_read_to_a_limit(
    monkeypatch: pytest.MonkeyPatch, limit: str
) -> None:
    monkeypatch.setattr(lines, limit, 1_000)
    endless = itertools.repeat(record("note", text="x"))
    with pytest.raises(UsageError, match=r"t\.jsonl:\d+: it has more than 1,000 "):
        for _ in lines.read_lines("t.jsonl", endless):
            pass


def test_a_diff_shortens_what_no_application_says(prima: Prima, tmp_path: Path) -> None:
    told = [
        record("event", actor="environment", event=one, data={"a": "x" * 900_000}) for one in "ab"
    ]
    write(tmp_path, "t.jsonl", record("event", actor="user", event="x") + told[0])
    write(tmp_path, "u.jsonl", record("event", actor="user", event="x") + told[1])
    assert len(prima("diff", "t.jsonl", "u.jsonl").out) < 30_000


PIPES = [
    "show p",
    "explain p 0",
    "diff p t",
    "report p",
    "export p --to csv",
    "replay p",
    "run --from p",
]


@pytest.mark.parametrize("words", PIPES)
def test_nothing_waits_for_a_pipe_that_nobody_writes_to(words: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "p")
    write(tmp_path, "t", record("note", text="x"))
    process(tmp_path, *words.split()).check(2, "p: ")


def test_a_table_that_is_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "p.csv")
    process(tmp_path, "report", "p.csv").check(2, "p.csv: cannot be read: it is not a file.")


def test_a_pipe_is_compared_as_a_file_is(tmp_path: Path) -> None:
    write(tmp_path, "t.jsonl", record("note", text="x"))
    os.mkfifo(tmp_path / "p")
    with subprocess.Popen(["cp", "t.jsonl", "p"], cwd=tmp_path) as writer:
        process(tmp_path, "diff", "p", "t.jsonl").check(0, "rows: all the same")
    assert writer.returncode == 0
