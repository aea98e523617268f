"""Batches of runs: the same output in however many processes."""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path

import pytest

from bench import batch as bench
from prima import cli
from prima.errors import UsageError
from prima.experiments.batch import run_batch, run_job
from prima.experiments.plan import BatchPlan, Job, Options, stem_of
from prima.experiments.rows import format_row
from tests.helpers.batches import HELLO, POLICIES, WRONG, files, prima, scenario, write

ALL = ("a", "b", "gone.xml", *POLICIES)


# What comes out ---------------------------------------------------------------------------------
@pytest.mark.parametrize("form", ["text", "json"])
def test_all_is_the_same_in_however_many_processes(stage: Path, form: str) -> None:
    made = []
    for workers in (1, 2, 5):
        shutil.rmtree("runs", ignore_errors=True)
        done = prima(*ALL, "-o", "runs", "--workers", workers, "--format", form)
        made.append((done.returncode, done.stdout, done.stderr, files("runs")))
    assert made[0] == made[1] == made[2]
    assert made[0][0] == 3
    if form == "json":
        rows = [json.loads(line) for line in made[0][1].splitlines()]
        names = ["a/four", "a/one", "a/three", "b/five", "b/one", "gone"]
        assert [(row["scenario"], row["policy"]) for row in rows] == [
            (f"{name}.xml", policy) for name in names for policy in ("prima", "fifo")
        ]
        assert [row["exit"] for row in rows] == [1, 1, 0, 0, 3, 3, 0, 0, 0, 0, 2, 2]


def test_a_run_of_a_batch_is_that_of_its_own(stage: Path) -> None:
    prima("a/one.xml", "a/three.xml", "-o", "runs/", *POLICIES)
    for name, policy in (("one", "prima"), ("three", "fifo")):
        prima(f"a/{name}.xml", "--policy", policy, "-o", "single.jsonl")
        assert Path("single.jsonl").read_bytes() == files("runs")[f"a/{name}.{policy}.jsonl"]


def test_the_table_and_the_messages(stage: Path) -> None:
    done = prima("a/one.xml", "a/three.xml", "a/four.xml", "gone.xml", "a/hello.xml")
    lines = done.stdout.splitlines()
    assert lines[0].split()[:4] == ["scenario", "policy", "exit", "ended"]
    assert [line.split()[0] for line in lines[1:6]] == [
        *("a/one.xml", "a/three.xml", "a/four.xml", "gone.xml", "a/hello.xml")
    ]
    assert lines[1].split()[1:4] == ["prima", "0", "over"]
    assert lines[-1] == "runs: 5; fine: 1; exit code 1: 2; exit code 2: 1; exit code 3: 1"
    told = done.stderr.splitlines()
    assert told[0].startswith("prima: a/three.xml, prima: app: bored") and "on event" in told[0]
    assert told[1].startswith("prima: a/four.xml: a/wrong.xml:1:")
    assert told[2] == "prima: gone.xml: cannot be read: No such file or directory."
    assert "This is an application; a scenario is needed here." in told[3]
    assert len(told) == 4


@pytest.mark.parametrize(
    ("names", "code"),
    [
        (["a/one.xml", "b/one.xml"], 0),
        (["a/one.xml", "a/four.xml"], 1),
        (["a/four.xml", "gone.xml", "a/one.xml"], 2),
        (["a/three.xml", "gone.xml", "a/four.xml"], 3),
    ],
)
def test_the_exit_code_is_the_highest(stage: Path, names: list[str], code: int) -> None:
    assert prima(*names).returncode == code


def test_an_application_that_a_policy_prefers_and_one_scenario_lacks(stage: Path) -> None:
    write("a/two.xml", scenario("two", "two-app.xml"))
    write("a/two-app.xml", HELLO.replace('id="app"', 'id="other"'))
    done = prima("a/one.xml", "a/two.xml", "--policy", "fixed:app", "-o", "runs")
    assert done.returncode == 2
    assert '"fixed:app" names an application that is not in the scenario' in done.stderr
    assert set(files("runs")) == {"a/one.fixed-app.jsonl", "a/one.fixed-app.run.json"}


# Names ------------------------------------------------------------------------------------------
def test_transcripts_stand_as_their_scenarios_do(stage: Path) -> None:
    done = prima("a", stage / "b", "../" + stage.name + "/a/one.xml", "-o", "runs")
    assert done.returncode == 3
    names = {"a/one", "b/one", "b/five", "a/three"}
    assert set(files("runs")) == {f"{n}{end}" for n in names for end in (".jsonl", ".run.json")}


def test_a_scenario_elsewhere_keeps_its_whole_path(
    stage: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir("a")
    assert stem_of("one.xml") == "one"
    assert stem_of("../b/one.xml") == str(stage / "b" / "one").lstrip("/")
    done = prima("one.xml", "../b/one.xml", "-o", "../runs")
    assert done.returncode == 0, done.stderr
    assert f"{str(stage).lstrip('/')}/b/one.jsonl" in files("../runs")


def test_two_scenarios_of_one_name_are_refused(stage: Path) -> None:
    shutil.copy("a/one.xml", "a/one.scn")
    done = prima("a/one.xml", "a/one.scn", "-o", "runs")
    assert done.returncode == 2
    assert (
        "a/one.scn: its transcript has the same name as that of a/one.xml, runs/a/one.jsonl."
        in done.stderr
    )
    assert not Path("runs").exists()


def test_what_is_named_twice_runs_once(stage: Path) -> None:
    done = prima("a/one.xml", "a", "./a/one.xml", "--policy", "fifo", "--policy", "fifo")
    assert done.stdout.splitlines()[-1].startswith("runs: 3;")


@pytest.mark.parametrize("name", ["runs/a/one.jsonl", "runs/a/one.run.json"])
def test_what_somebody_else_has_written_stays(stage: Path, name: str) -> None:
    Path("runs/a").mkdir(parents=True)
    write(name, "my notes\n")
    done = prima("a/one.xml", "b/one.xml", "-o", "runs")
    assert done.returncode == 2
    assert f"{name}: not written by a batch; move it away." in done.stderr
    assert Path(name).read_text() == "my notes\n"
    assert "b/one.jsonl" in files("runs")


def test_a_run_that_is_wrong_now_leaves_no_old_transcript(stage: Path) -> None:
    prima("a/one.xml", "b/one.xml", "-o", "runs")
    write("a/hello.xml", WRONG)
    assert prima("a/one.xml", "b/one.xml", "-o", "runs").returncode == 1
    assert files("runs") == {}


# Lists ------------------------------------------------------------------------------------------
def test_a_path_in_a_list_may_have_any_letter(stage: Path) -> None:
    name = "a/one\u2028\x85two.xml"
    write(name, Path("a/one.xml").read_text())
    write("list", f"{name}\n")
    done = prima("--from", "list", "--format", "json")
    assert [json.loads(line)["scenario"] for line in done.stdout.splitlines()] == [name]


def test_a_list_comes_from_a_file_or_a_pipe(stage: Path) -> None:
    text = "# mine\n\na/one.xml\n  b  \r\n"
    write("list", text)
    one = prima("--from", "list")
    assert (one.returncode, one.stdout.splitlines()[-1]) == (0, "runs: 3; fine: 3")
    assert prima("--from", "-", input=text).stdout == one.stdout
    both = prima("b/five.xml", "--from", "list", "--format", "json").stdout
    assert [json.loads(line)["scenario"] for line in both.splitlines()] == [
        *("b/five.xml", "a/one.xml", "b/one.xml")
    ]


USAGES = [
    (["a", "--workers", "0"], "is not in the range"),
    (["a", "--workers", "-1"], "is not in the range"),
    (["a", "--workers", "10000"], "is not in the range"),
    (["a", "--workers", "x"], "is not a valid integer"),
    (["a", "--policy", "fif"], 'Did you mean "fifo"?'),
    (["a", "--resume"], "--resume needs the folder of the transcripts: -o FOLDER."),
    (["a", "--why"], "prima show TRANSCRIPT --why"),
    (["a", "--say", "yes"], "--say works only with --fa and --ea"),
    (
        ["a", "--ea", "a/hello.xml"],
        "A scenario names its own applications; leave out --fa and --ea.",
    ),
    (["--ea", "a/hello.xml", *POLICIES], "name one run; for several, write scenarios."),
    (["--ea", "a/hello.xml", "--workers", "2"], "name one run; for several, write scenarios."),
    (["empty"], "empty: contains no scenarios"),
    (
        ["--from", "empty"],
        "empty: cannot be read: it is a folder. To run the scenarios in it, leave out --from.",
    ),
    (["--from", "no"], "no: cannot be read: No such file or directory."),
    (["--from", "a/one.xml"], "a/one.xml: not a list of scenarios: write one path per line"),
    (["--from", "nothing"], "nothing: names no scenarios: write their paths, one per line."),
    (["--from", "/dev/zero"], "/dev/zero: not a list of scenarios"),
    (["a", "-o", "nothing"], "nothing: this is a file; several transcripts need a folder"),
    (["a", "-o", "nothing/runs"], "nothing/runs: cannot be written: Not a directory."),
    (["a", "-o", "runs.jsonl"], "runs.jsonl: several transcripts go into a folder: -o runs/."),
    (["a", "-o", ""], "it is empty; write a path."),
    (["a/one.xml", "-o", "empty"], 'Is a directory. For a transcript in it, write "empty/".'),
    (["a/one.xml", "-o", "."], 'Is a directory. For a transcript in it, write "./".'),
    (["a", "-o", "/proc/runs"], "/proc/runs: cannot be written: No such file or directory."),
    (["no/such/folder/", "-o", "runs/"], "no/such/folder: cannot be read: No such file"),
]


@pytest.mark.parametrize(
    ("arguments", "message"), USAGES, ids=[" ".join(one[0])[:40] for one in USAGES]
)
def test_usage(
    stage: Path,
    arguments: list[str],
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (stage / "empty").mkdir()
    write("nothing", "# nothing\n")
    monkeypatch.setattr(sys, "argv", ["prima", "run", *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    said = capsys.readouterr().err
    assert (ended.value.code, message in said) == (2, True), said


def test_a_folder_that_is_read_only(stage: Path) -> None:
    Path("closed").mkdir(mode=0o500)
    if os.access("closed", os.W_OK):
        pytest.skip("whoever runs this may write everywhere")
    done = prima("a", "-o", "closed")
    assert (done.returncode, done.stderr) == (
        2,
        "prima: closed: cannot be written: Permission denied.\n",
    )


def test_a_disk_that_is_full_ends_the_batch(stage: Path) -> None:
    """The folder in which transcripts grow leads to a device that is always full."""
    Path("parts").mkdir()
    os.symlink("/dev/full", f"parts/{os.getpid()}.jsonl")
    row = run_job(Options(parts="parts"), Job("a/one.xml", None, "runs/a/one"))
    assert (row.exit, row.full) == (2, True)
    assert row.messages == ["runs/a/one.jsonl: cannot be written: No space left on device."]
    assert files("runs") == {}


# From Python ------------------------------------------------------------------------------------
def test_from_python(stage: Path) -> None:
    plan = BatchPlan(["a/one.xml", "b"], ["prima", "fifo"], "runs")
    assert len(plan) == len(list(plan)) == 6
    rows = list(run_batch(plan, Options(), workers=2))
    assert [row.exit for row in rows] == [0] * 6
    assert rows[0].transcript == "runs/a/one.prima.jsonl"
    assert format_row(rows[0], (10, 8)).startswith("a/one.xml   prima        0  over")
    with pytest.raises(UsageError, match="There is no policy"):
        BatchPlan(["a"], ["x"])


def test_the_measurement_compares_what_it_measures(
    stage: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("documents").mkdir()
    shutil.copytree("b", "documents/scenarios")
    shutil.copytree("a", "documents/a", ignore=shutil.ignore_patterns("[oft]*.xml"))
    monkeypatch.setattr(bench, "ROOT", stage)
    assert bench.ratio(rounds=1) > 0
    write("documents/scenarios/one.xml", scenario("one", "gone.xml"))
    with pytest.raises(AssertionError):
        bench.ratio(rounds=1)


def test_a_long_policy_has_a_column_as_wide(stage: Path) -> None:
    policies = ("--policy", "fixed:one", "--policy", "prima+x1+x2+x3")
    head, *rows = prima("a/one.xml", *policies).stdout.splitlines()[:3]
    ends = head.index("exit") + len("exit")
    assert [row[ends - 3 : ends] for row in rows] == ["  2", "  0"], rows
