"""Measures of records that no short run has."""

from __future__ import annotations

from typing import Any

import pytest

from prima.messages import Record
from prima.transcript.observer import observe


def question(app: str, number: int, begin: float, end: float, outcome: str) -> list[Record]:
    """The records of a question of an application."""
    common: dict[str, Any] = {
        "actor": "robot",
        "app": app,
        "behavior": f"{app}#{number}",
        "tree": f"{app}:1",
        "command": "q-and-a",
        "text": "Well?",
        "devices": ["speaker", "speech-recognition"],
    }
    return [
        {"time": begin, "phase": "request", **common},
        {"time": begin, "phase": "start", **common},
        {"time": end, "phase": "end", **common, "outcome": outcome},
    ]


@pytest.mark.parametrize(("asked", "count"), [("ea", 1), ("fa", 1)])
def test_the_timeout_of_each_application_is_remembered(asked: str, count: int) -> None:
    """Whoever takes the answer, a question of the other one has timed out less than 3 s before."""
    records = [
        *question("ea", 1, 0.0, 5.0, "noinput"),
        *question("fa", 1, 5.0, 6.0, "noinput"),
        *question(asked, 2, 6.0, 7.5, "filled"),
    ]
    assert observe(records).misanswered == count


@pytest.mark.parametrize(("end", "count"), [(4.4, 1), (4.401, 0), (4.399, 1)])
def test_an_answer_exactly_three_seconds_after_a_timeout_is_late(end: float, count: int) -> None:
    """4.4 - 1.4 is a little more than 3 for floats."""
    records = [
        *question("ea", 1, 0.0, 1.4, "noinput"),
        *question("fa", 1, 1.4, end, "filled"),
    ]
    assert observe(records).misanswered == count
