"""What a page says of who speaks, and to what a row reacts, where there are several persons."""

from __future__ import annotations

import re
from html import unescape
from pathlib import Path

from prima import api
from prima.report import make
from tests import ROOT
from tests.report.test_report import data_of

DOCUMENTS = ROOT / "documents"


def two_visitors(folder: Path, application: str, script: str) -> api.Transcript:
    """The run of a scenario with the persons ann and ben."""
    (folder / "app.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="app" xml:lang="en">'
        f'<form id="all">{application}</form></prima>'
    )
    file = folder / "two.xml"
    file.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="two"'
        f' world="{DOCUMENTS}/worlds/room.xml" robot="{DOCUMENTS}/robots/papero.xml">'
        '<robot at="middle"/><person id="ann" x="1" y="0"/><person id="ben" x="1" y="1"/>'
        f'<application src="app.xml"/>{script}</scenario>'
    )
    return api.rehearse(file)


def test_of_several_persons_only_the_words_carry_a_language(tmp_path: Path) -> None:
    question = '<field name="who"><grammar>ann</grammar><prompt>Who?</prompt></field>'
    said = (
        '<when at="2s" person="ann"><say>ann</say></when>'
        '<when at="3s" person="ben"><say confidence="0.4">ben</say></when>'
    )
    page = make([two_visitors(tmp_path, question, said)])
    cells = re.findall('<td[^>]*>([^<]*)<bdi lang="en">([^<]*)</bdi>([^<]*)', unescape(page))
    assert cells[1:] == [('ann: "', "ann", '"'), ('ben: "', "ben", '" (confidence 0.4)')]
    rows = [row for row in data_of(page)["runs"][0]["rows"] if len(row) > 5]
    places = [row[3][row[6] - 1 : row[6] + row[7] + 1] for row in rows]
    assert places == ['"Who?"', '"ann"', '"ben"']


def test_of_touches_in_one_instant_a_row_names_its_own(tmp_path: Path) -> None:
    handler = (
        '<block/><on event="touch" cond="event.data.person == \'ben\'"><speak>Ben!</speak></on>'
    )
    touches = "".join(
        f'<when at="2s" person="{who}"><touch sensor="head"/></when>' for who in ("ann", "ben")
    )
    transcript = two_visitors(tmp_path, handler, touches)
    whys = data_of(make([transcript]))["runs"][0]["whys"]
    said = next(row for row in transcript.rows() if row.kind == "speak")
    assert transcript.rows()[whys[said.number]["cause"]].what == "ben touches the robot's head"
