"""The command line in this process: what needs no pool, terminal or signal."""

from __future__ import annotations

import io
import os
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import chdir, contextmanager, redirect_stderr, redirect_stdout
from dataclasses import asdict
from pathlib import Path
from subprocess import CompletedProcess
from unittest.mock import patch

from prima import cli
from prima.markup.limits import LIMITS, set_limits


def prima(
    *args: object,
    cwd: str | Path = ".",
    input: str | bytes = "",
    env: Mapping[str, str] | None = None,
    encoding: str = "utf-8",
    together: bool = False,
    terminal: io.TextIOWrapper | None = None,
) -> CompletedProcess[str]:
    """Run ``prima`` with arguments; a traceback, or a defect that it reports, fails the test.

    Args:
        args: The words of the command.
        cwd: Its folder.
        input: What it reads from a file as its stdin.
        env: Its whole environment, as far as Python has not read that when it started.
        encoding: That of its stdout at the beginning, as PYTHONIOENCODING sets it.
        together: Whether its stderr goes to its stdout.
        terminal: Where both go, instead of into what is returned.
    """
    words = [str(one) for one in args]
    code: object = 0
    out = terminal or _stream(encoding)
    err = terminal or (out if together else _stream("utf-8"))
    argv = patch.object(sys, "argv", ["prima", *words])
    environment = patch.dict(os.environ, dict(os.environ if env is None else env), clear=True)
    with chdir(cwd), environment, _own_process(input), redirect_stdout(out), redirect_stderr(err):
        try:
            with argv:
                cli.main()
        except SystemExit as ended:
            code = ended.code
    if terminal:
        terminal.flush()
        return CompletedProcess(words, int(str(code or 0)))
    errors = _text(err)
    assert "Traceback" not in errors and "defect of prima" not in errors, errors
    return CompletedProcess(words, int(str(code or 0)), _text(out), "" if together else errors)


@contextmanager
def _own_process(input: str | bytes) -> Iterator[None]:
    """Give back afterwards what a command changes for the rest of its process."""
    limits = asdict(LIMITS)  # --limit
    kept = os.dup(0), os.dup(1)
    given = input.encode("utf-8", "surrogateescape") if isinstance(input, str) else input
    try:
        with tempfile.TemporaryFile() as file:
            file.write(given)
            file.seek(0)
            os.dup2(file.fileno(), 0)
        with open(0, encoding="utf-8", closefd=False) as stdin, patch.object(sys, "stdin", stdin):
            yield
    finally:
        for number, one in enumerate(kept):  # stdout is closed where nobody reads it any more
            os.dup2(one, number)
            os.close(one)
        set_limits(limits)


def _stream(encoding: str) -> io.TextIOWrapper:
    errors = "surrogateescape" if encoding == "utf-8" else "strict"
    return io.TextIOWrapper(io.BytesIO(), encoding, errors, newline="")


def _text(stream: io.TextIOWrapper) -> str:
    stream.flush()
    raw = stream.buffer
    assert isinstance(raw, io.BytesIO)
    return raw.getvalue().decode("utf-8", "surrogateescape").replace("\r\n", "\n")
