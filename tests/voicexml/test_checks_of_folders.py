"""Checks of VoiceXML documents in several folders."""

from __future__ import annotations

from pathlib import Path

from prima import loading
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
