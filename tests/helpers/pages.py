"""Examples in the pages of the documentation."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

from lxml import etree

from prima.devices.vocabulary.robot import ROBOT
from prima.devices.vocabulary.services import SERVICES
from prima.interpreter.vocabulary.dialogue import DIALOGUE
from prima.sim.vocabulary.scenario import SCENARIO
from prima.sim.vocabulary.user import USER
from prima.sim.vocabulary.world import WORLD
from tests import ROOT
from tests.helpers.here import prima

PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(
    r"^```(?P<language>\w*)(?: (?P<name>\S+))?\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL
)
NAMESPACES = {one.namespace: one for one in (DIALOGUE, WORLD, ROBOT, SCENARIO, USER, SERVICES)}


def run(words: list[str], folder: Path, given: str | None = None) -> tuple[int, list[str]]:
    """A command of a page: its exit code, and the lines that it prints."""
    paths = [
        sorted(path.relative_to(folder).as_posix() for path in folder.glob(word))
        if "*" in word
        else [word]
        for word in words
    ]
    names = [name for names in paths for name in names]
    done = prima(*names, cwd=folder, input=given or "", together=True)
    return done.returncode, [line.rstrip() for line in done.stdout.splitlines()]


BEGIN = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="fa" id="x">'


@lru_cache
def compiled_schema(name: str) -> etree.XMLSchema:
    """The published schema of that name."""
    return etree.XMLSchema(etree.parse(str(ROOT / "schemas" / f"{name}.xsd")))
