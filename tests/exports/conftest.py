"""What the tests of this room share."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from tests.helpers.exporting import DEMO


@pytest.fixture(scope="module")
def demo() -> api.Transcript:
    return api.rehearse(DEMO)


@pytest.fixture(scope="module")
def folder(demo: api.Transcript, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("exports")
    (path / "t.jsonl").write_text(demo.dumps(), encoding="utf-8")
    return path
