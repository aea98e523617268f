"""What the mediator records of requests, starts, ends, decisions and holds, with every field."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from prima.language.commands import TABLE_4_2
from prima.messages import Command, Cue, Group, Record, Step
from tests.helpers.stage import Stage, ask, chain, command, say, search

ALL = "prima+x2+x3+x4+x5+x7+x8+x9"


def shown(record: Record) -> dict[str, Any]:
    """A record as it is written."""
    return {name: value for name, value in record.items() if value is not None}


def recorded(stage: Stage, behavior: str, phase: str) -> dict[str, Any]:
    """The last record of an AB in a phase, without what all of its records have."""
    record = [one for one in stage.phases(phase) if one["behavior"] == behavior][-1]
    same = ("time", "phase", "app", "behavior", "tree", "command", "text")
    return {name: value for name, value in shown(record).items() if name not in same}


def test_a_request_is_recorded_with_all_that_its_author_has_written() -> None:
    stage = Stage(ALL)
    hello = Command("speak", {}, "Hello there.", source="fa.xml:3:5", restartable=True)
    hello.cues = (Cue(0, "hotword"), Cue(5, "pause", 300))
    go = command("set-speed-and-time", speed=1, time="2s")
    stage.at(1000).request(
        "fa", hello, go, cause=7, hold=5000, connect=True, words=say("As I said."), fresh=1500,
        state=4,
    )  # fmt: skip
    stage.select()
    [first, second, facing] = stage.phases("request")
    assert shown(first) == {
        "time": 1000,
        "phase": "request",
        "actor": "robot",
        "app": "fa",
        "behavior": "fa#1",
        "tree": "fa:1",
        "command": "speak",
        "text": "Hello there.",
        "devices": ["speaker"],
        "priority": "high",
        "reactive": True,
        "cause": 7,
        "state": 4,
        "cues": [{"at": 0, "hotword": True}, {"at": 5, "pause": 300}],
        "source": "fa.xml:3",
        "restartable": True,
        "hold": 5.0,
        "connect": True,
        "fresh": 1.5,
        "words": "As I said.",
    }
    assert recorded(stage, "fa#2", "request") == {
        "actor": "robot",
        "parent": "fa#1",
        "devices": ["locomotion"],
        "priority": "high",
        "reactive": False,
        "state": 4,
        "args": {"speed": 1.0, "time": 2000, "turn-speed": 0.0},
        "hold": 5.0,
        "words": "As I said.",
    }
    assert (facing["inserted"], facing["before"]) == ("X4", "fa#1")
    assert (facing["cause"], facing["fresh"], facing["source"]) == (7, 1.5, "fa.xml:3")
    assert [one["behavior"] for one in (first, second)] == ["fa#1", "fa#2"]


def test_values_of_extensions_are_recorded_only_where_they_are_on() -> None:
    names = {"restartable", "hold", "connect", "fresh", "words", "spans", "motion"}
    for policy, seen in (("prima", set()), (ALL, {"restartable", "hold", "connect", "fresh"})):
        stage = Stage(policy)
        hello = Command("speak", {}, "Hello.", restartable=True)
        stage.request("fa", hello, cause=7, hold=5000, connect=True, fresh=1500)
        assert set(shown(stage.recorder.drain()[-1])) & names == seen
        stage.open("fa", 1, "speaker")
        assert ("spans" in shown(stage.recorder.drain()[-1])) is (policy == ALL)


def test_an_ab_that_waits_for_several_names_them_all() -> None:
    stage = Stage()
    place = Group(chain(say()), source="fa.xml:7:1")
    both = Step(search("Where?"), (0, 1))
    steps = [Step(command("move-head", pan=1)), Step(command("turn", angle=5)), both]
    stage.request("fa", steps=[*steps, Step(place, (2,))], cause=3)
    stage.select()
    assert recorded(stage, "fa#3", "request") == {
        "actor": "robot",
        "parent": "fa#2",
        "parents": ["fa#1", "fa#2"],
        "devices": ["human-detection", "localization", "locomotion", "speaker"],
        "priority": "high",
        "reactive": False,
        "feedback": True,
        "engages": True,
        "state": 1,
        "args": {"patience": 10000},
    }
    assert recorded(stage, "fa#4", "request") == {
        "actor": "robot",
        "parent": "fa#3",
        "devices": ["speaker"],
        "priority": "high",
        "reactive": False,
        "state": 1,
        "source": "fa.xml:7",
    }


def test_those_whom_an_ab_waits_for_are_named_in_one_order() -> None:
    stage = Stage()
    steps = [Step(say(), ()) for _ in range(20)]
    stage.request("fa", steps=[*steps, Step(say(), tuple(range(20)))])
    stage.select()
    names = recorded(stage, "fa#21", "request")["parents"]
    assert names == sorted(f"fa#{number}" for number in range(1, 21))


def test_a_unit_around_items_is_recorded_without_a_place() -> None:
    stage = Stage()
    stage.open("ea", 5, "speaker")
    stage.select()
    assert "source" not in recorded(stage, "ea#1", "request")


def test_a_command_that_leaves_is_recorded_so_and_additional_arguments_apart() -> None:
    table = dict(TABLE_4_2)
    table["topological-move"] = replace(table["topological-move"], extra=frozenset({"curve"}))
    stage = Stage(table=table)
    stage.request("fa", Command("topological-move", {"to": "room"}, extra={"curve": 1}))
    stage.select()
    found = recorded(stage, "fa#1", "request")
    assert (found["leaves"], found["priority"], found["feedback"]) == (True, "low", True)
    assert (found["args"], found["extra"]) == ({"to": "room"}, {"curve": 1})


def test_starts_ends_holds_and_decisions_are_recorded() -> None:
    stage = Stage()
    stage.request("fa", search("Where?"), cause=1)
    stage.request("ea", ask(), state=2)
    stage.select()
    stage.at(30).end("fa#1.1", goal=False, x=1)
    stage.select()
    devices = ["human-detection", "localization", "locomotion", "speaker"]
    assert recorded(stage, "fa#1.1", "start") == {
        "actor": "robot",
        "devices": devices,
        "rule": "S2b",
        "reactive": True,
        "cause": 1,
    }
    assert recorded(stage, "fa#1.1", "end") == {
        "actor": "robot",
        "outcome": "again",
        "inbound": True,
        "goal": False,
        "data": {"x": 1},
    }
    again = {"actor": "robot", "parent": "fa#1.1", "devices": devices, "rule": "S1"}
    assert recorded(stage, "fa#1.2", "start") == again
    assert recorded(stage, "ea#1", "hold") == {"actor": "mediator", "rule": "F2", "by": "fa:1"}
    [first, _] = map(shown, stage.phases("decision"))
    assert first == {
        "time": 0,
        "phase": "decision",
        "actor": "mediator",
        "app": "fa",
        "winner": "fa#1.1",
        "rule": "S2b",
        "losers": ["ea#1"],
        "losers_count": 1,
    }
    [floor] = map(shown, stage.phases("floor"))
    assert floor == {
        "time": 0,
        "phase": "floor",
        "actor": "mediator",
        "app": "fa",
        "tree": "fa:1",
        "rule": "F1",
        "outcome": "taken",
        "floor": ["fa:1"],
    }


def test_only_the_next_loop_is_recorded_with_what_it_follows() -> None:
    stage = Stage()
    stage.request("ea", say("One."), say("Two."))
    stage.select()
    stage.at(10).end("ea#1")
    stage.select()
    assert recorded(stage, "ea#2", "start") == {
        "actor": "robot",
        "devices": ["speaker"],
        "rule": "S1",
    }


def test_a_decision_names_eight_losers_and_counts_all() -> None:
    stage = Stage(apps={f"a{number}": "ea" for number in range(10)})
    for number in range(10):
        stage.request(f"a{number}", say())
    stage.select()
    [decision] = stage.phases("decision")
    assert decision["losers"] == [f"a{number}#1" for number in range(1, 9)]
    assert decision["losers_count"] == 9
