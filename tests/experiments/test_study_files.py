"""Study files: a sweep written down in TOML."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from prima.errors import UsageError
from prima.experiments.studyfile import read_study
from tests.helpers import command
from tests.helpers.here import prima
from tests.helpers.sweeps import write_visit

STUDY = """
scenarios = ["site/visit.xml"]
policies = ["prima", "fifo"]
seeds = 2
patience = "30s"

[vary]
touch = "0s..4s/2s"
"reply" = ["Yes.", "A|B", ""]
"person.speed" = [0.5, 1]
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "site").mkdir()
    write_visit(tmp_path / "site")
    monkeypatch.chdir(tmp_path)
    Path("study.toml").write_text(STUDY, encoding="utf-8")
    return tmp_path


def test_a_study_is_the_sweep_of_the_command_line(folder: Path) -> None:
    question = read_study("study.toml")
    assert question.scenarios == ("site/visit.xml",)
    assert question.vary == {
        "touch": "0s..4s/2s", "reply": "Yes.|A\\|B|", "person.speed": "0.5|1",
    }  # fmt: skip
    assert (question.policies, question.seeds, question.patience) == (("prima", "fifo"), 2, 30000)
    done = prima("sweep", "study.toml", "-o", "s.csv")
    assert done.stdout.startswith("s.csv: 72 runs, ")
    same = prima(
        "sweep", "site/visit.xml", "--policy", "prima", "--policy", "fifo", "--seeds", "2",
        "--patience", "30s", "--vary", "touch=0s..4s/2s", "--vary", "reply=Yes.|A\\|B|",
        "--vary", "person.speed=0.5|1", "-o", "t.csv",
    )  # fmt: skip
    assert same.returncode == 0, same.stderr
    assert Path("t.csv").read_text().replace("t/", "s/") == Path("s.csv").read_text()


def test_paths_begin_at_the_study_s_folder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "else").mkdir()
    monkeypatch.chdir(folder / "else")
    (folder / "delays.csv").write_text("1\n2\n", encoding="utf-8")
    study = STUDY.replace('"0s..4s/2s"', '"empirical(delays.csv)"')
    (folder / "study.toml").write_text(study, encoding="utf-8")
    done = prima("sweep", "../study.toml", "-o", "t.csv")
    assert done.returncode == 0, done.stderr
    assert ",../site/visit.xml," in Path("t.csv").read_text()


def test_options_come_before_the_file(folder: Path) -> None:
    done = prima("sweep", "study.toml", "--seeds", "1", "--vary", "touch=1s", "--policy", "fair")
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 1 + 6
    done = prima("sweep", "study.toml", "--runs", "9")
    assert done.stderr.startswith("prima: --runs is for --design"), "the study has none"


@pytest.mark.parametrize(
    ("old", "new", "where", "why"),
    [
        ("seeds = 2", "seed = 2", ":4", 'no "seed" in a study. Did you mean "seeds"?'),
        ("seeds = 2", "seeds = 0", ":4", "seeds: write a whole number from 1"),
        ("seeds = 2", 'seeds = "2"', ":4", "seeds: write a whole number from 1"),
        ('"site/visit.xml"', "", ":2", 'scenarios: write a list of files, as ["visit.xml"]'),
        ('"site/visit.xml"', "1", ":2", 'scenarios: write a list of files, as ["visit.xml"]'),
        ('"prima", "fifo"', "1", ":3", 'policies: write a list of policies, as ["prima", "fifo"]'),
        ("scenarios", "#", "", 'a study needs scenarios: write scenarios = ["visit.xml"]'),
        ("seeds = 2", "seeds = ", ":4:9", "not TOML"),
        ("seeds = 2", 'design = "cube"', ":4", 'design: write "full", "random" or "lhs"'),
        ('"30s"', '"soon"', ":5", 'patience: write a time, as "30s"'),
        ("[0.5, 1]", "[[1]]", ":10", "person.speed: write its levels, as"),
        ("[0.5, 1]", "[]", ":10", "person.speed: write its levels, as"),
        ("[0.5, 1]", "[0.5, 9]", ":10", 'person.speed: "9" is out of range'),
        ("seeds = 2", "seeds = 0x" + "f" * 9000, ":4", "seeds: write a whole number from 1 to"),
        ("[0.5, 1]", "[0x" + "f" * 9000 + "]", ":10", "person.speed: write its levels, as"),
        ("[0.5, 1]", "9", ":10", 'person.speed: "9" is out of range'),
        ("touch =", "toch =", ":8", '"toch" is not a value of the scenario. Did you mean "touch"'),
        ("site/visit.xml", "site/none.xml", ":2", "none.xml: cannot be read"),
        ("site/visit.xml", "site/vist.xml", ":2", 'Did you mean "site/visit.xml"?'),
        ('"prima", "fifo"', '"prima+x33"', ":3", 'There is no extension "x33". Did you mean "x3"?'),
        ("touch =", "policy =", ":8", 'in a study file policies = ["prima", "fifo"]'),
        ("site/visit.xml", "site\\u0000.xml", ":2", "this is not a file's name"),
        ('"prima", "fifo"', '"pirma"', ":3", 'Did you mean "prima"'),
        ("seeds = 2", "runs = 9", ":4", "--runs is for --design random or lhs"),
        ("seeds = 2", 'design = "lhs"', ":4", "--design lhs needs the number of runs"),
    ],
)
def test_mistakes_have_their_line(old: str, new: str, where: str, why: str) -> None:
    assert old in STUDY
    Path("study.toml").write_text(STUDY.replace(old, new), encoding="utf-8")
    done = prima("sweep", "study.toml", "-o", "t.csv")
    assert done.returncode == 2 and done.stdout == ""
    assert why in done.stderr
    assert f"study.toml{where}:" in done.stderr or not where, done.stderr
    assert not Path("t.csv").exists()


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"\xff\xfe", "study.toml:1:1: not TOML: it is not UTF-8"),
        (b"seeds = 1\r\n# caf\xe9", "study.toml:2:6: not TOML: it is not UTF-8"),
        (b"\xef\xbb\xbf# \xe9", "study.toml:1:3: not TOML: it is not UTF-8"),
        (b"a = " + b"[" * 100_000, "not TOML"),
        (b"x" * 1_000_001, "larger than 1,000,000 bytes"),
        (b"", "a study needs scenarios"),
        (b".".join([b"a"] * 100_000) + b" = 1", "it has a key of more than 100 parts"),
        (b"[" + b" . ".join([b"'a'"] * 100_000) + b"]", "it has a key of more than 100 parts"),
        (b"seeds = " + b"9" * 5000, "a number in it has too many digits"),
    ],
)
def test_files_that_are_no_studies(data: bytes, why: str) -> None:
    Path("study.toml").write_bytes(data)
    with pytest.raises(UsageError, match=why):
        read_study("study.toml")


def test_a_pipe_is_no_study(tmp_path: Path) -> None:
    os.mkfifo("pipe.toml")
    with pytest.raises(UsageError, match=r"pipe.toml: cannot be read: it is not a file"):
        read_study("pipe.toml")


def test_a_study_file_is_named_alone() -> None:
    done = prima("sweep", "study.toml", "site/visit.xml")
    assert done.returncode == 2 and "name it alone" in done.stderr
    assert prima("sweep", "none.toml").stderr.startswith("prima: none.toml: cannot be read")


def test_large_studies_are_refused_soon_and_with_their_line() -> None:
    """What once took the square of the number of levels, or gigabytes for as many mistakes."""
    levels = ",".join(f'"a{number}"' for number in range(80_000))
    for written, why in (
        (f'reply = [{levels}, "z", "z"]', 'reply: The level "z" is there twice'),
        (f"reply = [{'{},' * 300_000}]", "reply: write its levels, as"),
        (f'touch = "{"0ms..99999ms/1ms|" * 1000}"', "levels; at most 100,000"),
        ("\n".join(f"a{number} = 1" for number in range(60_000)), '"a0" is not a value'),
        (f'touch = "{"s" * 900_000}"', "is not a time. Write a number with its unit"),
        (f'reply = ["a", "{"s" * 10_001}"]', "A level has 10,001 characters; at most 10,000"),
    ):
        Path("study.toml").write_text(f"{STUDY.partition('touch')[0]}{written}", encoding="utf-8")
        done = command.prima("sweep", "study.toml", "--plan", timeout=60)
        assert done.returncode == 2 and why in done.stderr and "study.toml:8" in done.stderr
        assert len(done.stderr) < 5_000


@pytest.mark.parametrize("given, then", [((), "none"), (("--isolate", "ea"), "ea")])
def test_an_option_takes_the_place_of_what_the_study_says(
    folder: Path, given: tuple[str, ...], then: str
) -> None:
    Path("study.toml").write_text(f'isolate = "none"{STUDY}', encoding="utf-8")
    assert prima("sweep", "study.toml", *given, "-o", "t.csv").returncode == 0
    question = json.loads(Path("t/plan.json").read_text())["question"]
    assert question["isolate"] == then
