"""One driver without a run, in the environment of its party: told by lines, it tells by lines.

``python tests/parties/driven.py ROBOT.xml``
"""

from __future__ import annotations

import asyncio
import dataclasses
import importlib
import json
import sys
import time
from pathlib import Path
from typing import Any

from prima.devices.goals import Begin, Lost
from prima.devices.profile import read_robot
from prima.live.driver import Driver, Unreachable
from prima.messages import Command
from prima.sim.map import Map

AGAIN_S = 0.3


def tell(what: object, **more: object) -> None:
    fields: dict[str, Any] = {}
    if dataclasses.is_dataclass(what) and not isinstance(what, type):
        fields = dataclasses.asdict(what)
    name = what if isinstance(what, str) else type(what).__name__
    line = {"what": name, "at": time.monotonic(), **fields, **more}
    print(json.dumps(line, default=list), flush=True)


class Driven:
    def __init__(self, robot: str) -> None:
        self.profile = read_robot(robot, Path(robot).read_bytes())
        settings = self.profile.drivers[0]
        module = importlib.import_module(f"prima.live.drivers.{settings.kind}")
        self.driver: Driver = module.DRIVER(settings, self.profile, Map("nowhere"))
        self.tasks: set[asyncio.Task[None]] = set()
        self.lost = False

    async def run(self) -> None:
        self.driver.attach(self.told)
        began = time.monotonic()
        try:
            async with asyncio.timeout(self.driver.settings.open / 1000):
                await self.driver.open()
        except Exception as error:
            tell("closed", error=str(error), after=time.monotonic() - began)
            await self.driver.close()
            return
        tell("open", after=time.monotonic() - began)
        self.spawn(self.watch())
        lines = asyncio.StreamReader()
        loop = asyncio.get_running_loop()
        await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(lines), sys.stdin)
        while line := await lines.readline():
            self.do(*json.loads(line))
        for task in self.tasks:
            task.cancel()
        await self.driver.safe()
        await self.driver.close()
        tell("end")

    def told(self, what: object) -> None:
        tell(what)
        if isinstance(what, Lost) and not self.lost:
            self.lost = True
            self.spawn(self.find())

    def do(self, what: str, *given: Any) -> None:
        if what == "start":
            key, kind, args, text = given
            command = Command("speak" if kind in ("say", "listen") else kind, args, text, lang="en")
            row = self.profile.commands.get(kind)
            devices = row.devices if row is not None else frozenset({"speaker"})
            self.driver.start(Begin(key, kind, command, devices))
        elif what == "cancel":
            self.driver.cancel(*given)
        elif what == "stand":
            self.driver.stand()
        elif what == "safe":
            self.spawn(self.driver.safe())

    def spawn(self, what: Any) -> None:
        task = asyncio.ensure_future(what)
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)

    async def find(self) -> None:
        await self.driver.safe()
        while self.lost:
            await asyncio.sleep(AGAIN_S)
            try:
                async with asyncio.timeout(self.driver.settings.open / 1000):
                    await self.driver.open()
                self.lost = False
            except (Unreachable, TimeoutError):
                continue
        tell("Back")

    async def watch(self) -> None:
        seconds = self.driver.settings.heartbeat / 1000
        while True:
            await asyncio.sleep(seconds)
            if self.lost:
                continue
            try:
                async with asyncio.timeout(seconds):
                    await self.driver.ping()
            except (Unreachable, TimeoutError) as error:
                self.driver.lose(str(error) or "the robot does not answer")


if __name__ == "__main__":
    asyncio.run(Driven(sys.argv[1]).run())
