"""Study files: a sweep written down in TOML."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.errors import UsageError
from prima.experiments.studyfile import read_study
from tests.helpers.command import prima
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


@pytest.mark.parametrize(
    ("old", "new", "where", "why"),
    [
        ("seeds = 2", "seed = 2", ":4", 'no "seed" in a study. Did you mean "seeds"?'),
        ("seeds = 2", "seeds = 0", ":4", "seeds: input should be greater than or equal to 1"),
        ("seeds = 2", 'seeds = "2"', ":4", "seeds: input should be a valid integer"),
        ('"site/visit.xml"', "", ":2", "scenarios: "),
        ("scenarios", "#", "", 'a study needs scenarios: write scenarios = ["visit.xml"]'),
        ("seeds = 2", "seeds = ", ":4:9", "not TOML"),
        ("seeds = 2", 'design = "cube"', ":4", "design: "),
        ('"30s"', '"soon"', ":5", "patience "),
        ("[0.5, 1]", "[[1]]", ":10", "vary.person.speed|person.speed: "),
        ("touch =", "toch =", "", '"toch" is no value of the scenario. Did you mean "touch"'),
        ("site/visit.xml", "site/none.xml", "", "none.xml: cannot be read"),
        ('"prima", "fifo"', '"pirma"', "", 'Did you mean "prima"'),
    ],
)
def test_mistakes_have_their_line(old: str, new: str, where: str, why: str) -> None:
    assert old in STUDY
    Path("study.toml").write_text(STUDY.replace(old, new), encoding="utf-8")
    done = prima("sweep", "study.toml", "-o", "t.csv")
    assert done.returncode == 2 and done.stdout == ""
    assert any(one in done.stderr for one in why.split("|")), done.stderr
    assert f"study.toml{where}:" in done.stderr or not where, done.stderr
    assert not Path("t.csv").exists()


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"\xff\xfe", "it is not UTF-8"),
        (b"a = " + b"[" * 100_000, "not TOML"),
        (b"x" * 10_000_001, "larger than 10,000,000 bytes"),
        (b"", "a study needs scenarios"),
    ],
)
def test_files_that_are_no_studies(data: bytes, why: str) -> None:
    Path("study.toml").write_bytes(data)
    with pytest.raises(UsageError, match=why):
        read_study("study.toml")


def test_a_study_file_is_named_alone() -> None:
    done = prima("sweep", "study.toml", "site/visit.xml")
    assert done.returncode == 2 and "name it alone" in done.stderr
    assert prima("sweep", "none.toml").stderr.startswith("prima: none.toml: cannot be read")
