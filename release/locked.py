"""What the files of locked versions say."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

FOLDER = Path(__file__).parent
PIN = re.compile(r"([A-Za-z0-9][A-Za-z0-9._-]*)==([^\s;\\]+)")
HASH = re.compile(r"--hash=sha256:([0-9a-f]{64})")
PROJECT = "prima"


@dataclass(slots=True)
class Locked:
    """A package in the one version that is installed, and what may be installed of it."""

    name: str
    version: str
    hashes: list[str] = field(default_factory=list)
    """SHA-256 of each file that is taken for it."""
    via: list[str] = field(default_factory=list)
    """The packages that need it."""


def locked(name: str) -> list[Locked]:
    """The packages of ``runtime`` or ``dev``, in their order."""
    found: list[Locked] = []
    for line in (FOLDER / f"{name}.txt").read_text(encoding="utf-8").splitlines():
        if pin := PIN.match(line):
            found.append(Locked(pin[1], pin[2]))
        elif found:
            _add(found[-1], line.strip())
    return found


def _add(package: Locked, line: str) -> None:
    if by := HASH.search(line):
        package.hashes.append(by[1])
    elif line.startswith("#"):
        named = line.lstrip("# ").removeprefix("via").strip().partition(" ")[0]
        package.via += [named] if named else []
