"""Ctrl-C in places that swallow exceptions."""

from __future__ import annotations

import sys
import threading
from types import SimpleNamespace
from typing import cast

import pytest

from prima.cli import interrupt_again


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
