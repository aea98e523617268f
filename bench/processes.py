"""Whole processes, and the floors below which no start can come."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter

from bench.fresh import ROOT, check

SMALL = "documents/fa/follow.xml"
DEMO = "documents/scenarios/follow-during-navigation.xml"
SYNTAX = ("tree_sitter", "tree_sitter_javascript")

FLOORS = {
    "bare": (),
    "click": ("click",),
    "validate": ("click", "xml.parsers.expat", *SYNTAX),
    "run": ("click", "xml.parsers.expat", *SYNTAX, "pymunk", "networkx"),
}
"""The libraries that a command imports; the code of these documents is simple and needs no engine."""

TINY = {
    "sismic": (
        "from bench.machines import Sismic, sismic_text\n"
        "m = Sismic(sismic_text(2)); m.tick(1); assert m.count() == 1"
    ),
    "transitions": (
        "from bench.machines import Transitions\n"
        "m = Transitions(2); m.tick(1); assert m.count() == 1"
    ),
}


def floor(what: str) -> float:
    """Seconds of a Python process that imports what a command needs, and does nothing."""
    code = "import " + ", ".join(FLOORS[what]) if FLOORS[what] else "pass"
    return _timed([sys.executable, "-c", code])[0]


def peer(system: str) -> float:
    """Seconds of a whole process of a peer: a machine of two states, and one event."""
    return _timed([sys.executable, "-c", TINY[system]])[0]


def help_() -> float:
    """Seconds of ``prima --help``."""
    lasted, told = _timed(_prima("--help"))
    check("validate" in told and "talk" in told, f"this is not the help: {told}")
    return lasted


def validate() -> float:
    """Seconds of ``prima validate`` of a small clean file; a wrong one is refused."""
    lasted, told = _timed(_prima("validate", SMALL))
    check("1; no problems" in told, told)
    with tempfile.TemporaryDirectory() as folder:
        wrong = Path(folder, "wrong.xml")
        wrong.write_text((ROOT / SMALL).read_text(encoding="utf-8").replace("<speak>", "<spaek>"))
        refused = subprocess.run(_prima("validate", str(wrong)), capture_output=True, cwd=ROOT)
        check(refused.returncode == 1, "a wrong document is not refused")
    return lasted


XSD = """
import glob, sys
from lxml import etree
schema = etree.XMLSchema(etree.parse("schemas/dialogue.xsd"))
files = glob.glob(sys.argv[1] + "/*.xml")
print(sum(schema.validate(etree.parse(file)) for file in files))
"""


def validate_many(system: str, files: int) -> float:
    """Seconds of a process that validates so many small files; ``lxml`` parses them, with the XSD."""
    text = (ROOT / SMALL).read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        for index in range(files):
            own = text.replace('id="follow"', f'id="follow-{index}"', 1)
            Path(folder, f"{index}.xml").write_text(own, encoding="utf-8")
        if system == "lxml":
            lasted, told = _timed([sys.executable, "-c", XSD, folder])
            check(told.strip() == str(files), told)
        else:
            lasted, told = _timed(_prima("validate", folder))
            check(f"{files}; no problems" in told, told)
    return lasted


def run() -> float:
    """Seconds of ``prima run`` of the demo, with its transcript written."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "t.jsonl")
        lasted, told = _timed(_prima("run", DEMO, "-o", str(path)))
        lines = path.read_text(encoding="utf-8").splitlines()
        check(f"{len(lines)} records" in told and len(lines) > 300, told)
        check('"phase":"over"' in lines[-1].replace(" ", ""), lines[-1])
    return lasted


def _prima(*words: str) -> list[str]:
    return [sys.executable, "-m", "prima", *words]


def _timed(command: list[str]) -> tuple[float, str]:
    """Seconds of a process that has to end well, and its output.

    It runs twice, and the second time counts: where people work, modules have been compiled and
    files have been read before.
    """
    _ended(command)
    began = perf_counter()
    done = _ended(command)
    lasted = perf_counter() - began
    check(done.returncode == 0, f"{command}: {done.stderr}")
    return lasted, done.stdout + done.stderr


def _ended(command: list[str]) -> subprocess.CompletedProcess[str]:
    """A process that has ended; it keeps what it compiles, whatever this one has been told."""
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    return subprocess.run(command, capture_output=True, cwd=ROOT, env=kept, text=True, check=False)
