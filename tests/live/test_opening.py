"""Drivers that cannot be opened, or fail later: a clear sentence, a safe robot, nothing lost."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path
from subprocess import PIPE
from types import SimpleNamespace
from typing import Any

import pytest

from prima.live.driver import Unreachable
from prima.live.drivers.speech.sound import SoundCard
from prima.live.signals import BLOCKED_S
from tests.helpers.command import prima
from tests.live.test_live import HELLO, ROOT

DRIVERS = """
import asyncio, sys, time
from prima.live.driver import Driver, TaskDriver, Unreachable, Unusable

class Well(TaskDriver):
    kind = "well"
    async def open(self): print("well opens", file=sys.stderr)
    async def perform(self, goal):
        await asyncio.sleep(1000 if goal.kind == "listen" else 0.05)
        return {}
    async def safe(self): print("well is safe", file=sys.stderr)

class Slow(Well):
    kind = "slow"
    async def open(self):
        try:
            await asyncio.sleep(1000)
        except asyncio.CancelledError:
            print("slow gives up", file=sys.stderr)
            raise

class Stubborn(Well):
    kind = "stubborn"
    async def open(self):
        print("stubborn opens", file=sys.stderr, flush=True)
        while True:
            try:
                await asyncio.sleep(1000)
            except BaseException:
                pass

class Owns(Well):
    kind = "owns"
    async def open(self): self.task = asyncio.ensure_future(Stubborn.open(self))

class Raises(Well):
    kind = "raises"
    async def open(self): raise ZeroDivisionError("division by zero")

class Exits(Well):
    kind = "exits"
    async def open(self): sys.exit(7)

class Never(Well):
    kind = "never"
    async def ping(self): await asyncio.sleep(1000)

class Lacks(Well):
    kind = "lacks"
    async def open(self): raise Unusable("the library wheels is missing: pip install wheels")

class Made(Well):
    kind = "made"
    def __init__(self, *given): raise KeyError("wheels")

class Unmade(Well):
    kind = "unmade"
    def __init__(self, *given): self.wheels = 4

class Samples(Well):
    kind = "samples"
    def sample(self, now): raise ValueError("no such joint")

class Blocks(Well):
    kind = "blocks"
    async def open(self):
        print("blocks", file=sys.stderr, flush=True)
        time.sleep(1000)

class Stands(Well):
    kind = "stands"
    async def safe(self):
        print("blocks", file=sys.stderr, flush=True)
        time.sleep(999)

class Due(Well):
    kind = "due"
    def due(self): raise ValueError("no such joint")

class Starts(Well):
    kind = "starts"
    def start(self, goal):
        super().start(goal)
        raise ValueError("too late")
    async def perform(self, goal):
        print("begins", file=sys.stderr)
        return await super().perform(goal)

class Soon(Well):
    kind = "soon"
    def due(self): return "soon"

class Cancelled(Well):
    kind = "cancelled"
    def sample(self, now): raise asyncio.CancelledError

class Past(Well):
    kind = "past"
    def due(self): return 5

class Changes(Well):
    kind = "changes"
    async def perform(self, goal):
        goal.command.args.clear()
        return await super().perform(goal)

class Pings(Well):
    kind = "pings"
    done = 0
    async def ping(self):
        self.done += 1
        if self.done == 2:
            raise KeyError("battery")
"""
TWO = """<driver kind="{}" devices="speaker speech-recognition" {}/><driver kind="well"/>"""


@pytest.fixture
def stage(tmp_path: Path) -> Path:
    (tmp_path / "hello.xml").write_text(HELLO)
    (tmp_path / "drivers.py").write_text(DRIVERS)
    return tmp_path


def robot(stage: Path, drivers: str) -> str:
    text = (ROOT / "documents" / "robots" / "simulated.xml").read_text()
    (stage / "robot.xml").write_text(text.replace('<driver kind="sim"/>', drivers))
    return str(stage / "robot.xml")


def live(stage: Path, drivers: str, *more: str) -> Any:
    words = ["--robot", robot(stage, drivers), "--driver", str(stage / "drivers.py")]
    return prima("live", *words, "--ea", str(stage / "hello.xml"), *more)


@pytest.mark.parametrize(
    ("kind", "code", "told"),
    [
        ("raises", 3, "robot.xml:20:3: raises: the driver has failed: ZeroDivisionError: division"),
        ("exits", 3, "robot.xml:20:3: exits: the driver has failed: SystemExit: 7"),
        ("slow", 3, "robot.xml:20:3: slow: no answer within 0.5 s"),
        ("stubborn", 3, "robot.xml:20:3: stubborn: no answer within 0.5 s"),
        ("never", 3, "robot.xml:20:3: never: no answer within 0.5 s"),
        ("lacks", 2, "robot.xml:20:3: lacks: the library wheels is missing: pip install wheels"),
        ("made", 2, "robot.xml:20:3: made: the driver has failed: KeyError: 'wheels'"),
        ("unmade", 2, "Write super().__init__(settings, profile, site) in it"),
    ],
)
def test_a_driver_that_cannot_be_opened_ends_the_run(
    kind: str, code: int, told: str, stage: Path
) -> None:
    journal = stage / "visit.jsonl"
    ran = live(stage, TWO.format(kind, 'open="500ms"'), "-o", str(journal))
    assert told in ran.stderr
    assert ran.returncode == code, ran.stderr
    assert "Traceback" not in ran.stderr
    assert "defect" not in ran.stderr
    assert not journal.exists(), "nothing has happened, so the same command may be given again"
    if kind not in ("made", "unmade"):
        assert "well is safe" in ran.stderr
    again = live(stage, '<driver kind="well"/>', "-o", str(journal))
    assert again.returncode == 0, again.stderr


@pytest.mark.parametrize("check", [[], ["--check"]])
@pytest.mark.parametrize(("kind", "blocked"), [("blocks", 1000), ("stands", 999)])
def test_a_second_signal_ends_a_run_that_a_driver_blocks(
    kind: str, blocked: int, check: list[str], stage: Path
) -> None:
    words = ["--robot", robot(stage, TWO.format(kind, "")), "--driver", "drivers.py", *check]
    journal = [] if check else ["--ea", "hello.xml", "-o", "visit.jsonl"]
    command = [sys.executable, "-m", "prima", "live", *words, *journal]
    with subprocess.Popen(command, cwd=stage, stdout=PIPE, stderr=PIPE, text=True) as run:
        assert run.stderr is not None
        assert any(line == "blocks\n" for line in run.stderr)
        run.send_signal(signal.SIGINT)
        with pytest.raises(subprocess.TimeoutExpired):
            run.wait(2 * BLOCKED_S)
        run.send_signal(signal.SIGINT)
        told = "".join(run.communicate(timeout=60))
    line = 1 + DRIVERS.splitlines().index(f"        time.sleep({blocked})")
    assert run.returncode == 130, told
    assert f"drivers.py:{line}. Drivers must wait with await." in told
    assert "well is safe" in told
    assert "Traceback" not in told and "never awaited" not in told
    assert "Go on with" not in told
    assert (stage / "visit.jsonl").exists() == (kind == "stands" and not check)


@pytest.mark.parametrize("check", [[], ["--check"]])
def test_a_signal_ends_a_run_whose_driver_does_not_heed_it(check: list[str], stage: Path) -> None:
    words = ["--robot", robot(stage, TWO.format("stubborn", "")), "--driver", "drivers.py", *check]
    command = [sys.executable, "-m", "prima", "live", *words]
    command += [] if check else ["--ea", "hello.xml"]
    with subprocess.Popen(command, cwd=stage, stdout=PIPE, stderr=PIPE, text=True) as run:
        assert run.stderr is not None
        assert any(line == "stubborn opens\n" for line in run.stderr)
        run.send_signal(signal.SIGINT)
        told = "".join(run.communicate(timeout=60))
    assert run.returncode == 130, told
    assert "well is safe" in told and "Traceback" not in told


def test_a_task_of_a_driver_that_does_not_end_keeps_no_run_from_its_end(stage: Path) -> None:
    ran = live(stage, TWO.format("owns", ""))
    assert ran.returncode == 0, ran.stderr
    assert "stubborn opens" in ran.stderr and "Traceback" not in ran.stderr


def test_no_driver_stays_half_open(stage: Path) -> None:
    ran = live(stage, TWO.format("raises", "").replace('"well"', '"slow"'))
    assert ran.returncode == 3
    assert "slow gives up" in ran.stderr


def test_a_run_that_goes_on_keeps_its_journal(stage: Path) -> None:
    journal = stage / "visit.jsonl"
    ran = live(stage, '<driver kind="well"/>', "-o", str(journal))
    assert ran.returncode == 0, ran.stderr
    cut = "".join(journal.read_text().splitlines(keepends=True)[:8])
    journal.write_text(cut)
    (stage / "drivers.py").write_text(DRIVERS.replace('print("well opens"', '1/0; print("x"'))
    words = ("--resume", str(journal), "--driver", str(stage / "drivers.py"))
    on = prima("live", *words)
    assert (on.returncode, journal.read_text()[: len(cut)]) == (3, cut)
    (stage / "drivers.py").write_text(DRIVERS)
    on = prima("live", *words)
    assert on.returncode == 0, on.stderr
    assert "Turn (angle 30)" in on.stdout, "although it was asked for before the cut"


def test_what_a_driver_has_begun_ends_where_its_start_fails(stage: Path) -> None:
    waits = '<on event="error"><pause time="300ms"/><exit/></on></form>'
    (stage / "hello.xml").write_text(HELLO.replace("</form>", waits))
    ran = live(stage, '<driver kind="starts"/>')
    assert ran.returncode == 0, ran.stderr
    assert "begins" not in ran.stderr, "its device is free for another Command"


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("samples", "the driver has failed: ValueError: no such joint"),
        ("due", "the driver has failed: ValueError: no such joint"),
        ("soon", "the driver has failed: TypeError: due returns str, not a time"),
        ("cancelled", "the driver has failed: CancelledError"),
        ("pings", "KeyError: 'battery'"),
    ],
)
def test_a_driver_that_fails_later_has_lost_its_robot(kind: str, told: str, stage: Path) -> None:
    drivers = f'<driver kind="{kind}" devices="localization" heartbeat="100ms"/>'
    waits = HELLO.replace("<exit/>", "<pause time='1s'/><exit/>")
    (stage / "hello.xml").write_text(waits)
    journal = stage / "visit.jsonl"
    ran = live(stage, f'{drivers}<driver kind="well"/>', "-o", str(journal))
    assert ran.returncode == 0, ran.stderr
    assert f"{kind}: the robot is lost ({told}); it is looked for." in ran.stderr
    assert told in journal.read_text()
    assert "well is safe" in ran.stderr


def test_a_driver_that_is_always_due_does_not_keep_a_run_from_its_end(stage: Path) -> None:
    ran = live(stage, '<driver kind="past" devices="arm"/><driver kind="well"/>')
    assert ran.returncode == 0, ran.stderr


def test_a_driver_may_change_the_arguments_that_it_gets(stage: Path) -> None:
    question = '<field name="a" type="boolean"><prompt timeout="100ms">Well?</prompt>'
    asks = HELLO.replace("</block>", f"</block>{question}<noinput><exit/></noinput></field>")
    (stage / "hello.xml").write_text(asks.replace("<exit/></block>", "</block>"))
    journal = stage / "visit.jsonl"
    ran = live(stage, '<driver kind="changes"/>', "-o", str(journal))
    assert ran.returncode == 0, ran.stderr
    assert '"args":{"angle":30.0}' in journal.read_text()
    assert prima("replay", str(journal)).returncode == 0


@pytest.mark.parametrize("name", ["microphone", "loudspeaker"])
@pytest.mark.parametrize("chosen", ["", "USB"])
def test_a_missing_microphone_is_named_with_its_remedy(
    name: str, chosen: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Stream:
        def __init__(self, **_: object) -> None:
            """It is there."""

        def start(self) -> None:
            """Begin."""

        def close(self, **_: object) -> None:
            """End."""

    class Missing(Stream):
        def __init__(self, **_: object) -> None:
            raise ValueError("Error querying device -1")

    kinds = (Missing, Stream) if name == "microphone" else (Stream, Missing)
    made = SimpleNamespace(RawInputStream=kinds[0], RawOutputStream=kinds[1])
    monkeypatch.setitem(__import__("sys").modules, "sounddevice", made)
    which = f'the {name} "USB" cannot be opened' if chosen else f"there is no {name}"
    with pytest.raises(Unreachable, match=rf'{which} .*<option name="{name}" value="..."/>'):
        SoundCard(chosen, chosen).open(lambda _: None, lambda _: None)


@pytest.mark.parametrize(
    ("drivers", "told"),
    [
        ('<driver kind="well" devices="speaker"/>', 'write devices="locomotion" into a <driver>'),
        ('<driver kind="mapped" devices="locomotion"/>', 'write <does command="turn" ...> in a'),
    ],
)
def test_a_command_that_no_driver_carries_out_is_told_before_it_fails(
    drivers: str, told: str, stage: Path
) -> None:
    mapped = "\nclass Mapped(Well):\n    kind = 'mapped'\n    mapped = True\n"
    (stage / "drivers.py").write_text(DRIVERS + mapped)
    (stage / "hello.xml").write_text(HELLO.replace("<speak>Hello there.</speak>", ""))
    ran = live(stage, drivers)
    before = re.search(
        r"hello\.xml:2:\d+: warning: turn: no driver carries it out: (.+)", ran.stderr
    )
    assert before is not None, ran.stderr
    assert told in before[1]
    assert (ran.returncode, told in ran.stderr.partition(before[0])[2]) == (3, True)
    checked = live(stage, drivers, "--check", "--why")
    assert "prima: --check tries the robot alone; it ignores --ea, --why.\n" in checked.stderr
    assert re.search(rf"FAILS +turn +no driver carries it out: {re.escape(told)}", checked.stdout)


def test_a_robot_without_a_driver_is_told_with_its_place(stage: Path) -> None:
    ran = live(stage, "")
    assert (ran.returncode, "robot.xml:3:1: The robot simulated has no driver." in ran.stderr) == (
        2,
        True,
    )


def test_extras_that_are_missing_are_wrong_settings() -> None:
    for name, line in (
        ("speech", "pip install 'prima[speech]'"),
        ("nao", "pip install 'prima[naoqi]'"),
        ("ros2", "source /opt/ros/DISTRIBUTION/setup.bash"),
        ("rosbridge", "pip install 'prima[rosbridge]'"),
    ):
        words = ("--robot", f"documents/robots/{name}.xml", "--ea", "documents/ea/guide.xml")
        ran = prima("live", *words)
        assert (ran.returncode, line in ran.stderr) == (2, True), ran.stderr
