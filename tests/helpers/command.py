"""The command line in a process of its own."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path


def prima(
    *args: object,
    cwd: str | Path | None = None,
    input: str = "",
    env: Mapping[str, str] | None = None,
    timeout: float = 60,
) -> subprocess.CompletedProcess[str]:
    """Run ``prima`` with arguments; a traceback, or a defect that it tells of, fails the test."""
    done = subprocess.run(
        [sys.executable, "-m", "prima", *map(str, args)],
        capture_output=True,
        encoding="utf-8",
        errors="surrogateescape",
        timeout=timeout,
        cwd=cwd,
        input=input,
        env=env,
        check=False,
    )
    assert "Traceback" not in done.stderr and "defect of prima" not in done.stderr, done.stderr
    return done
