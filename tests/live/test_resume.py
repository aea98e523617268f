"""What applications had asked when a run was killed: asked again where that does no harm."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from prima.live.journal import known
from prima.messages import Record
from tests.helpers import here
from tests.live.test_live import ROBOT, ROOT, prima
from tests.live.test_services import ASKS, Host, document, host

__all__ = ["host"]


def killed_while_asking(folder: Path, host: Host, how: str) -> Path:
    """The journal of a run that was killed when its service had been asked and was silent."""
    (folder / "asks.xml").write_text(ASKS)
    path = document(folder, host, f'url="URL/slow" deadline="20s" {how}/>')
    journal = folder / "visit.jsonl"
    words = ["--robot", ROBOT, "--ea", str(folder / "asks.xml"), "--services", str(path)]
    running = subprocess.Popen(
        [sys.executable, "-m", "prima", "live", *words, "-o", str(journal)],
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    limit = time.monotonic() + 30
    while not host.asked and time.monotonic() < limit:
        time.sleep(0.02)
    running.send_signal(signal.SIGKILL)
    running.wait(30)
    assert len(host.asked) == 1
    return journal


@pytest.mark.parametrize(
    ("how", "times", "line"),
    [
        ('method="get"', 2, "It is I, Robot."),
        ('idempotent="true"', 2, "It is I, Robot."),
        ('method="post"', 1, "It fails."),
    ],
)
def test_what_was_asked_is_asked_again_or_has_failed(
    how: str, times: int, line: str, host: Host, tmp_path: Path
) -> None:
    journal = killed_while_asking(tmp_path, host, how)
    on = prima("live", "--resume", str(journal), "--until", "600s", "--speed", "10")
    assert on.returncode == 0, on.stderr
    assert line in on.stdout
    assert len(host.asked) == times
    assert here.prima("replay", str(journal), cwd=ROOT).returncode == 0
    if times == 1:
        errors = [r for r in map(json.loads, journal.read_text().splitlines()) if r.get("event")]
        (told,) = [r["data"]["message"] for r in errors if r["event"] == "error.service.library"]
        assert "cut off" in told


def test_what_the_cut_left_out_of_its_instant_was_never_asked(host: Host, tmp_path: Path) -> None:
    journal = killed_while_asking(tmp_path, host, 'method="post"')
    lines = journal.read_text().splitlines(keepends=True)
    sends = next(i for i, text in enumerate(lines) if '"phase":"send"' in text)
    journal.write_text("".join(lines[:sends]))
    on = prima("live", "--resume", str(journal), "--until", "600s", "--speed", "10")
    assert on.returncode == 0, on.stderr
    assert "It is I, Robot." in on.stdout
    assert len(host.asked) == 2


def sends(serial: int, to: str = "library", app: str = "a", **more: object) -> Record:
    data = {"to": to, **more}
    return {
        "time": 1,
        "phase": "send",
        "actor": "robot",
        "app": app,
        "serial": serial,
        "data": data,
    }


def tells(event: str, app: str = "a") -> Record:
    given = {"time": 2, "phase": "event", "actor": "environment", "inbound": True}
    return {**given, "event": event, "app": app, "serial": 9}


@pytest.mark.parametrize(
    ("records", "left"),
    [
        ([sends(1), sends(2)], ["a!1", "a!2"]),
        ([sends(1), sends(2), tells("reply.library")], ["a!2"]),
        ([sends(1), sends(2), tells("error.service.library")], ["a!2"]),
        ([sends(1), tells("reply.library", "b")], ["a!1"]),
        ([sends(1), tells("reply.archive")], ["a!1"]),
        ([sends(1, method="get"), {**tells("x"), "phase": "fetched", "data": {"serial": 1}}], []),
        ([sends(1, transfer="bridge"), {**tells("x"), "phase": "transferred", "serial": 1}], []),
        ([sends(1, transfer="bridge"), sends(2, transfer="over", call=1)], []),
        ([sends(1), {**tells("x"), "phase": "load", "outcome": "", "data": {}}], []),
    ],
)
def test_what_has_no_answer_is_known(records: list[Record], left: list[str]) -> None:
    assert list(known(records).asked) == left


def test_what_was_the_case_at_the_cut_is_known() -> None:
    def record(phase: str, **more: object) -> Record:
        return {"time": 1, "phase": phase, "actor": "environment", "inbound": True, **more}

    area, seen = {"app": "cafe", "data": {"place": "cafe"}}, {"event": "human.found"}
    records = [
        record("load", app="guide"),
        record("load", **area),
        record("event", **seen),
        record("sensed", data={"battery": 20, "door": "open"}),
        record("sensed", data={"battery": 19}),
    ]
    state = known(records)
    assert (state.loaded, state.inside, state.found) == ({"guide", "cafe"}, {"cafe"}, True)
    assert state.sensors == {"battery": 19, "door": "open"}
    later = known([*records, record("unload", app="cafe"), record("event", event="human.lost")])
    assert (later.inside, later.found) == (set(), False)


# Scenarios ----------------------------------------------------------------------------------

SCENARIO = "documents/scenarios/touched-on-the-way.xml"


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The journal of a scenario's live run; paths in it lead to folders beside it."""
    path = tmp_path_factory.mktemp("whole") / "visit.jsonl"
    assert prima("live", "--speed", "1000", SCENARIO, "-o", str(path)).returncode == 0
    return path


@pytest.mark.parametrize("share", [0.0, 0.3, 0.999])
def test_a_scenario_goes_on_and_gives_the_rehearsals_transcript(share: float, whole: Path) -> None:
    journal, text = whole.with_name(f"{share}.jsonl"), whole.read_text()
    ends = text.index("\n") + 1
    journal.write_text(text[: max(int(len(text) * share), ends)])
    on = prima("live", "--speed", "1000", "--resume", str(journal))
    assert on.returncode == 0, on.stderr
    assert journal.read_text() == text
    assert here.prima("replay", str(journal), cwd=ROOT).returncode == 0


def test_a_scenario_that_a_host_has_answered_does_not_go_on(whole: Path) -> None:
    journal = whole.with_name("answered.jsonl")
    first = whole.read_text().splitlines(keepends=True)[0]
    fetched = {"time": 0.0, "phase": "fetched", "actor": "environment", "inbound": True}
    fetched |= {"app": "guide", "data": {"serial": 1, "uri": "http://localhost/", "host": True}}
    journal.write_text(first + json.dumps(fetched) + "\n")
    on = prima("live", "--resume", str(journal))
    assert on.returncode == 2
    assert "answered.jsonl:2: a host has answered this scenario's run" in on.stderr
    assert journal.read_text() == first + json.dumps(fetched) + "\n"


OWN = """
import asyncio, os, signal
from prima.live.driver import TaskDriver

class Own(TaskDriver):
    kind = "own"

    async def perform(self, goal):
        if not os.path.exists("stopped"):
            open("stopped", "w").close()
            os.kill(os.getpid(), signal.SIGINT)
            await asyncio.sleep(3600)
        return {}
"""


def test_a_run_on_a_driver_of_ones_own_goes_on_by_the_command_that_it_prints(
    tmp_path: Path,
) -> None:
    (tmp_path / "own.py").write_text(OWN)
    (tmp_path / "robot.xml").write_text(
        '<robot xmlns="urn:prima:robot:1" version="1.0" id="own"><device name="speaker"/>'
        '<driver kind="own"/></robot>'
    )
    (tmp_path / "hi.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="hi"><form id="a">'
        "<block><speak>Hi.</speak><speak>Bye.</speak><exit/></block></form></prima>"
    )
    words = ["--driver", "own.py", "--robot", "robot.xml", "--ea", "hi.xml", "-o", "visit.jsonl"]
    ran = here.prima("live", *words, cwd=tmp_path)
    told = "Stopped. Go on with: prima live "
    assert ran.returncode == 130 and told in ran.stderr, ran.stderr
    on = ran.stderr.splitlines()[-1].removeprefix(told).split()
    assert on == ["--resume", "visit.jsonl", "--driver", "own.py"]
    alone = here.prima("live", *on[:2], cwd=tmp_path)
    assert alone.returncode == 2 and "--driver names the file of one of your own" in alone.stderr
    ran = here.prima("live", *on, cwd=tmp_path)
    assert ran.returncode == 0 and '"Bye."' in ran.stdout, ran.stderr


def test_what_is_no_file_is_no_journal(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.jsonl")
    for path, what in (
        (tmp_path / "pipe.jsonl", "not a file"),
        ("/dev/zero", "not a file"),
        (tmp_path, "a folder. Name a file in it"),
    ):
        done = prima("live", "--resume", str(path))
        assert done.returncode == 2 and f"cannot be read: it is {what}." in done.stderr
