"""Progress of a batch on a terminal."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import subprocess
import time
from pathlib import Path

import pytest

from tests.helpers.batches import ENDLESS, MODULE, SECONDS, files, prima, scenario, write


def terminal(words: list[str], out_too: bool, **environment: str) -> tuple[bytes, bytes]:
    """What a batch writes to a terminal that is its stderr, and to its stdout."""
    ours, theirs = pty.openpty()
    made = subprocess.Popen(
        [*MODULE, *words],
        stdout=theirs if out_too else subprocess.PIPE,
        stderr=theirs,
        env={**os.environ, **environment},
    )
    os.close(theirs)
    said = b""
    deadline = time.monotonic() + SECONDS
    while time.monotonic() < deadline and select.select([ours], [], [], SECONDS)[0]:
        try:
            said += os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
    out = made.communicate(timeout=SECONDS)[0] or b""
    os.close(ours)
    return said, out


def test_progress_is_told_to_a_terminal_alone(stage: Path) -> None:
    write("a/endless.xml", ENDLESS)
    for name in "pqrs":
        write(f"b/{name}.xml", scenario(name, "../a/endless.xml", "300s"))
    words = ["b", "a/three.xml"]
    said, out = terminal(words, out_too=False)
    assert re.search(rb"\r[1-6] of 7 runs", said)
    assert out.decode() == prima(*words).stdout
    assert b"\x1b" not in out
    both, _ = terminal(words, out_too=True, NO_COLOR="1")
    assert re.search(rb"\r2 of 7 runs(, 1 not fine)?; about \d+ s left ", both)
    assert re.search(rb" \rb/q.xml +prima +0  until", both)  # a row begins at the margin
    assert prima("b").stderr == ""


@pytest.mark.parametrize(
    ("variable", "value", "wanted"),
    [("NO_COLOR", "1", False), ("NO_COLOR", "", True), ("TERM", "dumb", False)],
)
def test_colours_are_for_terminals_that_want_them(
    stage: Path, variable: str, value: str, wanted: bool
) -> None:
    colours = {"NO_COLOR": "", "TERM": "xterm", variable: value}
    said, _ = terminal(["a/one.xml", "a/three.xml"], out_too=True, **colours)
    red = [line for line in said.splitlines() if b"\x1b[31m" in line]
    assert [b"a/three.xml" in line for line in red] == [True] * wanted
    assert (b"\x1b" in said) is wanted


def test_control_characters_in_a_name_do_not_reach_the_terminal(stage: Path) -> None:
    done = prima("a/one.xml", "a/\x1b[31m.xml")
    assert "\x1b" not in done.stdout + done.stderr


@pytest.mark.parametrize("form", ["text", "json"])
def test_a_name_that_is_not_utf_8(stage: Path, form: str) -> None:
    shutil.copy("b/one.xml", os.fsdecode(b"b/\xff.xml"))
    env = {**os.environ, "PYTHONIOENCODING": "utf-8:strict"}
    done = prima("b", "-o", "runs", "--format", form, env=env)
    assert done.returncode == 2
    assert "its path is not UTF-8; rename it." in done.stderr
    assert set(files("runs")) == {
        f"b/{name}{end}" for name in ("one", "five") for end in (".jsonl", ".run.json")
    }


def test_nobody_reads_any_more(stage: Path) -> None:
    words = "a b --policy prima --policy fifo -j 1 -o"
    whole = prima(*words.split(), "whole")
    command = f"{' '.join(MODULE)} {words} unread | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, timeout=SECONDS, check=False
    )
    assert "Traceback" not in done.stderr and done.stdout.startswith("scenario")
    assert (done.returncode, files("unread")) == (whole.returncode, files("whole"))
    assert done.returncode != 0
