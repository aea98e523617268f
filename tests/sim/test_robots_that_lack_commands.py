"""Warnings of Commands, questions and texts that a robot cannot carry out."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from tests import ROOT

SCENARIO = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" robot="robot.xml"'
    f' world="{ROOT}/documents/worlds/room.xml"><robot at="middle"/><person x="1" y="0"/>'
    '<application src="{}"/></scenario>'
)


@pytest.mark.parametrize(
    ("device", "handler", "told"),
    [
        ("speech-recognition", "", []),
        ("arm", "", ["it lacks speech-recognition", "So it is at 1 more place."]),
        ("arm", '<on event="error.unsupported"><exit/></on>', ["it lacks speech-recognition"]),
    ],
)
def test_a_robot_that_hears_nothing_cannot_ask(
    tmp_path: Path, device: str, handler: str, told: list[str]
) -> None:
    (tmp_path / "robot.xml").write_text(
        '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"><device name="speaker"/>'
        f'<device name="{device}"/></robot>'
    )
    ask = "<field name='{}'><prompt>Tea?</prompt><option>yes</option><noinput><exit/></noinput></field>"
    (tmp_path / "a.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a" xml:lang="en">'
        f'<form id="f">{handler}{ask.format("one")}{ask.format("two")}</form></prima>'
    )
    (tmp_path / "s.xml").write_text(SCENARIO.format("a.xml"))
    found = [one for one in api.validate(tmp_path / "s.xml") if one.code == "unsupported-command"]
    assert [one.severity for one in found] == ["warning"] * bool(told)
    whole = "".join(f"{one.message} {one.remedy}" for one in found)
    assert all(words in whole for words in told)
    assert ("Handle it" in whole) == (bool(told) and not handler)


POINT = "This robot cannot do point-by-hand: it lacks arm. At run time it is error.unsupported.point-by-hand."
ASK = "This robot cannot do q-and-a: it lacks speech-recognition. At run time it is error.unsupported.q-and-a."
DEAF = ASK.replace("lacks ", "lacks speaker, ")
SAY = "This robot cannot do speak: it lacks speaker. At run time it is error.unsupported.speak."


@pytest.mark.parametrize(
    ("devices", "handler", "told"),
    [
        ("speaker speech-recognition arm", "", []),
        ("speaker speech-recognition", "", [f'{POINT} <catch event="error.unsupported.point-by-hand">.']),
        ("speaker arm", "", [f'{ASK} <catch event="error.unsupported.q-and-a">. So it is at 1 more place.']),
        ("speaker arm", "<catch event='error.unsupported'><exit/></catch>", [f"{ASK} So it is at 1 more place."]),
        ("speaker arm", "<error><exit/></error>", [f"{ASK} So it is at 1 more place."]),
        ("speaker arm", "<catch><exit/></catch>", [f"{ASK} So it is at 1 more place."]),
        ("arm", "<catch><exit/></catch>", [SAY, f"{DEAF} So it is at 1 more place."]),
    ],
)  # fmt: skip
def test_commands_of_voicexml_that_a_robot_lacks_are_told(
    tmp_path: Path, devices: str, handler: str, told: list[str]
) -> None:
    listed = "".join(f'<device name="{one}"/>' for one in devices.split())
    (tmp_path / "robot.xml").write_text(
        f'<robot xmlns="urn:prima:robot:1" version="1.0" id="r">{listed}</robot>'
    )
    (tmp_path / "a.vxml").write_text(
        '<vxml xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1" version="2.1"'
        f' xml:lang="en">{handler}<form><block>Hello. <p:point-by-hand toward="door"/></block>'
        '<field name="one"><option>a</option></field></form>'
        '<menu><choice event="exit">b</choice></menu></vxml>'
    )
    (tmp_path / "s.xml").write_text(SCENARIO.format("a.vxml"))
    found = [one for one in api.validate(tmp_path / "s.xml") if one.code == "unsupported-command"]
    whole = [f"{one.message} {one.remedy}".replace("Handle it: ", "").strip() for one in found]
    assert whole == told
