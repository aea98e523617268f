"""Wrong usage, pipes, full disks and terminals."""

from __future__ import annotations

import os
import pty
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from prima.cli.printing import how_to_go_on
from tests.helpers.bad_input import (
    SECONDS,
    Prima,
    Result,
    app,
    block,
    form,
    process,
    record,
    scenario,
    stage,
    write,
)


def test_a_scenario_that_names_a_pipe(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    write(tmp_path, "s.xml", scenario('<application src="pipe"/>'))
    process(tmp_path, "validate", "s.xml").check(1, "s.xml:2:19")


# The command line --------------------------------------------------------------------------
USAGES: list[Any] = [
    ([], 2, "Usage:"),
    (["rn"], 2, 'Did you mean "run"?'),
    (["vaildate", "x"], 2, 'Did you mean "validate"?'),
    (["zzz"], 2, 'There is no command "zzz". prima --help lists them.'),
    (["--verson"], 2, "--version"),
    (["run"], 2, "Name a scenario"),
    (["validate"], 2, "Missing argument"),
    (["run", "s.xml", "more"], 2, "more: cannot be read: No such file"),
    (["run", "s.xml", "--polcy", "fifo"], 2, "--policy"),
    (["run", "s.xml", "--policy", "fif"], 2, 'Did you mean "fifo"?'),
    (["run", "s.xml", "--policy", "x\x1b[31m"], 2, "Write fair, fifo"),
    (["run", "s.xml", "--policy", "prima+"], 2, "Write all, or one of x1 to x10.\n"),
    (["run", "s.xml", "--policy", "prima+x11"], 2, 'Did you mean "x1"?\n'),
    (["run", "s.xml", "--bound", "0"], 2, "not in the range"),
    (["run", "s.xml", "--bound", "x"], 2, "not a valid integer."),
    (["run", "s.xml", "--bound", "9" * 50, "-o", "t"], 0, "records"),
    (["run", "s.xml", "--format", "jsn"], 2, "jsn"),
    (["run", "no.xml"], 2, "no.xml: cannot be read: No such file"),
    (["run", "s.xm"], 2, 's.xm: cannot be read: No such file or directory. Did you mean "s.xml"?'),
    (["validate", "ap.xml"], 2, 'Did you mean "app.xml"?'),
    (["show", "god.jsonl"], 2, 'Did you mean "good.jsonl"?'),
    (["run", "."], 0, "runs: 1; fine: 1"),
    (["run", "app.xml"], 1, "a scenario is needed here. prima run, talk and live take it by --fa app.xml."),
    (["run", "good.jsonl"], 1, "prima show prints it"),
    (["run", "s.xml", "-o", "."], 2, "Is a directory"),
    (["run", "s.xml", "-o", ""], 2, "it is empty; write a path."),
    (["run", "s.xml", "-o", "", "--resume"], 2, "it is empty; write a path."),
    (["run", ""], 2, "it is empty; write a path."),
    (["test", "s.xml", "--junit", ""], 2, "it is empty; write a path."),
    (["test", "s.xml", "--junit", "-"], 2, "-: this does not go to stdout; name a file."),
    (["demo", "--no-open", "-o", "-"], 2, "-: this does not go to stdout; name a file."),
    (["live", "--fa", "app.xml", "--robot", ""], 2, "it is empty; write a path."),
    (["explore", "s.xml", "-o", ""], 2, "it is empty; write a path."),
    (["run", "s.xml", "-o", "no/t"], 2, "no/t: cannot be written: No such file"),
    (["run", "s.xml", "-o", "/proc/t"], 2, "/proc/t: cannot be written"),
    (["documents", ""], 2, "it is empty; write a path."),
    (["validate", "/dev/zero"], 2, "/dev/zero: cannot be read"),
    (["show", "s.xml"], 2, "s.xml:1: this is not a line of JSON"),
    (["replay", "good.jsonl", "app.xml"], 1, "a scenario is needed here"),
    (["run", "s.xml", "--policy", "fixed:A"], 2, 'Did you mean "a"?'),
    (["run", "s.xml", "--policy", "fixd"], 2, "fixed:APP"),
    (["show", "no"], 2, "no: cannot be read"),
    (["show", "x" * 5000], 2, "cannot be read"),
    (["diff", "good.jsonl"], 2, "Name two transcripts"),
    (["replay", "s.xml", "good.jsonl"], 2, "s.xml:1: this is not a line of JSON"),
    (["explain", "undeclard-variable"], 2, 'Did you mean "undeclared-variable"?'),
    (["explain", "good.jsonl"], 2, "Say which row"),
    (["explain", "good.jsonl", "99"], 2, "the rows are 0 to 3"),
    (["explain", "good.jsonl", "9" * 30], 2, "good.jsonl: there is no row"),
    *(([*words, "."], 2, ".: cannot be read: it is a folder. Name a transcript in it.")
      for words in (["show"], ["replay"], ["diff", "."], ["export", "--to", "csv"])),
    (["explain", ".", "1"], 2, ".: cannot be read: it is a folder. Name a transcript in it."),
    (["explain", "."], 2, ".: cannot be read: it is a folder. Name a transcript in it, and its row."),
    (["report", "."], 2, ".: no table in this folder (.csv or .parquet). Name a transcript or a scenario in it, or make a table: prima sweep"),
    (["run", "s.xml", "--policy", "fixed:zz"], 2, '"fixed:zz" names an application that is not in the scenario. Write a.'),
    (["run", "s.xml", "--policy", ""], 2, "policy"),
    (["run", "s.xml", "-o", "s.xml"], 2, "s.xml"),
    (["talk", "s.xml", "--map", "http://a.example/=a"], 2, "--map works only with --fa and --ea"),
    (["test", "s.xml", "--yes"], 2, "--yes works only with --update."),
    (["test", "s.xml", "--update", "--policy", "fifo"], 2, "leave out --policy."),
    (["test", "s.xml", "--update", "--format", "json"], 2, "leave out --format json."),
    (["sweep", "s.xml", "--resume"], 2, "--resume needs the table: -o sweep.csv."),
    (["sweep", "s.xml", "--vary", "person.speed"], 2, '--vary "person.speed": write PATH=LEVELS'),
    (["sweep", "s.xml", "--vary", " =1"], 2, '--vary " =1": write PATH=LEVELS'),
    (["sweep", "s.xml", "--vary", "until=1s", "--vary", "until =2s"], 2, "--vary: until is there twice"),
    (["report", "good.jsonl", "--scenario", "s.xml", "--scenario", "s.xml"], 2, "Name one --scenario for all transcripts, or one for each."),
    (["run", "s.xml", "-o", "/dev/full"], 2, "No space left"),
    (["replay", "good.jsonl", "s.xml", "-o", "/dev/full"], 2, "No space left"),
    *(([*words, "--why"], 2, "--why works only with a table: prima show TRANSCRIPT --why.")
      for words in (["run", "s.xml", "-o", "t"], ["run", "s.xml", "-o", "-"], ["run", "s.xml", "s.xml"],
                    *([verb, "s.xml", "--format", "json"] for verb in ("run", "talk", "live")))),
    (["validate", "s.xml", "--watch", "--strict"], 2, "leave out --strict."),
]  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "code", "message"), USAGES, ids=lambda value: str(value)[:40]
)
def test_usage(
    prima: Prima, transcript: str, arguments: list[str], code: int, message: str
) -> None:
    prima(*arguments).check(code, message)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("graph s.xml", "Name the file to write: -o FILE.svg; or print text"),
        ("export good.jsonl --to mcap", "mcap is a binary format: name a file with -o."),
        ("report good.jsonl", "Name the file to write: -o report.html."),
    ],
)
def test_what_is_not_for_a_terminal_is_not_written_to_one(
    prima: Prima, transcript: str, monkeypatch: pytest.MonkeyPatch, words: str, message: str
) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    made = prima(*words.split())
    made.check(2, message)
    assert not made.out


def test_a_grammar_in_place_of_an_application(prima: Prima, tmp_path: Path) -> None:
    srgs = 'xmlns="http://www.w3.org/2001/06/grammar" version="1.0" root="r"'
    write(tmp_path, "yes.grxml", f'<grammar {srgs}><rule id="r">yes</rule></grammar>')
    hint = 'an application is needed here. An application names it by <grammar src="..."/>.'
    prima("run", "--ea", "yes.grxml").check(1, f"yes.grxml:1:1: error: This is a grammar; {hint}")


def test_no_row_at_all(prima: Prima, tmp_path: Path) -> None:
    write(tmp_path, "t.jsonl", record("over"))
    prima("explain", "t.jsonl", 0).check(2, "no row")


def test_a_folder_that_is_read_only(prima: Prima, tmp_path: Path, transcript: str) -> None:
    folder = tmp_path / "closed"
    folder.mkdir(mode=0o500)
    if os.access(folder, os.W_OK):
        pytest.skip("whoever runs this may write everywhere")
    prima("run", "s.xml", "-o", folder / "t").check(2, "cannot be written: Permission denied")


LONG = "x" * 300


@pytest.mark.parametrize(
    "words",
    [("run", "s.xml", "-o", f"{LONG}.jsonl"), ("report", "s.xml", "-o", f"{LONG}.html"),
     ("report", f"{LONG}.csv"), ("new", "ea", f"{LONG}.xml")],
    ids=["run", "report", "table", "new"],
)  # fmt: skip
def test_a_name_that_is_too_long_is_named(
    tmp_path: Path, transcript: str, words: tuple[str, ...]
) -> None:
    done = process(tmp_path, *words, seconds=30).check(2, "File name too long")
    assert LONG in done.err


@pytest.mark.parametrize("words", ["sweep loop", "sweep s.xml -o t.csv --bundle loop", "run loop"])
def test_links_in_a_circle_are_no_scenarios(tmp_path: Path, words: str) -> None:
    stage(tmp_path, app(block("<exit/>")))
    (tmp_path / "loop").symlink_to("loop")
    process(tmp_path, *words.split()).check(2, "prima: ")


def test_tables_are_not_updated_where_nobody_can_be_asked(tmp_path: Path) -> None:
    stage(tmp_path, app(block("<speak>Hello.</speak><exit/>")))
    write(tmp_path, "s.txt", "another table")
    command = f"{sys.executable} -m prima test s.xml --update <&-"
    made = subprocess.run(
        ["bash", "-c", command], cwd=tmp_path, check=False, capture_output=True, text=True
    )
    assert made.returncode == 1 and "not written. To write it, add --yes." in made.stderr


def test_a_journal_with_any_name_can_be_gone_on_with_as_told() -> None:
    assert how_to_go_on("a b'c.jsonl").endswith("""--resume 'a b'"'"'c.jsonl'""")
    assert how_to_go_on("-v.jsonl").endswith("--resume ./-v.jsonl")


def test_a_scenario_with_any_name_can_be_run_as_told(
    tmp_path: Path, transcript: str, prima: Prima
) -> None:
    shutil.copy(tmp_path / "s.xml", tmp_path / "-my s.xml")
    told = prima("graph", "--", "-my s.xml")
    told.check(2, "prima run './-my s.xml' -o FILE.jsonl")


# Pipes, terminals and signals ----------------------------------------------------------------
def closed_pipe(folder: Path) -> Result:
    """What a long table gives when its reader goes away after the first line."""
    write(folder, "long.jsonl", "".join(record("note", text="x" * 60) for _ in range(5_000)))
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", "show", "long.jsonl"],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert made.stdout is not None and made.stderr is not None
    first = made.stdout.readline()
    made.stdout.close()
    with made.stderr:
        return Result(made.wait(SECONDS), first, made.stderr.read())


def test_a_pipe_that_is_closed(tmp_path: Path) -> None:
    said = closed_pipe(tmp_path)
    assert "Behavior" in said.out and said.err == ""


def test_a_closed_pipe_is_no_problem(tmp_path: Path) -> None:
    closed_pipe(tmp_path).check(0)


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("validate wrong.xml", 1),
        ("test wrong.xml --junit r.xml", 1),
        *((f"diff good.jsonl other.jsonl{how}", 1) for how in ("", " --format json")),
        ("show torn.jsonl", 2),
        ("explain torn.jsonl 1 --format json", 2),
        ("graph torn.jsonl --to dot --row 1", 2),
        ("report torn.jsonl", 2),
    ],
)
def test_what_nobody_reads_still_has_its_exit_code(
    tmp_path: Path, transcript: str, given: str, code: int
) -> None:
    write(tmp_path, "wrong.xml", scenario('<expect says="Never."/>' + "<wrong/>" * 900))
    write(tmp_path, "other.jsonl", record("over"))
    write(tmp_path, "torn.jsonl", f"{transcript}torn")
    command = f"{sys.executable} -m prima {given} | true; exit ${{PIPESTATUS[0]}}"
    made = subprocess.run(["bash", "-c", command], cwd=tmp_path, check=False, capture_output=True)
    assert made.returncode == code, made.stderr
    assert "--junit" not in given or (tmp_path / "r.xml").is_file()


@pytest.mark.parametrize("given", [["show", "good.jsonl"], ["--help"], ["explain", "bad-value"]])
def test_a_full_disk_behind_the_standard_output(
    tmp_path: Path, prima: Prima, transcript: str, given: list[str]
) -> None:
    with Path("/dev/full").open("w") as full:
        process(tmp_path, *given, stdout=full).check(2, "No space left")


@pytest.mark.parametrize("given", ["show good.jsonl", "validate s.xml"])
def test_no_standard_output(tmp_path: Path, prima: Prima, transcript: str, given: str) -> None:
    done = subprocess.run(
        ["sh", "-c", f'"{sys.executable}" -m prima {given} >&-'],
        cwd=tmp_path, capture_output=True, text=True, timeout=SECONDS, check=False,
    )  # fmt: skip
    Result(done.returncode, done.stdout, done.stderr).check(done.returncode)


def on_terminal(folder: Path, *args: object) -> bytes:
    """What a command shows on a terminal, where nothing takes control sequences out."""
    ours, theirs = pty.openpty()
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", *map(str, args)], cwd=folder,
        stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs,
    )  # fmt: skip
    os.close(theirs)
    shown = b""
    try:
        while more := os.read(ours, 65_536):
            shown += more
    except OSError:
        pass  # the terminal's other end is closed
    made.wait(SECONDS)
    os.close(ours)
    return shown


CONTROLS = (
    "<speak>caf&#x9b;31m</speak>"
    "<log expr=\"'\\x1b[31mred\\x07'\"/>"
    '<throw event="foo" message-expr="\'\\x1b[2J\\x1b]0;title\\x07\'"/>'
)


@pytest.mark.parametrize(
    "given",
    [
        ["show", "t", "--why"],
        ["run", "s.xml"],
        ["explain", "t", "2"],
        ["diff", "t", "t"],
        ["validate", "v.xml"],
        ["explain", "\x1b[31mx"],
        ["run", "s.xml", "--policy", "\x1b[31m"],
        ["r\x1b[31mn"],
    ],
    ids=lambda given: given[0],
)
def test_control_characters_on_a_terminal(prima: Prima, tmp_path: Path, given: list[str]) -> None:
    prima("run", stage(tmp_path, app(block(CONTROLS))), "-o", "t").check(3)
    write(tmp_path, "v.xml", app(block('<turn angle="&#x9b;31m"/>')))
    shown = on_terminal(tmp_path, *given)
    assert b"Traceback" not in shown and shown
    for control in (b"\x1b", b"\x07", b"\xc2\x9b"):
        assert control not in re.sub(rb"\x1b\[(0|1|2|1;3[136])m", b"", shown)  # its own colours


def test_very_long_texts(prima: Prima, tmp_path: Path) -> None:
    body = block(f"<speak>{'word ' * 300}</speak><log>{'word ' * 20_000}</log><exit/>")
    path = stage(tmp_path, app(body), attributes='until="3000s"')
    said = prima("run", path).check(0, "word word")
    assert max(map(len, said.out.splitlines())) < 140


def test_a_very_long_word(tmp_path: Path) -> None:
    write(tmp_path, "t.jsonl", record("note", text="x" * 100_000))
    process(tmp_path, "show", "t.jsonl", seconds=30).check(0, "x" * 40)


def test_a_long_text_is_said_to_its_end(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, app(block(f"<speak>{'word ' * 600}</speak><exit/>")), "", 'until="900s"')
    prima("run", path).check(0)


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGKILL"])
def test_what_was_written_before_the_end_stays_readable(
    prima: Prima, tmp_path: Path, name: str
) -> None:
    body = form('<block><tracking-human/></block><on event="x"><exit/></on>')
    path = stage(tmp_path, app(body, kind="ea"), attributes='until="86400s"')
    made = subprocess.Popen(
        [sys.executable, "-m", "prima", "run", str(path), "-o", "t"],
        cwd=tmp_path, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    deadline = time.monotonic() + SECONDS
    while not (tmp_path / "t").exists() or (tmp_path / "t").stat().st_size < 20_000:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    made.send_signal(getattr(signal, name))
    said = made.communicate(timeout=SECONDS)[1]
    if name != "SIGKILL":
        assert made.returncode == 130 and said.strip() == "prima: interrupted"
    shown = prima("show", "t")
    torn = name == "SIGKILL" and "the record is cut off" in shown.err  # killed within a write
    shown.check(2 if torn else 0, "Tracking Human")
