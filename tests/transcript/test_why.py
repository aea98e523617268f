"""prima explain: why a row came when it did."""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path

import pytest

from prima import api
from prima.report import make
from prima.transcript.rows import GrowingTable
from prima.transcript.rules import RULES
from tests import ROOT
from tests.helpers.certifying import FA, TOUCH, block, write
from tests.helpers.certifying import run as run_pair


@cache
def run() -> api.Transcript:
    """One application sends itself an event; another's device fails, which ends it."""
    return api.rehearse(ROOT / "documents" / "rules" / "device.xml")


def explained(what: str) -> list[str]:
    number = next(row.number for row in run().rows() if row.what.startswith(what))
    return api.explain_row(run(), number).splitlines()


def test_an_event_of_an_application_did_not_come_from_outside() -> None:
    assert explained("fancy")[1:] == ["trains raised it itself; no rule decided its time."]
    assert explained("the arm fails")[1:] == ["It came from outside; no rule decided its time."]
    page = "".join(make([run()]))
    assert "trains raised it itself" in page and "It came from outside" in page


@pytest.mark.parametrize(
    ("what", "rule"), [("Point by Hand fails", "E1"), ("ends tour", "E2"), ("ends trains", "E2")]
)
def test_the_rule_of_an_ending_is_named_with_its_sentence(what: str, rule: str) -> None:
    assert explained(what)[-1].endswith(f" s: rule {rule}: {RULES[rule]}.")


def test_every_rule_of_a_row_is_among_its_reasons() -> None:
    for row in run().rows():
        if row.rule:
            assert f"rule {row.rule}" in api.explain_row(run(), row.number)


UNIT = '<iu restartable="true"><speak>It is a rather long story.</speak><speak>Two.</speak></iu>'


def pair(folder: Path, body: str, policy: str, own: str = FA) -> api.Transcript:
    """The run of an EA, and of an FA that is touched."""
    fa, ea = write(folder, "mine", own, "fa"), write(folder, "theirs", body)
    run_pair(folder, fa, ea, TOUCH, "20s")
    return api.rehearse(folder / "s.xml", policy)


def why(made: api.Transcript, what: str) -> list[str]:
    """The reasons for the last of the rows that begin with some words."""
    number = [row.number for row in made.rows() if row.what.startswith(what)][-1]
    return [line.partition(" s: ")[2] for line in api.explain_row(made, number).splitlines()[1:]]


def test_what_gives_way_is_told_with_its_unit(tmp_path: Path) -> None:
    made = pair(tmp_path, block(UNIT), "prima+x2")
    assert "it gives way to mine#1 (rule X2)." in why(made, "breaks off the unit")
    reasons = why(made, '"It is a rather')
    assert "the unit theirs#1 gives way to mine#1 (rule X2)." in reasons


def test_of_units_in_units_the_inner_one_is_named(tmp_path: Path) -> None:
    inner = '<iu><par><iu><speak>Good morning.</speak></iu><gesture name="bow"/></par></iu>'
    reasons = why(pair(tmp_path, block(inner), "prima"), '"Good')
    starts = [one for one in reasons if "started" in one]
    assert starts == ["started inside the unit theirs#2 (rule U4)."], reasons


def test_what_is_put_in_is_told_with_what_it_precedes() -> None:
    made = api.rehearse(ROOT / "documents" / "scenarios" / "situations" / "s07.xml", "prima+x1")
    assert why(made, "Set Position (x 2.906")[1] == "put in before museum#5 (rule X1)."


def test_a_unit_that_waits_too_long_is_told_as_one(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "documents", tmp_path / "documents")
    trains = tmp_path / "documents" / "rules" / "trains.xml"
    said = "<speak>I like trains.</speak>"
    trains.write_text(trains.read_text().replace(said, f"<iu>{said}</iu>"))
    made = api.rehearse(trains.with_name("patience.xml"))
    waits = "kept waiting by barker#4 for 5 s (rule E6)."
    assert why(made, "still waits after 5 s: the unit")[-1] == waits
    assert f"the unit trains#1 is {waits}" in why(made, '"I like trains."')
    made = api.rehearse(ROOT / "documents" / "rules" / "patience.xml")
    assert why(made, 'still waits after 5 s: "I like trains."')[-1] == waits


def test_without_a_mediator_a_pair_collides_in_one_row(tmp_path: Path) -> None:
    made = pair(tmp_path, block(UNIT), "none")
    assert why(made, "the unit loses the speaker")
    own = FA.replace("<speak>Yes?</speak>", '<tracking-human distance="0.5"/>')
    made = pair(tmp_path, block('<tracking-human distance="1"/>'), "none", own)
    lost = [row.what for row in made.rows() if "loses" in row.what]
    assert lost == ["tracking-human loses the human-detection"]
    assert len([one for one in made.records if one["phase"] == "collision"]) > 10, "in each loop"
    growing = GrowingTable()
    shown = [row.what for record in made.records for row in growing.add([record])]
    assert [what for what in shown if "loses" in what] == lost
