"""What the tests of this room share."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

import pytest

from prima import cli
from prima.markup.limits import LIMITS
from tests.helpers.bad_input import GOOD, Prima, Result, stage


@pytest.fixture
def prima(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Prima:
    """The command line in this process, in the test's own folder."""
    monkeypatch.chdir(tmp_path)
    for name, number in asdict(LIMITS).items():
        monkeypatch.setattr(LIMITS, name, number)  # undone, whatever --limit raises

    def call(*args: object) -> Result:
        monkeypatch.setattr(sys, "argv", ["prima", *map(str, args)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        shown = capsys.readouterr()
        return Result(int(ended.value.code or 0), shown.out, shown.err)

    return call


@pytest.fixture
def transcript(prima: Prima, tmp_path: Path) -> str:
    """A good transcript, ``good.jsonl``, of ``s.xml``."""
    prima("run", stage(tmp_path, GOOD), "-o", "good.jsonl").check(0)
    return (tmp_path / "good.jsonl").read_text()
