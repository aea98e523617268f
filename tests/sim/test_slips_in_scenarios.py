"""Slips that a scenario once took without a word, or with a remedy that mends nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from tests import ROOT

SCENARIO = f"""<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="60s"
 world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">
  <robot at="middle"/>
  <person x="1" y="0"/>
  <application src="a.xml"/>
  {{}}
</scenario>
"""
ASKS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="a" xml:lang="en">
  <form id="f">
    <block><send to="post"><param name="a" value="1"/></send></block>
    <field name="x" type="boolean"><prompt>Shall I go on?</prompt>
      <noinput><exit/></noinput><nomatch><exit/></nomatch><filled><exit/></filled></field>
    <on event="reply.post"><exit/></on>
    <on event="error.service.post"><exit/></on>
    <on event="rain"><exit/></on>
  </form>
</prima>"""
POST = '<service name="post"><reply/></service>'
LATE = "The run is over after 60 s (until): this never comes."
TWICE = '"a" is there twice. Keep one.'
DATA = '<data name="a" value="1"/><data name="a" value="2"/>'


def told(folder: Path, line: str) -> list[tuple[int, str]]:
    """The problems of a scenario with a line: the columns, messages and remedies."""
    path = folder / "s.xml"
    path.write_text(SCENARIO.format(line), encoding="utf-8")
    (folder / "a.xml").write_text(ASKS, encoding="utf-8")
    found = [one for one in api.validate(path) if one.place.line == 6]
    return [(one.place.column, f"{one.message} {one.remedy}") for one in found]


@pytest.mark.parametrize(
    ("line", "column"),
    [
        ('<when at="50s" after="20s"><leave/></when>', 13),
        ('<application src="a.xml" start="61s"/>', 35),
    ],
)
def test_what_comes_after_the_end_is_told(tmp_path: Path, line: str, column: int) -> None:
    line = line.replace('src="a.xml"', 'src="b.xml"')
    (tmp_path / "b.xml").write_text(ASKS.replace('id="a"', 'id="b"'), encoding="utf-8")
    late = (column, f"{LATE} Write an earlier time, or a later until.")
    assert told(tmp_path, line + POST) == [late]
    assert told(tmp_path, line.replace("61s", "60s").replace("20s", "10s") + POST) == []


@pytest.mark.parametrize(
    "line",
    [
        f'{POST}<when at="1s"><event name="rain">{DATA}</event></when>',
        f'<service name="post"><reply>{DATA}</reply></service>',
        f'{POST}<expect sends="post">{DATA}</expect>',
    ],
)
def test_a_value_whose_name_is_there_twice_is_told(tmp_path: Path, line: str) -> None:
    column = line.rindex('"a"') + 2 + 2
    assert told(tmp_path, line) == [(column, TWICE)]


@pytest.mark.parametrize(
    ("tag", "remedy"),
    [
        ("place", "Write it into the world's document."),
        ("device", "Write it into the robot's document."),
        ("answers", 'Write it into the document of a user: <person user="...">.'),
    ],
)
def test_what_another_document_holds_is_told(tmp_path: Path, tag: str, remedy: str) -> None:
    assert told(tmp_path, f"<{tag}/>{POST}") == [(3, f"There is no <{tag}>. {remedy}")]
