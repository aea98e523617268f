"""``prima live`` from the command line."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.helpers import here

ROOT = Path(__file__).parents[2]
ROBOT = "documents/robots/simulated.xml"
HELLO = """<prima xmlns="urn:prima:dialogue:1" version="1.0" id="hello" kind="ea">
  <form id="a"><block><speak>Hello there.</speak><turn angle="30"/><exit/></block></form>
</prima>"""
WAITS = HELLO.replace("<exit/>", "").replace('id="hello"', 'id="waits"')


def prima(*words: str, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    return here.prima(*words, cwd=cwd)


@pytest.fixture
def hello(tmp_path: Path) -> str:
    path = tmp_path / "hello.xml"
    path.write_text(HELLO)
    return str(path)


def robot_with(tmp_path: Path, driver: str) -> str:
    path = tmp_path / "robot.xml"
    text = (ROOT / ROBOT).read_text()
    path.write_text(text.replace('<driver kind="sim"/>', driver))
    return str(path)


def test_a_run_prints_its_rows_and_writes_a_journal_that_replays(
    hello: str, tmp_path: Path
) -> None:
    journal = tmp_path / "visit.jsonl"
    words = ["--robot", ROBOT, "--ea", hello, "--speed", "20", "--late", "0s", "-o", str(journal)]
    ran = prima("live", *words)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert '"Hello there."' in ran.stdout
    assert json.loads(journal.read_text().splitlines()[-1])["phase"] == "over"
    again = here.prima("replay", str(journal), cwd=ROOT)
    assert (again.returncode, again.stderr) == (0, "the same, byte for byte\n")
    shown = prima("show", str(journal), "--why")
    assert shown.returncode == 0, shown.stderr
    assert "S1" in shown.stdout


def test_a_question_without_a_prompt_listens_at_once(tmp_path: Path) -> None:
    (tmp_path / "listens.xml").write_text("""<prima xmlns="urn:prima:dialogue:1" version="1.0"
  id="listens" kind="ea"><form id="a"><field name="sure" type="boolean"><prompt>Sure?</prompt>
  <noinput><log>again</log></noinput><noinput count="2"><exit/></noinput></field></form></prima>""")
    ran = prima("live", "--robot", ROBOT, "--ea", str(tmp_path / "listens.xml"), "--speed", "20")
    assert ran.returncode == 0, ran.stderr
    assert "(listens)" in ran.stdout


def test_a_journal_replays_wherever_it_and_its_documents_are_moved(tmp_path: Path) -> None:
    before, after = tmp_path / "before", tmp_path / "after"
    before.mkdir()
    (before / "hello.xml").write_text(HELLO)
    journal = before / "visit.jsonl"
    ran = prima("live", "--robot", ROBOT, "--ea", str(before / "hello.xml"), "-o", str(journal))
    assert ran.returncode == 0, ran.stderr
    before.rename(after)
    again = here.prima("replay", str(after / "visit.jsonl"), cwd=ROOT)
    assert again.returncode == 0, again.stderr
    (after / "hello.xml").write_text(HELLO.replace("there", "you"))
    other = here.prima("replay", str(after / "visit.jsonl"), cwd=ROOT)
    assert other.returncode == 2
    assert "has changed" in other.stderr or "is not the file" in other.stderr


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupt_makes_the_robot_safe_and_says_how_to_go_on(
    sent: signal.Signals, tmp_path: Path
) -> None:
    (tmp_path / "waits.xml").write_text(WAITS)
    journal = tmp_path / "visit.jsonl"
    words = ["--robot", ROBOT, "--ea", str(tmp_path / "waits.xml"), "-o", str(journal)]
    running = subprocess.Popen(
        [sys.executable, "-m", "prima", "live", *words],
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    limit = time.monotonic() + 30
    while not (journal.exists() and journal.stat().st_size) and time.monotonic() < limit:
        time.sleep(0.02)
    running.send_signal(sent)
    _, told = running.communicate(timeout=30)
    assert running.returncode == 130
    assert f"prima live --resume {journal}" in told
    on = prima("live", "--resume", str(journal), "--speed", "50", "--until", "20s")
    assert on.returncode == 0, on.stderr
    assert "the run was cut off here, and goes on" in on.stdout
    assert here.prima("replay", str(journal), cwd=ROOT).returncode == 0


@pytest.mark.parametrize("form", ["text", "json"])
def test_a_run_whose_rows_nobody_reads_any_more_ends_as_by_ctrl_c(
    form: str, tmp_path: Path
) -> None:
    (tmp_path / "waits.xml").write_text(WAITS)
    journal = tmp_path / "visit.jsonl"
    words = ["--robot", ROBOT, "--ea", str(tmp_path / "waits.xml"), "-o", str(journal)]
    running = subprocess.Popen(
        [sys.executable, "-m", "prima", "live", *words, "--format", form],
        cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert running.stdout is not None and running.stderr is not None
    running.stdout.readline()
    running.stdout.close()
    with running.stderr:
        told = running.stderr.read()
    assert running.wait(30) == 130
    assert f"prima live --resume {journal}" in told


def test_a_machine_that_stood_still_is_reported_and_the_run_goes_on(tmp_path: Path) -> None:
    journal, talk = tmp_path / "visit.jsonl", tmp_path / "talk.xml"
    speak = "<speak>Hello there.</speak>"
    talk.write_text(HELLO.replace(speak, speak * 20))  # an instant is due in any two seconds of it
    words = ["--ea", str(talk), "--speed", "2", "-o", str(journal)]
    running = subprocess.Popen(
        [sys.executable, "-m", "prima", "live", "--robot", ROBOT, *words],
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    limit = time.monotonic() + 30
    while "Hello" not in (journal.read_text() if journal.exists() else ""):  # the clock runs then
        assert running.poll() is None and time.monotonic() < limit
        time.sleep(0.02)
    running.send_signal(signal.SIGSTOP)
    time.sleep(2)
    running.send_signal(signal.SIGCONT)
    _, told = running.communicate(timeout=60)
    assert running.returncode == 0, told
    assert re.search(r"An instant was carried out \d\S* s late \(\d\S* s of real time\)", told)
    assert here.prima("replay", str(journal), cwd=ROOT).returncode == 0


def test_every_command_of_the_simulated_robot_passes_the_preflight() -> None:
    ran = prima("live", "--robot", ROBOT, "--check")
    assert ran.returncode == 0, ran.stdout
    assert "ok     turn   " in ran.stdout
    assert "FAILS" not in ran.stdout


BROKEN_DRIVER = """
from prima.devices.goals import Accepted
from prima.live.driver import Driver, Refused, TaskDriver, Unreachable
import asyncio

class Silent(Driver):
    kind = "silent"
    def start(self, goal): pass
    def cancel(self, key): pass

class Never(Driver):
    kind = "never"
    async def open(self): await asyncio.sleep(1000)

class Away(Driver):
    kind = "away"
    async def open(self): raise Unreachable("nobody listens there; start the daemon")

class Wrong(TaskDriver):
    kind = "wrong"
    async def perform(self, goal): raise Refused("the motor is hot")

class Bare(TaskDriver):
    kind = "bare"

class Flood(TaskDriver):
    kind = "flood"
    async def perform(self, goal):
        from prima.messages import Narrated
        for number in range(self.settings.heartbeat):
            self.tell(Narrated("environment", f"note {number}"))
        return {}

class Broken(Driver):
    kind = "broken"
    def start(self, goal): raise ZeroDivisionError("division by zero")
    def cancel(self, key): pass
    async def safe(self): raise RuntimeError("no link")
"""


@pytest.mark.parametrize(
    ("driver", "code", "told"),
    [
        ('<driver kind="sims"/>', 2, 'robot.xml:20:3: There is no driver of the kind "sims". Did'),
        ('<driver kind="zz"/>', 2, "The kinds are away, bare, broken, console, flood"),
        ('<driver kind="never" open="300ms"/>', 3, "robot.xml:20:3: never: no answer within 0.3 s"),
        ('<driver kind="away" address="here:1"/>', 3, "away at here:1: nobody listens there"),
        ('<driver kind="silent" accept="300ms"/>', 3, "the device does not accept it"),
        ('<driver kind="wrong"/>', 3, "the motor is hot"),
        ('<driver kind="bare"/>', 3, "Bare has no method perform"),
        (
            '<driver kind="broken"/>',
            3,
            "the driver broken has failed: ZeroDivisionError: division by zero",
        ),
        ('<driver kind="flood" heartbeat="2s"/>', 0, ""),
        ('<driver kind="flood" heartbeat="50s"/>', 3, "reports more than 10,000 things at once"),
        ("", 2, "has no driver"),
    ],
)
def test_drivers_that_do_not_work_end_in_a_clear_sentence(
    driver: str, code: int, told: str, hello: str, tmp_path: Path
) -> None:
    (tmp_path / "drivers.py").write_text(BROKEN_DRIVER)
    words = ["--driver", str(tmp_path / "drivers.py"), "--until", "20s"]
    robot = robot_with(tmp_path, driver)
    ran = prima("live", "--robot", robot, "--ea", hello, *words)
    assert told in ran.stderr
    assert ran.returncode == code, ran.stderr
    assert "Traceback" not in ran.stderr


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "Name applications"),
        (["--robot", ROBOT], "Name applications"),
        (["--check"], "--robot"),
        (["--check", "--resume", "visit.jsonl"], "Name the robot to be checked"),
        (["--ea", "documents/ea/guide.xml"], "--robot"),
        (["--resume", "nowhere.jsonl"], "cannot be read"),
        (["--resume", "visit.jsonl", "--robot", ROBOT], "leave out the rest"),
        (["--resume", "visit.jsonl", "--policy", "fifo"], "leave out --policy"),
        (["--resume", "visit.jsonl", "--patience", "1s"], "leave out --policy"),
        (["documents/scenarios/schedule-alone.xml", "--ea", "x.xml"], "leave out --fa"),
        (["documents/scenarios/schedule-alone.xml", "--services", "x.xml"], "its own services"),
        (
            ["documents/scenarios/schedule-alone.xml", "-o", "no/x.jsonl"],
            "no/x.jsonl: cannot be written",
        ),
        (
            ["documents/scenarios/schedule-alone.xml", "-o", "documents"],
            "documents: cannot be written",
        ),
        (["documents/scenarios/schedule-alone.xml", "--driver", "x.py"], "leave out --driver"),
        (["--robot", ROBOT, "--ea", "documents/ea/guide.xml", "--until", "soon"], "--until"),
        (
            ["--robot", "nowhere.xml", "--ea", "documents/ea/guide.xml"],
            "prima: nowhere.xml: cannot",
        ),
        (["--robot", ROBOT, "--world", "nowhere.xml"], "prima: nowhere.xml: cannot"),
        (
            ["--robot", ROBOT, "--ea", "documents/ea/guide.xml", "--driver", "nowhere.py"],
            "prima: nowhere.py: cannot be read: there is no such file.",
        ),
    ],
)
def test_wrong_usage_is_told_with_exit_code_2(words: list[str], told: str) -> None:
    ran = prima("live", *words)
    assert (ran.returncode, told in ran.stderr) == (2, True), ran.stderr
    assert "Traceback" not in ran.stderr


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("raise SystemExit", "d.py: it ends the program when it is imported. Put "),
        ("import nowhere", "d.py: ModuleNotFoundError: No module named 'nowhere'."),
        ("class Mine: kind = 'mine'", "d.py: it defines no Driver with a kind."),
        (
            "from prima.live.driver import TaskDriver\nclass Mine(TaskDriver): kind = 5",
            "d.py: it defines no Driver with a kind.",
        ),
        (
            "from prima.live.driver import TaskDriver\nclass Mine(TaskDriver):\n kind = 'mine'\n"
            " async def hears(self, takes): pass",
            "d.py: nobody awaits Mine.hears: write def hears, without async.",
        ),
        (None, "d.py: cannot be read: it is not a file."),
    ],
)
def test_a_file_that_brings_no_drivers_is_told(
    code: str | None, told: str, hello: str, tmp_path: Path
) -> None:
    file = tmp_path / "d.py"
    if code is None:
        file.mkdir()
    else:
        file.write_text(code)
    ran = prima("live", "--robot", ROBOT, "--ea", hello, "--driver", str(file))
    assert ran.returncode == 2, ran.stderr
    assert told in ran.stderr and "defect" not in ran.stderr


def test_a_full_disk_ends_the_run_and_is_told(hello: str) -> None:
    ran = prima("live", "--robot", ROBOT, "--ea", hello, "-o", "/dev/full")
    assert ran.returncode == 3
    assert "/dev/full: cannot be written: No space left on device" in ran.stderr


def test_rows_that_cannot_be_printed_end_the_run(hello: str) -> None:
    words = f'"{sys.executable}" -m prima live --robot "{ROBOT}" --ea "{hello}" >/dev/full'
    ran = subprocess.run(["sh", "-c", words], capture_output=True, text=True, check=False)
    assert ran.returncode == 3, ran.stderr
    assert "stdout: cannot be written: No space left on device" in ran.stderr


def test_the_recipe_for_a_robot_of_ones_own_works_as_written(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "live.md").read_text()
    section = page.partition("## Your own robot in an hour")[2]
    blocks = {one[1]: one[2] for one in re.finditer(r"```([^\n]+)\n(.+?)```", section, re.S)}
    (tmp_path / "my_robot.py").write_text(blocks["python"])
    (tmp_path / "my-robot.xml").write_text(blocks["xml my-robot.xml"])
    (tmp_path / "hello.xml").write_text(page.split("```xml hello.xml\n")[1].split("```")[0])
    commands = [line.split()[1:] for line in blocks["text"].splitlines()]
    checked, ran, again = [prima(*words, cwd=tmp_path) for words in commands]
    assert (checked.returncode, checked.stderr) == (0, ""), checked.stdout
    assert "FAILS" not in checked.stdout
    assert ran.returncode == 0, ran.stderr  # a busy machine is told of there
    assert ran.stdout.index("says: Hello") < ran.stdout.index("start the motors")
    assert ran.stdout.index("stop the motors here") < ran.stdout.index("stop everything here")
    assert again.returncode == 0, again.stderr
    text = blocks["xml my-robot.xml"].replace("192.168.0.7", "")
    (tmp_path / "my-robot.xml").write_text(text)
    away = prima(*commands[0], cwd=tmp_path)
    assert (away.returncode, 'write its address="..."' in away.stdout) == (2, True)


def test_what_users_say_can_be_left_out_of_the_journal(tmp_path: Path) -> None:
    scenario, journal = "documents/scenarios/library-alone.xml", tmp_path / "visit.jsonl"
    ran = prima("live", "--redact", "--speed", "50", scenario, "-o", str(journal))
    assert ran.returncode == 0, ran.stderr
    records = [json.loads(text) for text in journal.read_text().splitlines()]
    spoken = [one for one in records if one.get("event") == "speech"]
    assert spoken
    assert {one["text"] for one in spoken} == {"[redacted]"}
    answers = [one["data"] for one in records if one.get("outcome") == "filled"]
    assert answers
    assert all("utterance" not in data and "value" in data for data in answers)
    for words in (["replay", str(journal)], ["live", "--resume", str(journal)]):
        refused = prima(*words)
        assert refused.returncode == 2
        assert "left out of this journal" in refused.stderr or "has ended" in refused.stderr


def test_a_site_without_areas_is_a_map_alone(tmp_path: Path) -> None:
    goes = HELLO.replace('<turn angle="30"/>', '<topological-move to="door"/>')
    (tmp_path / "goes.xml").write_text(goes)
    words = ["--robot", ROBOT, "--world", "documents/worlds/room.xml", "--speed", "50"]
    ran = prima("live", *words, "--ea", str(tmp_path / "goes.xml"))
    assert ran.returncode == 0, ran.stderr
    assert "reaches door" in ran.stdout
    ran = prima("live", *words)
    assert (ran.returncode, ran.stdout) == (2, "")
    assert "room.xml: no <area> offers an application; name some by --fa" in ran.stderr


def test_an_area_of_the_site_brings_its_application(tmp_path: Path) -> None:
    world = tmp_path / "site.xml"
    (tmp_path / "hello.xml").write_text(HELLO)
    world.write_text(
        """<world xmlns="urn:prima:world:1" version="1.0" id="site">
  <place id="hall" x="1" y="1"/><place id="shop" x="4" y="1"/><way from="hall" to="shop"/>
  <area id="the-shop" title="the shop" x1="3" y1="0" x2="5" y2="2"
        application="hello.xml"/>
</world>"""
    )
    goes = HELLO.replace('kind="ea"', 'kind="fa"').replace('id="hello"', 'id="goes"')
    goes = goes.replace('<turn angle="30"/>', '<topological-move to="shop"/>')
    (tmp_path / "goes.xml").write_text(goes)
    words = ["--robot", ROBOT, "--world", str(world), "--fa", str(tmp_path / "goes.xml")]
    journal = tmp_path / "visit.jsonl"
    ran = prima("live", *words, "--speed", "20", "--until", "20s", "-o", str(journal))
    assert ran.returncode == 0, ran.stderr
    records = [json.loads(text) for text in journal.read_text().splitlines()]
    loads = [one for one in records if one["phase"] == "load" and one.get("inbound")]
    assert [(one["app"], (one.get("data") or {}).get("place")) for one in loads] == [
        ("goes", None),
        ("hello", "the shop"),
    ]
    assert here.prima("replay", str(journal), cwd=ROOT).returncode == 0
