"""Mediated runs on the daemon's robot, by ``prima live``, and their journals."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.parties.reachy.daemon import ROBOT, ROOT, Daemon, daemon
from tools.environments import python_of

RUN_S = 60
EA = """<?xml version="1.0" encoding="UTF-8"?>
<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="desk" xml:lang="en">
  <form id="greet" channel="connect">
    <block>
      <speak>Welcome to the museum.</speak>
      <gesture name="nod"/>
    </block>
    <field name="lost" type="boolean">
      <prompt>Are you looking for the way out?</prompt>
      <filled><goto next="#show"/></filled>
    </field>
  </form>
  <form id="show">
    <block>
      <turn-and-speak toward="door">It is over there, on your left.</turn-and-speak>
      <point-by-hand toward="door"/>
      <move-head pan="20"/>
      <speak>Good-bye.</speak>
      <exit/>
    </block>
    <on event="error.device"><speak>I cannot turn.</speak><exit/></on>
  </form>
</prima>
"""
FA = """<?xml version="1.0" encoding="UTF-8"?>
<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="shy" xml:lang="en">
  <form id="wait">
    <on event="touch">
      <gesture name="perk-up"/>
      <speak>That tickles!</speak>
      <exit/>
    </on>
    <on event="error.device"><speak>That tickles!</speak><exit/></on>
  </form>
</prima>
"""


@pytest.fixture(scope="module")
def party(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Daemon]:
    with daemon(tmp_path_factory.mktemp("reachy")) as one:
        yield one


def stage(folder: Path, address: str, touches: str) -> list[str]:
    """Write a robot and applications into a folder, and give the command that runs the robot."""
    spoken = (
        '<driver kind="user" devices="speaker speech-recognition">'
        f'<option name="touches" value="{touches}"/><option name="answers" value="yes"/></driver>'
    )
    console = '<driver kind="console" devices="speaker speech-recognition"/>'
    robot = ROBOT.read_text(encoding="utf-8").replace("http://127.0.0.1:8000", address)
    assert console in robot
    robot = robot.replace(console, spoken).replace('x="2" y="1"', 'x="0" y="2"')
    texts = {"robot.xml": robot, "ea.xml": EA, "fa.xml": FA}
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    user = str(Path(__file__).with_name("user.py"))
    prima = [str(python_of("reachy")), "-m", "prima", "live", "--driver", user]
    return [*prima, "--robot", "robot.xml"]


APPLICATIONS = ["--policy", "prima+x6", "--until", "40s", "--fa", "fa.xml", "--ea", "ea.xml"]


def start(command: list[str], folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def replay(folder: Path) -> None:
    """Replay the run without robot, and hold that the same bytes come out."""
    again = [sys.executable, "-m", "prima", "replay", "visit.jsonl", "-o", "again.jsonl"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(again, cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert (folder / "again.jsonl").read_bytes() == (folder / "visit.jsonl").read_bytes()


def records(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "visit.jsonl").read_text().splitlines()]


def test_two_applications_run_to_their_end_and_are_replayed(party: Daemon, tmp_path: Path) -> None:
    command = stage(tmp_path, party.address, "Are you looking for the way out?")
    run = start([*command, *APPLICATIONS, "-o", "visit.jsonl"], tmp_path)
    out, errors = run.communicate(timeout=RUN_S)
    assert run.returncode == 0, out + errors
    lines = out.splitlines()
    for part in (
        "Gesture (name nod)",
        "Turn to",
        "Gesture (name perk-up)",
        "That tickles!",
        "Good-bye.",
    ):
        assert part in out, out
    assert any("ends desk" in line for line in lines) and any("ends shy" in line for line in lines)
    assert math.degrees(party.body()) == pytest.approx(90, abs=3)
    assert party.get("/api/move/running") == []
    replay(tmp_path)


def test_what_turns_fails_with_the_daemon_and_the_other_application_goes_on(
    tmp_path: Path,
) -> None:
    with daemon(tmp_path) as party:
        command = stage(tmp_path, party.address, "I cannot turn.")
        run = start([*command, *APPLICATIONS, "-o", "visit.jsonl"], tmp_path)
        assert run.stdout is not None
        for line in run.stdout:  # at most for as long as --until says
            if "Turn to" in line:
                party.kill()
                break
        out, errors = run.communicate(timeout=RUN_S)
    assert "I cannot turn." in out and "That tickles!" in out, out + errors
    assert run.returncode == 0 and "the robot is lost" in errors
    missing = [one for one in records(tmp_path) if one["phase"] == "device"]
    assert missing, "the transcript tells that the devices are missing"
    replay(tmp_path)


def test_ctrl_c_in_a_gesture_stops_the_robot(party: Daemon, tmp_path: Path) -> None:
    command = stage(tmp_path, party.address, "")
    run = start([*command, *APPLICATIONS, "-o", "visit.jsonl"], tmp_path)
    assert run.stdout is not None
    for line in run.stdout:
        if "Gesture" in line:
            run.send_signal(signal.SIGINT)
            break
    _, errors = run.communicate(timeout=RUN_S)
    assert run.returncode == 130, errors
    assert party.get("/api/move/running") == []
    replay(tmp_path)


def test_the_preflight_tries_all_that_it_does(party: Daemon, tmp_path: Path) -> None:
    command = stage(tmp_path, party.address, "")
    run = start([*command, "--check"], tmp_path)
    out, errors = run.communicate(timeout=RUN_S)
    assert run.returncode == 0, out + errors
    assert "gesture perk-up" in out and "turn-to" in out and "point-by-hand" in out


def test_an_address_where_nobody_is_ends_with_a_sentence(tmp_path: Path) -> None:
    command = stage(tmp_path, "http://127.0.0.1:9", "")
    run = start([*command, *APPLICATIONS], tmp_path)
    _, errors = run.communicate(timeout=RUN_S)
    assert run.returncode == 3
    assert (
        "robot.xml:" in errors and "No Reachy Mini answers" in errors and "Traceback" not in errors
    )
