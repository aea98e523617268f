"""The pairs that the page of Reachy Mini names run on it, to their end."""

from __future__ import annotations

import asyncio
import re
import sys
from asyncio.subprocess import PIPE
from pathlib import Path

import pytest

from tests import ROOT
from tests.live.fake_reachy import fake_reachy
from tests.live.test_reachy import play

PAGE = (ROOT / "docs" / "robots" / "reachy.md").read_text(encoding="utf-8")
NOD = 4
"""The steps of a nod in the robot's document."""


@pytest.mark.parametrize(
    ("ea", "typed", "shown"),
    [
        (
            "pizza.vxml",
            "/touch head\n/wait\na large pizza with cheese\n/wait\nyes\n",
            ['"Welcome to the pizza service."', "Gesture (name nod)", "ends pizza"],
        ),
        (
            "guide.xml",
            "/touch head\n",
            ["Topological Move fails", '"Please go ahead without me."', "ends guide: exit"],
        ),
    ],
)
def test_a_pair_of_the_page_runs_to_its_end_and_replays(
    ea: str, typed: str, shown: list[str], tmp_path: Path
) -> None:
    (line,) = re.findall(r"^prima (live --robot \S*reachy-mini.xml --fa .*)$", PAGE, re.MULTILINE)
    assert ea in PAGE
    journal = tmp_path / "visit.jsonl"

    async def run() -> None:
        async with fake_reachy() as fake:
            robot = tmp_path / "reachy-mini.xml"
            written = (ROOT / "documents/robots/reachy-mini.xml").read_text(encoding="utf-8")
            robot.write_text(written.replace("127.0.0.1:8000", f"127.0.0.1:{fake.port}"))
            words = line.replace("documents/robots/reachy-mini.xml", str(robot))
            words = words.replace("pizza.vxml", ea).replace("visit.jsonl", str(journal))
            out = await _prima(f"{words} --speed 5 --until 20s", typed)
            assert all(one in out for one in shown), out
            assert len(fake.gotos) == NOD

    play(run())
    assert asyncio.run(_prima(f"replay {journal} -o -")) == journal.read_text(encoding="utf-8")


async def _prima(words: str, typed: str = "") -> str:
    command = [sys.executable, "-m", "prima", *words.split()]
    ran = await asyncio.create_subprocess_exec(
        *command, stdin=PIPE, stdout=PIPE, stderr=PIPE, cwd=ROOT
    )
    out, told = await ran.communicate(typed.encode())
    assert ran.returncode == 0, told.decode()
    return out.decode()
