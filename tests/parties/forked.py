"""The command in processes that start quickly, and can be killed: they are forked from one with its imports."""

from __future__ import annotations

import os
import sys
from multiprocessing import get_context
from pathlib import Path

from prima import cli

LONGEST_S = 60
FORKED = get_context("forkserver")
FORKED.set_forkserver_preload(
    [
        "prima.api.live",
        "prima.cli.live",
        "prima.live.drivers.sim",
        "prima.live.resumed",
        "prima.live.visit",
        "prima.testing.golden",
        "prima.voicexml.checks.later",
        __name__,
    ]
)


class Command:
    """The command, in a process of its own, without a stdin and stdout.

    Args:
        said: A file for its stderr.
        words: What follows ``prima``.
    """

    def __init__(self, said: Path, *words: str) -> None:
        self._said = said
        self.process = FORKED.Process(target=prima, args=(str(said), *words))
        self.process.start()

    def end(self) -> tuple[int | None, str]:
        """Wait for its end: its exit code, and what it has written to stderr."""
        self.process.join(LONGEST_S)
        return self.process.exitcode, self._said.read_text() if self._said.exists() else ""


def prima(said: str, *words: str) -> None:
    """Run the command, in this process."""
    for number, path in enumerate((os.devnull, os.devnull, said)):
        opened = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC)
        os.dup2(opened, number)
        os.close(opened)
    sys.argv = ["prima", *words]
    cli.main()
