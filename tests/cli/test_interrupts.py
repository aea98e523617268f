"""Ctrl-C in places that swallow exceptions."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from prima.cli.interrupts import interrupt_again

ROOT = Path(__file__).parents[2]
IN_CLASS = """
import signal
import prima.cli
class Part:
    def __set_name__(self, owner, name):
        signal.raise_signal(signal.{name})
def make(**_):
    class Whole:
        part = Part()
prima.cli.cli.main = make
prima.cli.main()
"""
"""Python 3.11 makes a RuntimeError of each exception in this place, as in enumerations."""
IGNORED = "import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)"
IN_PHYSICS = """
import signal, sys
from prima.__main__ import main
left = [1]
def watch(frame, event, _):
    if event == "call" and frame.f_code.co_name == "{place}" and left:
        left.clear()
        signal.raise_signal(signal.SIGINT)
sys.setprofile(watch)
main()
"""
IN_TEXT = """
import builtins
from prima.__main__ import main
real = builtins.__import__
def imports(name, *rest, **named):
    if name == "{module}":
        exec("import signal; signal.raise_signal(signal.SIGINT)")
    return real(name, *rest, **named)
builtins.__import__ = imports
main()
"""
"""Dataclasses are made of text, too."""


@pytest.mark.parametrize("place", ["ext_cpSpaceShapeIteratorFunc", "spacefree", "step", "add"])
def test_ctrl_c_breaks_nothing_in_physics(place: str) -> None:
    """A world that was half freed crashed the process at its end."""
    done = subprocess.run(
        [sys.executable, "-c", IN_PHYSICS.format(place=place), "test", "documents/scenarios", "-j", "1"],
        capture_output=True, text=True, timeout=60, check=False, cwd=ROOT,
    )  # fmt: skip
    assert (done.returncode, done.stderr.lstrip()) == (130, "prima: interrupted\n")


def test_sigterm_in_physics_ends_a_background_job() -> None:
    """A shell's background job ignores SIGINT, by which the signal was repeated."""
    code = IGNORED + IN_PHYSICS.format(place="spacefree").replace("SIGINT", "SIGTERM")
    done = subprocess.run(
        [sys.executable, "-c", code, "test", "documents/scenarios", "-j", "1"],
        capture_output=True, text=True, timeout=60, check=False, cwd=ROOT,
    )  # fmt: skip
    assert (done.returncode, done.stderr.lstrip()) == (130, "prima: interrupted\n")


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_each_signal_ends_a_command_that_makes_a_class(name: str) -> None:
    done = subprocess.run(
        [sys.executable, "-c", IN_CLASS.format(name=name)],
        capture_output=True, text=True, timeout=60, check=False, cwd=ROOT,
    )  # fmt: skip
    assert (done.returncode, done.stderr.lstrip()) == (130, "prima: interrupted\n")


@pytest.mark.parametrize("module", ["prima.cli", "prima.talk"])
def test_a_module_interrupted_in_code_from_text_ends_with_130(tmp_path: Path, module: str) -> None:
    """``python -m`` repeats the signal to itself at its end, though the exception was handled."""
    (tmp_path / "started.py").write_text(IN_TEXT.format(module=module))
    done = subprocess.run(
        [sys.executable, "-m", "started", "talk", "none.xml"],
        capture_output=True, text=True, timeout=60, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert (done.returncode, done.stderr.lstrip()) == (130, "prima: interrupted\n")


def test_a_lost_ctrl_c_is_repeated_until_its_timer_has_started(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """On a busy machine the signal comes while the hook still waits for the timer's thread."""
    starts = 0

    class Quick(threading.Timer):
        def start(self) -> None:
            nonlocal starts
            starts += 1
            if starts < 3:
                raise KeyboardInterrupt

    monkeypatch.setattr(threading, "Timer", Quick)
    lost = SimpleNamespace(exc_value=KeyboardInterrupt())
    interrupt_again(cast("sys.UnraisableHookArgs", lost))
    assert starts == 3


class Talk(subprocess.Popen[str]):
    """A talk that waits for a line; ``before`` is run in its process, before PRIMA."""

    def __init__(self, before: str = "") -> None:
        scenario = "documents/scenarios/follow-during-navigation.xml"
        code = f"import signal\n{before}\nfrom prima.__main__ import main\nmain()"
        super().__init__(
            [sys.executable, "-c", code, "talk", "--scripted", scenario],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            cwd=ROOT,
        )  # fmt: skip
        assert self.stdin is not None and self.stdout is not None
        self.stdin.write("/wait 1s\n")
        self.stdin.flush()
        assert self.stdout.readline()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_each_signal_ends_a_talk_that_waits_for_a_line(number: signal.Signals) -> None:
    with Talk() as talk:
        talk.send_signal(number)
        assert talk.wait(60) == 130
        assert talk.stderr is not None
        assert talk.stderr.read().endswith("prima: interrupted\n")


def test_a_talk_goes_on_after_a_signal_that_its_caller_ignores() -> None:
    """As that of a closed terminal, under nohup."""
    with Talk("signal.signal(signal.SIGHUP, signal.SIG_IGN)") as talk:
        talk.send_signal(signal.SIGHUP)
        _, err = talk.communicate("/quit\n", timeout=60)
        assert talk.returncode == 0 and "interrupted" not in err
