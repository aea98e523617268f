"""Robots whose devices belong to several drivers: each goal reaches the one that carries it out."""

from __future__ import annotations

from pathlib import Path

from tests.helpers.here import prima

ROOT = Path(__file__).parents[2]

VOICE = """
import asyncio
from prima.devices.goals import LISTEN, SAY
from prima.live.driver import Refused, TaskDriver

class Voice(TaskDriver):
    kind = "voice"
    async def perform(self, goal):
        if goal.kind not in (SAY, LISTEN):
            raise Refused(f"a voice cannot {goal.kind}")
        await asyncio.sleep(0.02 if goal.kind == SAY else 3600)
        return {}
"""
ASKS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="asks">
  <form id="ask">
    <block><turn angle="90"/></block>
    <field name="well" type="boolean" channel="connect">
      <prompt timeout="100ms">Well?</prompt>
      <noinput><exit/></noinput>
    </field>
  </form>
</prima>"""


def test_a_turn_to_the_user_before_a_question_is_not_the_voices(tmp_path: Path) -> None:
    """X4: it keeps speaker and ear for the question; they are another driver's."""
    text = (ROOT / "documents" / "robots" / "simulated.xml").read_text()
    both = '<driver kind="voice" devices="speaker speech-recognition"/><driver kind="sim"/>'
    (tmp_path / "robot.xml").write_text(text.replace('<driver kind="sim"/>', both))
    (tmp_path / "voice.py").write_text(VOICE)
    (tmp_path / "asks.xml").write_text(ASKS)
    words = ("--robot", "robot.xml", "--driver", "voice.py", "--policy", "prima+x4")
    ran = prima("live", *words, "--speed", "10", "--ea", "asks.xml", cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert "Face Human [inserted, X4]" in ran.stdout
    assert "fails" not in ran.stdout
