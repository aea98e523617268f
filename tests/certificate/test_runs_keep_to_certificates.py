"""No run takes longer than its certificate says, and a certificate that is too good is found out."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from prima import api
from prima.certificate import (
    Certificate,
    certificates,
    certify,
    format_certificate,
)
from prima.checks.prices import commands
from prima.loading import load_scenario
from tests import ROOT
from tests.helpers.certified import faults
from tests.helpers.certifying import PROFILE, certified, run, without_more_for_each_event
from tests.helpers.generated_pairs import pair

SITUATIONS = sorted(ROOT.glob("documents/scenarios/**/*.xml"))
FAS = sorted(ROOT.glob("documents/fa/*.xml"))
EAS = sorted(ROOT.glob("documents/ea/*ml"))


@given(st.integers(0, 10**6))
@settings(
    max_examples=int(os.environ.get("PRIMA_EXAMPLES", "300")) * 17 // 100,
    derandomize=os.environ.get("CI") == "true",
    deadline=None,
    database=None,
)
def test_no_run_exceeds_what_its_certificate_says(seed: int) -> None:
    with TemporaryDirectory() as folder:
        fa, ea, scenario = pair(seed).write(Path(folder))
        (found,) = certificates([str(fa)], [str(ea)])
        records = api.rehearse(scenario).records
        assert faults(found, records, PROFILE.voices) == []


@pytest.mark.parametrize("seed", (2, 12, 23))
def test_certificates_that_are_too_good_are_found_out(seed: int) -> None:
    """The property can fail: with all waits taken away, runs exceed them."""
    broken = 0
    with TemporaryDirectory() as folder:
        for one in range(seed * 10, seed * 10 + 10):
            fa, ea, scenario = pair(one).write(Path(folder))
            (found,) = certificates([str(fa)], [str(ea)])
            found.delays.clear()
            broken += bool(faults(found, api.rehearse(scenario).records, PROFILE.voices))
    assert broken


def broken_by(change: Callable[[Certificate], None]) -> int:
    """How many of some pairs exceed their certificates once those are changed."""
    broken = 0
    for seed in range(0, 60, 4):
        with TemporaryDirectory() as folder:
            fa, ea, scenario = pair(seed).write(Path(folder))
            (found,) = certificates([str(fa)], [str(ea)])
            change(found)
            broken += bool(faults(found, api.rehearse(scenario).records, PROFILE.voices))
    return broken


def as_it_is(_found: Certificate) -> None:
    """Change nothing."""


def without_the_time_of_responses(found: Certificate) -> None:
    for delay in found.delays:
        delay.response = replace(delay, response=None)


def test_the_slowest_runs_need_all_that_their_certificates_allow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """None of these can go: what further events add to a wait, the time of responses, and the
    time in which turns slow down."""
    assert not broken_by(as_it_is)
    assert broken_by(without_more_for_each_event)
    assert broken_by(without_the_time_of_responses)
    monkeypatch.setattr(commands, "SETTLING_MS", 0)
    assert broken_by(as_it_is)


@pytest.mark.parametrize("path", SITUATIONS, ids=lambda path: path.stem)
def test_the_situations_keep_to_the_certificates(path: Path) -> None:
    cast = load_scenario(path).cast
    records = api.rehearse(path).records
    for fa in cast.documents:
        for ea in cast.documents:
            if fa is not ea:
                found = certify(fa, ea, cast.robot, [])
                assert faults(found, records, cast.robot.voices) == []


@pytest.mark.parametrize("ea", EAS, ids=lambda path: path.stem)
@pytest.mark.parametrize("fa", FAS, ids=lambda path: path.stem)
def test_the_demos_have_useful_certificates(fa: Path, ea: Path) -> None:
    """Reactions wait for a bounded time, but for texts that only a run tells."""
    (found,) = certificates([str(fa)], [str(ea)])
    assert found.gaps == []
    for delay in found.delays:
        assert not delay.endless and not delay.after
        assert 0 < delay.lasts < 12_000
        assert {gap.reason for gap in delay.unknown} <= {
            "an expression gives its text",
            "an expression gives a part of what it says",
        }


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ('<block><speak>Buy.</speak><goto next="#f"/></block>', "f follows itself"),
        (
            '<block><speak>Buy.</speak></block><on event="end.speak"><speak>More.</speak></on>',
            "what is done about end.speak leads to it again",
        ),
        (
            '<subdialog name="s" src="#sub"><filled><clear/></filled></subdialog></form>'
            '<form id="sub"><block><speak>Buy.</speak><return/></block>',
            "items of the form are visited again",
        ),
        (
            '<subdialog name="s" src="#sub"/><block><goto next="#f"/></block></form>'
            '<form id="sub"><block><speak>Buy.</speak><return/></block>',
            "f follows itself",
        ),
    ],
)
def test_whoever_talks_without_an_end_is_certified_to(tmp_path: Path, body: str, why: str) -> None:
    """As the run shows: an FA's sentence that is not a reaction waits as long as that goes on."""
    own = (
        '<form id="s"><block><send event="now" delay="1s"/></block>'
        '<on event="now"><speak>It is three.</speak><exit/></on></form>'
    )
    found = certified(tmp_path, f'<form id="f">{body}</form>', own)
    (starved,) = found.starves
    assert why in starved.what and (starved.rule, starved.devices) == ("S2c", ("speaker",))
    assert "(S2c), each for a run's patience, 60 s by default (E6)" in format_certificate(found)
    records = run(tmp_path, str(tmp_path / "mine.xml"), str(tmp_path / "theirs.xml"), "", "100s")
    told = [(one["app"], one["rule"]) for one in records if one["phase"] == "starve"]
    assert told == [("mine", "E6")]
