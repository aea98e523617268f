"""The pair that the page of Reachy Mini names runs on it, to its end."""

from __future__ import annotations

import asyncio
import re
import sys
from asyncio.subprocess import PIPE
from pathlib import Path

from tests import ROOT
from tests.live.fake_reachy import fake_reachy
from tests.live.test_reachy import play

PAGE = (ROOT / "docs" / "robots" / "reachy.md").read_text(encoding="utf-8")
TYPED = b"/touch head\n/wait\na large pizza with cheese\n/wait\nyes\n"


def test_the_pair_of_the_page_runs_to_its_end_and_replays(tmp_path: Path) -> None:
    (line,) = re.findall(r"^prima (live --robot \S*reachy-mini.xml --fa .*)$", PAGE, re.MULTILINE)
    assert all(f"`{one}`" in PAGE for one in ("a large pizza with cheese", "yes"))
    journal = tmp_path / "visit.jsonl"

    async def run() -> None:
        async with fake_reachy() as fake:
            robot = tmp_path / "reachy-mini.xml"
            written = (ROOT / "documents/robots/reachy-mini.xml").read_text(encoding="utf-8")
            robot.write_text(written.replace("127.0.0.1:8000", f"127.0.0.1:{fake.port}"))
            words = line.replace("documents/robots/reachy-mini.xml", str(robot))
            words = words.replace("visit.jsonl", str(journal)) + " --speed 5 --until 20s"
            command = [sys.executable, "-m", "prima", *words.split()]
            ran = await asyncio.create_subprocess_exec(
                *command, stdin=PIPE, stdout=PIPE, stderr=PIPE, cwd=ROOT
            )
            out, told = await ran.communicate(TYPED)
            assert ran.returncode == 0, told.decode()
            shown = out.decode()
            assert '"Welcome to the pizza service."' in shown and "Gesture (name nod)" in shown
            assert len(fake.gotos) == 4, "the steps of a nod"
            assert "ends pizza" in shown

    play(run())
    replay = asyncio.run(_replayed(journal))
    assert replay == journal.read_bytes()


async def _replayed(journal: Path) -> bytes:
    command = [sys.executable, "-m", "prima", "replay", str(journal), "-o", "-"]
    ran = await asyncio.create_subprocess_exec(*command, stdout=PIPE, cwd=ROOT)
    out, _ = await ran.communicate()
    assert ran.returncode == 0
    return out
