"""The command line in this process: what needs no pool, terminal, signal or input."""

from __future__ import annotations

import io
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import asdict
from pathlib import Path
from subprocess import CompletedProcess
from unittest.mock import patch

from prima import cli
from prima.markup.limits import LIMITS


def prima(*args: object, cwd: str | Path = ".") -> CompletedProcess[str]:
    """Run ``prima`` with arguments; a traceback, or a defect that it reports, fails the test."""
    words = [str(one) for one in args]
    code: object = 0
    out, err = _stream(), _stream()
    limits = asdict(LIMITS)
    argv = patch.object(sys, "argv", ["prima", *words])
    with chdir(cwd), redirect_stdout(out), redirect_stderr(err), argv:
        try:
            cli.main()
        except SystemExit as ended:
            code = ended.code
        finally:
            for name, number in limits.items():  # --limit is for one process
                setattr(LIMITS, name, number)
    errors = _text(err)
    assert "Traceback" not in errors and "defect of prima" not in errors, errors
    return CompletedProcess(words, int(str(code or 0)), _text(out), errors)


def _stream() -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BytesIO(), "utf-8", "surrogateescape", newline="")


def _text(stream: io.TextIOWrapper) -> str:
    stream.flush()
    raw = stream.buffer
    assert isinstance(raw, io.BytesIO)
    return raw.getvalue().decode("utf-8", "surrogateescape").replace("\r\n", "\n")
