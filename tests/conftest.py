"""What holds for all tests."""

from __future__ import annotations

import gc
import signal

from tests.helpers.robot import close_sessions


def pytest_configure() -> None:
    """Let signals reach what tests start, also in the background of a shell and under `nohup`."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
        signal.signal(signal.SIGHUP, signal.SIG_DFL)


def pytest_collection_finish() -> None:
    """Leave the tests themselves, 11,000, out of every search for garbage that they make."""
    gc.collect()
    gc.freeze()


def pytest_runtest_teardown() -> None:
    """Give back a test's processes for scripts now: only the collector would do it later."""
    close_sessions()
