"""Law as data: each folder of tests/cases is a scenario with its expected transcript.

``expected.txt`` is the table that a person reads; ``expected.jsonl`` is the whole
transcript. A folder has its own ``scenario.xml``, or is named after one of the
demo scenarios. To accept a change, look at the difference first:
``prima run SCENARIO -o new.jsonl && prima diff tests/cases/NAME/expected.jsonl new.jsonl``.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api

CASES = Path(__file__).parent / "cases"
NAMES = sorted(path.name for path in CASES.iterdir() if path.is_dir())


def scenario_of(name: str) -> Path:
    own = CASES / name / "scenario.xml"
    return own if own.exists() else api.documents_folder() / "scenarios" / f"{name}.xml"


@pytest.mark.parametrize("name", NAMES)
def test_the_transcript_is_the_expected_one(name: str) -> None:
    transcript = api.rehearse(scenario_of(name))
    assert transcript.table() == (CASES / name / "expected.txt").read_text(encoding="utf-8")
    whole = CASES / name / "expected.jsonl"
    if whole.exists():
        assert transcript.dumps() == whole.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES)
def test_replaying_the_inbound_records_gives_the_same_bytes(name: str) -> None:
    scenario = scenario_of(name)
    transcript = api.rehearse(scenario)
    assert api.replay(transcript, scenario).dumps() == transcript.dumps()


def test_every_demo_scenario_is_a_case() -> None:
    demos = {path.stem for path in (api.documents_folder() / "scenarios").glob("*.xml")}
    assert demos <= set(NAMES)
