"""What one application may do to another: who says which is which, and what reaches whom."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.errors import DocumentError, Problem

DEMO = api.documents_folder()


def app(name: str, body: str, kind: str = "ea") -> str:
    """An application in PRIMA's own language."""
    head = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{name}">'
    return f"{head}{body}</prima>"


def staged(folder: Path, content: str, attributes: str = "", **documents: str) -> Path:
    """A scenario in an empty room; applications stand in it by their names."""
    for name, text in documents.items():
        (folder / f"{name}.xml").write_text(text)
    robot = (DEMO / "robots" / "papero.xml").read_text()
    allows = '<allows command="face-human-and-speak" argument="volume"/></robot>'
    (folder / "robot.xml").write_text(robot.replace("</robot>", allows))
    path = folder / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{DEMO}/worlds/room.xml" robot="robot.xml" {attributes}>'
        f'<robot at="middle"/><person x="1" y="0"/>{content}</scenario>'
    )
    return path


def problems_of(path: Path) -> list[Problem]:
    """What loading a scenario finds, whether or not it can be run."""
    try:
        return api.load_scenario(path).problems
    except DocumentError as error:
        return error.problems


def whats(transcript: api.Transcript) -> list[str]:
    return [row.what for row in transcript.rows()]


# Of which kind an application is ------------------------------------------------------

LOUD = app(
    "loud",
    '<form id="f"><block><face-human-and-speak>Here.<param name="volume" value="loud"/>'
    "</face-human-and-speak><exit/></block></form>",
    "fa",
)
"""An application that says of itself that it is the robot's own."""


@pytest.mark.parametrize(
    ("said", "kind", "told"),
    [
        ("", "ea", "but this scenario does not say so: it runs as an EA."),
        ('kind="ea"', "ea", "but this scenario says EA: it runs as an EA."),
        ('kind="fa"', "fa", ""),
    ],
)
def test_no_document_makes_itself_an_fa(tmp_path: Path, said: str, kind: str, told: str) -> None:
    path = staged(tmp_path, f'<application src="loud.xml" {said}/>', loud=LOUD)
    loaded = api.load_scenario(path)
    assert [one.code for one in loaded.problems if told in one.message] == ["other-kind"] * bool(
        told
    )
    records = api.rehearse(loaded).records
    assert [one["data"]["kind"] for one in records if one["phase"] == "load" and "data" in one] == [
        kind
    ]
    refused = [one["rule"] for one in records if one["phase"] == "fail"]
    assert refused == (["E3"] if kind == "ea" else [])


def test_a_document_is_an_fa_where_the_scenario_says_so(tmp_path: Path) -> None:
    calm = app("calm", '<form id="f"><block><speak>Here.</speak><exit/></block></form>')
    path = staged(tmp_path, '<application src="calm.xml" kind="fa"/>', calm=calm)
    loaded = api.load_scenario(path)
    assert "says that it is an EA, but this scenario says FA" in loaded.problems[0].message
    assert loaded.cast.documents[0].kind == "fa"
    # Whoever else runs the same document runs it as that says.
    assert api.load(tmp_path / "calm.xml").kind == "ea"


def test_what_a_place_offers_is_an_ea(tmp_path: Path) -> None:
    world = (DEMO / "worlds" / "room.xml").read_text()
    offer = '<area id="shop" application="loud.xml" x1="-1" y1="-1" x2="1" y2="1"/></world>'
    path = staged(tmp_path, "", 'entrances="open"', loud=LOUD)
    (tmp_path / "world.xml").write_text(world.replace("</world>", offer))
    path.write_text(path.read_text().replace(f"{DEMO}/worlds/room.xml", "world.xml"))
    loaded = api.load_scenario(path)
    assert "but a place offers EAs: it runs as an EA" in loaded.problems[0].message
    assert "Only an FA may give" in " ".join(whats(api.rehearse(loaded)))
