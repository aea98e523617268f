"""The page on experiments is true: its Python runs, and pandas and polars take the table."""

from __future__ import annotations

import re
from typing import Any

import pytest

from prima.devices.vocabulary.robot import ROBOT
from prima.experiments.design import DESIGNS
from prima.experiments.levels import cell
from prima.markup.reader import read_tree
from prima.sim.paths import find
from prima.sim.scenario import look_at_scenario
from tests import ROOT

PAGE = ROOT / "docs" / "experiments.md"
TEXT = PAGE.read_text(encoding="utf-8")
SCENARIO = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="x" world="w" robot="r">
<robot at="a"/><person x="1" y="0"/><application src="a.xml"/><application src="b.xml"/>
<answer to="a">Yes.</answer><when id="touch" at="1s"><touch sensor="head"/></when>
<when said="a" after="2s"><wait for="1s"/></when><service name="mail"><reply/></service></scenario>
"""


def test_python_and_data_frames(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pandas")
    polars = pytest.importorskip("polars")
    monkeypatch.chdir(ROOT)
    code = re.findall(r"^```python\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)[0]
    names: dict[str, Any] = {}
    exec(compile(code, str(PAGE), "exec"), names)
    printed = capsys.readouterr().out
    assert "policy" in printed and "Never mind." in printed and "Name: seconds" in printed
    frame = polars.from_arrow(names["table"])
    assert frame.shape[0] == len(names["frame"]) == 16
    assert frame["when.at"].to_list()[:2] == [0.0, 0.0]


def test_all_paths_of_the_page_lead_somewhere() -> None:
    root = look_at_scenario("x.xml", SCENARIO.encode())[0].node
    robot = read_tree("papero.xml", (ROOT / "documents/robots/papero.xml").read_bytes(), ROBOT)[0]
    section = TEXT[TEXT.index("## What is varied") : TEXT.index("An `id` is the best name")]
    paths = re.findall(r"`([^`<]+)`", " ".join(re.findall(r"^\| (`.*?) \|", section, re.MULTILINE)))
    assert len(paths) >= 10
    for path in paths:
        target = find(root, path, lambda: robot)
        assert cell(target.kind, target.written) is not None


def test_designs_are_named() -> None:
    assert all(f"--design {name}" in TEXT for name in DESIGNS)
