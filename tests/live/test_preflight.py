"""``prima live --check``: every Command is begun and really cancelled, and a table says so."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from prima.live.chosen import Chosen
from prima.live.preflight import check_robot
from prima.live.visit import LiveSettings
from tests.live.test_live import ROOT, prima

DRIVERS = """
import asyncio, sys, time
from prima.devices.goals import Accepted, Progress, Stopped
from prima.live.driver import Driver, Refused, TaskDriver, Unreachable, Unusable

class Well(TaskDriver):
    kind = "well"
    async def perform(self, goal):
        await asyncio.sleep(5)
        return {}
    async def safe(self): print("safe", file=sys.stderr)

class Quick(Well):
    kind = "quick"
    async def perform(self, goal): return {}

class Heedless(Well):
    kind = "heedless"
    async def perform(self, goal):
        ends = time.monotonic() + 0.8
        while (left := ends - time.monotonic()) > 0:
            try:
                await asyncio.sleep(left)
            except asyncio.CancelledError:
                pass
        return {}

class Hangs(Driver):
    kind = "hangs"
    def start(self, goal): self.tell(Accepted(goal.key))
    def cancel(self, key): pass

class Silent(Driver):
    kind = "silent"
    def start(self, goal): pass
    def cancel(self, key): pass

class Leaves(Driver):
    kind = "leaves"
    def start(self, goal):
        self.tell(Accepted(goal.key))
        self.tell(Stopped(goal.key))
    def cancel(self, key): pass

class Dies(Driver):
    kind = "dies"
    def start(self, goal): self.lose("the cable is out")
    def cancel(self, key): pass

class Drops(Hangs):
    kind = "drops"
    def cancel(self, key):
        self.tell(Progress(key))
        self.lose("the cable is out")

class Refuses(Well):
    kind = "refuses"
    async def perform(self, goal): raise Refused("the motor is hot")

class Raises(Well):
    kind = "raises"
    def cancel(self, key): raise KeyError("joint")

class Cancelled(Well):
    kind = "cancelled"
    def cancel(self, key): raise asyncio.CancelledError

class Begun(Well):
    kind = "begun"
    def start(self, goal): raise asyncio.CancelledError

class Lists(Well):
    kind = "lists"
    async def check(self): return ["microphone"]

class Mute(Well):
    kind = "mute"
    async def check(self): return {"microphone": "no sound comes from it"}

class Hears(Well):
    kind = "hears"
    async def check(self): return {"microphone": ""}

class Away(Well):
    kind = "away"
    async def open(self): raise Unreachable("it is switched off")

class Slow(Well):
    kind = "slow"
    async def safe(self):
        print("stopping", flush=True)
        await asyncio.sleep(0.5)
        await super().safe()
    async def close(self): print("closed", file=sys.stderr)

class Lacks(Well):
    kind = "lacks"
    async def open(self): raise Unusable("pip install wheels")
"""
PROFILE = """<robot xmlns="urn:prima:robot:1" version="1.0" id="r">
  <device name="locomotion"/><device name="neck"/>
  {}
</robot>"""


def document(folder: Path, *drivers: str) -> str:
    (folder / "drivers.py").write_text(DRIVERS)
    path = folder / "robot.xml"
    path.write_text(PROFILE.format("".join(drivers)))
    return str(path)


def checked(folder: Path, *drivers: str) -> subprocess.CompletedProcess[str]:
    words = ("--driver", str(folder / "drivers.py"), "--check")
    return prima("live", "--robot", document(folder, *drivers), *words)


LIMITS = 'accept="300ms" cancel="600ms"'


@pytest.mark.parametrize(
    ("kind", "code", "line"),
    [
        ("well", 0, r"ok +turn +well +\d+ ms +\d+ ms$"),
        ("quick", 0, r"ok +move-head +quick +\d+ ms +\d+ ms$"),
        ("heedless", 3, r"FAILS +turn +heedless .* goes on to its end although it is cancelled$"),
        ("hangs", 3, r"FAILS +turn +hangs .* does not stop within 600 ms$"),
        ("silent", 3, r"FAILS +turn +silent .* not accepted within 300 ms$"),
        ("leaves", 3, r"FAILS +turn +leaves .* it stops by itself$"),
        ("dies", 3, r"FAILS +turn +dies .* the cable is out$"),
        ("drops", 3, r"FAILS +turn +drops .* the cable is out$"),
        ("refuses", 3, r"FAILS +turn +refuses .* the motor is hot$"),
        ("raises", 3, r"FAILS +turn +raises .* the driver has failed: KeyError: 'joint'$"),
        ("cancelled", 3, r"FAILS +turn +cancelled .* the driver has failed: CancelledError"),
        ("begun", 3, r"FAILS +turn +begun .* the driver has failed: CancelledError"),
        ("lists", 3, r"FAILS +check +lists +check has failed: .* returns list, not a dict$"),
        ("mute", 3, r"FAILS +microphone +mute +no sound comes from it$"),
        ("hears", 0, r"ok +microphone +hears$"),
        ("away", 3, r"FAILS +connection +away .*robot\.xml:3:3: away: it is switched off$"),
        ("lacks", 2, r"FAILS +connection +lacks .*robot\.xml:3:3: lacks: pip install wheels$"),
    ],
)
def test_a_table_says_what_works(kind: str, code: int, line: str, tmp_path: Path) -> None:
    ran = checked(tmp_path, f'<driver kind="{kind}" {LIMITS}/>')
    assert re.search(line, ran.stdout, re.M), ran.stdout + ran.stderr
    assert ran.returncode == code, ran.stdout
    assert ran.stdout.splitlines()[0].split() == ["driver", "accepted", "cancelled"]
    assert "Traceback" not in ran.stderr


def test_what_a_driver_that_is_not_there_would_do_is_not_tried(tmp_path: Path) -> None:
    ran = checked(tmp_path, '<driver kind="away" devices="neck"/>', '<driver kind="well"/>')
    assert ran.returncode == 3
    assert re.search(r"^- +move-head +away +not tried: its driver is not there$", ran.stdout, re.M)
    assert re.search(r"^ok +turn +well", ran.stdout, re.M)


def test_a_command_that_no_driver_carries_out_is_named(tmp_path: Path) -> None:
    ran = checked(tmp_path, '<driver kind="reachy" address="127.0.0.1:9" devices="locomotion"/>')
    assert re.search(r'FAILS +move-head .*write devices="neck" into a <driver>', ran.stdout)


def test_the_emergency_stop_is_named(tmp_path: Path) -> None:
    senses = '<driver kind="well"><senses as="emergency" by="/estop"/></driver>'
    ran = checked(tmp_path, senses)
    assert re.search(
        r"^- +emergency stop +well +by /estop; press it once in a run$", ran.stdout, re.M
    )


def test_a_signal_ends_the_check_with_a_safe_robot(tmp_path: Path) -> None:
    path = document(
        tmp_path, f'<driver kind="hangs" devices="neck" {LIMITS}/><driver kind="well"/>'
    )
    words = ["live", "--robot", path, "--driver", str(tmp_path / "drivers.py"), "--check"]
    code, told = signalled("ok     connection                  well", words)
    assert (code, "safe" in told) == (130, True), told


def signalled(awaited: str, words: list[str]) -> tuple[int, str]:
    """The exit code and the messages of a check that a signal ends soon after a line."""
    running = subprocess.Popen(
        [sys.executable, "-u", "-m", "prima", *words],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert running.stdout is not None
    for line in running.stdout:
        if line.startswith(awaited):
            break
    time.sleep(0.1)
    running.send_signal(signal.SIGTERM)
    _, told = running.communicate(timeout=30)
    return running.returncode, told


def test_a_signal_at_the_end_of_a_check_lets_the_robot_be_made_safe(tmp_path: Path) -> None:
    path = document(tmp_path, '<driver kind="slow"/>')
    words = ["live", "--robot", path, "--driver", str(tmp_path / "drivers.py"), "--check"]
    code, told = signalled("stopping", words)
    assert (code, told.split()) == (130, ["safe", "closed"])


def test_ctrl_c_before_a_check_begins_says_nothing_of_coroutines(
    monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    def interrupted(_work: object) -> None:
        raise KeyboardInterrupt

    told: list[str] = []
    monkeypatch.setattr("asyncio.run", interrupted)
    chosen = Chosen(robot=str(ROOT / "documents" / "robots" / "simulated.xml"))
    assert check_robot(chosen, LiveSettings(), told.append) == 130
    assert (told, recwarn.list) == (["The check was broken off."], [])


@pytest.mark.parametrize("name", ["simulated", "console"])
def test_the_drivers_that_need_nothing_pass(name: str) -> None:
    ran = prima("live", "--robot", f"documents/robots/{name}.xml", "--check")
    assert ran.returncode == 0, ran.stdout
    assert re.search(r"^ok +say .* \d+ ms +\d+ ms$", ran.stdout, re.M), ran.stdout


@pytest.mark.parametrize(
    ("option", "told"),
    [
        ('name="usr" value="true"', 'no option "usr". Write at, stopping or user.'),
        ('name="user" value="no"', 'user is "no". Write false or true.'),
        ('name="stopping" value="20"', "stopping is not a duration. Write it as 20ms."),
    ],
)
def test_a_wrong_option_of_the_simulated_body_is_told(
    option: str, told: str, tmp_path: Path
) -> None:
    robot = (ROOT / "documents" / "robots" / "simulated.xml").read_text()
    wrong = f'<driver kind="sim"><option {option}/></driver>'
    (tmp_path / "r.xml").write_text(robot.replace('<driver kind="sim"/>', wrong))
    done = prima("live", "--robot", str(tmp_path / "r.xml"), "--check")
    assert done.returncode == 2 and told in done.stdout + done.stderr


def test_what_the_robots_document_says_does_nothing_to_the_terminal(tmp_path: Path) -> None:
    robot = (ROOT / "documents" / "robots" / "simulated.xml").read_text()
    wrong = '<driver kind="sim"><option name="at" value="&#x202e;&#x9b;31m"/></driver>'
    begin, _, rest = robot.partition("<driver")
    (tmp_path / "r.xml").write_text(begin + wrong + rest[rest.index("/>") + 2 :])
    done = prima("live", "--robot", str(tmp_path / "r.xml"), "--check")
    assert done.returncode == 2 and "no place" in done.stdout + done.stderr
    assert not {"\u202e", "\x9b"} & {*done.stdout, *done.stderr}
