"""prima talk at a terminal."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from prima import api
from tests import ROOT
from tests.helpers.talking import ASKS, TICKS, room

pty = pytest.importorskip("pty")


class Terminal:
    """The command in a terminal of its own."""

    def __init__(self, *words: str, folder: Path, **variables: str) -> None:
        self.pid, self.fd = pty.fork()
        if self.pid == 0:  # pragma: no cover
            os.chdir(folder)
            os.environ.update({"PYTHONPATH": str(ROOT), "TERM": "xterm", **variables})
            os.environ.setdefault("COLUMNS", "120")
            os.execv(sys.executable, [sys.executable, "-m", "prima", "talk", *words])
        self.seen = ""

    def type(self, text: str) -> None:
        os.write(self.fd, text.encode())

    def until(self, text: str, seconds: float = 30) -> str:
        """Wait until a text has come, and give all since the last time."""
        import select

        end, got = time.monotonic() + seconds, self.seen
        while text not in got:
            assert time.monotonic() < end, (text, got)
            if select.select([self.fd], [], [], 0.2)[0]:
                try:
                    got += os.read(self.fd, 65536).decode("utf-8", "replace")
                except OSError:
                    break
        assert text in got, got
        at = got.index(text) + len(text)
        self.seen, got = got[at:], got[:at]
        return got

    def end(self) -> int:
        import select

        end = time.monotonic() + 30
        while time.monotonic() < end:
            if select.select([self.fd], [], [], 0.1)[0]:
                try:
                    self.seen += os.read(self.fd, 65536).decode("utf-8", "replace")
                except OSError:
                    pass
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self._drain()
                os.close(self.fd)
                return os.waitstatus_to_exitcode(status)
        raise AssertionError(self.seen)

    def _drain(self) -> None:
        """Take what was written last."""
        try:
            while got := os.read(self.fd, 65536):
                self.seen += got.decode("utf-8", "replace")
        except OSError:  # Linux tells the end so
            return


def test_a_terminal_step_by_step(tmp_path: Path) -> None:
    terminal = Terminal(str(room(tmp_path, ASKS)), "--step", folder=tmp_path)
    terminal.until("ea listens> ")
    terminal.type("/wh\t\t")
    terminal.until("/who")
    terminal.type("\x15y\t\r")  # the answer is completed
    terminal.until("\x1b[36m")
    terminal.until('"yes"')
    terminal.until("Every application has ended")
    terminal.type("/save visit.xml\r")
    terminal.until("Saved visit.xml.")
    terminal.until("> ")  # before, the key would be nobody's
    terminal.type("\x04")
    assert terminal.end() == 0
    assert (tmp_path / "visit.xml").exists()


def test_no_colour_where_none_is_wanted(tmp_path: Path) -> None:
    terminal = Terminal(str(room(tmp_path, ASKS)), "--step", folder=tmp_path, NO_COLOR="1")
    terminal.until("ea listens> ")
    terminal.type("Yes.\r")
    assert "\x1b[3" not in terminal.until("ends ea: exit")
    terminal.type("/quit\r")
    assert terminal.end() == 0


def test_ctrl_c_ends_with_130_and_what_was_saved_is_intact(tmp_path: Path) -> None:
    path = room(tmp_path, '<form id="f"><on event="touch"><speak>Ouch.</speak></on></form>')
    for mode in ("--step", "--real-time"):
        target = tmp_path / f"at-end{mode}.xml"
        terminal = Terminal(str(path), mode, "--save", str(target), folder=tmp_path)
        terminal.until("> ")
        terminal.type("/touch head\r")
        terminal.until("Ouch.")
        terminal.type("/save first.xml\r")
        terminal.until("Saved first.xml.")
        terminal.until("> ")  # before, the key would be nobody's
        terminal.type("half a li")
        terminal.until("half a li")
        time.sleep(0.5)  # readline notices a signal only while it waits for a key
        terminal.type("\x03")
        assert terminal.end() == 130
        assert "interrupted" in terminal.seen
        for saved in (tmp_path / "first.xml", target):
            assert "Ouch." not in saved.read_text(encoding="utf-8").partition("<when")[0]
            assert any("Ouch" in row.what for row in api.rehearse(saved).rows())


def test_a_terminal_that_is_gone_ends_it_as_an_interrupt_does(tmp_path: Path) -> None:
    words = (str(room(tmp_path, TICKS)), "--save", "visit.xml")
    terminal = Terminal(*words, folder=tmp_path)
    terminal.until("Behavior")
    os.close(terminal.fd)
    assert os.waitstatus_to_exitcode(os.waitpid(terminal.pid, 0)[1]) == 130
    assert (tmp_path / "visit.xml").exists()


def test_time_stands_still_while_a_line_is_typed(tmp_path: Path) -> None:
    terminal = Terminal(str(room(tmp_path, TICKS)), folder=tmp_path, NO_COLOR="1")
    terminal.until("> ")
    terminal.type("/hel")
    terminal.until("/hel")
    with pytest.raises(AssertionError):
        terminal.until('"Tick."', seconds=4)
    terminal.type("p walk\r")
    terminal.until("walks to a place or thing")
    terminal.until('"Tick."')  # it goes on
    terminal.type("/quit\r")
    assert terminal.end() == 0


def test_a_question_waits_for_who_types_the_answer(tmp_path: Path) -> None:
    path = room(tmp_path, ASKS.replace("<prompt>", '<prompt timeout="2s">'))
    terminal = Terminal(str(path), folder=tmp_path, NO_COLOR="1")
    terminal.until('"Well?"')
    terminal.type("y")
    terminal.until("y")
    time.sleep(5)
    terminal.type("es\r")
    assert "Nothing heard" not in terminal.until('"Thanks."')
    terminal.type("/quit\r")
    assert terminal.end() == 0


def test_rows_come_above_the_line_that_is_typed(tmp_path: Path) -> None:
    from prima.cli.terminal import Keyboard

    terminal = Terminal(str(room(tmp_path, TICKS)), folder=tmp_path, NO_COLOR="1")
    terminal.until("> ")
    terminal.type("/note a\r/hel")  # the note's row comes while the next line is typed
    terminal.until("a\r\n")
    terminal.until("/hel")
    terminal.type("p walk\r")
    terminal.until("walks to a place or thing")
    terminal.type("/quit\r")
    assert terminal.end() == 0
    assert Keyboard("> ").begun() is False


def test_what_is_typed_is_shown_again_without_what_steers_a_terminal(tmp_path: Path) -> None:
    terminal = Terminal(str(room(tmp_path, TICKS)), folder=tmp_path, NO_COLOR="1")
    terminal.until("> ")
    terminal.type("/note a\r\x16\x1b]0;title\x07 hel")
    got = terminal.until("a\r\n") + terminal.until("hel")
    terminal.type("\x15/quit\r")
    assert terminal.end() == 0
    assert "\x1b]" not in got + terminal.seen


SLOW = """
import builtins, time
read = builtins.input
builtins.input = lambda prompt: (time.sleep(0.05), read(prompt))[1]
"""


def test_the_prompt_is_shown_before_rows_come_above_it(tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(SLOW)
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    terminal = Terminal(str(room(tmp_path, TICKS)), folder=tmp_path, PYTHONPATH=path)
    got = terminal.until("Behavior")
    assert "\n> \r\x1b[K       No. " in got
    terminal.until("> ")
    terminal.type("/quit\r")
    assert terminal.end() == 0


@pytest.mark.parametrize("begun", [(), (1, 2, 3)])
def test_a_clock_leaves_out_what_was_typed(
    begun: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    from prima.cli import terminal

    moment = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: moment[0])

    class Hand(terminal.Piped):
        """Types at some of the clock's looks, and is done at the sixth."""

        looks = 0

        def begun(self) -> bool:
            return self.looks in begun

        def line(self, wait: float | None) -> str | None:
            self.looks += 1
            moment[0] += wait or 0
            if self.looks == 6:
                return "yes"
            raise TimeoutError

    clock, hand = terminal.PausingClock(), Hand()
    assert clock.line(hand, 10_000) == "yes"
    assert clock.now == 600 - 100 * len(begun)


POLLS = """
import sys, threading, time
from prima.cli.terminal import _typed

def edit():
    while True:
        input()

seen = {_typed()}
threading.Thread(target=edit, daemon=True).start()
end = time.monotonic() + 2
while time.monotonic() < end:
    seen.add(_typed())
sys.exit(len(seen) < 2)  # a word at its end might be lost with the terminal
"""


def test_a_line_is_read_while_it_changes() -> None:
    """readline's own function fails, or aborts the process, if a key comes meanwhile."""
    import select

    pid, fd = pty.fork()
    if pid == 0:  # pragma: no cover
        os.environ.update({"PYTHONPATH": str(ROOT), "TERM": "xterm"})
        os.execv(sys.executable, [sys.executable, "-c", POLLS])
    shown = ""
    while True:
        reading, writing, _ = select.select([fd], [fd], [], 5)
        try:
            if writing and not reading:
                os.write(fd, b"e" * 60 + b"\x15\r")
                time.sleep(0.004)
            shown += os.read(fd, 65536).decode("utf-8", "replace") if reading else ""
        except OSError:  # the process has ended
            break
    assert os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 0, shown[-300:]
