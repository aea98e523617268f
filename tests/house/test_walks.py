"""The count of what a value passes in ``prima`` (docs/development.md)."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests import ROOT


@pytest.fixture(scope="module")
def walks() -> list[list[str]]:
    """The functions of each walk, as the tool lists them, in a process of its own."""
    command = [sys.executable, "tools/walks.py", "--list"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [part.splitlines() for part in told.split("| --- | --- | --- | --- |")[1].split("\n\n")]


@pytest.mark.parametrize(
    ("number", "passed"),
    [
        (0, ["markup/reader.py parse", "language/arguments.py check_arguments"]),
        (1, ["voicexml/prompts.py Speaker.utter", "scheduler/admission.py check_command"]),
        (2, ["sim/people.py People._speak", "grammar/answers.py Answers.match"]),
    ],
)
def test_a_walk_goes_from_the_file_to_the_table(
    walks: list[list[str]], number: int, passed: list[str]
) -> None:
    steps = [line for line in walks[number] if line and not line.startswith("|")]
    assert steps[0] == "loading/files.py read_bytes"
    assert steps[-1] == "api/transcripts.py Transcript.table"
    assert [step for step in steps if step in passed] == passed
