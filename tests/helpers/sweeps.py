"""A small scenario whose timing matters: a guide speaks and asks, a pet answers a touch."""

from __future__ import annotations

from pathlib import Path

from tests import ROOT

GUIDE = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="guide">
  <form id="tour">
    <block><speak>Welcome to the museum of clocks.</speak></block>
    <field name="more">
      <prompt>Shall I go on?</prompt>
      <option>Yes.</option>
      <option>No.</option>
      <filled><speak>You said <value expr="more"/></speak><exit/></filled>
      <noinput><speak>Then goodbye.</speak><exit/></noinput>
    </field>
  </form>
</prima>
"""
PET = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="pet">
  <form id="mood"><on event="touch"><speak>That tickles!</speak></on></form>
</prima>
"""
VISIT = f"""<?xml version="1.0" encoding="UTF-8"?>
<!-- A visit. -->
<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit" until="30s"
          world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">
  <robot at="middle"/>
  <person x="1" y="0" speed="1"/>
  <application src="pet.xml" kind="fa"/>
  <application src="guide.xml"/>
  <answer id="reply" to="Shall I go on?" after="1s">Yes.</answer>
  <when id="touch" at="1s"><touch sensor="head"/></when>
  <expect says="Welcome" by="guide"/>
</scenario>
"""


def write_visit(folder: Path, scenario: str = VISIT) -> Path:
    """Write the scenario and its documents; gives the scenario's path."""
    (folder / "guide.xml").write_text(GUIDE, encoding="utf-8")
    (folder / "pet.xml").write_text(PET, encoding="utf-8")
    visit = folder / "visit.xml"
    visit.write_text(scenario, encoding="utf-8")
    return visit
