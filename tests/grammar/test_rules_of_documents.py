"""Grammars as they stand in a document: what names their rules, and how often parts repeat."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api


@pytest.mark.parametrize(
    ("grammar", "told"),
    [
        ('<grammar root="zz">yes</grammar>', "Remove root: this grammar holds no <rule>."),
        ('<grammar root="root">yes</grammar>', "Remove root: this grammar holds no <rule>."),
        ('<grammar><rule id="a">yes</rule>no</grammar>', "its own text has no effect."),
        (
            '<grammar><rule id="a">yes</rule><rule id="a">no</rule></grammar>',
            'There are two rules "a". Rename one.',
        ),
        ('<grammar root="a"><rule id="a">yes</rule></grammar>', ""),
        ('<grammar><item repeat="">yes</item></grammar>', "repeat"),
        ('<grammar><item repeat="2">yes</item></grammar>', ""),
    ],
)
def test_what_a_grammar_says_of_its_rules(grammar: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f">'
        f'<field name="x"><prompt>Yes?</prompt>{grammar}<noinput><exit/></noinput></field>'
        "<block><exit/></block></form></prima>"
    )
    found = [f"{one.message} {one.remedy}" for one in api.validate([path])]
    assert len(found) == bool(told) and all(told in one for one in found)
