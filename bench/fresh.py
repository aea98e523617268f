"""Functions in processes of their own, and what every measurement checks with."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).parent.parent
RUN = (
    "import importlib, json, sys; module, name, args = sys.argv[1:];"
    "print(json.dumps(getattr(importlib.import_module(module), name)(*json.loads(args))))"
)


class WrongAnswer(Exception):
    """The process did other work than asked for, so there is no figure."""


def check(right: bool, message: str) -> None:
    """Refuse a figure unless its work was done.

    Raises:
        WrongAnswer: it was not.
    """
    if not right:
        raise WrongAnswer(message)


class Figure(NamedTuple):
    """Figures, and a remark about them."""

    value: float
    note: str = ""


NOTE = "note: "


def note(text: str) -> None:
    """Say something of the figure that this process is taking."""
    print(NOTE + text)


def fresh(function: Callable[..., float], *args: Any) -> Figure:
    """The result of a function in a new Python process.

    Raises:
        WrongAnswer: the process ended by an error.
    """
    main = sys.modules["__main__"].__spec__
    module = main.name if main and function.__module__ == "__main__" else function.__module__
    given = [module, function.__name__, json.dumps(args)]
    done = subprocess.run(
        [sys.executable, "-c", RUN, *given], capture_output=True, text=True, cwd=ROOT, check=False
    )
    if done.returncode:
        raise WrongAnswer(f"{function.__name__}{args}:\n{done.stderr}")
    *before, last = done.stdout.splitlines()
    notes = [line.removeprefix(NOTE) for line in before if line.startswith(NOTE)]
    return Figure(float(last), "; ".join(notes))
