"""Wrong documents and command lines: run, and checked for a clear error."""

from __future__ import annotations

import json
import math
import resource
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from prima import api
from prima.language.commands import DEVICES

DOCUMENTS = api.documents_folder()
WORLD, ROBOT = DOCUMENTS / "worlds" / "office.xml", DOCUMENTS / "robots" / "papero.xml"
GIGABYTE = 1 << 30
SECONDS = 20
"""How long anything here may take at most; what is bounded takes a fraction of it."""


SHARED = 5
"""How many may share the processor: by the clock it may take so many times as long."""


# Documents ----------------------------------------------------------------------
def app(body: str, kind: str = "fa", name: str = "a", head: str = "") -> str:
    """An application, its body on the second line."""
    start = f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{name}">'
    return f"{start}{head}\n{body}\n</prima>\n"


def form(content: str, name: str = "f") -> str:
    return f'<form id="{name}">{content}</form>'


def block(content: str) -> str:
    return form(f"<block>{content}</block>")


def scenario(body: str, attributes: str = "", world: object = WORLD, robot: object = ROBOT) -> str:
    start = '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
    return f'{start} world="{world}" robot="{robot}" {attributes}>\n{body}\n</scenario>\n'


def world(body: str) -> str:
    return f'<world xmlns="urn:prima:world:1" version="1.0" id="w">\n{body}\n</world>\n'


def robot(body: str, attributes: str = "") -> str:
    start = f'<robot xmlns="urn:prima:robot:1" version="1.0" id="r" {attributes}>'
    return start + "".join(f'<device name="{name}"/>' for name in DEVICES) + f"\n{body}\n</robot>\n"


GOOD = app(block("<speak>Hello there.</speak><log>alive</log><exit/>"))
CATCH = '<on event="error"><log>caught <value expr="_message"/></log><exit/></on>'
PLAY = '<application src="app.xml"/>'


# Running -------------------------------------------------------------------------
@dataclass
class Result:
    """What a command gave."""

    code: int
    out: str
    err: str

    @property
    def text(self) -> str:
        return self.out + self.err

    def check(self, code: int, *parts: str) -> Result:
        """The exit code is ``code``, all of ``parts`` are said, and nothing is a defect."""
        assert "Traceback" not in self.text and "defect of prima" not in self.text, self.text
        assert self.code == code, self.text[-2000:]
        for part in parts:
            assert part in self.text, f"{part!r} is not in {self.text[-2000:]!r}"
        return self


Prima = Callable[..., Result]


def process(
    tmp_path: Path, *args: object, seconds: float = SECONDS, memory: int = 2 * GIGABYTE, **more: Any
) -> Result:
    """The command line as a process of its own, bounded in memory and in the processor's time."""
    busy = math.ceil(seconds)

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CPU, (busy, busy + 1))

    command = [sys.executable, "-m", "prima", *map(str, args)]
    more = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more}
    try:
        done = subprocess.run(
            command, cwd=tmp_path, timeout=SHARED * seconds, stdin=subprocess.DEVNULL,
            preexec_fn=limit, **more,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        pytest.fail(f"it takes longer than {SHARED * seconds} s")
    if done.returncode == -signal.SIGXCPU:
        pytest.fail(f"it takes longer than {seconds} s of the processor's time")
    out, err = done.stdout or b"", done.stderr or b""
    return Result(done.returncode, out.decode(errors="replace"), err.decode(errors="replace"))


def write(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def stage(folder: Path, document: str | bytes, body: str = "", attributes: str = "") -> Path:
    """A scenario with one application, ``app.xml``."""
    write(folder, "app.xml", document)
    return write(folder, "s.xml", scenario(f"{PLAY}\n{body}", attributes or 'until="20s"'))


def messages(path: Path) -> list[str]:
    """What applications have logged in a transcript."""
    records = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    return [record["message"] for record in records if record["phase"] == "log"]


# Meaning -------------------------------------------------------------------------
def grammar(content: str) -> str:
    return form(f'<field name="q"><grammar>{content}</grammar></field>')


BAD = "document.x.y"


def record(phase: str, **fields: object) -> str:
    return json.dumps({"time": 0, "phase": phase, "actor": "mediator", **fields}) + "\n"


def head(**data: object) -> Callable[[str], str]:
    return lambda good: record("run", data=data) + "".join(good.splitlines(keepends=True)[1:])
