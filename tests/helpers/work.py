"""Work counted in steps, the same however busy a machine is."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from types import FrameType
from typing import Any


def steps(act: Callable[[], object]) -> int:
    """Steps of Python's (bytecodes) that something takes.

    It is done once before: what is imported or made only the first time is not counted.
    What the garbage collector calls is not counted either: it may come at any time.
    """
    act()
    count = 0

    def note(frame: FrameType, event: str, _argument: object) -> Any:
        nonlocal count
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        count += event == "opcode"
        return note

    before = sys.gettrace()
    gc.disable()
    sys.settrace(note)
    try:
        act()
    finally:
        sys.settrace(before)
        gc.enable()
    return count
