"""Who is kept waiting for long: loops are counted and reported (E4), and time (E6), to the millisecond."""

from __future__ import annotations

import pytest

from prima.language.commands import PATIENCE_MS
from prima.messages import Command, Group, Step
from tests.helpers.stage import TRACK, Stage, chain, command, restartable, say

EVENT = 7
TURN = command("turn", angle=3)


def tracked(
    bound: int | None = None, apps: dict[str, str] | None = None, patience: int = PATIENCE_MS
) -> Stage:
    """The FA follows the user for ever."""
    stage = Stage(bound=bound, apps=apps, patience=patience)
    stage.request("fa", TRACK)
    stage.select()
    return stage


def loops(stage: Stage, most: int = 60) -> dict[str, int]:
    """Who starts at the end of which loop of the FA's."""
    begun: dict[str, int] = {}
    for _ in range(most):
        (loop,) = (name for name in stage.running if name.startswith("fa#1."))
        stage.at(stage.recorder.now + 500).end(loop, goal=False)
        while (started := stage.select()) and not started[0].startswith("fa#1."):
            begun[started[0]] = int(loop.partition(".")[2])
            stage.end(started[0])
    return begun


@pytest.mark.parametrize("bound", [1, 2, 30])
def test_e4_a_bound_counts_the_loops_that_were_begun_while_another_waited(bound: int) -> None:
    stage = tracked(bound)
    stage.at(1).request("ea", TURN)
    assert loops(stage) == {"ea#1": bound + 1}, "the loop in which it came is not counted"
    found = [(r["behavior"], r["loop"], r["by"]) for r in stage.phases("starve")]
    assert found == ([("ea#1", 20, "fa#1.21")] if bound > 20 else [])


def test_e4_the_first_loop_is_not_counted() -> None:
    stage = Stage(bound=2)
    stage.request("fa", TRACK)
    stage.request("ea", TURN)
    assert stage.select() == ["fa#1.1"]
    assert loops(stage) == {"ea#1": 3}


def test_e4_it_is_told_once_whatever_the_patience() -> None:
    stage = tracked(patience=12_000)
    stage.at(1).request("ea", TURN)
    assert loops(stage) == {}
    found = [(r["behavior"], r["actor"], r["rule"]) for r in stage.phases("starve")]
    assert found == [("ea#1", "mediator", "E4")]


def test_e4_branches_of_one_tree_starve_nobody_of_it() -> None:
    stage = Stage()
    stage.request("fa", steps=[Step(TRACK, ()), Step(TURN, ())])
    assert stage.select() == ["fa#1.1"]
    assert loops(stage) == {} and stage.holds("fa#2")[0] == "S1"
    assert stage.phases("starve") == []


def test_e4_a_loop_keeps_others_waiting_from_the_first_instant() -> None:
    stage = tracked(patience=5000)
    stage.request("ea", TURN)
    stage.select()
    assert stage.mediator.deadline() == 5000
    for time in range(500, 5500, 500):
        stage.at(time).end(next(iter(stage.running)), goal=False)
        stage.select()
    assert [(r["time"], r["rule"]) for r in stage.phases("starve")] == [(5000, "S1")]


def test_e4_another_priority_is_not_counted() -> None:
    stage = tracked(3)
    stage.at(1).request("ea", command("topological-move", to="room"))
    assert loops(stage, 30) == {}
    assert stage.phases("starve") == []


def test_e4_all_that_wait_for_the_loops_are_counted() -> None:
    stage = tracked(3, {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.at(1).request("ea", command("topological-move", to="room"))
    stage.request("eb", TURN)
    assert loops(stage, 30) == {"eb#1": 4}, "also behind one of another priority"


def test_e4_only_waits_for_the_loops_are_counted() -> None:
    """What waits for the speaker alone is not starved by somebody who drives."""
    stage = tracked(2, {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.at(1).request("ea", say("A long story."), say("The end."))
    stage.request("eb", say("Hello."))
    stage.select()
    assert loops(stage, 30) == {} and stage.phases("starve") == []
    stage.end("ea#1")
    assert stage.select() == ["ea#2"], "its topic goes on (S2c)"
    assert stage.floor == []


def test_e4_what_the_floor_of_the_loops_keeps_waiting_is_counted() -> None:
    stage = Stage()
    stage.request("fa", TRACK, cause=EVENT)
    stage.select()
    stage.at(1).request("ea", say("Hello."))
    assert loops(stage, 30) == {}
    assert [(r["behavior"], r["rule"]) for r in stage.phases("starve")] == [("ea#1", "E4")]


def test_e4_what_is_bounded_first_goes_first() -> None:
    stage = tracked(3, {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.at(1).request("eb", TURN)
    stage.at(500).end("fa#1.1", goal=False)
    stage.select()
    stage.request("ea", TURN)
    begun = loops(stage, 12)
    assert [*begun] == ["eb#1", "ea#1"]


def test_e4_a_reaction_that_waits_is_not_counted() -> None:
    """It may not break in, as it reacts to the same event (F2): no number of loops changes that."""
    stage = Stage(bound=2)
    stage.request("fa", TRACK, cause=EVENT)
    stage.select()
    stage.at(1).request("ea", TURN, cause=EVENT)
    assert loops(stage, 10) == {}


def test_e4_whoever_goes_next_by_the_bound_does_not_interrupt_the_loop() -> None:
    """X2: it counts as a reaction, but nothing has happened after the loop's start."""
    stage = Stage("prima+x2", bound=1)
    stage.request("fa", restartable(TRACK))
    stage.select()
    stage.at(1).request("ea", TURN)
    stage.select()
    stage.at(500).end("fa#1.1", goal=False)
    assert (stage.select(), stage.phases("interrupt")) == (["fa#1.2"], [])
    stage.at(1000).end("fa#1.2", goal=False)
    assert stage.select() == ["ea#1"]


def test_e4_what_is_bounded_together_reacts_to_different_events() -> None:
    stage = tracked(1, {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.at(1).request("ea", TURN, TURN)
    stage.request("eb", TURN)
    stage.select()
    stage.at(500).end("fa#1.1", goal=False)
    stage.select()
    stage.at(1000).end("fa#1.2", goal=False)
    assert stage.select() == ["ea#1"]
    stage.at(1100).end("ea#1")
    assert stage.select() == ["eb#1"]


def waiting(policy: str = "prima", patience: int = 5000, since: int = 0) -> Stage:
    """The EA speaks on and on; the FA waits for its turn since that time (ms)."""
    stage = Stage(policy, patience=patience)
    stage.request("ea", say("First."))
    if not since:
        stage.request("fa", say("One."))
    stage.select()
    if since:
        stage.at(since).request("fa", say("One."))
        stage.select()
    return stage


def turns(stage: Stage, *times: int) -> list[str]:
    """The EA ends what it says at these times, and says something else; gives who starts."""
    begun: list[str] = []
    for time in times:
        running = next(name for name in stage.running if name.startswith("ea"))
        stage.at(time).end(running, then=lambda: stage.request("ea", say("On.")))
        begun += stage.select()
        if not any(name.startswith("ea") for name in stage.running):
            break
    return begun


@pytest.mark.parametrize("since", [1, 1000])
def test_e6_the_turn_comes_when_the_patience_has_just_passed(since: int) -> None:
    stage = waiting(since=since)
    assert turns(stage, since + 4999) == ["ea#2"]
    assert stage.mediator.deadline() == since + 5000
    assert stage.phases("starve") == []
    assert turns(stage, since + 5000) == ["fa#1"]
    (told,) = stage.phases("starve")
    assert (told["rule"], told["by"], told["data"]) == ("E6", "ea#2", {"waited": 5.0})


def test_e6_time_counts_from_the_first_instant() -> None:
    stage = Stage(patience=5000)
    stage.request("fa", say("First."))
    stage.select()
    stage.request("ea", say("Mine."))
    stage.select()
    stage.at(4999).end("fa#1", then=lambda: stage.request("fa", say("On.")))
    assert stage.select() == ["fa#2"]
    stage.at(5000).end("fa#2", then=lambda: stage.request("fa", say("On.")))
    assert stage.select() == ["ea#1"]


@pytest.mark.parametrize(("policy", "patience"), [("fifo", 1000), ("prima", 0)])
def test_e6_without_floor_or_patience_nothing_is_counted(policy: str, patience: int) -> None:
    stage = Stage(policy, patience=patience)
    stage.request("ea", say("First."), say("Second."))
    stage.select()
    stage.at(1).request("fa", say("One."))
    stage.select()
    stage.at(9000).end("ea#1")
    stage.select()
    assert stage.phases("starve") == []
    assert stage.mediator.memory.behaviors["fa#1"].wait.kept == 0
    assert stage.mediator.deadline() == 132_500, "that of the device (E1)"


def test_e6_the_first_who_will_starve_is_looked_for_first() -> None:
    stage = Stage(apps={"fa": "fa", "ea": "ea", "eb": "ea"}, patience=5000)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(10).request("fa", say("One."))
    stage.select()
    stage.at(900).request("eb", say("Two."))
    stage.select()
    assert stage.mediator.deadline() == 5010


def test_e6_waiting_for_its_own_application_is_no_starving() -> None:
    stage = waiting(since=1000)
    stage.at(2000).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.request("fa", say("Two."))
    stage.select()
    stage.at(9000).request("ea", say("On."))
    stage.select()
    assert stage.phases("starve") == []


def test_e6_time_stands_still_while_its_own_application_speaks() -> None:
    stage = Stage(patience=5000)
    stage.request("ea", say("First."))
    stage.select()
    stage.request("fa", steps=[Step(say("One."), ()), Step(say("Two."), ())])
    stage.select()
    stage.at(3000).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(9000).request("ea", say("Ouch!"), cause=7)
    stage.select()
    stage.at(9100).end("fa#1")
    assert stage.select() == ["ea#2"], "it is not overdue"
    assert stage.phases("starve") == []


def test_e6_time_stands_still_while_another_has_the_floor() -> None:
    stage = Stage(apps={"fa": "fa", "ea": "ea", "eb": "ea"}, patience=5000)
    stage.request("ea", say("First."))
    stage.select()
    stage.at(1000).request("fa", say("One."))
    stage.select()
    stage.at(3000).request("eb", say("Ouch!"), cause=EVENT)
    stage.end("ea#1", then=lambda: stage.request("ea", say("On.")))
    assert stage.select() == ["eb#1"]
    stage.at(9000).end("eb#1")
    assert stage.select() == ["ea#2"], "the other has been kept from the speaker for 2 s"


def test_e6_who_has_been_kept_twice_is_told_when_both_times_are_the_patience() -> None:
    stage = Stage(apps={"eb": "ea", "fa": "fa", "ea": "ea"}, patience=5000)
    stage.request("ea", steps=[Step(say("First.")), Step(command("point-by-hand", angle=1))])
    stage.select()
    stage.request("eb", Group(chain(say("Two."), command("point-by-hand", angle=2))))
    stage.request("fa", steps=[Step(say("One.")), Step(say("Three."))])
    stage.select()
    stage.at(3000).end("ea#1")
    assert stage.select() == ["fa#1"], "so that its other sentence waits for its own application"
    stage.at(9000).end("ea#2")
    stage.select()
    stage.at(9100).end("fa#1")
    assert stage.select() == ["eb#1", "eb#2"]
    assert stage.mediator.deadline() == 11_100, "3 s before it, and 2 s from now on"
    stage.at(11_100).mediator.expire()
    stage.select()
    told = stage.phases("starve")[-1]
    assert (told["behavior"], told["rule"], told["data"]) == ("fa#2", "E6", {"waited": 5.0})


def test_e6_in_an_emergency_time_stands_still() -> None:
    stage = waiting(since=1000)
    stage.at(4000).mediator.emergency(True, True, 8)
    stage.select()
    assert stage.mediator.deadline() is None
    stage.at(8000).mediator.emergency(False, True, 9)
    assert stage.select() == ["ea#1"]
    assert turns(stage, 9999) == ["ea#2"]
    assert turns(stage, 10_000) == ["fa#1"], "3 s before it, and 2 s afterwards"


def test_e6_a_turn_that_was_interrupted_has_waited_for_nobody() -> None:
    apps = {"fa": "fa", "ea": "ea", "third": "fa"}
    stage = Stage("prima+x2", apps=apps, patience=1000)
    stage.request("ea", say())
    stage.select()
    stage.request("fa", restartable(say("One.")))
    stage.request("third", say("Two."))
    stage.select()
    stage.at(1000).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(1100).request("ea", say("Oh!"), cause=7)
    assert stage.select() == ["ea#2"]
    stage.at(1500).end("ea#2")
    assert (stage.select(), stage.rule("third#1")) == (["third#1"], "E6")


@pytest.mark.parametrize(
    ("runs", "waits"),
    [
        ([say("Long."), command("turn", angle=90)], command("turn", angle=3)),
        ([command("turn", angle=90)], command("turn-and-speak", "Here.", angle=3)),
    ],
)
def test_e6_time_stands_still_while_only_another_device_is_missing(
    runs: list[Command], waits: Command
) -> None:
    stage = Stage(apps={"fa": "fa", "ea": "ea", "third": "ea"}, patience=1000)
    stage.request("ea", steps=[Step(one) for one in runs])
    stage.select()
    stage.at(1).request("fa", waits)
    assert stage.select() == []
    stage.at(2000).request("third", command("point-by-hand", angle=9))
    assert stage.select() == ["third#1"]
    assert [(r["behavior"], r["rule"]) for r in stage.phases("starve")] == [("fa#1", "S1")]
