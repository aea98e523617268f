"""prima export: pipes, wrong usage, cut transcripts, a missing library."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from prima import api
from prima.exports import FORMATS, timeline
from tests.helpers.exporting import SCENARIOS, check_all, end, exported, of, start
from tests.helpers.here import prima


@pytest.mark.parametrize("to", FORMATS)
def test_the_command_writes_what_the_function_does(
    to: str, folder: Path, demo: api.Transcript
) -> None:
    done = prima("export", "t.jsonl", "-o", f"t.{to}", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert done.stderr.startswith(f"t.{to}: 18 tiers with ") and not done.stdout
    assert (folder / f"t.{to}").read_bytes() == exported(demo, to)


@pytest.mark.parametrize("to", FORMATS)
def test_it_writes_to_a_pipe_from_a_pipe(to: str, folder: Path, demo: api.Transcript) -> None:
    if not os.path.exists("/dev/stdin"):
        pytest.skip("no /dev/stdin here")
    command = [sys.executable, "-m", "prima", "export", "/dev/stdin", "--to", to]
    given = (folder / "t.jsonl").read_bytes()
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        out, _ = process.communicate(given)
    assert process.returncode == 0 and out == exported(demo, to)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["t.jsonl"], "Name a format: --to csv, eaf, mcap, textgrid or vtt"),
        (
            ["t.jsonl", "-o", "t.txt"],
            't.txt: no format has the suffix "txt"; name a format: --to csv',
        ),
        (["t.jsonl", "-o", "t"], "t: it has no suffix; name a format: --to csv"),
        (["t.jsonl", "--to", "textgird"], 'Did you mean "textgrid"?'),
        (["t.jsonl", "--to", "pdf"], "Name csv, eaf, mcap, textgrid or vtt."),
        (["none.jsonl", "--to", "csv"], "none.jsonl: cannot be read"),
        (["t.jsonl", "--to", "csv", "-o", "t.jsonl"], "the export is made from this file"),
        (["t.jsonl", "--to", "csv", "-o", "no/t.csv"], "no/t.csv: cannot be written"),
        (["t.jsonl", "--to", "eaf", "--lang", "e_n"], "is not a language tag"),
        (
            ["t.jsonl", "--to", "csv", "--lang", "en"],
            "--lang works only with --to eaf, not with csv",
        ),
        (
            ["t.jsonl", "-o", "t.TextGrid", "--lang", "a=en"],
            "--lang works only with --to eaf, not with textgrid",
        ),
        (["t.jsonl", "--to", "eaf", "--lang", "en", "--lang", "ja"], "two languages of all: en"),
        (["t.jsonl", "--to", "eaf", "--lang", "folow=ja"], 'Did you mean "follow"?'),
        (["."], "Name a format"),
        ([".", "--to", "vtt"], "it is a folder. Name a transcript in it."),
    ],
)
def test_wrong_usage_is_told(words: list[str], message: str, folder: Path) -> None:
    done = prima("export", *words, cwd=folder)
    assert done.returncode == 2 and message in done.stderr
    assert "Traceback" not in done.stderr and not done.stdout


def test_an_empty_file_and_one_with_its_head_alone(folder: Path, demo: api.Transcript) -> None:
    (folder / "empty.jsonl").write_text("")
    done = prima("export", "empty.jsonl", "--to", "vtt", cwd=folder)
    assert done.returncode == 2 and "it has no records" in done.stderr
    check_all(api.Transcript(demo.records[:1], "head.jsonl"), folder)


def test_a_transcript_that_was_cut_off_is_written_as_far_as_it_goes(tmp_path: Path) -> None:
    whole = api.rehearse(SCENARIOS / "follow-during-navigation-ja.xml").dumps().encode()
    letter = next(at for at in range(20_000, len(whole)) if whole[at] >= 0xE0)  # of three bytes
    newline = b"\n"
    cut = f"cut.jsonl:{whole.count(newline, 0, letter) + 1}: the record is cut off"
    for length in (letter, letter + 1, letter + 2):
        (tmp_path / "cut.jsonl").write_bytes(whole[:length])
        done = prima("export", "cut.jsonl", "-o", "cut.csv", cwd=tmp_path)
        assert done.returncode == 2 and cut in done.stderr
        assert "木戸出".encode() in (tmp_path / "cut.csv").read_bytes()


@pytest.mark.parametrize("to", ["csv", "mcap"])
def test_a_reader_that_goes_away_does_not_hide_that_a_transcript_is_cut(
    tmp_path: Path, demo: api.Transcript, to: str
) -> None:
    (tmp_path / "cut.jsonl").write_text(demo.dumps()[:-40], encoding="utf-8")
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "prima", "export", "cut.jsonl", "--to", to]
    done = subprocess.run(command, cwd=tmp_path, stdout=writing, stderr=subprocess.PIPE)
    os.close(writing)
    assert (done.returncode, b"the record is cut off" in done.stderr) == (2, True), done.stderr


def test_letters_that_are_none_are_told(tmp_path: Path, demo: api.Transcript) -> None:
    (tmp_path / "t.jsonl").write_bytes(demo.dumps().encode().replace(b"poster", b"p\xffster"))
    done = prima("export", "t.jsonl", "--to", "csv", cwd=tmp_path)
    assert done.returncode == 2 and "it is not UTF-8" in done.stderr


def test_without_the_library_mcap_tells_what_to_install(folder: Path) -> None:
    code = (
        "import sys; sys.modules['mcap'] = None; sys.argv = "
        "['prima', 'export', 't.jsonl', '-o', 'never.mcap']; from prima.cli import main; main()"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8")
    assert done.returncode == 2 and "pip install 'prima[export]'" in done.stderr
    assert not (folder / "never.mcap").exists()


class Weighed(dict[str, Any]):
    """A record that counts how many of its kind there are at a time."""

    alive = most = 0

    def __init__(self, *args: Any, **more: Any) -> None:
        super().__init__(*args, **more)
        Weighed.alive += 1
        Weighed.most = max(Weighed.most, Weighed.alive)

    def __del__(self) -> None:
        Weighed.alive -= 1


def test_of_a_long_transcript_no_records_are_kept() -> None:
    def records() -> Iterator[dict[str, Any]]:
        for number in range(20_000):
            more = {"outcome": "again", "data": {"x": number}}
            yield Weighed(start(number, f"a#1.{number + 1}", "topological-move"))
            yield Weighed(end(number + 1, f"a#1.{number + 1}", "topological-move", **more))

    found = timeline("long.jsonl", records())
    assert of(found, "a: does")[0][:2] == (0.0, 20_000.0) and found.marks == 2
    assert Weighed.most < 10
