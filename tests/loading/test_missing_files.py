"""Documents that name very many files which are not there."""

from __future__ import annotations

from pathlib import Path
from time import thread_time

import pytest

from prima import api
from prima.errors import DocumentError, UsageError
from prima.markup.limits import LIMITS
from tests import ROOT

SCENARIO = ROOT / "documents" / "scenarios" / "touched-on-the-way.xml"
MANY, BESIDE = 3_000, 200


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for number in range(BESIDE):
        (tmp_path / f"number-{number}.grxml").write_text("")
    return tmp_path


def listed(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The folders that are listed from now on."""
    found: list[Path] = []
    plain = Path.iterdir

    def iterdir(self: Path) -> object:
        found.append(self)
        return plain(self)

    monkeypatch.setattr(Path, "iterdir", iterdir)
    return found


def test_a_folder_is_listed_once_for_all_grammars_that_are_not_there(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fields = "".join(
        f'<field name="a{number}"><grammar src="nunber-{number}.grxml"/></field>\n'
        for number in range(BESIDE, MANY)
    )
    path = folder / "page.vxml"
    path.write_text(
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="en">'
        f"<form>{fields}</form></vxml>"
    )
    folders = listed(monkeypatch)
    began = thread_time()
    found = [one for one in api.validate([path]) if one.code == "no-such-file"]
    assert thread_time() - began < 5, "half a second on a quiet machine"
    assert len(folders) == 1
    assert len(found) == LIMITS.problems
    assert "number-" in found[0].remedy


def test_a_folder_is_listed_once_for_all_applications_that_are_not_there(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    named = "".join(f'<application src="nunber-{one}.xml" id="a{one}"/>' for one in range(300))
    (folder / "room.xml").write_text("")
    path = folder / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="no-room.xml">'
        f'<robot at="x"/><person x="1" y="0"/>{named}</scenario>'
    )
    folders = listed(monkeypatch)
    found = api.validate([path])
    assert len([one for one in found if "nunber-" in one.message]) == 300
    assert folders == [folder]


def test_a_wrong_robot_beside_a_scenario_is_told_in_its_own_place(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"nix\.xml: cannot be read: No such file"):
        api.load_scenario(SCENARIO, robot=str(tmp_path / "nix.xml"))
    world = str(ROOT / "documents" / "worlds" / "office.xml")
    with pytest.raises(DocumentError) as caught:
        api.load_scenario(SCENARIO, robot=world)
    (problem,) = caught.value.problems
    assert problem.place.file == world
    assert problem.message == "This is a world; a robot is needed here."


def test_no_folder_is_meant_by_the_name_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "robots").mkdir()
    path = tmp_path / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" robot="robot.xml"/>'
    )
    (problem,) = [one for one in api.validate([path]) if "robot.xml" in one.message]
    assert "robots" not in problem.remedy and not problem.fixes
