"""Processes of a test against a second party: the party itself, and a driver in its environment."""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tools.environments import ROOT, python_of

DRIVEN = Path(__file__).parent / "driven.py"
LONGEST_S = 20.0
"""How long anything that is waited for may take."""
ROS_HOME = {
    # Those from 102 on have ports that the system gives to anybody.
    "ROS_DOMAIN_ID": str(20 + os.getpid() % 80),
    "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
}
"""A ROS domain of this process of tests, on this machine alone."""
Line = dict[str, Any]


class Process:
    """A process that tells what it does by lines of JSON."""

    def __init__(self, party: str, *command: str, **environment: str) -> None:
        known = {"PYTHONPATH": str(ROOT), "PYTHONUNBUFFERED": "1", **environment}
        self.process = subprocess.Popen(
            [str(python_of(party)), *command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **known},
            cwd=ROOT,
        )
        self.lines: list[Line] = []
        self.errors: list[str] = []
        self._queue: queue.Queue[Line] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()
        threading.Thread(target=self._read_errors, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith("{"):
                self._queue.put(json.loads(line))
            else:
                self.errors.append(line)

    def _read_errors(self) -> None:
        assert self.process.stderr is not None
        self.errors.extend(self.process.stderr)

    def expect(self, what: str, longest: float = LONGEST_S, **fields: object) -> Line:
        """The next line of a kind and with these fields; others before it are passed over."""

        def fits(line: Line) -> bool:
            return line["what"] == what and all(line.get(key) == fields[key] for key in fields)

        return self.until(fits, f"{what} {fields}", longest)

    def until(self, fits: Callable[[Line], bool], name: str, longest: float = LONGEST_S) -> Line:
        until = time.monotonic() + longest
        while True:
            try:
                line = self._queue.get(timeout=max(until - time.monotonic(), 0.001))
            except queue.Empty:
                told = "".join(self.errors[-20:])
                raise AssertionError(f"no {name}; before: {self.lines[-8:]}\n{told}") from None
            self.lines.append(line)
            if fits(line):
                return line

    def nothing(self, what: str, seconds: float) -> None:
        """See that for some time no line of a kind comes."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0:
            try:
                line = self._queue.get(timeout=left)
            except queue.Empty:
                return
            self.lines.append(line)
            assert line["what"] != what, line

    def write(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def freeze(self) -> None:
        """Let it hang."""
        self.process.send_signal(signal.SIGSTOP)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait(LONGEST_S)

    def end(self) -> int:
        """Let it end by itself; gives its exit code."""
        assert self.process.stdin is not None
        try:
            self.process.stdin.close()
            return self.process.wait(LONGEST_S)
        finally:
            self.kill()


class Driven(Process):
    """A driver in the environment of its party."""

    def __init__(self, party: str, robot: Path, **environment: str) -> None:
        super().__init__(party, str(DRIVEN), str(robot), **environment)
        self._count = 0

    def do(self, *what: object) -> None:
        self.write(json.dumps(what))

    def start(self, kind: str, text: str | None = None, **args: object) -> str:
        """Begin a goal; gives its key."""
        self._count += 1
        key = f"goal/{self._count}"
        self.do("start", key, kind, args, text)
        return key

    def cancel(self, key: str) -> float:
        """Cancel a goal; gives when (s)."""
        now = time.monotonic()
        self.do("cancel", key)
        return now


class Visit(Process):
    """``prima live`` with the applications of this folder, in the environment of a party."""

    def __init__(self, party: str, robot: Path, journal: Path, **environment: str) -> None:
        self.journal = journal
        here = Path(__file__).parent
        given = ("--robot", robot, "--fa", here / "fa.xml", "--ea", here / "ea.xml", "-o", journal)
        command = ("-m", "prima", "live", *(str(one) for one in given), "--until", "60s")
        super().__init__(party, *command, **environment)

    def until_printed(self, text: str) -> None:
        """Wait until it has printed something."""
        until = time.monotonic() + 2 * LONGEST_S
        while not any(text in line for line in self.errors):
            assert time.monotonic() < until, "".join(self.errors)
            time.sleep(0.05)

    def rows(self, code: int = 0) -> str:
        """What it printed, after it has come to its end; its journal replays to the same bytes."""
        assert self.process.wait(2 * LONGEST_S) == code, "".join(self.errors)
        again = self.journal.with_suffix(".again")
        command = [sys.executable, "-m", "prima", "replay", str(self.journal), "-o", str(again)]
        subprocess.run(command, check=True, capture_output=True, timeout=LONGEST_S, cwd=ROOT)
        assert again.read_bytes() == self.journal.read_bytes()
        return "".join(self.errors)

    def rows_of_lost_robot(
        self, robot: Process, again: Callable[[], Process], touch: str, **goes: Any
    ) -> str:
        """What it printed, where its robot is lost on the way, comes back and is touched."""
        back: Process | None = None
        try:
            robot.expect("goes", **goes)
            robot.kill()
            self.until_printed("the robot is lost")
            back = again()
            self.until_printed("the robot is back")
            back.write(touch)
            back.expect("says", text="Oh!")
            return self.rows(code=3)
        finally:
            self.kill()
            if back is not None:
                back.kill()


LOST_AND_BACK = (
    "Topological Move fails",
    "ends walk: error.device.",
    "Turn",
    "Oh!",
    "ends dodge: exit",
)
"""What a visit prints whose robot is lost on the way and comes back."""


def in_order(text: str, *parts: str) -> bool:
    """Whether a text has these parts one behind the other."""
    at = 0
    for part in parts:
        at = text.find(part, at)
        if at < 0:
            return False
    return True
