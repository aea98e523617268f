"""Checks of the sensors that a document reads."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import loading
from tests.helpers.validating import mended_all

DOCUMENT = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a">{0}
  <form id="f">
    <watch name="seen" when="{1}"/>
    <block cond="{2}"><speak>Hi.</speak></block>
    <on event="seen"><exit/></on>
  </form>
</prima>
"""


def told(folder: Path, when: str, cond: str = "true", more: str = "") -> list[str]:
    path = folder / "a.xml"
    path.write_text(DOCUMENT.format(more, when, cond))
    return [f"{one.place.column} {one.message}" for one in loading.validate([path])]


NOT_YET = "sensor.{} has no value before the robot reports one: until then this is error.semantic."


@pytest.mark.parametrize(
    ("when", "problems", "right"),
    [
        (
            "sensor.human.visable",
            ['43 There is no "sensor.human.visable".'],
            "sensor.human.visible",
        ),
        (
            "sensor.position?.Y == 1",
            ['47 There is no "sensor.position.Y".'],
            "sensor.position?.y == 1",
        ),
        (
            "sensor.battery.level == 2",
            ["30 " + NOT_YET.format("battery")],
            "sensor.battery?.level == 2",
        ),
        (
            "sensor.human.visible &amp;&amp; sensor.arm.joint.angle == 1",
            ["62 " + NOT_YET.format("arm")],
            "sensor.human.visible &amp;&amp; sensor.arm?.joint.angle == 1",
        ),
        ("sensor.battery?.level == 2", [], ""),
        ("sensor.battery &amp;&amp; sensor.battery.level == 2", [], ""),
        ("sensor.light == 2", [], ""),
        ("sensor.human.mood == 2", [], ""),
        ("sensor.moving == sensor['arm'].angle", [], ""),
    ],
)
def test_what_a_watch_reads(tmp_path: Path, when: str, problems: list[str], right: str) -> None:
    assert told(tmp_path, when) == problems
    wanted = [DOCUMENT.format("", right, "true")] if problems else []
    assert mended_all(tmp_path / "a.xml") == wanted


def test_only_a_watch_is_surely_too_early(tmp_path: Path) -> None:
    assert told(tmp_path, "sensor.moving", "sensor.battery.level == 2") == []
    assert told(tmp_path, "sensor.moving", "sensor.human.distanse == 2") == [
        '31 There is no "sensor.human.distanse".'
    ]


def test_a_variable_of_that_name_is_another_thing(tmp_path: Path) -> None:
    own = """<var name="sensor" expr="{ battery: { level: 1 }, human: { visable: true } }"/>"""
    assert told(tmp_path, "sensor.battery.level == 2", "sensor.human.visable", own) == []
