"""Scenarios that expect something, and how they come out."""

from __future__ import annotations

from html import escape
from pathlib import Path

from prima.testing.running import Result, TestOptions, run_one
from tests import ROOT

DEMOS = sorted((ROOT / "documents" / "scenarios").rglob("*.xml"))
WORLD = ROOT / "documents" / "worlds" / "room.xml"
ROBOT = ROOT / "documents" / "robots" / "papero.xml"
DESK = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="desk" xml:lang="en">
  <form id="ask">
    <field name="floor" type="number">
      <prompt>Which floor?</prompt>
      <filled>
        <log>floor <value expr="floor"/></log>
        <send to="lift"><param name="floor" expr="floor"/></send>
        <goto next="#ride"/>
      </filled>
    </field>
  </form>
  <form id="ride">
    <block><speak>Going up.</speak></block>
    <on event="reply.lift">
      <gesture name="nod"/>
      <speak>Floor <value expr="event.data.floor"/>. Mind the step.</speak>
      <exit/>
    </on>
    <on event="touch"><speak>Please do not push.</speak></on>
  </form>
</prima>
"""
SCENE = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="lift" title="Up"
  world="{world}" robot="{robot}" until="60s">
  <robot at="middle"/>
  <person x="1" y="0"/>
  <application src="desk.xml"/>
  <answer to="Which floor?">Three.</answer>
  <when said="Going up" after="1s"><touch sensor="head"/></when>
  <service name="lift"><reply after="6s"><data name="floor" value="3"/></reply></service>
{expected}
</scenario>
"""
FIRST = SCENE[: SCENE.index("{expected}")].count("\n") + 1
"""The line of the first expectation."""


def write(folder: Path, expected: str, desk: str = DESK) -> Path:
    (folder / "desk.xml").write_text(desk, encoding="utf-8")
    path = folder / "lift.xml"
    text = SCENE.format(world=escape(str(WORLD)), robot=escape(str(ROBOT)), expected=expected)
    path.write_text(text, encoding="utf-8")
    return path


def outcome(folder: Path, expected: str, desk: str = DESK) -> Result:
    return run_one(str(write(folder, expected, desk)), TestOptions())
