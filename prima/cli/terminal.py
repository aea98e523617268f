"""Lines typed or piped in, while time may pass."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Protocol

from prima.cli.failures import INTERRUPTED
from prima.cli.interrupts import PYTHONS
from prima.cli.printing import clean
from prima.devices.lines import line_text

GLANCE = 0.1
"""How often to check whether a line has been begun (s)."""
LONGEST_BYTES = 8004
"""Maximum length that is kept of a line, above the limit on lines."""


class Typist(Protocol):
    """Gives lines one by one."""

    def line(self, wait: float | None) -> str | None:
        """The next line, or None at the end of input.

        Raises:
            TimeoutError: there is none within so many seconds.
            UnicodeDecodeError: it is not UTF-8.
        """

    def begun(self) -> bool:
        """Whether a line has been begun and not finished, as far as can be known."""

    def ready(self) -> None:
        """Allow the next line, after the last one has been carried out."""


class Piped:
    """Lines of a pipe or file; too long ones are cut."""

    def __init__(self) -> None:
        self._held = b""
        self._over = sys.stdin is None

    def line(self, wait: float | None) -> str | None:
        """See :class:`Typist`."""
        import select

        while b"\n" not in self._held:
            if self._over:
                last, self._held = self._held, b""
                return line_text(last) if last else None
            if wait is not None and not select.select([0], [], [], wait)[0]:
                raise TimeoutError
            got = os.read(0, 65536)
            self._over = not got
            self._take(got)
        line, _, self._held = self._held.partition(b"\n")
        return line_text(line)

    def _take(self, got: bytes) -> None:
        """Keep what was read, and the beginning of a line that is too long."""
        for piece in got.splitlines(keepends=True):
            ends = piece.endswith(b"\n")
            begun = len(self._held) - self._held.rfind(b"\n") - 1
            self._held += piece.rstrip(b"\n")[: max(LONGEST_BYTES - begun, 0)]
            self._held += b"\n" if ends else b""

    def begun(self) -> bool:
        """Never: lines of a pipe come whole."""
        return False

    def ready(self) -> None:
        """Do nothing: no thread waits."""


class Keyboard:
    """Lines typed at a terminal while rows are printed above them; a context manager.

    Lines are edited in a thread of their own. Only the thread that asks for lines prints.
    """

    def __init__(self, prompt: str) -> None:
        import queue
        import threading

        self._prompt = prompt
        self._lines: queue.Queue[str | UnicodeDecodeError | None] = queue.Queue()
        self._asked = threading.Semaphore(1)
        self._typing = True
        self._prompted = threading.Event()
        """Set when the prompt is on the screen."""
        self._thread = threading.Thread(target=self._read, daemon=True)

    def __enter__(self) -> Keyboard:
        with suppress(ImportError, AttributeError):
            import readline

            readline.set_pre_input_hook(self._prompted.set)
        self._thread.start()
        self._prompted.wait(GLANCE)
        return self

    def __exit__(self, *_: object) -> None:
        if self._typing:
            sys.stdout.write("\n")
        sys.stdout.flush()

    def _read(self) -> None:
        while True:
            self._asked.acquire()
            try:
                self._lines.put(input(self._prompt))
            except UnicodeDecodeError as error:
                self._lines.put(error)
            except (EOFError, OSError, ValueError):
                self._lines.put(None)
                return

    def line(self, wait: float | None) -> str | None:
        """See :class:`Typist`."""
        import queue

        try:
            # Without a time the wait could not be interrupted on every system.
            got = self._lines.get(timeout=3600.0 if wait is None else wait)
        except queue.Empty:
            raise TimeoutError from None
        self._typing = got is None
        if isinstance(got, UnicodeDecodeError):
            raise got
        return got

    def begun(self) -> bool:
        """See :class:`Typist`."""
        return self._typing and bool(_typed())

    def ready(self) -> None:
        """See :class:`Typist`."""
        self._typing = True
        self._prompted.clear()
        self._asked.release()
        self._prompted.wait(GLANCE)

    def clear(self) -> None:
        """Erase the line being typed from the screen."""
        if self._typing:
            sys.stdout.write("\r\x1b[K")
            sys.stdout.flush()

    def restore(self) -> None:
        """Show the line being typed again."""
        if self._typing:
            sys.stdout.write(self._prompt + clean(_typed()))
            sys.stdout.flush()


class PausingClock:
    """Real time, except that it stands still while a line is being typed."""

    def __init__(self) -> None:
        self._start = time.monotonic()

    @property
    def now(self) -> int:
        """The time that has passed (ms)."""
        return round((time.monotonic() - self._start) * 1000)

    def back(self, now: int) -> None:
        """Go back to a time (ms)."""
        self._start = time.monotonic() - now / 1000

    def line(self, typist: Typist, until: int | None) -> str | None:
        """The next line; time stands still while it is typed.

        Raises:
            TimeoutError: no line has been begun by a time (ms).
            UnicodeDecodeError: it is not UTF-8.
        """
        while True:
            before, begun = self.now, typist.begun()
            left = GLANCE if until is None or begun else max((until - before) / 1000, 0)
            try:
                return typist.line(min(left, GLANCE))
            except TimeoutError:
                if not begun and until is not None and self.now >= until:
                    raise
            finally:
                if begun:
                    self.back(before)


@contextmanager
def ending_well(on_signal: Callable[[], object]) -> Iterator[None]:
    """Restore the terminal, however the session ends.

    An interrupt, or the end of the terminal, ends the process at once: an exception could be
    lost or changed while a line is edited.

    Args:
        on_signal: called before that; its exceptions are ignored.
    """
    restore = _restoring()

    def end(_number: int, _frame: object) -> None:
        restore()
        if os.isatty(2):
            os.write(2, b"\n")  # after the line that was begun
        with suppress(Exception):
            sys.stdout.flush()
        with suppress(Exception):
            on_signal()
        with suppress(OSError):  # the terminal may be gone
            os.write(2, b"prima: interrupted\n")
        os._exit(INTERRUPTED)

    heeded = [number for number in PYTHONS if signal.getsignal(number) is not signal.SIG_IGN]
    before = {number: signal.signal(number, end) for number in heeded}
    try:
        yield
    finally:
        restore()
        for number, handler in before.items():
            signal.signal(number, handler)


def _restoring() -> Callable[[], None]:
    """A function that restores the terminal's present state, if there is a terminal."""
    try:
        import termios
    except ImportError:
        return lambda: None
    try:
        state = termios.tcgetattr(0)
    except termios.error:
        return lambda: None

    def restore() -> None:
        with suppress(termios.error):
            termios.tcsetattr(0, termios.TCSANOW, state)

    return restore


def _typed() -> str:
    """The line as typed so far.

    It is copied before it is decoded: readline's own function decodes it while the thread that
    edits changes it, and then it fails, or the C library ends the process.
    """
    try:
        import readline
        from ctypes import CDLL, c_char_p

        library = CDLL(getattr(readline, "__file__", None))  # None: it is built into Python
        line = c_char_p.in_dll(library, "rl_line_buffer").value
    except (ImportError, OSError, ValueError):  # there is none that can be read
        return ""
    return (line or b"").decode(sys.stdin.encoding, "replace")


def edit_lines(complete: Callable[[str], list[str]]) -> None:
    """Turn on editing, history and completion of lines, if the system has readline.

    Args:
        complete: returns the completions of a line.
    """
    try:
        import readline
    except ImportError:
        return
    found: list[str] = []

    def choose(text: str, state: int) -> str | None:
        if state == 0:
            found[:] = complete(text)[:50]
        return found[state] if state < len(found) else None

    readline.set_completer_delims("")
    readline.set_completer(choose)
    readline.parse_and_bind(
        "bind ^I rl_complete" if "libedit" in (readline.__doc__ or "") else "tab: complete"
    )
