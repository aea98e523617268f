"""Transcripts of runs that were stopped from outside stay readable."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from prima import api
from prima.errors import UsageError
from tests import ROOT
from tests.helpers.here import prima

SCENARIO = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"

COMMANDS = {
    "show": ["show", "t.jsonl"],
    "explain": ["explain", "t.jsonl", "10"],
    "explain as data": ["explain", "t.jsonl", "10", "--format", "json"],
    "report": ["report", "t.jsonl", "-o", "made"],
    "tree": ["graph", "t.jsonl", "--to", "svg", "-o", "made"],
    "streams": ["graph", "t.jsonl", "--what", "streams", "--to", "dot", "-o", "made"],
    "diff": ["diff", "t.jsonl", "whole.jsonl"],
    "diff as data": ["diff", "whole.jsonl", "t.jsonl", "--format", "json"],
    "diff as a page": ["diff", "t.jsonl", "whole.jsonl", "--format", "html", "-o", "made"],
    "export": ["export", "t.jsonl", "--to", "csv"],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("cut")
    (made / "whole.jsonl").write_text(api.rehearse(SCENARIO).dumps(), encoding="utf-8")
    return made


def cut(folder: Path, letters: int = 0) -> None:
    """Write the first 150 records as ``t.jsonl``, and so many letters of the next."""
    lines = (folder / "whole.jsonl").read_text(encoding="utf-8").splitlines(keepends=True)
    text = "".join(lines[:150]) + lines[150][:letters]
    (folder / "t.jsonl").write_text(text, encoding="utf-8")
    (folder / "made").unlink(missing_ok=True)


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_what_stands_before_a_cut_line_is_shown(folder: Path, words: list[str]) -> None:
    cut(folder, letters=30)
    done = prima(*words, cwd=folder)
    assert done.returncode == 2, done.stderr
    assert "t.jsonl:151: the record is cut off" in done.stderr
    assert done.stdout or (folder / "made").stat().st_size


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (b"t", b"\xff", "not a transcript's record: it is not UTF-8."),
        (b"{", b'{"serial":' + b"1" * 5000 + b",", "a number is too large."),
    ],
)
def test_a_line_that_was_damaged_is_named_and_those_above_are_read(
    folder: Path, old: bytes, new: bytes, told: str
) -> None:
    whole = (folder / "whole.jsonl").read_bytes().splitlines(keepends=True)
    damaged = whole[150].replace(old, new, 1)
    path = folder / "damaged.jsonl"
    path.write_bytes(b"".join([*whole[:150], damaged, *whole[151:]]))
    made = api.read(path, partial=True)
    assert len(made.records) == 150 and made.cut == f"{path}:151: {told}"
    with pytest.raises(UsageError) as caught:
        api.read(path)
    assert str(caught.value) == made.cut


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_a_run_that_did_not_end_is_shown_and_told(folder: Path, words: list[str]) -> None:
    cut(folder)
    done = prima(*words, cwd=folder)
    assert done.returncode == (1 if words[0] == "diff" else 0), done.stderr
    assert done.stderr.count("the transcript ends at 35.000 s, before its run did.") == 1
    assert done.stdout or (folder / "made").stat().st_size


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_of_a_whole_transcript_nothing_is_told(folder: Path, words: list[str]) -> None:
    cut(folder)
    (folder / "t.jsonl").write_bytes((folder / "whole.jsonl").read_bytes())
    done = prima(*words, cwd=folder)
    assert done.returncode == 0 and "before its run did" not in done.stderr


def test_a_row_that_was_cut_off_is_told_so(folder: Path) -> None:
    cut(folder, letters=30)
    done = prima("explain", "t.jsonl", "30", cwd=folder)
    assert done.returncode == 2 and done.stdout == ""
    assert "t.jsonl: there is no row 30; the rows are 0 to 20. t.jsonl:151:" in done.stderr


def test_a_cut_run_is_explained_as_the_whole_one(folder: Path) -> None:
    cut(folder, letters=30)
    words = ["explain", "10", "--format", "json"]
    data = [
        json.loads(prima(words[0], name, *words[1:], cwd=folder).stdout)
        for name in ("t.jsonl", "whole.jsonl")
    ]
    assert data[0] == data[1]
