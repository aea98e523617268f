"""Values as they were most likely meant."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.markup.hints import meant_value


@pytest.mark.parametrize(
    ("text", "usual", "meant"),
    [
        ("99", "", "99s"),
        ("500", "", "500ms"),
        ("500", "0s", "500ms"),
        ("500", "10s", "500ms"),
        ("120", "600s", "120s"),  # when a run ends
        ("2min", "600s", "120s"),
        ("soon", "600s", ""),
    ],
)
def test_a_time_without_a_unit(text: str, usual: str, meant: str) -> None:
    assert meant_value("duration", text, usual) == meant


def test_no_fix_writes_an_empty_text(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><meta/><form id="f">'
        '<block><send to="x"><param value="1"/></send><exit/></block></form></prima>'
    )
    found = [one for one in api.validate([path]) if one.code == "missing-attribute"]
    assert len(found) == 3
    assert not any(one.fixes for one in found)


def voice(body: str) -> str:
    return (
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xmlns:p="urn:prima:dialogue:1"'
        f' xml:lang="en"><form>{body}</form></vxml>'
    )


@pytest.mark.parametrize(
    ("text", "there"),
    [
        (
            '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a"><form id="f">'
            '<block><topological-move too="lab" to="lab"/><exit/></block></form></prima>',
            "to",
        ),
        (voice('<block name="a" nam="b">Hello.</block>'), "name"),
        (voice('<block><p:topological-move too="lab" to="lab"/></block>'), "to"),
        (voice('<p:iu longest="2s" longst="3s"><block>Hello.</block></p:iu>'), "longest"),
        (
            voice(
                '<field name="q"><grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"'
                ' root="r" rot="r"><rule id="r">a</rule></grammar></field>'
            ),
            "root",
        ),
        (
            voice(
                '<field name="q"><grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"'
                ' root="r"><rule id="r" idd="s">a</rule></grammar></field>'
            ),
            "id",
        ),
    ],
)
def test_no_fix_writes_an_attribute_that_is_there(tmp_path: Path, text: str, there: str) -> None:
    path = tmp_path / "a.xml"
    path.write_text(text)
    (problem,) = (one for one in api.validate([path]) if one.code == "unknown-attribute")
    assert problem.remedy.startswith(f'Remove it: there is "{there}" already.')
    assert not problem.fixes
