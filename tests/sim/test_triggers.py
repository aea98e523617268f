"""Triggers of ``<when>`` and of expectations: which records fire them (docs/scenarios.md)."""

from __future__ import annotations

from typing import Any

import pytest

from prima.sim.triggers import fires
from prima.transcript.record import Entry

START = {"phase": "start", "command": "speak", "behavior": "guide#3"}
END = {"phase": "end", "command": "speak", "behavior": "guide#3", "outcome": "done"}
HEARD = {"phase": "listening", "behavior": "guide#3"}
TOUCH = {"phase": "event", "event": "touch.head"}
PRESSED = {"phase": "emergency", "outcome": "pressed"}
CASES: list[tuple[str, str, dict[str, Any], bool]] = [
    ("doing", "speak", START, True),
    ("doing", "speak", START | {"behavior": "guide#3.1"}, True),
    ("doing", "speak", START | {"behavior": "guide#3.2"}, False),
    ("doing", "speak", START | {"resumed": True}, False),
    ("doing", "gesture", START, False),
    ("doing", "speak", END, False),
    ("done", "speak", END, True),
    ("done", "speak", END | {"outcome": "again"}, False),
    ("done", "speak", END | {"outcome": "refused"}, True),
    ("done", "speak", START, False),
    ("asked", "which FLOOR", HEARD, True),
    ("asked", "which room", HEARD, False),
    ("asked", "which floor", END, False),
    ("said", "which floor", HEARD, True),
    ("said", "which floor", END, True),
    ("said", "which floor", END | {"outcome": "cancelled"}, False),
    ("said", "which floor", START, False),
    ("on", "touch", TOUCH, True),
    ("on", "tou", TOUCH, False),
    ("on", "touch", START, False),
    ("on", "emergency.stop", PRESSED, True),
    ("on", "emergency", PRESSED | {"outcome": "released"}, True),
    ("on", "emergency.stop", PRESSED | {"outcome": "released"}, False),
]


@pytest.mark.parametrize(("trigger", "what", "record", "fired"), CASES)
def test_records_that_fire_a_trigger(
    trigger: str, what: str, record: dict[str, Any], fired: bool
) -> None:
    assert fires(trigger, what, Entry(record | {"time": 1.0}), "Which floor, please?") is fired


def test_an_ab_that_says_nothing_has_not_asked() -> None:
    assert not fires("asked", "", Entry(HEARD | {"time": 1.0}), "")
