"""VoiceXML applications run by a scenario with a telephone."""

from __future__ import annotations

from pathlib import Path

from prima import api
from prima.messages import Transferred
from tests.helpers.voice import Call, vxml

SCENARIO = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="world.xml"
  robot="robot.xml"><robot at="middle"/><person x="1" y="0"/>
  <application src="app.vxml"/>{script}</scenario>"""
STOP = (
    '<grammar version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar" xml:lang="en">'
    '<rule id="r">stop it</rule></grammar>'
)
ZERO = (
    '<grammar version="1.0" mode="dtmf" root="r" xmlns="http://www.w3.org/2001/06/grammar">'
    '<rule id="r">0</rule></grammar>'
)
ALL = (
    '<catch event="error connection"><log>'
    '<value expr="_event"/> <value expr="typeof t"/></log><exit/></catch>'
)


def run(place: Path, app: str, script: str = "", **files: str) -> api.Transcript:
    """Run an application in a scenario; its replay must be the same, byte for byte."""
    (place / "app.vxml").write_text(vxml(app))
    for name, text in files.items():
        (place / f"{name}.vxml").write_text(text)
    (place / "s.xml").write_text(SCENARIO.format(script=script))
    made = api.rehearse(place / "s.xml")
    (place / "made.jsonl").write_text(made.dumps())
    assert api.replay(api.read(place / "made.jsonl"), place / "s.xml").dumps() == made.dumps()
    return made


def logs(made: api.Transcript) -> list[str]:
    return [record["message"] for record in made.records if record["phase"] == "log"]


def shown(made: api.Transcript) -> list[str]:
    return [row.what for row in made.rows()]


def ended(made: api.Transcript) -> tuple[float, str]:
    """When and how the application ended."""
    (found,) = (
        record
        for record in made.records
        if record["phase"] == "unload" and record["actor"] == "mediator"
    )
    return found["time"], found["outcome"]


def transfer(more: str = 'bridge="true"', inside: str = "", to: str = "tel:+1-555-1234") -> str:
    """A form with one transfer, which logs what comes of it."""
    return f"""{ALL}<form><transfer name="t" dest="{to}" {more}>{inside}
    <filled><log><value expr="t"/> <value expr="t$.duration"/> <value expr="typeof t$.inputmode"/>
    </log></filled></transfer><block><log>on</log></block></form>"""


# What devices tell --------------------------------------------------------------------------
class Quiet(Call):
    """A call whose telephone says what the test says."""

    calls = False

    def told(self, outcome: str, serial: int = 1) -> None:
        self.step(Transferred("app", serial, "tel:+1-555-1234", outcome))


# 2.3.6 Recording ----------------------------------------------------------------------------
def record(more: str = "", inside: str = "") -> str:
    """A form with one recording, which logs what comes of it."""
    return f"""<catch event="connection.disconnect.hangup"><log>hangup: <value expr="r"/>,
    <value expr="r$.duration"/></log></catch>
    <form><record name="r" {more}><prompt>Speak.</prompt>{inside}
    <noinput><log>silence</log><exit/></noinput>
    <filled><log expr="[r, r$.duration, r$.size, r$.termchar, r$.maxtime].join()"/></filled></record>
    </form>"""
