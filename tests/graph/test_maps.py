"""Maps of worlds."""

from __future__ import annotations

import json
from collections import Counter
from itertools import combinations
from pathlib import Path

import pytest
from lxml import etree

from prima import api
from prima.graph import picture, run, treepicture
from prima.graph.svg import measure
from prima.transcript.colours import colours
from tests import ROOT
from tests.helpers.graphs import SVG, prima, read_dot, transcript


def test_all_scenarios_can_be_drawn() -> None:
    for path in sorted((ROOT / "documents/scenarios").glob("*.xml")):
        told = api.rehearse(path).run()
        for moment in (told.entries[len(told.entries) // 2].time, run.NEVER):
            graph = run.trees(told, moment)
            made = treepicture.draw(graph)
            etree.fromstring(made.encode())


WORLD = '<world xmlns="urn:prima:world:1" version="1.0" id="w">{}</world>'
WORLDS = sorted((ROOT / "documents/worlds").iterdir())


def test_a_map_shows_all_that_a_world_has() -> None:
    path = ROOT / "documents/worlds/office.xml"
    root = etree.fromstring(picture(path).encode())
    counts = Counter(str(one.get("class")) for one in root.iter(f"{SVG}circle", f"{SVG}path"))
    assert counts["place"] == 5 + 1, "and one in the legend"
    assert (counts["way"], counts["wall"], counts["corner"]) == (4 + 1, 8 + 1, 1 + 1)
    assert len([one for one in root.iter(f"{SVG}rect") if one.get("class") == "thing"]) == 1 + 1
    written = {one.text for one in root.iter(f"{SVG}text")}
    names = {"entrance", "hall", "crossing", "kidode-room", "lab", "poster", "crossing-corner"}
    assert names | {"the office", "1 m"} <= written
    told = root.findtext(f"{SVG}desc") or ""
    for words in (
        "entrance to hall",
        "poster at 5.9, 4",
        "crossing-corner within 0.8 m",
        "8 walls",
    ):
        assert words in told


def test_an_area_has_the_colour_of_its_application() -> None:
    shade = colours(transcript("scenarios/follow-during-navigation.xml").run().apps)["navigate"]
    assert f'class="s{shade} area"' in picture(ROOT / "documents/worlds/office.xml")


@pytest.mark.parametrize("path", WORLDS, ids=lambda path: path.stem)
def test_no_name_of_a_map_lies_on_another(path: Path) -> None:
    root = etree.fromstring(picture(path).encode())
    found = []
    for one in root.iter(f"{SVG}text"):
        wide = measure(one.text or "", *((13, True) if one.get("class") == "name" else ()))
        x, y = float(one.get("x", "")), float(one.get("y", ""))
        found.append((x, y - 9, x + wide, y + 2, one.text))
    for a, b in combinations(found, 2):
        apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
        assert apart, (a, b)
    assert all(x >= 0 and right <= float(root.get("width", "")) for x, _, right, _, _ in found)


def test_a_map_in_all_formats() -> None:
    path = ROOT / "documents/worlds/office.xml"
    made = json.loads(picture(path, "json", "map"))
    assert made["places"][0] == {"id": "entrance", "x": 0.0, "y": 0.0}
    assert made["corners"][0]["radius"] == 0.8 and made["areas"][0]["title"] == "the office"
    read = read_dot(picture(path, "dot"))
    assert read.get_type() == "graph" and len(read.get_edges()) == len(made["ways"]) == 4
    lines = picture(path, "mermaid").splitlines()
    assert lines[3] == "flowchart LR" and "  n1 --- n2" in lines
    assert '  n4["kidode#45;room"]' in lines


def test_names_of_a_map_are_escaped_and_a_world_may_be_empty(tmp_path: Path) -> None:
    path = tmp_path / "w.xml"
    path.write_text(WORLD.format(""))
    assert etree.fromstring(picture(path).encode()).findtext(f"{SVG}title") == "The map of w"
    title = "&lt;script>alert(1)&lt;/script>&#x202e;"
    area = f'<area id="a" title="{title}" application="x.xml" x1="0" y1="0" x2="2" y2="2"/>'
    path.write_text(WORLD.format(area), encoding="utf-8")
    made = picture(path)
    assert "<script" not in made and "\u202e" not in made


def test_a_wrong_world_is_told_as_by_validate_and_too_many_marks_are_refused(
    tmp_path: Path,
) -> None:
    path = tmp_path / "w.xml"
    path.write_text(WORLD.format('<way from="a" to="b"/>'))
    code, _, told = prima(tmp_path, "w.xml", "-o", "w.svg")
    assert code == 1 and "w.xml:1:" in told and 'There is no place "a".' in told
    path.write_text(WORLD.format("".join(f'<place id="p{n}" x="{n}" y="0"/>' for n in range(301))))
    code, _, told = prima(tmp_path, "w.xml", "-o", "w.svg")
    assert code == 2 and "301 places, things and corners are too many" in told
    assert picture(path, "dot").count("pos=") == 301
