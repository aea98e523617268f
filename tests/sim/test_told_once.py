"""What a mistake leaves without a name or an end is not told a second time."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.errors import DocumentError
from prima.sim.map import read_world
from tests import ROOT

WORLD = (
    '<world xmlns="urn:prima:world:1" version="1.0" id="w"><place id="a" x="0" y="0"/>{}</world>'
)
SCENARIO = (
    '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml"'
    f' robot="{ROOT}/documents/robots/papero.xml"><robot at="{{}}"/><person x="1" y="0"/>'
    '<application src="a.xml" kind="fa"/></scenario>'
)


def test_a_wall_without_its_other_end_has_no_length_of_its_own() -> None:
    with pytest.raises(DocumentError) as error:
        read_world("w.xml", WORLD.format('<wall x1="0" y1="0"/>').encode())
    assert [one.code for one in error.value.problems] == ["missing-attribute"] * 2


@pytest.mark.parametrize(
    "content", ['<command name="glow"/>', '<speak>Hi.<param volume="low"/></speak>']
)
def test_a_name_that_is_missing_is_looked_up_nowhere(tmp_path: Path, content: str) -> None:
    (tmp_path / "w.xml").write_text(WORLD.format(""))
    (tmp_path / "s.xml").write_text(SCENARIO.format("a"))
    (tmp_path / "a.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="a" xml:lang="en">'
        f'<form id="f"><block>{content}<exit/></block></form></prima>'
    )
    found = api.validate(tmp_path / "s.xml")
    assert {one.code for one in found} <= {"unknown-attribute", "missing-attribute"}
    assert not any('""' in one.message for one in found)


def test_a_name_that_no_place_may_have_is_not_suggested() -> None:
    content = '<place id="the maps" x="1" y="0"/><way from="a" to="maps"/>'
    with pytest.raises(DocumentError) as error:
        read_world("w.xml", WORLD.format(content).encode())
    remedies = [one.remedy for one in error.value.problems if one.code == "no-such-name"]
    assert remedies == ["There is a."]
