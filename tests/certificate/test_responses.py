"""Times to the first Command and to the first response."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from prima.certificate import (
    certificate_data,
    format_certificate,
)
from prima.checks.prices import outline
from prima.errors import UsageError
from prima.loading import read_application
from tests.helpers.certified import faults
from tests.helpers.certifying import ASKS, FA, HEAD, PROFILE, block, certified, lasting, run, waited

LATE = FA.replace("<speak>", '<move-head tilt="10"/><speak>')
"""An FA whose first Command is not a response."""


def test_the_first_word_may_come_long_after_the_first_command(tmp_path: Path) -> None:
    found = certified(tmp_path, ASKS, LATE)
    (delay,) = found.delays
    assert (delay.lasts, delay.known, delay.place) == (0, True, None)
    assert delay.response is not None and delay.response.known
    assert delay.response.lasts == lasting("Tell me?") + 55_000
    text = format_certificate(found)
    assert "touch: not at all\n    first word or movement towards the user: up to 55." in text
    assert "never" not in text
    data = certificate_data(found)["delays"][0]
    assert (data["lasts"], data["response"]["lasts"]) == (0, delay.response.lasts)
    records = run(
        tmp_path, "mine.xml", "theirs.xml", '<when at="200ms"><touch sensor="head"/></when>'
    )
    assert 55 < waited(records) <= delay.response.lasts / 1000
    assert faults(found, records, PROFILE.voices) == []
    delay.response = replace(delay, response=None)
    assert "the response to touch.head" in faults(found, records, PROFILE.voices)[0]


def test_where_response_and_first_command_are_one_they_are_told_once(tmp_path: Path) -> None:
    found = certified(tmp_path, ASKS)
    (delay,) = found.delays
    assert delay.response == replace(delay, response=None)
    assert "first word" not in format_certificate(found)
    data = certificate_data(found)["delays"][0]
    assert data["response"]["lasts"] == data["lasts"]
    nods = FA.replace("<speak>Yes?</speak>", '<gesture name="nod"/>')
    (delay,) = certified(tmp_path, block('<gesture name="bow"/>'), nods).delays
    assert delay.response is None


@pytest.mark.parametrize(
    ("content", "most"),
    [
        ("<par><gesture name='bow'/><speak>Yes?</speak></par>", 1),
        ('<iu><gesture name="bow"/><speak>Yes?</speak></iu>', 1),
        ('<move-head pan="3"/><if cond="a"><gesture name="nod"/></if><speak>Yes?</speak>', 2),
        ('<move-head pan="3"/><goto next="#g"/>', 2),
        ('<move-head pan="3"><on event="end"><speak>Yes?</speak></on></move-head>', 1),
        ('<move-head pan="3"/><face-human/><speak>Yes?</speak>', 2),
        ('<foreach item="x" array="[1]"><speak>Yes?</speak></foreach><gesture name="nod"/>', 1),
        ('<throw event="e"/><gesture name="nod"/></on><on event="e"><speak>Yes?</speak>', 0),
        ('<move-head pan="3"/><goto next-expr="a"/>', 2),
    ],
)
def test_a_response_is_found_on_all_ways(tmp_path: Path, content: str, most: int) -> None:
    own = (
        f'<var name="a" expr="true"/><form id="s"><on event="touch">{content}</on></form>'
        '<form id="g"><block><gesture name="nod"/><speak>Yes?</speak></block></form>'
    )
    document, _ = read_application("a.xml", (HEAD.format("fa", "a") + own + "</prima>").encode())
    (reaction,) = outline(document, PROFILE).reactions
    assert reaction.responds
    others = [one for one in reaction.responds if "speaker" not in one.devices]
    assert len(others) <= most


@pytest.mark.parametrize("calls", [1, 2])
@pytest.mark.parametrize("content", ['<gesture name="bow"/>', '<goto next="#s"/>', ""])
def test_a_response_is_found_where_a_subdialog_comes_back(content: str, calls: int) -> None:
    called = "".join(f'<subdialog name="i{one}" src="#g"/>' for one in range(calls))
    own = (
        f'<form id="s">{called}<block><speak>There.</speak></block>'
        f'<on event="touch">{content}</on></form>'
        '<form id="g"><block><gesture name="bow"/><return/></block></form>'
    )
    document, _ = read_application("a.xml", (HEAD.format("fa", "a") + own + "</prima>").encode())
    (reaction,) = outline(document, PROFILE).reactions
    assert any("speaker" in one.devices for one in reaction.responds)


@pytest.mark.parametrize(
    "blocks",
    [
        '<block name="b"><if cond="session.time &gt; 9"><goto nextitem="b"/></if></block>',
        '<block name="b"><goto nextitem="c"/></block><block name="c"><goto nextitem="b"/></block>',
    ],
)
def test_blocks_that_go_to_each_other_have_a_certificate(tmp_path: Path, blocks: str) -> None:
    """Each goto may lead to any item of the form: followed for ever, it was a RecursionError."""
    own = (
        f'<form id="f">{blocks}<block><speak>Yes?</speak></block>'
        '<on event="touch"><goto nextitem="b"/></on></form>'
    )
    (delay,) = certified(tmp_path, block("<speak>Buy.</speak>"), own).delays
    assert delay.event == "touch"


def test_a_chain_of_very_many_forms_is_not_followed(tmp_path: Path) -> None:
    names = range(1000)
    chain = "".join(
        f'<form id="f{one}"><block><goto next="#f{one + 1}"/></block></form>' for one in names
    )
    own = f"""{chain}<form id="f1000"><block><speak>Yes?</speak></block></form>
    <on event="touch"><goto next="#f0"/></on>"""
    with pytest.raises(UsageError, match="too many forms lead to one another"):
        certified(tmp_path, block("<speak>Buy.</speak>"), own)
