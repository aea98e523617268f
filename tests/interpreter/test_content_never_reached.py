"""Content that is never reached is warned of, in both languages; what is warned of never runs."""

from __future__ import annotations

import pytest

from prima.errors import Problem
from prima.voicexml.reading import read_page
from tests.helpers.robot import Bench, read
from tests.helpers.voice import Call, vxml

HERE = "<log>here</log>"
FORM = '<form id="m"><block>{}</block><block name="b"><exit/></block></form>'
DEAD = [
    "<exit/>§",
    '<goto nextitem="b"/>§',
    '<if cond="true"><exit/>§</if>',
    '<if cond="false"><log>a</log><else/><exit/>§</if>',
    '<if cond="true"><exit/><else/><goto nextitem="b"/></if>§',
    '<if cond="false"><exit/><elseif cond="true"/><exit/><else/><goto nextitem="b"/></if>§',
    '<if cond="true"><if cond="true"><exit/><else/><exit/></if><else/><exit/></if>§',
    '<foreach item="x" array="[1]"><exit/>§</foreach>',
]
LIVE = [
    "§<exit/>",
    '<if cond="false"><exit/></if>§',
    '<if cond="false"><exit/><elseif cond="false"/><exit/></if>§',
    '<if cond="false"><exit/><else/><log>a</log></if>§',
    '<if cond="false"><exit/><else/>§</if>',
    '<foreach item="x" array="[]"><exit/></foreach>§',
]


def warned(body: str) -> list[int]:
    """The columns of the warnings of dead content."""
    return [one.place.column for one in read(body)[1] if one.code == "dead-content"]


def warned_in_voicexml(body: str) -> list[Problem]:
    found = read_page("a.vxml", "a.vxml", vxml(body).encode()).warnings()
    return [one for one in found if one.code == "dead-content"]


@pytest.mark.parametrize("content", [*DEAD, *LIVE])
def test_dead_content_is_warned_of_and_never_runs(content: str) -> None:
    body = FORM.format(content)
    head = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="app">'
    dead = [len(head) + body.index("§") + 1] if content in DEAD else []
    body = body.replace("§", HERE)
    assert warned(body) == dead
    assert ("here" in Bench(body).logs()) == (content in LIVE)


@pytest.mark.parametrize("content", [*DEAD, *LIVE])
def test_dead_content_of_voicexml_is_warned_of_and_never_runs(content: str) -> None:
    body = FORM.format(content)
    dead = [vxml(body).index("§") + 1] if content in DEAD else []
    body = body.replace("§", HERE)
    assert [one.place.column for one in warned_in_voicexml(body)] == dead
    assert ("here" in Call(body).logs()) == (content in LIVE)


@pytest.mark.parametrize("leaving", ['<submit next="a.vxml"/>', "<disconnect/>", "<return/>"])
def test_dead_content_of_voicexml_behind_its_own_elements(leaving: str) -> None:
    [found] = warned_in_voicexml(FORM.format(leaving + HERE))
    tag = leaving.split()[0].strip("</>")
    assert found.message == f"<log> comes after <{tag}> and is never reached."


@pytest.mark.parametrize("content", [*DEAD, *LIVE])
def test_dead_text_of_voicexml_is_warned_of_and_never_said(content: str) -> None:
    body = FORM.format(content.replace("§", "<!-- here -->§")).replace("true", "1 > 0")
    dead = [vxml(body).index("§") + 1] if content in DEAD else []
    body = body.replace("§", "here it is")
    found = warned_in_voicexml(body)
    assert [one.place.column for one in found] == dead
    assert all(one.message.startswith("Text ") for one in found)
    assert ("here it is" in Call(body).play()) == (content in LIVE)


def test_text_out_of_place_behind_an_exit_is_one_problem() -> None:
    assert [one.code for one in read(FORM.format("<exit/>here"))[1]] == ["stray-text"]
