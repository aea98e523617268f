"""The driver ``rosbridge`` without roslibpy: its address, and what it says where the library lacks."""

from __future__ import annotations

import asyncio
import sys
from typing import Any

import pytest

from prima.devices.profile import read_robot
from prima.errors import UsageError
from prima.live.driver import Unreachable, Unusable
from prima.live.drivers.rosbridge import DRIVER
from prima.live.drivers.rosbridge.link import RosbridgeLink
from prima.live.ros import RosUse
from prima.sim.map import Map
from tests.live.test_mapped import ROBOT


def driver(address: str = "") -> Any:
    text = ROBOT.format("").replace('kind="mapped"', f'kind="rosbridge" address="{address}"')
    robot = read_robot("robot.xml", text.encode())
    return DRIVER(robot.drivers[0], robot, Map("m"))


def test_without_roslibpy_it_is_told_how_to_have_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "roslibpy", None)
    with pytest.raises(Unusable, match=r"pip install 'prima\[rosbridge\]'"):
        asyncio.run(driver().open())


@pytest.mark.parametrize(
    ("address", "url"),
    [
        ("", "ws://127.0.0.1:9090"),
        ("robot.local", "ws://robot.local:9090"),
        ("ws://robot.local:9999/bridge", "ws://robot.local:9999/bridge"),
        ("wss://robot.local", "wss://robot.local:443"),
    ],
)
def test_an_address_may_be_short(address: str, url: str) -> None:
    async def made() -> str:
        return str(driver(address).make_link()._url)

    assert asyncio.run(made()) == url


@pytest.mark.parametrize(
    "address", ["http://robot.local", "ws://", "ws://robot:port", "not an address"]
)
def test_a_wrong_address_is_told(address: str) -> None:
    with pytest.raises(UsageError, match='Write for example address="ws://'):
        asyncio.run(driver(address).open())


@pytest.mark.parametrize(
    ("answers", "told"),
    [(0, "ws://robot does not tell what is there"), (1, "the action /go .* is not there")],
)
def test_what_is_missing_is_told_although_the_last_answer_is_late(answers: int, told: str) -> None:
    """The time to open ends while the bridge is asked once more."""

    class Late(RosbridgeLink):
        asked = 0

        async def _missing(self) -> list[RosUse]:
            self.asked += 1
            await asyncio.sleep(0 if self.asked <= answers else 1000)
            return [RosUse("action", "/go", "my_robot/action/Go")]

    async def connect() -> None:
        link = Late("ws://robot", 0.3, 1.0)
        await link._await_all(asyncio.get_running_loop().time() + 0.3)

    with pytest.raises(Unreachable, match=told):
        asyncio.run(connect())
