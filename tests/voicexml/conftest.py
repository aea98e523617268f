"""What the tests of this room share."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from tests import ROOT
from tests.helpers.spoken import DEMO, Played
from tests.helpers.voice import vxml


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A folder with a world and a robot."""
    demo = ROOT / "documents"
    (tmp_path / "world.xml").write_bytes((demo / "worlds/room.xml").read_bytes())
    (tmp_path / "robot.xml").write_bytes((demo / "robots/papero.xml").read_bytes())
    return tmp_path


@pytest.fixture
def played(tmp_path: Path) -> Played:
    """Runs a document beside its files; each ``(ms, text)`` is said at a time of the run."""

    def run(
        body: str, *says: tuple[int, str], policy: str = "prima", more: str = ""
    ) -> api.Transcript:
        (tmp_path / "app.vxml").write_text(vxml(body))
        script = "".join(f'<when at="{at}ms"><say>{text}</say></when>' for at, text in says)
        (tmp_path / "scenario.xml").write_text(
            f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" policy="{policy}"'
            f' world="{DEMO}/worlds/room.xml" robot="{DEMO}/robots/papero.xml">'
            '<robot at="middle"/><person x="1" y="0"/><application src="app.vxml"/>'
            f"{script}{more}</scenario>"
        )
        made = api.rehearse(tmp_path / "scenario.xml")
        again = api.replay(made, tmp_path / "scenario.xml")
        assert again.dumps() == made.dumps()
        return made

    return run
