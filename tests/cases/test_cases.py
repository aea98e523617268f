"""Scenarios with their expected transcripts.

Each folder of tests/cases is a case: ``expected.txt`` is the table that a person
reads, ``expected.jsonl`` the whole transcript. A folder has its own
``scenario.xml``, or is named after one of the demo scenarios; ``NAME+x1`` is
that scenario with an extension. A scenario of documents with a table beside it
(``NAME.txt``) is a case as well. To accept a change, look at the difference
first: ``prima run SCENARIO -o new.jsonl && prima diff old.jsonl new.jsonl``.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api

CASES = Path(__file__).parent
DEMOS = api.documents_folder() / "scenarios"
FOLDERS = {path.parent.name for path in CASES.glob("*/expected.txt")}
BESIDE = {path.stem: path for path in DEMOS.rglob("*.txt")}
NAMES = sorted({*FOLDERS, *BESIDE})


def scenario_of(name: str) -> Path:
    own = CASES / name / "scenario.xml"
    stem = name.partition("+")[0]
    return own if own.exists() else next(DEMOS.rglob(f"{stem}.xml"))


def policy_of(name: str) -> str | None:
    _, plus, extensions = name.partition("+")
    return f"prima+{extensions}" if plus else None


@pytest.mark.parametrize("name", NAMES)
def test_the_transcript_is_the_expected_one(name: str) -> None:
    transcript = api.rehearse(scenario_of(name), policy_of(name))
    table = BESIDE.get(name, CASES / name / "expected.txt")
    assert transcript.table() == table.read_text(encoding="utf-8")
    whole = CASES / name / "expected.jsonl"
    if whole.exists():
        assert transcript.dumps() == whole.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES)
def test_replaying_the_inbound_records_gives_the_same_bytes(name: str) -> None:
    scenario = scenario_of(name)
    transcript = api.rehearse(scenario, policy_of(name))
    assert api.replay(transcript, scenario).dumps() == transcript.dumps()


def test_every_demo_scenario_is_a_case() -> None:
    assert {path.stem for path in DEMOS.rglob("*.xml")} <= set(NAMES)
