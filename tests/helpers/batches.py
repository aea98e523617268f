"""Scenarios for batches: a small world of their own."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Mapping
from pathlib import Path

from tests import ROOT
from tests.helpers import command

SECONDS = 60
MODULE = [sys.executable, "-m", "prima", "run"]


def app(body: str, name: str = "app") -> str:
    return (
        f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="{name}">'
        f'<form id="f">{body}</form></prima>\n'
    )


def scenario(
    name: str, application: str, until: str = "60s", documents: Path = ROOT / "documents"
) -> str:
    return (
        f'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="{name}" until="{until}"'
        f' world="{documents}/worlds/room.xml" robot="{documents}/robots/papero.xml">'
        f'<robot at="middle"/><person x="1" y="0"/><application src="{application}"/></scenario>\n'
    )


HELLO = app("<block><speak>Hello there.</speak><exit/></block>")
FAILS = app('<block><speak>Oh.</speak><throw event="bored"/></block>')
WRONG = app("<blok/>")
ENDLESS = app('<block><speak>Still here.</speak><goto next="#f"/></block>')


def write(name: str, content: str) -> None:
    Path(name).write_text(content, encoding="utf-8")


def prima(
    *args: object, input: str = "", env: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a batch in this folder."""
    return command.prima("run", *args, input=input, env=env, timeout=SECONDS)


def files(folder: str) -> dict[str, bytes]:
    found = Path(folder).rglob("*")
    return {str(one.relative_to(folder)): one.read_bytes() for one in found if one.is_file()}


POLICIES = ("--policy", "prima", "--policy", "fifo")


def until(condition: object, *args: object) -> None:
    assert callable(condition)
    deadline = time.monotonic() + SECONDS
    while not condition(*args):
        assert time.monotonic() < deadline
        time.sleep(0.02)


def begun(stage: Path) -> subprocess.Popen[str]:
    """A batch in whose middle are runs that last, when the first is done and they are at work."""
    write("a/endless.xml", ENDLESS)
    for name in ("x", "y"):
        write(f"b/{name}.xml", scenario(name, "../a/endless.xml", "86400s"))
    made = subprocess.Popen(
        [*MODULE, "b/one.xml", "b/x.xml", "b/y.xml", "b/five.xml", "-o", "runs", "--workers", "2"],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    until(lambda: len([one for one in stage.glob("runs/.prima-*/*") if one.stat().st_size]) == 2)
    until(Path("runs/b/one.jsonl").exists)
    return made
