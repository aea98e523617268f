"""Peers that are not written in Python: XState (JavaScript) and Apache Commons SCXML (Java).

``python -m bench.peers`` installs those whose tools are there, into this folder.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from bench.fresh import WrongAnswer, check

HERE = Path(__file__).parent
BUILD = HERE / "build"
WARM_SECONDS = 2.5
"""How long they run before they are timed: both compile while they run."""
LONGEST_SECONDS = 180


@dataclass(frozen=True)
class Peer:
    """How a peer is installed and run."""

    title: str
    tools: tuple[str, ...]
    install: tuple[tuple[str, ...], ...]
    command: tuple[str, ...]
    proof: Path
    """A file that is there when it is installed."""


CLASSES = os.pathsep.join(("build", str(Path("build", "lib", "*"))))
PEERS = {
    "xstate": Peer(
        "XState",
        ("node", "npm"),
        (("npm", "ci", "--ignore-scripts", "--silent", "--no-audit", "--no-fund"),),
        ("node", "ring.mjs"),
        HERE / "node_modules" / ".package-lock.json",
    ),
    "scxml": Peer(
        "Commons SCXML",
        ("java", "javac", "mvn"),
        (
            ("mvn", "-q", "-B", "dependency:copy-dependencies", "-DoutputDirectory=build/lib"),
            ("javac", "-cp", CLASSES, "-d", "build", "Ring.java"),
        ),
        ("java", "-cp", CLASSES, "Ring"),
        BUILD / "Ring.class",
    ),
}


def installed(name: str) -> bool:
    """Whether a peer can be measured here."""
    peer = PEERS[name]
    return peer.proof.exists() and shutil.which(peer.command[0]) is not None


def runtime(name: str) -> str:
    """The platform of a peer, with its version."""
    told = _run((PEERS[name].command[0], "--version")).splitlines()[0]
    return f"node {told}" if name == "xstate" else told


def version(name: str) -> str:
    """Which version of a peer is installed."""
    if name == "xstate":
        lock = json.loads(PEERS[name].proof.read_text(encoding="utf-8"))
        return str(lock["packages"]["node_modules/xstate"]["version"])
    jar = next((BUILD / "lib").glob("commons-scxml-*.jar"))
    return jar.stem.removeprefix("commons-scxml-")


def rate(name: str, states: int, seconds: float, guards: bool = False) -> float:
    """Events a second of a peer's ring, which must have counted every one of them.

    Raises:
        WrongAnswer: it has lost some, or did not run.
    """
    warm = min(WARM_SECONDS, 5 * seconds)
    given = [str(states), str(int(guards)), str(warm), str(seconds)]
    return checked(states, _run(PEERS[name].command, *given))


def checked(states: int, told: str) -> float:
    """Events a second, from a peer's output: see ``ring.mjs``.

    Raises:
        WrongAnswer: its counter or its state is not what so many events make.
    """
    found = json.loads(told)
    check(found["count"] == found["sent"], f"{found['sent'] - found['count']} events are missing")
    check(found["state"] == found["sent"] % states, "it is in another state")
    return float(found["timed"] / found["lasted"])


def _run(command: tuple[str, ...], *more: str) -> str:
    done = subprocess.run(
        [shutil.which(command[0]) or command[0], *command[1:], *more],
        capture_output=True,
        text=True,
        cwd=HERE,
        timeout=LONGEST_SECONDS,
        check=False,
    )
    if done.returncode:
        raise WrongAnswer(f"{' '.join(command)}: {done.stderr or done.stdout}")
    return done.stdout


def install(name: str) -> str:
    """Install a peer if its tools are there; gives a sentence on how that went."""
    peer = PEERS[name]
    missing = [tool for tool in peer.tools if shutil.which(tool) is None]
    if installed(name) and peer.proof.stat().st_mtime >= _changed():
        return f"{peer.title} {version(name)} is installed."
    if missing:
        return f"{peer.title} is left out: it needs {' and '.join(missing)}."
    try:
        for command in peer.install:
            _run(command)
    except (WrongAnswer, subprocess.TimeoutExpired) as error:
        return f"{peer.title} is left out: it could not be installed. {error}"
    return f"{peer.title} {version(name)} is installed."


def _changed() -> float:
    """When what the peers are made of was changed last."""
    made_of = (path for path in HERE.iterdir() if path.is_file() and path.suffix != ".py")
    return max(path.stat().st_mtime for path in made_of)


def main() -> None:
    """Install all that can be."""
    for name in PEERS:
        print(install(name), file=sys.stderr)
