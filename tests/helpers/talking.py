"""A session that a test talks to."""

from __future__ import annotations

from pathlib import Path

from prima import api
from prima.talk import Conversation, Game
from prima.transcript.row import Row
from tests import ROOT

DOCUMENTS = ROOT / "documents"
TOUCHED = DOCUMENTS / "scenarios" / "touched-on-the-way.xml"


class Paper:
    """A screen that keeps what it shows."""

    interactive = True

    def __init__(self) -> None:
        self.made: list[Row] = []
        self.shown: list[str] = []
        self.told: list[str] = []

    def rows(self, rows: list[Row]) -> None:
        self.made += rows

    def show(self, text: str) -> None:
        self.shown.append(text)

    def tell(self, text: str) -> None:
        self.told.append(text)

    @property
    def what(self) -> list[str]:
        return [row.what for row in self.made]


def start(
    scenario: Path = TOUCHED, real: bool = False, **more: object
) -> tuple[Conversation, Paper]:
    game = Game(api.load_scenario(scenario), str(scenario.parent), **more)  # type: ignore[arg-type]
    paper = Paper()
    talk = Conversation(game, paper, real)
    if not real:
        talk.begin()
    return talk, paper


def type_in(talk: Conversation, *lines: str) -> None:
    for text in lines:
        talk.line(text)


def room(tmp_path: Path, ea: str, more: str = "") -> Path:
    """A scenario with one application in an empty room."""
    (tmp_path / "ea.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="ea" xml:lang="en">'
        f"{ea}</prima>",
        encoding="utf-8",
    )
    path = tmp_path / "scene.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="scene"'
        f' world="{DOCUMENTS}/worlds/room.xml" robot="{DOCUMENTS}/robots/papero.xml">'
        f'<robot at="middle"/><person x="1" y="0"/><application src="ea.xml"/>{more}</scenario>',
        encoding="utf-8",
    )
    return path


ASKS = """<form id="f"><field name="a" type="boolean"><prompt>Well?</prompt>
<noinput><speak>Nothing heard.</speak><exit/></noinput>
<filled><speak>Thanks.</speak><exit/></filled></field></form>"""
TICKS = (
    '<form id="f"><block><send event="tick" delay="2s"/></block>'
    '<on event="tick"><speak>Tick.</speak></on></form>'
)
