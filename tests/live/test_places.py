"""Places of a robot's own map: the site's map need not have them."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.live.chosen import Chosen
from tests.helpers.voice import vxml

ROBOT = """<robot xmlns="urn:prima:robot:1" version="1.0" id="r">
  <device name="speaker"/><device name="locomotion"/><device name="localization"/>
  <driver kind="sim"><place name="library" x="12.4" y="3.1"/></driver>
</robot>
"""
NATIVE = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f">
<block><topological-move to="{place}"/><exit/></block></form></prima>
"""
MOVE = '<p:topological-move xmlns:p="urn:prima:dialogue:1" to="{place}"/>'
VOICE = vxml(f"<form><block>{MOVE}</block></form>")


@pytest.mark.parametrize(("name", "text"), [("a.xml", NATIVE), ("a.vxml", VOICE)])
def test_a_place_of_the_robots_own_map_is_there(tmp_path: Path, name: str, text: str) -> None:
    robot, application = tmp_path / "robot.xml", tmp_path / name
    robot.write_text(ROBOT)
    for place, told in (("library", []), ("librery", ["librery"])):
        application.write_text(text.replace("{place}", place))
        loaded = Chosen(robot=str(robot), eas=(str(application),)).loaded()
        assert [one.get("name") for one in loaded.problems] == told
