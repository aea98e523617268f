"""prima new: what it writes is valid and runs, and nothing is overwritten."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

import pytest

from prima.cli.new import KINDS
from prima.errors import UsageError
from prima.templates import identifier, write
from tests.helpers.here import prima


@pytest.mark.parametrize("name", ["guide", "My guide 3", "日本", "3--x <&> y", "_"])
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_written_is_valid_without_a_warning(tmp_path: Path, kind: str, name: str) -> None:
    assert prima("new", kind, name, cwd=tmp_path).returncode == 0
    done = prima("validate", ".", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, ""), done.stdout


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_told_to_try_works(tmp_path: Path, kind: str) -> None:
    told = prima("new", kind, "a b", cwd=tmp_path).stderr
    command = told.partition("Now try: prima ")[2].strip()
    done = prima(*shlex.split(command), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    if kind in ("ea", "vxml", "scenario"):
        assert "tea is" in done.stdout.lower() and "exit" in done.stdout.splitlines()[-1]


@pytest.mark.parametrize("name", ["a\x01", "a\uffff", os.fsdecode(b"m\xe9")])
@pytest.mark.parametrize("kind", KINDS)
def test_a_name_that_no_document_can_hold_is_refused(tmp_path: Path, kind: str, name: str) -> None:
    done = prima("new", kind, name, cwd=tmp_path)
    assert done.returncode == 2 and "Name another file" in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_scenario_takes_in_what_its_folder_has(tmp_path: Path) -> None:
    for kind, name in (("fa", "friend"), ("ea", "cafe"), ("world", "hall"), ("robot", "arms")):
        prima("new", kind, name, cwd=tmp_path)
    done = prima("new", "scenario", "visit", cwd=tmp_path)
    assert done.stderr.splitlines()[0] == "written: visit.xml"
    text = (tmp_path / "visit.xml").read_text()
    assert 'src="friend.xml"' in text and 'src="cafe.xml"' in text
    assert 'world="hall.xml" robot="arms.xml"' in text
    table = prima("run", "visit.xml", cwd=tmp_path).stdout
    assert "Shall I wave, or nod?" in table and "ends cafe: exit" in table


def test_every_question_of_a_new_scenario_is_answered_once(tmp_path: Path) -> None:
    for kind, name in (("fa", "friend"), ("ea", "cafe"), ("vxml", "bar"), ("scenario", "visit")):
        prima("new", kind, name, cwd=tmp_path)
    table = prima("run", "visit.xml", cwd=tmp_path).stdout
    assert table.count('"Tea."') == 2 and "ends bar: exit" in table


def test_an_id_keeps_letters_without_their_accents() -> None:
    assert identifier("café crème", "ea") == "cafe-creme"


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "guide.xml").write_text("mine")
    for kind in ("ea", "scenario"):
        done = prima("new", kind, "guide", cwd=tmp_path)
        assert done.returncode == 2 and "already exists" in done.stderr
    assert (tmp_path / "guide.xml").read_text() == "mine"
    done = prima("new", "scenario", "visit", cwd=tmp_path)  # which would write a guide.xml
    assert done.returncode == 2 and (tmp_path / "guide.xml").read_text() == "mine"


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no folder"):
        write("ea", str(tmp_path / "none" / "guide"))


def test_a_kind_that_is_none_is_guessed(tmp_path: Path) -> None:
    done = prima("new", "scenari", "x", cwd=tmp_path)
    assert done.returncode == 2 and 'Did you mean "scenario"?' in done.stderr


@pytest.mark.parametrize(
    ("name", "made"), [("guide", "guide"), ("a b", "a-b"), ("3d", "ea-3d"), ("日本", "ea")]
)
def test_ids_are_made_of_names(name: str, made: str) -> None:
    assert identifier(name, "ea") == made


def test_a_scenario_takes_in_one_application_of_an_id(tmp_path: Path) -> None:
    prima("new", "ea", "tour", cwd=tmp_path)
    (tmp_path / "copy.xml").write_bytes((tmp_path / "tour.xml").read_bytes())
    prima("new", "scenario", "visit", cwd=tmp_path)
    assert prima("run", "visit.xml", cwd=tmp_path).returncode == 0


def test_a_scenario_leaves_out_what_has_errors(tmp_path: Path) -> None:
    prima("new", "ea", "cafe", cwd=tmp_path)
    (tmp_path / "broken.xml").write_text(
        (tmp_path / "cafe.xml").read_text().replace("speak", "speek")
    )
    assert prima("new", "scenario", "visit", cwd=tmp_path).returncode == 0
    assert "broken" not in (tmp_path / "visit.xml").read_text()
    assert prima("run", "visit.xml", cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("name", ["", ".", "..", "a/"])
def test_a_name_that_is_none(tmp_path: Path, name: str) -> None:
    assert prima("new", "ea", name, cwd=tmp_path).returncode == 2


@pytest.mark.parametrize(("kind", "name"), [("vxml", "v.xml"), ("ea", "v.vxml"), ("ea", "v.xml")])
def test_either_ending_is_understood(tmp_path: Path, kind: str, name: str) -> None:
    assert prima("new", kind, name, cwd=tmp_path).returncode == 0
    (made,) = tmp_path.iterdir()
    assert made.name == ("v.vxml" if kind == "vxml" else "v.xml")


def test_names_with_braces_are_kept_as_they_are(tmp_path: Path) -> None:
    for kind, name in (("ea", "{file}"), ("fa", "{id}"), ("scenario", "{world}")):
        done = prima("new", kind, name, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    made = (tmp_path / "{world}.xml").read_text(encoding="utf-8")
    assert 'title="{world}"' in made
    assert 'src="{file}.xml"' in made and 'src="{id}.xml"' in made
    assert prima("validate", ".", cwd=tmp_path).returncode == 0
