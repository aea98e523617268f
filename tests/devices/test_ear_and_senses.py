"""The ear, sight, sensors, speech with marks, the loop."""

from __future__ import annotations

from typing import Any

import pytest

from prima.devices.conductor import Conductor
from prima.devices.ear import Ear
from prima.devices.goals import Begin, Done, RecordingBounds
from prima.devices.loop import Loop
from prima.devices.profile import Profile
from prima.devices.senses import LOST_AFTER_MS, Sensors, Sight
from prima.devices.speech import SpeechMarks, Utterance
from prima.language.commands import TABLE_4_2
from prima.messages import (
    ApplicationLoaded,
    Command,
    Cue,
    Ended,
    Inbound,
    Json,
    Occurred,
    Order,
    Record,
    Sensed,
)
from prima.scheduler.policy import policy_named
from prima.session import Session


def events(values: list[Inbound]) -> list[str]:
    return [one.name for one in values if isinstance(one, Occurred)]


def question(*cues: Cue, **args: object) -> Command:
    return Command("q-and-a", {"timeout": 5000, **args}, "Shall we go?", cues=cues)


def test_a_question_that_nobody_answers_is_over_after_its_timeout() -> None:
    ear = Ear()
    ear.ask("a#1", question())
    assert ear.due() is None, "it is still being asked"
    ear.listen(2000, "a#1")
    assert ear.due() == 7000
    assert ear.unanswered(6999, "a#1") == []
    assert ear.unanswered(7000, "a#1") == [Ended("a#1", True, {"outcome": "noinput"})]
    assert ear.question is None


def test_who_speaks_is_not_interrupted_by_the_timeout() -> None:
    ear = Ear()
    ear.ask("a#1", question())
    ear.listen(0, "a#1")
    assert ear.speech_begins() == ""
    assert ear.due() is None
    ear.listen_on(4000)
    assert ear.due() is None, "they are still speaking"
    ear.speech_ends()
    ear.listen_on(6000)
    assert ear.due() == 11000


def test_a_timeout_does_not_begin_while_the_user_speaks() -> None:
    ear = Ear()
    ear.speech_begins()
    ear.ask("a#1", question())
    ear.listen(1000, "a#1")
    assert ear.due() is None


@pytest.mark.parametrize(
    ("command", "broken_off"),
    [
        (question(), True),
        (question(bargein=False), False),
        (question(Cue(0, "hotword")), False),
    ],
)
def test_bargein_breaks_off_a_prompt(command: Command, broken_off: bool) -> None:
    ear = Ear()
    ear.ask("a#1", command)
    assert ear.speech_begins() == ("a#1" if broken_off else "")


def test_a_recogniser_that_hangs_never_ends_the_question() -> None:
    ear = Ear()
    ear.ask("a#1", question())
    ear.listen(0, "a#1")
    ear.deafen("a#1")
    assert ear.due() is None
    ear.listen_on(100)
    assert ear.due() is None
    assert ear.unanswered(10**9, "a#1") == []


def test_the_bounds_of_a_recording() -> None:
    ear = Ear()
    ear.ask("a#1", question())
    assert ear.recording() is None
    ear.drop("a#1")
    ear.ask("a#2", question(Cue(0, "record", 8000), Cue(0, "finalsilence", 1500)))
    assert ear.recording() == RecordingBounds(8000, 1500)


def test_sight_finds_at_once_and_loses_after_a_while() -> None:
    sight, where = Sight(), {"distance": 1.0}
    assert events(sight.look(0, True, where)) == ["human.found"]
    assert sight.look(100, True, where) == []
    assert sight.look(200, False, {}) == []
    assert sight.due(200, False) == 200 + LOST_AFTER_MS
    assert sight.look(700, True, where) == [], "out of sight for a moment only"
    assert sight.look(800, False, {}) == []
    assert events(sight.look(800 + LOST_AFTER_MS, False, {})) == ["human.lost"]
    assert sight.due(10_000, False) is None


def test_a_search_reports_by_itself_whom_it_finds() -> None:
    sight = Sight()
    assert sight.look(0, True, {}, searching=True) == []
    found = Occurred("human.found", "robot", {"angle": 3.0, "sensed": True})
    assert sight.find({"angle": 3.0}) == found
    assert sight.look(100, True, {}) == []


@pytest.mark.parametrize("goes_on", [True, False])
def test_whom_the_camera_sees_before_the_search_has_found_them_is_reported_once(
    goes_on: bool,
) -> None:
    profile = Profile("any", commands=dict(TABLE_4_2), loop=500)
    conductor = Conductor(profile, dict)
    command, devices = Command("active-sensing-human", {}), frozenset({"locomotion"})
    conductor.order(0, Order("start", "a#1.1", command, devices, 1))
    (goal,) = conductor.drain()
    assert isinstance(goal, Begin)
    assert conductor.collect(499, True, {}) == []
    assert conductor.collect(500, True, {}) == [Ended("a#1.1", False)]
    if goes_on:
        conductor.order(500, Order("start", "a#1.2", command, devices, 2))
    conductor.end_loops()
    conductor.report(502, Done(goal.key))
    assert conductor.due(True) == (1000 if goes_on else 503)
    found = conductor.collect(conductor.due(True) or 0, True, {})
    assert events(found) == ["human.found"]
    assert events(conductor.collect(1500, True, {})) == []


def test_sensors_tell_changes_alone() -> None:
    sensors = Sensors()
    assert sensors.take({"battery": 80, "door": None}) == [Sensed({"battery": 80, "door": None})]
    assert sensors.take({"battery": 80}) == []
    assert sensors.take({"battery": 79, "door": None}) == [Sensed({"battery": 79})]


@pytest.mark.parametrize("values", [[1, True], [True, 1], [0.0, False]])
def test_a_sensor_that_turns_true_has_changed_from_one(values: list[Json]) -> None:
    sensors = Sensors()
    assert [len(sensors.take({"door": value})) for value in values] == [1, 1]


def start(*cues: Cue, **more: Any) -> Order:
    command = Command("speak", {}, "One two three four.", lang="en", cues=cues)
    return Order("start", "a#1", command, app="a", **more)


def test_how_much_of_an_utterance_has_been_heard() -> None:
    said = Utterance.of(1000, start(), {"en": 10.0})
    assert said is not None
    assert said.heard(1000) == {"heard": ""}
    assert said.heard(said.ends) == {"heard": "One two three four."}
    assert said.heard((said.began + said.ends) // 2)["heard"] in ("One two", "One two three")
    assert Utterance.of(0, start(loop=2), {}) is None, "said in the first loop"


def test_marks_are_told_and_gone_on_from() -> None:
    said = Utterance.of(0, start(Cue(0, "mark", "begin"), Cue(8, "mark", "middle")), {"en": 10.0})
    assert said is not None
    count, name, since = said.passed(said.ends) or (0, "", 0)
    assert (count, name) == (2, "middle")
    assert since > 0
    again = Utterance.of(0, start(Cue(0, "mark", "begin"), Cue(8, "mark", "middle"),
                                  data={"passed": 2}), {"en": 10.0})  # fmt: skip
    assert again is not None
    assert again.ends < said.ends
    marks = SpeechMarks()
    assert marks.heard(0, "a", said) == {"markname": "begin", "marktime": 0}
    marks.end(said.ends, "a", said)
    asked = Utterance.of(said.ends, start(Cue(0, "earlier")), {"en": 10.0})
    assert marks.heard(said.ends, "a", asked)["markname"] == "middle"
    assert marks.heard(said.ends, "another", asked) == {"markname": None}


class Still:
    """Devices on which nothing ever happens but that an application is loaded."""

    awaits = False

    def __init__(self) -> None:
        self.left: list[Inbound] = [ApplicationLoaded("nobody")]
        self.seen: list[Record] = []

    def due(self) -> int | None:
        return 0 if self.left else None

    def collect(self, now: int) -> list[Inbound]:
        self.left = []
        return []

    def order(self, now: int, order: Order) -> None:
        raise AssertionError("nobody orders anything")

    def observe(self, now: int, records: list[Record]) -> None:
        self.seen += records


def test_the_loop_ends_when_nothing_is_due() -> None:
    devices = Still()
    loop = Loop(Session([], policy_named("prima"), TABLE_4_2), devices, until=5000)
    (last,) = [record for records in loop.run() for record in records]
    assert (last["phase"], last["outcome"]) == ("over", "quiet")
