"""The maker's daemon as a process, and a run that is a list of what a driver tells."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import httpx

from prima.devices.goals import Begin, Broke, Done, News, Report, Stopped
from prima.devices.profile import Profile, read_robot
from prima.live.drivers.reachy import DRIVER
from prima.messages import Command
from prima.sim.map import Map
from tools.environments import python_of

ROOT = Path(__file__).parents[3]
ROBOT = ROOT / "documents" / "robots" / "reachy-mini.xml"
START_S = 60
"""How long the daemon may take to start, MuJoCo included: 9 s on two quiet cores."""

One = TypeVar("One")


class Daemon:
    """One daemon with a robot in MuJoCo; ``home`` holds what it writes and its recorded moves."""

    def __init__(self, port: int, home: Path) -> None:
        self.port, self.home = port, home
        self.address = f"http://127.0.0.1:{port}"
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it, and wait until its robot runs.

        Raises:
            AssertionError: it does not start; with what it has said.
        """
        script = python_of("reachy").parent / "reachy-mini-daemon"
        options = ("--sim", "--headless", "--no-media", "--dataset-update-interval", "0")
        offline = {"HOME": str(self.home), "HF_HOME": str(self.home), "HF_HUB_OFFLINE": "1"}
        said = self.home / "said.txt"
        with said.open("ab") as out:
            self._process = subprocess.Popen(
                [str(script), *options, "--fastapi-port", str(self.port)],
                env={**os.environ, **offline},
                stdout=out,
                stderr=out,
                start_new_session=True,
            )
        end = time.monotonic() + START_S
        while not self._runs():
            assert self._process.poll() is None and time.monotonic() < end, said.read_text()
            time.sleep(0.2)

    def _runs(self) -> bool:
        try:
            return bool(self.get("/api/daemon/status")["state"] == "running")
        except httpx.HTTPError:
            return False

    def get(self, path: str) -> Any:
        """Ask it by itself, past the driver."""
        return httpx.get(self.address + path, timeout=5, trust_env=False).json()

    def body(self) -> float:
        """Where the body is, in radians."""
        return float(self.get("/api/state/full")["body_yaw"])

    def send(self, number: int) -> None:
        """Send it, and all that it has started, a signal."""
        if self._process is not None:
            os.killpg(self._process.pid, number)

    def kill(self) -> None:
        """End it at once."""
        if self._process is not None:
            self.send(signal.SIGKILL)
            self._process.wait(10)
            self._process = None


@contextmanager
def daemon(home: Path) -> Iterator[Daemon]:
    """A running daemon on a free port, which is killed in the end."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    one = Daemon(port, home)
    try:
        one.start()
        yield one
    finally:
        one.kill()


class Run:
    """A driver, and what it has told."""

    def __init__(self, address: str, more: str = "") -> None:
        self.profile = profile(address, more)
        self.driver = DRIVER(self.profile.drivers[0], self.profile, Map("nowhere"))
        self.told: list[Report | News] = []
        self.driver.attach(self.told.append)
        self._keys = 0

    def begin(self, kind: str, **args: Any) -> str:
        """Begin a goal; gives its key."""
        self._keys += 1
        key, names = (
            f"goal/{self._keys}",
            {"gesture": "neck arm", "move-head": "neck", "point-by-hand": "arm"},
        )
        devices = frozenset(names.get(kind, "locomotion").split())
        given = {name.replace("_", "-"): value for name, value in args.items()}
        self.driver.start(Begin(key, kind, Command(kind, given), devices))
        return key

    def end_of(self, key: str) -> Report | None:
        """How a goal has ended, if it has."""
        ends = (one for one in self.told if isinstance(one, Done | Stopped | Broke))
        return next((one for one in ends if one.key == key), None)

    async def end(self, key: str, within: float = 15.0) -> Report:
        """Wait for the end of a goal."""
        return await until(lambda: self.end_of(key), within)

    async def do(self, kind: str, **args: Any) -> Report:
        """Begin a goal, and wait for its end."""
        return await self.end(self.begin(kind, **args))


async def until(seen: Callable[[], One | None], within: float = 15.0) -> One:
    """Wait for something to be there, in s at most."""
    async with asyncio.timeout(within):
        while not (found := seen()):
            await asyncio.sleep(0.01)
        return found


def profile(address: str, more: str = "") -> Profile:
    """The shipped robot, with another address and more in its driver, in place of gestures of the same name."""
    written = ROBOT.read_text(encoding="utf-8").replace("http://127.0.0.1:8000", address)
    for gesture in re.findall('<does gesture="(.+?)"', more):
        written = re.sub(f'<does gesture="{gesture}".*?</does>', "", written, flags=re.DOTALL)
    return read_robot(str(ROBOT), written.replace("<place ", f"{more}<place ", 1).encode())
