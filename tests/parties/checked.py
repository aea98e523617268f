"""``prima live --check`` against a party: its lines."""

from __future__ import annotations

from pathlib import Path

from tests.parties.bench import Process

WORLD = Path(__file__).parent / "world.xml"


def checked(party: str, robot: Path, **environment: str) -> tuple[int, dict[str, str]]:
    """The exit code of a check, and its lines by what they are about.

    Args:
        party: whose environment it runs in.
        robot: the robot's document.
        environment: more of the environment.
    """
    words = ("-m", "prima", "live", "--robot", str(robot), "--world", str(WORLD), "--check")
    check = Process(party, *words, **environment)
    try:
        check.process.wait(90)
        lines = [one.rstrip() for one in check.errors if one.strip()]
    finally:
        check.kill()
    return check.process.returncode, {line[7:33].strip(): line for line in lines}
