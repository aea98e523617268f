"""What the tests of this room share."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.batches import FAILS, HELLO, WRONG, scenario, write


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with six scenarios, of which two go wrong, and one file that is none."""
    monkeypatch.chdir(tmp_path)
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
    write("a/hello.xml", HELLO)
    write("a/fails.xml", FAILS)
    write("a/wrong.xml", WRONG)
    write("a/one.xml", scenario("one", "hello.xml"))
    write("b/one.xml", scenario("one", "../a/hello.xml"))
    write("a/three.xml", scenario("three", "fails.xml"))
    write("a/four.xml", scenario("four", "wrong.xml"))
    write("b/five.xml", scenario("five", "../a/hello.xml"))
    return tmp_path
