"""Applications without a scenario, and what is wrong with them: nobody sees the scenario that is made."""

from __future__ import annotations

from pathlib import Path
from shutil import copyfile

import pytest

from prima import api
from prima.errors import DocumentError, UsageError

WORLD, EA = "documents/worlds/room.xml", "documents/ea/library.xml"
ROBOT = "documents/robots/papero.xml"


@pytest.mark.parametrize(
    ("eas", "robot", "needed"),
    [([WORLD], None, "an application"), ([EA], WORLD, "a robot")],
)
def test_a_document_of_the_wrong_kind_is_named_itself(
    eas: list[str], robot: str | None, needed: str
) -> None:
    with pytest.raises(DocumentError) as error:
        api.stage([], eas, robot=robot)
    (problem,) = [one for one in error.value.problems if one.severity == "error"]
    assert str(problem.place) == f"{WORLD}:3:1"
    assert problem.message == f"This is a world; {needed} is needed here."


def test_an_answer_without_words_is_silence() -> None:
    silent, answered = (api.rehearse(api.stage([], [EA], says)) for says in ([], ["", " "]))
    assert answered.table() == silent.table()


@pytest.mark.parametrize("text", ["te\x01a", "te\udcff", "te\uffff"])
def test_an_answer_that_no_document_can_hold_is_told_as_such(text: str) -> None:
    with pytest.raises(UsageError, match="holds a control character, or is not UTF-8"):
        api.stage([], [EA], ["\n Yes.\t", text])


def test_a_stage_without_applications_is_wrong_usage() -> None:
    with pytest.raises(UsageError, match="Name an application, in fas or eas"):
        api.stage([], [])


@pytest.mark.parametrize("name", ["a\nb.xml", "a\tb.xml", "a \r b.xml", "a&b<c>\"d'.xml"])
def test_files_of_a_stage_have_any_name(name: str, tmp_path: Path) -> None:
    for given in (EA, WORLD, ROBOT):
        (tmp_path / Path(given).parent.name).mkdir()
        copyfile(given, tmp_path / Path(given).parent.name / name)
    ea, world, robot = (tmp_path / folder / name for folder in ("ea", "worlds", "robots"))
    made = api.stage([], ea, world=world, robot=robot)
    assert {str(ea), str(world), str(robot)} <= set(made.files)


@pytest.mark.parametrize("name", ["a\udcff.xml", "a\x01.xml"])
def test_a_name_that_no_document_can_hold_is_told(name: str, tmp_path: Path) -> None:
    copyfile(EA, tmp_path / name)
    with pytest.raises(UsageError) as caught:
        api.stage([], tmp_path / name)
    told = "the name of this file holds a control character, or is not UTF-8. Rename it."
    assert str(caught.value) == f"{str(tmp_path / name)!r}: {told}"
