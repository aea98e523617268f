"""Measures of records, made up one by one."""

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


def records_of(
    app: str, number: int, phases: dict[str, float], command: str = "speak", **more: Any
) -> list[Record]:
    """The records of a Command, by phase and time; a text makes it speak."""
    common: dict[str, Any] = {
        "actor": "robot",
        "app": app,
        "behavior": f"{app}#{number}",
        "tree": f"{app}:1",
        "command": command,
        "devices": ["speaker"] if "text" in more else ["neck"],
    }
    return [{"time": at, "phase": phase, **common, **more} for phase, at in phases.items()]


def in_time(*commands: list[Record]) -> list[Record]:
    return sorted((one for records in commands for one in records), key=lambda one: one["time"])


def whole(begin: float, end: float, requested: float = 0.0) -> dict[str, float]:
    return {"request": requested, "start": begin, "end": end}


@pytest.mark.parametrize(
    ("later", "count"), [({}, 0), ({"cancel": 5.0}, 0), ({"start": 5.0}, 1)], ids=str
)
def test_what_gave_way_counts_when_it_starts_again(later: dict[str, float], count: int) -> None:
    gave_way = records_of("ea", 1, {"request": 0.0, "start": 0.0, "interrupt": 1.0}, text="One.")
    assert observe(in_time(gave_way, records_of("ea", 1, later, text="One."))).restarts == count


@pytest.mark.parametrize(("phases", "count"), [({"start": 2.0}, 1), ({"cancel": 2.0}, 0)], ids=str)
def test_who_never_asks_begins_no_conversation(phases: dict[str, float], count: int) -> None:
    asks = records_of("ea", 2, {"request": 0.0, **phases}, "q-and-a", text="Well?")
    assert observe(in_time(records_of("ea", 1, whole(0, 1), text="Hi."), asks)).unfaced == count


def test_a_reaction_that_came_first_hides_no_break() -> None:
    topic = [records_of("ea", 1, whole(0, 1), text="1"), records_of("ea", 2, whole(4, 5), text="2")]
    reaction = records_of("fa", 1, whole(1.3, 2, 1), text="Ouch.", reactive=True, cause=1)
    other = records_of("third", 1, whole(2.2, 3, 1), text="By the way.")
    assert observe(in_time(*topic, reaction)).broken == 0
    assert observe(in_time(*topic, reaction, other)).broken == 1


def test_a_break_by_words_and_a_turn_counts_once() -> None:
    topic = [
        records_of("ea", 1, whole(0, 1), text="1"),
        records_of("ea", 2, whole(1, 3), "move-head"),
        records_of("ea", 3, whole(4.7, 7.9), "face-human"),
        records_of("ea", 4, whole(7.9, 9), text="2"),
    ]
    others = [
        records_of("fa", 1, whole(1.3, 2), text="I say."),
        records_of("fa", 2, whole(3.3, 4.7), "turn"),
    ]
    assert observe(in_time(*topic, *others)).broken == 1


@pytest.mark.parametrize("first", ["fa", "ea"])
@pytest.mark.parametrize(("feedback", "count"), [(False, 1), (True, 0)])
def test_words_between_two_utterances_break_a_topic_whichever_is_recorded_first(
    first: str, feedback: bool, count: int
) -> None:
    """In the instant of the words it turns its head or drives, and only on its way one may talk."""
    beside = records_of("ea", 2, whole(1, 3), "move-head", feedback=feedback)
    words = records_of("fa", 1, whole(1, 2), text="I say.")
    topic = [
        records_of("ea", 1, whole(0, 1), text="1"),
        *([words, beside] if first == "fa" else [beside, words]),
        records_of("ea", 3, whole(3, 4), text="2"),
    ]
    assert observe(in_time(*topic)).broken == count


def test_words_that_begin_with_the_next_utterance_are_not_between_two() -> None:
    topic = [
        records_of("ea", 1, whole(0, 1), text="1"),
        records_of("ea", 2, whole(1, 3), "move-head"),
        records_of("fa", 1, whole(2, 3), text="I say."),
        records_of("ea", 3, whole(2, 3), text="2"),
    ]
    assert observe(in_time(*topic)).broken == 0


@pytest.mark.parametrize(("leaves", "count"), [(False, 1), (True, 0)])
def test_who_leaves_the_user_itself_is_not_left(leaves: bool, count: int) -> None:
    """The robot drives away for another application: from whom it talks to, but not on its way."""
    goes = records_of("ea", 2, whole(2, 9), "topological-move", leaves=leaves, feedback=True)
    other = records_of("fa", 1, whole(3, 5), "topological-move", leaves=True, feedback=True)
    asks = [one | {"engages": True} for one in question("ea", 1, 0.0, 2.0, "filled")]
    told = in_time(asks, goes, other)
    assert observe(told).left == count


def test_parts_of_a_unit_that_runs_leave_a_reaction_one() -> None:
    unit = [
        records_of("ea", 1, whole(2, 6, 2), "iu", reactive=True, cause=1),
        records_of("ea", 2, whole(2, 3, 2), text="I have got a message.", unit="ea#1"),
        records_of("ea", 3, whole(4, 6, 2), text="It is this.", unit="ea#1"),
        records_of("ea", 4, whole(9, 10, 2), text="So much for that."),
    ]
    touched = [
        records_of("fa", 1, whole(0, 1), text="I go."),
        records_of("fa", 2, whole(3, 3.1, 3), "stop-moving", reactive=True, cause=2),
        records_of("fa", 3, whole(6, 7, 3), text="What is it?"),
    ]
    assert observe(in_time(*unit, *touched)).broken == 0


@pytest.mark.parametrize(("between", "count"), [(999, 1), (1000, 1), (1001, 0)])
def test_a_reaction_counts_after_a_thousand_other_events(between: int, count: int) -> None:
    common = {"phase": "event", "actor": "user", "event": "touch.head"}
    events: list[Record] = [
        {"time": number / 1000, "serial": number, **common} for number in range(1, between + 2)
    ]
    reaction = records_of("ea", 1, whole(3, 4, 3), text="Ouch.", reactive=True, cause=1)
    assert observe(in_time(events, reaction)).reactions == count
