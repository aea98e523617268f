"""Drivers whose code would end the program or the run: the run goes on, or ends as it should."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.helpers import command
from tests.helpers.here import prima

DRIVER = """
import asyncio, sys
from prima.devices.goals import LISTEN
from prima.live.driver import Refused, TaskDriver
from prima.messages import Heard

class Panic(BaseException):
    pass

class Escaping(TaskDriver):
    kind = "escaping"
    pings = 0
    async def open(self):
        self.other = asyncio.create_task(self.outside())
    async def outside(self):
        await asyncio.sleep(0.05)
        OUTSIDE
    async def perform(self, goal):
        await asyncio.sleep(0.1)
        PERFORM
        return {}
    async def safe(self):
        print("safe", file=sys.stderr)
        SAFE
    async def close(self):
        CLOSE
    async def ping(self):
        self.pings += 1
        PING
    async def check(self):
        CHECK
        return {}
"""
PLACES = ("OUTSIDE", "PERFORM", "SAFE", "CLOSE", "PING", "CHECK")
ROBOT = """<robot xmlns="urn:prima:robot:1" version="1.0" id="robot">
  <driver kind="escaping" heartbeat="100ms"/>
  <device name="speaker"/>
  <device name="locomotion"/>
</robot>"""


def live(folder: Path, place: str, what: str, *words: str) -> tuple[int, str]:
    """A run of a driver that does something at a place of its code."""
    code = DRIVER
    for one in PLACES:
        code = code.replace(one, what if one == place else "pass")
    (folder / "escaping.py").write_text(code)
    (folder / "robot.xml").write_text(ROBOT)
    (folder / "hi.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="hi"><form id="a">'
        '<block><speak>Hi.</speak><turn angle="20"/><turn angle="20"/><exit/></block>'
        "</form></prima>"
    )
    words = words or ("--ea", "hi.xml", "-o", "m.jsonl", "--until", "5s")
    ran = command.prima(
        "live", "--driver", "escaping.py", "--robot", "robot.xml", *words, cwd=folder
    )
    assert "Traceback" not in ran.stderr
    return ran.returncode, ran.stdout + ran.stderr


@pytest.mark.parametrize(
    ("what", "told"),
    [
        (
            "sys.exit(0)",
            "A driver has ended the run: SystemExit: 0.",
        ),
        (
            "for one in asyncio.all_tasks(): one.cancel()",
            "A driver has ended the run: CancelledError.",
        ),
    ],
)
def test_a_task_of_a_driver_that_ends_the_run_ends_it_by_an_error(
    what: str, told: str, tmp_path: Path
) -> None:
    code, said = live(tmp_path, "OUTSIDE", what)
    assert code == 3
    assert told in said
    assert "safe\n" in said
    assert prima("replay", "m.jsonl", cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("place", ["SAFE", "CLOSE"])
@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("sys.exit(4)", "SystemExit: 4"),
        ("raise asyncio.CancelledError", "CancelledError, although nobody has cancelled it"),
        ("raise Panic('at the disco')", "Panic: at the disco"),
    ],
)
def test_an_end_that_fails_is_told_and_the_run_ends_well(
    place: str, what: str, told: str, tmp_path: Path
) -> None:
    code, said = live(tmp_path, place, what)
    assert code == 0
    assert f"prima: escaping: {place.lower()} has failed: {told}.\n" in said


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("raise KeyError('name')", "KeyError: 'name'"),
        ("raise Refused('too hot')", "too hot"),
        ("sys.exit(4)", "SystemExit: 4"),
        ("raise Panic('x')", "Panic: x"),
        ("raise asyncio.CancelledError", "CancelledError, although nobody has cancelled it"),
    ],
)
def test_a_command_that_fails_says_by_what(what: str, told: str, tmp_path: Path) -> None:
    code, _ = live(tmp_path, "PERFORM", what)
    assert code == 3
    records = [json.loads(line) for line in (tmp_path / "m.jsonl").read_text().splitlines()]
    assert [one["message"] for one in records if one["phase"] == "fail"] == [told]


@pytest.mark.parametrize("what", ["raise asyncio.CancelledError", "sys.exit(2)"])
def test_a_heartbeat_that_escapes_loses_the_robot(what: str, tmp_path: Path) -> None:
    code, said = live(tmp_path, "PING", f"if self.pings == 3: {what}")
    reason = (
        "SystemExit: 2" if "exit" in what else "CancelledError, although nobody has cancelled it"
    )
    assert f"prima: escaping: the robot is lost ({reason}); it is looked for.\n" in said
    assert code == 3  # its Command fails, and the document handles no error


@pytest.mark.parametrize("what", ["raise asyncio.CancelledError", "sys.exit(0)"])
def test_a_robot_whose_opening_escapes_is_not_there(what: str, tmp_path: Path) -> None:
    code, said = live(tmp_path, "PING", what)
    assert code == 3
    assert "robot.xml:2:3: escaping: the driver has failed: " in said


@pytest.mark.parametrize(
    ("what", "told"),
    [("raise ValueError('x')", "ValueError: x"), ("sys.exit(0)", "SystemExit: 0")],
)
def test_a_check_that_fails_is_a_line_of_the_table(what: str, told: str, tmp_path: Path) -> None:
    code, said = live(tmp_path, "CHECK", what, "--check")
    assert code == 3
    assert f"check has failed: {told}\n" in said


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("open", "robot.xml:2:3: escaping: the driver has failed: {}, not NoneType: {}"),
        ("ping", "robot.xml:2:3: escaping: the driver has failed: {}, not NoneType: {}"),
        ("safe", "escaping: safe has failed: {}, not NoneType: {}"),
        ("close", "escaping: close has failed: {}, not NoneType: {}"),
        ("perform", "{}, not dict: {}"),
    ],
)
def test_a_method_that_is_plain_where_it_is_awaited_says_what_to_write(
    name: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code = DRIVER.replace("await asyncio.sleep(0.1)", "").replace(
        f"async def {name}", f"def {name}"
    )
    monkeypatch.setitem(globals(), "DRIVER", code)
    said = live(tmp_path, "CHECK", "pass")[1]
    assert told.format("a coroutine is needed", "write async def") in said
