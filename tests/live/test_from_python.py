"""``prima.run_live``: as ``prima live``, from Python."""

from __future__ import annotations

import asyncio
import errno
import os
import re
import signal
import threading
import time
from pathlib import Path

import pytest

import prima
from prima.errors import DocumentError, RunError, UsageError
from prima.live.driver import Unreachable
from prima.live.visit import Visit
from tests.live.test_live import BROKEN_DRIVER, HELLO, ROBOT, ROOT, WAITS, robot_with
from tests.live.test_live import prima as command

ROBOT_PATH = ROOT / ROBOT
SCENARIO = ROOT / "documents" / "scenarios" / "touched-on-the-way.xml"


@pytest.fixture
def hello(tmp_path: Path) -> Path:
    path = tmp_path / "hello.xml"
    path.write_text(HELLO)
    return path


def test_the_example_of_the_docs_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (ROOT / "docs" / "live.md").read_text()
    section = page.partition("## From Python")[2]
    (code,) = re.findall(r"^```python\n(.*?)^```$", section, re.M | re.S)[:1]
    (tmp_path / "documents").symlink_to(ROOT / "documents")
    (tmp_path / "hello.xml").write_text(HELLO)
    monkeypatch.chdir(tmp_path)
    found: dict[str, object] = {}
    exec(code, found)
    visit = found["visit"]
    assert isinstance(visit, prima.Transcript)
    assert visit.outcome == "over"
    assert visit.dumps() == (tmp_path / "from-python.jsonl").read_text()
    assert prima.replay(visit).dumps() == visit.dumps()


def test_a_disk_that_is_full_at_the_start_leaves_no_journal(
    hello: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = os.write

    def until_full(file: int, data: bytes) -> int:
        if os.fstat(file).st_size:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return write(file, data[:500])

    journal = tmp_path / "visit.jsonl"
    with monkeypatch.context() as full, pytest.raises(RunError, match="No space left"):
        full.setattr("os.write", until_full)
        prima.run_live(robot=ROBOT_PATH, eas=hello, output=journal)
    visit = prima.run_live(robot=ROBOT_PATH, eas=hello, output=journal, speed=50)
    assert visit.outcome == "over"


def test_it_gives_what_the_command_line_gives(tmp_path: Path) -> None:
    journal, lines = tmp_path / "visit.jsonl", list[str]()
    visit = prima.run_live(SCENARIO, speed=1000, output=tmp_path / "own.jsonl", sink=lines.append)
    ran = command("live", str(SCENARIO), "--speed", "1000", "-o", str(journal))
    assert ran.returncode == 0, ran.stderr
    own = (tmp_path / "own.jsonl").read_text()
    assert own == journal.read_text() == visit.dumps() == "".join(lines)
    assert not prima.run_live(SCENARIO, speed=1000, keep=False).records


def test_a_run_goes_on(hello: Path, tmp_path: Path) -> None:
    journal = tmp_path / "visit.jsonl"
    whole = prima.run_live(robot=ROBOT_PATH, eas=[hello], speed=100, output=journal)
    journal.write_text("".join(journal.read_text().splitlines(keepends=True)[:8]))
    visit = prima.run_live(resume=journal, speed=100)
    assert visit.outcome == "over"
    assert visit.records[:8] == whole.records[:8]
    assert visit.dumps() == journal.read_text()
    assert prima.replay(visit).dumps() == visit.dumps()


def test_an_event_loop_may_run_already(hello: Path) -> None:
    async def notebook() -> prima.Transcript:
        return prima.run_live(robot=ROBOT_PATH, eas=[hello], speed=100)

    assert asyncio.run(notebook()).outcome == "over"


@pytest.mark.parametrize("inside", [False, True])
def test_an_interrupt_makes_the_robot_safe_and_is_raised(inside: bool, tmp_path: Path) -> None:
    (tmp_path / "waits.xml").write_text(WAITS)
    journal = tmp_path / "visit.jsonl"

    def interrupt() -> None:
        limit = time.monotonic() + 30
        while not (journal.exists() and journal.stat().st_size) and time.monotonic() < limit:
            time.sleep(0.02)
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    def run() -> None:
        prima.run_live(robot=ROBOT_PATH, eas=[tmp_path / "waits.xml"], output=journal)

    async def notebook() -> None:
        asyncio.get_running_loop().add_signal_handler(signal.SIGINT, lambda: None)
        asyncio.get_running_loop().remove_signal_handler(signal.SIGINT)
        run()

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Thread(target=interrupt, daemon=True).start()
    try:
        with pytest.raises(KeyboardInterrupt):
            asyncio.run(notebook()) if inside else run()
    finally:
        signal.signal(signal.SIGINT, before)
    assert prima.run_live(resume=journal, speed=100, until=20_000).outcome == "quiet"


def test_an_interrupt_while_the_thread_begins_ends_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "waits.xml").write_text(WAITS)
    journal = tmp_path / "visit.jsonl"
    start = threading.Thread.start

    def interrupted(thread: threading.Thread) -> None:
        start(thread)
        while not (journal.exists() and journal.stat().st_size):
            time.sleep(0.01)
        signal.raise_signal(signal.SIGINT)

    async def notebook() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        with monkeypatch.context() as slow:
            slow.setattr("threading.Thread.start", interrupted)
            prima.run_live(robot=ROBOT_PATH, eas=[tmp_path / "waits.xml"], output=journal)

    before = signal.getsignal(signal.SIGINT)
    try:
        with pytest.raises(KeyboardInterrupt):
            asyncio.run(notebook())
    finally:
        signal.signal(signal.SIGINT, before)
    assert prima.run_live(resume=journal, speed=100, until=20_000).outcome == "quiet"


def test_a_blocked_run_is_left_by_further_interrupts(
    hello: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    unblocked, left = threading.Event(), threading.Event()
    ended: list[bool] = []
    monkeypatch.setattr(Visit, "run", lambda *_: ended.append(unblocked.wait(20)))

    def interrupt() -> None:
        while not left.wait(0.1):
            signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)

    async def notebook() -> None:
        prima.run_live(robot=ROBOT_PATH, eas=[hello])

    before = signal.signal(signal.SIGINT, lambda *_: None)
    sender = threading.Thread(target=interrupt)
    sender.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            asyncio.run(notebook())
        assert not ended
    finally:
        left.set()
        unblocked.set()
        sender.join()
        signal.signal(signal.SIGINT, before)


def test_an_exception_of_the_sink_ends_the_run(hello: Path) -> None:
    def full(line: str) -> None:
        raise OSError("no room")

    with pytest.raises(OSError, match="no room"):
        prima.run_live(robot=ROBOT_PATH, eas=[hello], sink=full)


def test_what_is_wrong_is_raised_as_the_command_line_tells_it(hello: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="Name applications with"):
        prima.run_live(robot=ROBOT_PATH)
    with pytest.raises(UsageError, match="Name the robot with --robot"):
        prima.run_live(eas=[hello])
    with pytest.raises(UsageError, match="leave out the rest"):
        prima.run_live(SCENARIO, resume=tmp_path / "visit.jsonl")
    with pytest.raises(UsageError, match="The speed is 0"):
        prima.run_live(SCENARIO, speed=0)
    with pytest.raises(UsageError, match=r"none\.xml: cannot be read"):
        prima.run_live(robot=tmp_path / "none.xml", eas=[hello])
    with pytest.raises(UsageError, match='There is no driver of the kind "sims"'):
        prima.run_live(robot=robot_with(tmp_path, '<driver kind="sims"/>'), eas=[hello])
    hello.write_text(HELLO.replace("turn", "tunr"))
    with pytest.raises(DocumentError, match="tunr"):
        prima.run_live(robot=ROBOT_PATH, eas=[hello])
    hello.write_text(HELLO)
    (tmp_path / "drivers.py").write_text(BROKEN_DRIVER)
    with pytest.raises(Unreachable, match="start the daemon") as error:
        prima.run_live(
            robot=robot_with(tmp_path, '<driver kind="away"/>'),
            eas=[hello],
            drivers=[tmp_path / "drivers.py"],
        )
    assert isinstance(error.value, RunError)
    (tmp_path / "beside.py").write_text(BROKEN_DRIVER)
    (tmp_path / "mine.py").write_text("from beside import *\n")
    with pytest.raises(Unreachable, match="start the daemon"):
        prima.run_live(
            robot=robot_with(tmp_path, '<driver kind="away"/>'),
            eas=[hello],
            drivers=[tmp_path / "mine.py"],
        )
    (tmp_path / "there.jsonl").write_text("kept\n")
    with pytest.raises(UsageError, match="there is a journal already"):
        prima.run_live(robot=ROBOT_PATH, eas=[hello], output=tmp_path / "there.jsonl")
    (tmp_path / "there.jsonl").write_text("")  # as of a run that was stopped before its first line
    prima.run_live(robot=ROBOT_PATH, eas=[hello], output=tmp_path / "there.jsonl", speed=50)
    assert (tmp_path / "there.jsonl").read_text().startswith("{")
