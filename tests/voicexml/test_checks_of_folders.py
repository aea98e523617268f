"""Checks of VoiceXML documents in several folders."""

from __future__ import annotations

from pathlib import Path

from prima import loading
from tests import ROOT
from tests.helpers.here import prima
from tests.helpers.validating import VXML

LEADS = '<form><block><goto next="{}"/></block></form>'


def test_a_page_that_is_served_elsewhere_than_what_leads_to_it_is_checked(tmp_path: Path) -> None:
    below = tmp_path / "sub"
    below.mkdir()
    (tmp_path / "main.vxml").write_text(VXML.format("", LEADS.format("sub/page.vxml")))
    there = LEADS.format("https://example.org/app/next.vxml#no")
    (below / "page.vxml").write_text(VXML.format("", there))
    (below / "next.vxml").write_text(VXML.format("", "<form/>"))
    files = sorted(tmp_path.rglob("*.vxml"))
    found = loading.validate(files, [f"https://example.org/app/={below}"])
    assert [one.code for one in found] == ["no-such-form"]


def test_a_page_below_an_application_is_told_by_one_name(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "main.vxml").write_text(VXML.format("", LEADS.format("sub/a.vxml")))
    (tmp_path / "sub" / "a.vxml").write_text(VXML.format("", LEADS.format("b.vxml")))
    (tmp_path / "sub" / "b.vxml").write_text(VXML.format("", LEADS.format("a.vxml#no")))
    (tmp_path / "visit.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<robot at="middle"/><application src="main.vxml"/></scenario>'
    )
    done = prima("validate", "visit.xml", "sub", "--format", "short", cwd=tmp_path)
    (line,) = done.stdout.splitlines()
    assert line.startswith("sub/b.vxml:1:") and 'no dialog "no"' in line
