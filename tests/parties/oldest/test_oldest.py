"""PRIMA with the oldest versions of its libraries that it allows."""

from __future__ import annotations

import filecmp
import os
import subprocess
import sys
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.version import Version

from tests import ROOT
from tools.environments import PARTIES, python_of

OLDEST = [
    Requirement(line)
    for line in (PARTIES / "oldest" / "requirements.txt").read_text().splitlines()
    if not line.startswith("#")
]


def prima(python: str | Path, *words: str) -> None:
    """Run ``prima``; its exit code must be 0."""
    command = [str(python), "-m", "prima", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_environment_has_the_versions_that_begin_each_range() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = {one.name: one.specifier for one in map(Requirement, project["dependencies"])}
    assert {one.name for one in OLDEST} == set(wanted)
    for one in OLDEST:
        (first,) = [part for part in wanted[one.name] if part.operator == ">="]
        (own,) = one.specifier
        release, least = Version(own.version).release, Version(first.version).release
        assert release[: len(least)] == least, one


def test_all_documents_are_fine() -> None:
    prima(python_of("oldest"), "validate", "documents")


def test_the_shipped_scenarios_give_the_same_transcripts(tmp_path: Path) -> None:
    prima(python_of("oldest"), "run", "documents/scenarios", "-o", str(tmp_path / "oldest"))
    prima(sys.executable, "run", "documents/scenarios", "-o", str(tmp_path / "newest"))
    compared = [*(tmp_path / "newest").rglob("*.jsonl")]
    assert compared
    for one in compared:
        other = tmp_path / "oldest" / one.relative_to(tmp_path / "newest")
        assert filecmp.cmp(one, other, shallow=False), one.name
