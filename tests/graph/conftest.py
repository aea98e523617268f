"""What the tests of this room share."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests import ROOT
from tests.helpers.graphs import app, transcript


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("graph")
    dumped = transcript("scenarios/touched-on-the-way.xml").dumps()
    files = {
        "empty.xml": "",
        "text.txt": "hello",
        "app.xml": app('<form id="a"/>'),
        "world.xml": (ROOT / "documents/worlds/room.xml").read_text(encoding="utf-8"),
        "robot.xml": (ROOT / "documents/robots/papero.xml").read_text(encoding="utf-8"),
        "scenario.xml": (ROOT / "documents/scenarios/dance-alone.xml").read_text(encoding="utf-8"),
        "grammar.grxml": '<grammar xmlns="http://www.w3.org/2001/06/grammar" version="1.0"/>',
        "t.jsonl": dumped,
        "cut.jsonl": "\n".join(dumped.splitlines()[:3]) + '\n{"time": 1, "pha',
        "json.json": '{"a": 1}',
    }
    for name, content in files.items():
        (made / name).write_text(content, encoding="utf-8")
    return made
