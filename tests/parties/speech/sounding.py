"""PRIMA in the environment of the speech driver."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[3]
HERE = "tests/parties/speech"
LONGEST_S = 240
"""How long a run may take."""


def prima(python: str, *words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [python, "-m", "prima", *words],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "200", "PYTHONUNBUFFERED": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
