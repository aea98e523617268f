"""docs/mediation.md: its pictures are those of the runs and show what it says; it has all rules."""

from __future__ import annotations

import re
import shutil
from functools import lru_cache
from pathlib import Path

import pytest
from lxml import etree

from prima import api
from prima.messages import Record
from tests import ROOT
from tools import pictures
from tools.pictures import Bar

SVG = "{http://www.w3.org/2000/svg}"


@lru_cache
def records(scenario: str) -> list[Record]:
    return api.rehearse(ROOT / "documents" / "tutorial" / f"{scenario}.xml").records


def test_check_names_what_differs_and_a_run_without_it_writes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    quick = pictures.GRAPHS["sweep"][0], lambda _path: "<svg/>"
    monkeypatch.setitem(pictures.GRAPHS, "sweep", quick)  # hundreds of runs; make check does them
    shutil.copytree(ROOT / "documents", tmp_path / "documents")
    assert pictures.main([], tmp_path) == 0
    drawn = tmp_path / "docs" / "pictures" / "trees.svg"
    drawn.write_text(drawn.read_text(encoding="utf-8").replace("hello", "hallo"), encoding="utf-8")
    capsys.readouterr()
    assert pictures.main(["--check"], tmp_path) == 1
    [told] = capsys.readouterr().err.splitlines()
    assert told.startswith("docs/pictures/trees.svg differs")
    assert pictures.main(["--nonsense"]) == 2


@pytest.mark.parametrize("name", pictures.PICTURES)
def test_a_picture_is_small_titled_and_readable_in_light_and_dark(name: str) -> None:
    path = ROOT / "docs" / "pictures" / f"{name}.svg"
    root = etree.parse(str(path)).getroot()
    assert path.stat().st_size < 10_000
    assert root.findtext(f"{SVG}title") and root.findtext(f"{SVG}desc")
    assert "prefers-color-scheme: dark" in (root.findtext(f"{SVG}style") or "")
    page = (ROOT / "docs" / "mediation.md").read_text(encoding="utf-8")
    assert re.search(rf"!\[[^\]]+\]\(pictures/{name}\.svg\)", page), name


@pytest.mark.parametrize("name", pictures.PICTURES)
def test_nothing_is_drawn_outside_of_a_picture(name: str) -> None:
    root = etree.parse(str(ROOT / "docs" / "pictures" / f"{name}.svg")).getroot()
    width, height = float(root.get("width", "")), float(root.get("height", ""))
    for one in root.iter(f"{SVG}rect", f"{SVG}text"):
        x, y = float(one.get("x", "")), float(one.get("y", ""))
        assert 0 <= x <= x + float(one.get("width", "0")) <= width
        assert 0 <= y <= y + float(one.get("height", "0")) <= height


# What the pages say of them ---------------------------------------------------------------


def bar(bars: list[Bar], name: str, which: int = 0) -> Bar:
    return [one for one in bars if one.name == name][which]


def test_streams_the_topic_is_broken_after_the_unit_and_resumed_where_it_was() -> None:
    run = records("interleaved")
    ran, [touch] = pictures.runs(run), pictures.events(run)
    suspended = bar(pictures.between(run, "tree", "suspend", "resume"), "tour:1")
    assert bar(ran, "tour#1").begin < touch["time"] < bar(ran, "tour#1").end
    assert bar(ran, "hello#1").begin == bar(ran, "tour#1").end == suspended.begin
    assert bar(ran, "tour#2").begin == bar(ran, "hello#3").end == suspended.end
    assert [one.name for one in pictures.floors(run)] == ["hello:1"]


def test_channel_the_move_waits_for_the_end_of_the_conversation() -> None:
    run = records("channel")
    ran, [talk] = pictures.runs(run), pictures.talks(run)
    assert talk.name == "tea:1"
    assert bar(ran, "fetch#1").begin == bar(ran, "tea#1").end
    assert bar(ran, "fetch#2").begin == bar(ran, "tea#3").end == talk.end
    assert [one.name for one in pictures.floors(run)] == ["fetch:1"], "tea runs beside it (F3)"


def test_memory_the_three_states_at_two_moments() -> None:
    run = records("interleaved")
    touch = pictures.events(run)[0]["time"]
    assert pictures.memory_at(run, touch) == {
        "tour#1": "running",
        "tour#2": "linked",
        "tour#3": "linked",
        "tour#4": "linked",
        "hello#1": "waiting",
        "hello#2": "linked",
        "hello#3": "linked",
    }
    later = bar(pictures.runs(run), "tour#1").end
    assert pictures.memory_at(run, later) == {
        "tour#2": "waiting",
        "tour#3": "waiting",
        "tour#4": "linked",
        "hello#1": "running",
        "hello#2": "linked",
        "hello#3": "linked",
    }


def test_trees_a_window_continues_one_and_reactions_are_new_ones() -> None:
    run = records("trees")
    tree = {record["behavior"]: record["tree"] for record in run if record["phase"] == "request"}
    assert tree["walk#1"] == tree["walk#2"] == tree["walk#3"] == "walk:1"
    assert (tree["walk#4"], tree["hello#1"]) == ("walk:2", "hello:1")
    ran = pictures.runs(run)
    before, after = bar(ran, "walk#2"), bar(ran, "walk#2", 1)
    assert before.begin < bar(ran, "walk#4").begin < bar(ran, "walk#4").end < before.end
    assert before.cuts and bar(ran, "hello#1").begin < before.end < after.begin
    assert after.begin == bar(ran, "hello#3").end


# The page ----------------------------------------------------------------------------------


def test_every_rule_that_a_test_or_a_transcript_names_is_on_the_page() -> None:
    page = (ROOT / "docs" / "mediation.md").read_text(encoding="utf-8")
    folder = ROOT / "tests" / "scheduler"
    tests = "".join(file.read_text("utf-8") for file in sorted(folder.glob("test_*.py")))
    named = {rule.upper() for rule in re.findall(r"def test_([uoscfkex]\d)_", tests)}
    table = (ROOT / "docs" / "transcripts.md").read_text(encoding="utf-8")
    named |= set(re.findall(r"^\| ([A-Z]\d)", table, re.MULTILINE))
    missing = sorted(rule for rule in named if f"- **{rule}" not in page)
    assert len(named) > 30 and not missing, missing
