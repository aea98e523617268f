"""Environments of tests: second parties of drivers, the oldest libraries: ``python -m tools.environments NAME...``.

Each folder of ``tests/parties`` with a ``requirements.txt`` has one, in ``.environments``: Python
with PRIMA's own requirements and those, and the Debian packages that its ``apt.txt`` names. An
environment that is there and up to date is left as it is.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
PARTIES = ROOT / "tests" / "parties"
HOME = ROOT / ".environments"
LONGEST_S = 600
"""How long the installation of one environment may take."""


def python_of(name: str) -> Path:
    """The interpreter of a party's environment."""
    return HOME / name / "bin" / "python"


def names() -> list[str]:
    """The parties that have an environment."""
    return sorted(path.parent.name for path in PARTIES.glob("*/requirements.txt"))


def install(name: str) -> None:
    """Make a party's environment, if it is not there or its requirements have changed.

    Raises:
        subprocess.SubprocessError: it cannot be installed, or not in time.
    """
    folder, home = PARTIES / name, HOME / name
    wanted = [ROOT / "release" / "runtime.txt", folder / "requirements.txt"]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in wanted)).hexdigest()
    stamp = home / "installed"
    if stamp.exists() and stamp.read_text() == digest:
        return
    print(f"installing the environment {name}", flush=True)
    packages = folder / "apt.txt"
    if packages.exists():
        _install_packages(packages.read_text().split())
    uv = (sys.executable, "-m", "uv", "--quiet")
    _run(*uv, "venv", "--clear", "--python", sys.executable, str(home))
    for path in wanted:
        where = ("--python", str(python_of(name)), "--requirements", str(path))
        _run(*uv, "pip", "install", "--compile-bytecode", *where)
    stamp.write_text(digest)


def _install_packages(packages: list[str]) -> None:
    asked = ["dpkg-query", "-W", "-f", "${Status}\n", *packages]
    found = subprocess.run(asked, capture_output=True, text=True, check=False).stdout
    if found.count("install ok installed") == len(packages):
        return
    _run("apt-get", "update", "-q")
    _run("apt-get", "install", "-q", "-y", "--no-install-recommends", *packages)


def _run(*command: str) -> None:
    quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    subprocess.run(command, check=True, timeout=LONGEST_S, env=quiet, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    for one in sys.argv[1:] or names():
        install(one)
