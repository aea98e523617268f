"""The driver ``naoqi`` without qi: its document, and what it says where the library lacks."""

from __future__ import annotations

import asyncio
import sys
from types import ModuleType
from typing import Any

import pytest

from prima.devices.goals import SAY
from prima.devices.profile import read_robot
from prima.errors import UsageError
from prima.live.driver import Unusable
from prima.live.drivers.naoqi import DRIVER, _said, _url
from prima.messages import Command
from prima.sim.map import Map
from tests.live.test_mapped import ROBOT, begin


def driver(inside: str = "") -> Any:
    text = ROBOT.format(inside).replace('kind="mapped"', 'kind="naoqi"')
    robot = read_robot("robot.xml", text.encode())
    return DRIVER(robot.drivers[0], robot, Map("m"))


def test_without_qi_it_is_told_how_to_have_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "qi", None)
    with pytest.raises(Unusable, match=r"pip install 'prima\[naoqi\]'"):
        asyncio.run(driver().open())


@pytest.mark.parametrize("by", ["", "say", "ALTextToSpeech.say.now"])
def test_a_method_is_named_with_its_service(by: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "qi", ModuleType("qi"))
    written = f'by="{by}"' if by else ""
    with pytest.raises(UsageError, match=r"robot.xml:4:\d+: naoqi: .* is not a service and its"):
        asyncio.run(driver(f'<does command="say" {written}/>').open())


def test_it_has_no_options(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "qi", ModuleType("qi"))
    with pytest.raises(UsageError, match=r'there is no option "port"\. Remove it'):
        asyncio.run(driver('<option name="port" value="1"/>').open())


@pytest.mark.parametrize(
    ("address", "url"),
    [
        ("", "tcp://127.0.0.1:9559"),
        ("nao.local", "tcp://nao.local:9559"),
        ("nao.local:9560", "tcp://nao.local:9560"),
        ("tcps://nao.local:9503", "tcps://nao.local:9503"),
    ],
)
def test_an_address_may_be_short(address: str, url: str) -> None:
    assert _url(address) == url


def test_languages_have_the_robots_names() -> None:
    goal = begin(SAY, "はい")
    japanese = Command("speak", {}, "はい", lang="ja-JP")
    assert driver().values(goal)["language"] == "English"
    object.__setattr__(goal, "command", japanese)
    assert driver().values(goal)["language"] == "Japanese"


def test_an_error_is_its_first_line() -> None:
    error = "RuntimeError: ALMotion::moveTo there is a wall\n\nAt:\n  robot.py(39): moveTo\n"
    assert _said(error) == "ALMotion::moveTo there is a wall"
    assert _said("") == "the robot has refused it"


@pytest.mark.parametrize("address", ["http://nao.local", "nao local", "nao:0", "nao:99999", "a/b"])
def test_what_is_no_address_is_a_wrong_setting(address: str) -> None:
    with pytest.raises(Unusable, match=r'Write for example address="tcp://nao\.local:9559"'):
        _url(address)
