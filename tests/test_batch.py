"""Many runs at once: the same whatever the number of processes, and whatever happens to one."""

from __future__ import annotations

import json
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from bench import batch as bench
from prima import cli, pool
from prima.errors import RunError, UsageError
from prima.experiments.batch import run_batch, run_job
from prima.experiments.ledger import Inputs
from prima.experiments.plan import Job, Options, Plan, Row, stem_of
from prima.experiments.rows import format_row
from prima.pool import Died, spread

ROOT = Path(__file__).parent.parent
SECONDS = 60
MODULE = [sys.executable, "-m", "prima", "run"]


# A small world of its own ---------------------------------------------------------------------


def app(body: str, name: str = "app") -> str:
    return (
        f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="{name}">'
        f'<form id="f">{body}</form></prima>\n'
    )


def scenario(
    name: str, application: str, until: str = "60s", documents: Path = ROOT / "documents"
) -> str:
    return (
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="{name}" until="{until}"'
        f' world="{documents}/worlds/room.xml" robot="{documents}/robots/papero.xml">'
        f'<robot at="middle"/><person x="1" y="0"/><application src="{application}"/></scenario>\n'
    )


HELLO = app("<block><speak>Hello there.</speak><exit/></block>")
FAILS = app('<block><speak>Oh.</speak><throw event="bored"/></block>')
WRONG = app("<blok/>")
ENDLESS = app('<block><speak>Still here.</speak><goto next="#f"/></block>')


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with six scenarios, of which two go wrong, and one file that is none."""
    monkeypatch.chdir(tmp_path)
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    write("a/hello.xml", HELLO)
    write("a/fails.xml", FAILS)
    write("a/wrong.xml", WRONG)
    write("a/one.xml", scenario("one", "hello.xml"))
    write("b/one.xml", scenario("one", "../a/hello.xml"))
    write("a/three.xml", scenario("three", "fails.xml"))
    write("a/four.xml", scenario("four", "wrong.xml"))
    write("b/five.xml", scenario("five", "../a/hello.xml"))
    return tmp_path


def write(name: str, content: str) -> None:
    Path(name).write_text(content, encoding="utf-8")


def prima(*args: object, **more: object) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [*MODULE, *map(str, args)],
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
        **more,  # type: ignore[call-overload]
    )
    assert "Traceback" not in done.stderr and "defect of prima" not in done.stderr, done.stderr
    assert isinstance(done, subprocess.CompletedProcess)
    return done


def files(folder: str) -> dict[str, bytes]:
    found = Path(folder).rglob("*")
    return {str(one.relative_to(folder)): one.read_bytes() for one in found if one.is_file()}


POLICIES = ("--policy", "prima", "--policy", "fifo")
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
    (["a", "--ea", "a/hello.xml"], "Name a scenario, or applications with --fa and --ea."),
    (["--ea", "a/hello.xml", *POLICIES], "name one run; for several, write scenarios."),
    (["--ea", "a/hello.xml", "--workers", "2"], "name one run; for several, write scenarios."),
    (["empty"], "empty: contains no scenarios"),
    (["--from", "empty"], "empty: cannot be read: Is a directory."),
    (["--from", "no"], "no: cannot be read: No such file or directory."),
    (["--from", "a/one.xml"], "a/one.xml: not a list of scenarios: write one path per line"),
    (["--from", "nothing"], "nothing: names no scenarios: write their paths, one per line."),
    (["--from", "/dev/zero"], "/dev/zero: not a list of scenarios"),
    (["a", "-o", "nothing"], "nothing: this is a file; several transcripts need a folder"),
    (["a", "-o", "nothing/runs"], "nothing/runs: cannot be written: Not a directory."),
    (["a", "-o", "runs.jsonl"], "runs.jsonl: several transcripts go into a folder: -o runs/."),
    (["a", "-o", ""], "-o: name the folder that the transcripts go into."),
    (["a/one.xml", "-o", "empty"], "Is a directory. For a transcript in it, write empty/."),
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


# What happens to a process -------------------------------------------------------------------


def square(number: int) -> int:
    return number * number


def fate(number: int) -> int:
    """Some do not come to their end."""
    if number == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 5:
        os._exit(3)
    return number * number


def late(number: int) -> int:
    time.sleep(0.3 if number == 0 else 0)
    return number


def broken() -> None:
    os._exit(7)


@pytest.mark.parametrize("workers", [1, 2, 5])
def test_one_that_dies_takes_only_its_own_along(workers: int) -> None:
    made = list(spread(fate, range(8), workers))
    assert made == [(n, {2: Died(-signal.SIGKILL), 5: Died(3)}.get(n, n * n)) for n in range(8)]


def test_items_are_taken_as_they_are_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "AHEAD", 10)
    taken = 0
    most = 0

    def items() -> Iterator[int]:
        nonlocal taken
        for number in range(200):
            taken += 1
            yield number

    for due, (_, made) in enumerate(spread(late, items(), 2)):
        assert made == due
        most = max(most, taken - due)
    assert (taken, most <= 11) == (200, True)


def test_processes_that_cannot_begin_are_told() -> None:
    with pytest.raises(RunError, match="ended before it began to work, with code 7"):
        list(spread(square, range(3), 2, broken))


def test_the_processes_are_of_the_version_that_starts_them(stage: Path) -> None:
    """A checkout that one works in counts, and not a version that is installed beside it."""
    shutil.copytree(ROOT / "prima", "prima", ignore=shutil.ignore_patterns("__pycache__"))
    here = Path("prima/__init__.py")
    here.write_text(re.sub('__version__ = ".*"', '__version__ = "9.9"', here.read_text()))
    assert prima("b", "-o", "runs").returncode == 0
    assert json.loads(Path("runs/b/one.run.json").read_text())["key"]["prima"] == "9.9"


@pytest.mark.parametrize("most", [40, 60])
def test_a_system_that_has_no_more_processes(stage: Path, most: int) -> None:
    """Fewer files may be open than so many processes need: those that begin do the work."""
    command = f"ulimit -n {most}; {' '.join(MODULE)} a b --policy prima --policy fifo --workers 12"
    few = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=SECONDS, check=False
    )
    assert few.stdout == prima("a", "b", *POLICIES).stdout, few.stderr
    assert few.returncode == 3


def test_a_module_beside_the_scenarios_is_not_taken_for_one_of_python(stage: Path) -> None:
    for name in ("json", "random", "signal", "selectors"):
        write(f"{name}.py", "raise SystemExit('not this one')\n")
    code = "from prima.__main__ import main; main()"
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, "run", "a/one.xml", "b"],
        capture_output=True, text=True, timeout=SECONDS, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_how_the_death_of_a_process_is_told(stage: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fates: list[Row | Died] = [Died(-9), Died(3), Died(11), Row("b/one.xml", "prima")]

    def mock(_function: object, items: Plan, *_: object) -> Iterator[tuple[Job, Row | Died]]:
        yield from zip(items, fates, strict=True)

    monkeypatch.setattr("prima.experiments.batch.spread", mock)
    rows = list(run_batch(Plan(["a", "b/one.xml"]), Options()))
    assert [row.exit for row in rows] == [3, 3, 3, 0]
    assert [row.messages for row in rows[:3]] == [
        ["its process was killed by the signal SIGKILL; was there no memory left?"],
        ["its process ended with code 3."],
        ["its process ended with code 11."],
    ]


def children(parent: int) -> set[int]:
    """The processes below one, however deep."""
    pairs = re.findall(
        r"(\d+) +(\d+)",
        subprocess.run(
            ["ps", "-Ao", "pid=,ppid="], capture_output=True, text=True, check=True
        ).stdout,
    )
    found = {parent}
    for _ in range(5):
        found |= {int(pid) for pid, above in pairs if int(above) in found}
    return found - {parent}


def alive(processes: set[int]) -> set[int]:
    shown = subprocess.run(["ps", "-Ao", "pid=,stat="], capture_output=True, text=True, check=True)
    now = {int(pid) for pid, state in re.findall(r"(\d+) +(\S)", shown.stdout) if state != "Z"}
    return processes & now


def until(condition: object, *args: object) -> None:
    assert callable(condition)
    deadline = time.monotonic() + SECONDS
    while not condition(*args):
        assert time.monotonic() < deadline
        time.sleep(0.02)


def begun(stage: Path) -> subprocess.Popen[str]:
    """A batch in whose middle are runs that last, when the first is done and they are at work."""
    write("a/endless.xml", ENDLESS)
    for name in ("x", "y"):
        write(f"b/{name}.xml", scenario(name, "../a/endless.xml", "86400s"))
    made = subprocess.Popen(
        [*MODULE, "b/one.xml", "b/x.xml", "b/y.xml", "b/five.xml", "-o", "runs", "--workers", "2"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    until(lambda: len([one for one in stage.glob("runs/.prima-*/*") if one.stat().st_size]) == 2)
    until(Path("runs/b/one.jsonl").exists)
    return made


SPAWNS = """
import os, signal
from multiprocessing import util
from prima import pool

def waits():
    return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())

def spawn(path, args, fds, real=util.spawnv_passfds):
    print(args[-1].split()[1], waits(), os.environ.get("PYTHONSAFEPATH"))
    return real(path, args, fds)

util.spawnv_passfds = spawn
pool.warm_up()
print(waits(), os.environ.get("PYTHONSAFEPATH"))
"""


def test_no_process_begins_that_an_interrupt_could_end_before_it_takes_care() -> None:
    done = subprocess.run([sys.executable, "-c", SPAWNS], capture_output=True, text=True)
    begun = ["multiprocessing.resource_tracker", "multiprocessing.forkserver"]
    expected = [*(f"{name} True 1" for name in begun), "False None"]
    assert done.stdout.splitlines() == expected, done.stderr


def test_ctrl_c_ends_all_at_once(stage: Path) -> None:
    made = begun(stage)
    below = children(made.pid)
    assert len(below) >= 3
    made.send_signal(signal.SIGINT)
    out, errors = made.communicate(timeout=10)
    assert (made.returncode, errors) == (130, "prima: interrupted\n")
    until(lambda: not alive(below))
    assert "b/one.xml" in out and "b/x.xml" not in out
    assert set(files("runs")) == {"b/one.jsonl", "b/one.run.json"}
    shown = subprocess.run([*MODULE[:-1], "show", "runs/b/one.jsonl"], capture_output=True)
    assert shown.returncode == 0 and b"Hello there." in shown.stdout


@pytest.mark.parametrize("name", ["SIGKILL", "SIGTERM"])
def test_a_batch_that_is_killed_leaves_nothing_behind_and_goes_on(stage: Path, name: str) -> None:
    made = begun(stage)
    below = children(made.pid)
    made.send_signal(getattr(signal, name))
    made.communicate(timeout=10)
    until(lambda: not alive(below))
    until(lambda: set(files("runs")) == {"b/one.jsonl", "b/one.run.json"})
    write("a/endless.xml", HELLO)
    words = ("b/one.xml", "b/x.xml", "b/y.xml", "b/five.xml")
    again = prima(*words, "-o", "runs", "--resume")
    assert again.stderr == "1 of 4 runs had been made before\n"
    fresh = prima(*words, "-o", "fresh")
    assert (again.stdout, again.returncode) == (fresh.stdout, fresh.returncode)
    assert files("runs") == files("fresh")


def test_a_worker_that_is_killed_is_told_and_the_others_go_on(stage: Path) -> None:
    made = begun(stage)
    first, second = (int(one.stem) for one in stage.glob("runs/.prima-*/*.jsonl"))
    os.kill(first, signal.SIGKILL)
    until(lambda: Path("runs/b/five.jsonl").exists())
    os.kill(second, signal.SIGKILL)
    out, errors = made.communicate(timeout=SECONDS)
    assert made.returncode == 3
    assert out.splitlines()[-1] == "runs: 4; fine: 2; exit code 3: 2"
    assert errors.count("its process was killed by the signal SIGKILL") == 2


# Taking a batch up again ------------------------------------------------------------------------

BATCH = ("a/one.xml", "b", "a/three.xml", *POLICIES)


def test_only_what_is_missing_or_changed_is_done_again(stage: Path) -> None:
    first = prima(*BATCH, "-o", "runs")
    before = files("runs")
    assert (first.returncode, len(before)) == (3, 16)

    def again(count: int, *more: str) -> None:
        done = prima(*BATCH, "-o", "runs", "--resume", *more)
        assert done.stderr.splitlines()[-1] == f"{count} of 8 runs had been made before"
        assert (done.returncode, done.stdout) == (first.returncode, first.stdout)
        assert files("runs").keys() == before.keys()

    again(8)
    os.unlink("runs/a/one.fifo.jsonl")
    os.unlink("runs/b/one.fifo.run.json")
    again(6)
    assert files("runs") == before
    cut = Path("runs/a/three.prima.jsonl")
    cut.write_bytes(cut.read_bytes()[:-20])
    write("runs/b/five.prima.run.json", '{"key": ')
    again(6)
    assert files("runs") == before
    write("a/one.xml", scenario("one", "hello.xml").replace("><robot", ">\n<robot"))
    again(6)
    write("a/hello.xml", HELLO + "\n")
    again(2)
    again(0, "--bound", "3")


@pytest.mark.parametrize(
    "change",
    [
        lambda ledger: ledger["key"].update(prima="0.9"),
        lambda ledger: ledger.update(row=7),
        lambda ledger: ledger["row"].update(records="many"),
        lambda ledger: ledger["row"].update(messages="x"),
        lambda ledger: ledger["row"].pop("exit"),
        lambda ledger: ledger.update(inputs=[1]),
        lambda ledger: ledger.update(transcript=None),
    ],
)
def test_a_ledger_of_another_version_or_that_is_damaged(stage: Path, change: object) -> None:
    assert callable(change)
    options, job = Options(parts="."), Job("a/one.xml", None, "runs/a/one")
    run_job(options, job)
    resumed = Options(parts=".", resume=True)
    assert run_job(resumed, job).earlier
    ledger = Path("runs/a/one.run.json")
    data = json.loads(ledger.read_text())
    change(data)
    ledger.write_text(json.dumps(data))
    row = run_job(resumed, job)
    assert (row.exit, row.earlier) == (0, False), row.messages


VOICE = """<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1" xml:lang="en"><form>
<field name="f"><prompt>Which?<audio src="bell.wav">bell</audio></prompt>
<grammar src="which.grxml" type="application/srgs+xml"/><noinput><exit/></noinput>
<filled><exit/></filled></field></form></vxml>
"""
GRAMMAR = """<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0" xml:lang="en"
 root="r"><rule id="r"><one-of><item>this</item><item>that</item></one-of></rule></grammar>
"""


def test_what_an_application_fetches_counts_as_well(stage: Path) -> None:
    """Also what is looked at in part alone, or looked for in vain."""
    write("a/voice.vxml", VOICE)
    write("a/which.grxml", GRAMMAR)
    write("a/six.xml", scenario("six", "voice.vxml"))
    options, job = Options(parts=".", resume=True), Job("a/six.xml", None, "runs/a/six")

    def done() -> bool:
        row = run_job(options, job)
        assert (row.exit, row.messages) == (0, [])
        return row.earlier

    assert (done(), done()) == (False, True)
    write("a/which.grxml", GRAMMAR.replace("that", "it"))
    assert (done(), done()) == (False, True)
    Path("a/bell.wav").write_bytes(b"RIFF")
    assert (done(), done()) == (False, True)
    Path("a/bell.wav").write_bytes(b".snd")
    assert (done(), done()) == (False, True)


def test_what_is_no_file_has_no_digest(stage: Path) -> None:
    inputs = Inputs("a/one.xml")
    for name in ("a/one.xml", "/dev/zero", "a", "a/gone.xml", "a/\0"):
        assert inputs.get(Path(name).absolute()) is None
    assert [value is None for value in inputs.digests.values()] == [False, True, True, True, True]


# The terminal -----------------------------------------------------------------------------------


def terminal(words: list[str], out_too: bool, **environment: str) -> tuple[bytes, bytes]:
    """What a batch writes to a terminal that is its stderr, and to its stdout."""
    ours, theirs = pty.openpty()
    made = subprocess.Popen(
        [*MODULE, *words],
        stdout=theirs if out_too else subprocess.PIPE,
        stderr=theirs,
        env={**os.environ, **environment},
    )
    os.close(theirs)
    said = b""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline and select.select([ours], [], [], SECONDS)[0]:
        try:
            said += os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
    out = made.communicate(timeout=SECONDS)[0] or b""
    os.close(ours)
    return said, out


def test_progress_is_told_to_a_terminal_alone(stage: Path) -> None:
    write("a/endless.xml", ENDLESS)
    for name in "pqrs":
        write(f"b/{name}.xml", scenario(name, "../a/endless.xml", "300s"))
    words = ["b", "a/three.xml"]
    said, out = terminal(words, out_too=False)
    assert re.search(rb"\r[1-6] of 7 runs", said)
    assert out.decode() == prima(*words).stdout
    assert b"\x1b" not in out
    both, _ = terminal(words, out_too=True, NO_COLOR="")
    assert re.search(rb"\r2 of 7 runs(, 1 not fine)?; about \d+ s left ", both)
    assert re.search(rb" \rb/q.xml +prima +0  until", both)  # a row begins at the margin
    assert prima("b").stderr == ""


def test_colours_are_for_terminals_that_want_them(stage: Path) -> None:
    words = ["a/one.xml", "a/three.xml"]
    said, _ = terminal(words, out_too=True, NO_COLOR="")
    assert b"\x1b" not in said
    environment = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    ours, theirs = pty.openpty()
    subprocess.run([*MODULE, *words], stdout=theirs, stderr=subprocess.DEVNULL, env=environment)
    os.close(theirs)
    said = os.read(ours, 65536)
    os.close(ours)
    red = [line for line in said.splitlines() if b"\x1b[31m" in line]
    assert len(red) == 1 and b"a/three.xml" in red[0]


def test_control_characters_in_a_name_do_not_reach_the_terminal(stage: Path) -> None:
    done = prima("a/one.xml", "a/\x1b[31m.xml")
    assert "\x1b" not in done.stdout + done.stderr


@pytest.mark.parametrize("form", ["text", "json"])
def test_a_name_that_is_not_utf_8(stage: Path, form: str) -> None:
    shutil.copy("b/one.xml", os.fsdecode(b"b/\xff.xml"))
    env = {**os.environ, "PYTHONIOENCODING": "utf-8:strict"}
    done = prima("b", "-o", "runs", "--format", form, env=env)
    assert done.returncode == 2
    assert "its path is not UTF-8; rename it." in done.stderr
    assert set(files("runs")) == {
        f"b/{name}{end}" for name in ("one", "five") for end in (".jsonl", ".run.json")
    }


def test_nobody_reads_any_more(stage: Path) -> None:
    command = (
        f"{' '.join(MODULE)} a b --policy prima --policy fifo | head -1; exit ${{PIPESTATUS[0]}}"
    )
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=SECONDS, check=False
    )
    assert "Traceback" not in done.stderr and done.stdout.startswith("scenario")


# From Python ------------------------------------------------------------------------------------


def test_from_python(stage: Path) -> None:
    plan = Plan(["a/one.xml", "b"], ["prima", "fifo"], "runs")
    assert len(plan) == len(list(plan)) == 6
    rows = list(run_batch(plan, Options(), workers=2))
    assert [row.exit for row in rows] == [0] * 6
    assert rows[0].transcript == "runs/a/one.prima.jsonl"
    assert format_row(rows[0], 10).startswith("a/one.xml   prima        0  over")
    with pytest.raises(UsageError, match="There is no policy"):
        Plan(["a"], ["x"])


def test_a_partial_of_a_function_may_be_spread() -> None:
    assert [made for _, made in spread(partial(pow, 2), range(4), 2)] == [1, 2, 4, 8]


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
