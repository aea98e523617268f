"""prima explain: why a row came when it did."""

from __future__ import annotations

from functools import cache

import pytest

from prima import api
from prima.report import make
from prima.transcript.rules import RULES
from tests import ROOT


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
