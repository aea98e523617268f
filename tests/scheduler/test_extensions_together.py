"""Extensions where they meet: each other, O2, O3, E1, E6 and units around form items."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from prima.invariants import check
from prima.language.commands import TABLE_4_2, CommandType
from prima.messages import Command, Group, OpenUnit, Step
from tests.helpers.robot import Bench, document
from tests.helpers.stage import Stage, ask, chain, command, inserted, move, restartable, say

EVENT = 7
STOP = Command("stop-moving", now=True)


Then = Callable[[], object]


def cut_by_stopping(stage: Stage, then: Then) -> None:
    stage.request("ea", STOP)
    assert stage.select() == ["ea#3"]
    stage.at(1200).end("ea#3", then=then, x=3.0, y=0.0, heading=0.0)


def left(stage: Stage, then: Then) -> None:
    """It is left between two loops."""
    stage.leave("ea")
    then()


def failed(stage: Stage, then: Then) -> None:
    stage.mediator.failed("ea#2.2", "locomotion", "broken")
    stage.settle(then)


@pytest.mark.parametrize("how", [cut_by_stopping, left, failed])
def test_x1_nobody_goes_back_to_where_a_move_before_the_last_had_ended(
    how: Callable[[Stage, Then], None],
) -> None:
    stage = Stage("prima+x1")
    stage.request("ea", move(), move("hall"))
    stage.select()
    stage.at(500).end("ea#1.1", x=1.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#2.1"]
    stage.at(1000).end("ea#2.1", goal=False, x=3.0, y=0.0, heading=0.0)
    if how is not left:
        assert stage.select() == ["ea#2.2"]
    how(stage, lambda: stage.request("ea", say("One."), say("Two."), state=2))
    (first,) = stage.select()
    stage.at(1300).request("fa", say("Oh!"), cause=EVENT)
    stage.select()
    stage.at(2000).end(first)
    assert stage.select() == ["fa#1"]
    stage.at(3000).end("fa#1")
    assert stage.select()[0].startswith("ea") and inserted(stage) == []


def moved_away(policy: str, *then: Command) -> Stage:
    """The EA has gone somewhere and speaks, when the FA drives the robot away."""
    stage = Stage(policy)
    stage.request("ea", move(), say("One."), *then)
    stage.select()
    stage.at(500).end("ea#1.1", x=1.0, y=0.0, heading=0.0)
    stage.select()
    stage.request("fa", command("set-speed-and-time", speed=0.5, time="4s"), cause=EVENT)
    stage.select()
    stage.at(4500).end("fa#1", x=3.0, y=0.0, heading=0.0)
    return stage


def test_x1_a_command_with_now_waits_for_no_way_back() -> None:
    """O2. What follows it does."""
    stage = moved_away("prima+x1", command("gesture", name="bow"))
    stage.request("ea", Command("point-by-hand", {"angle": 30}, now=True))
    stage.request("ea", say("Two."))
    assert stage.select() == ["ea#4"] and inserted(stage) == []
    stage.at(5000).end("ea#2")
    stage.end("ea#4")
    assert stage.select() == ["ea#6.1"] and inserted(stage) == [("X1", "set-position")]
    stage.at(6000).end("ea#6.1", x=1.0, y=0.0, heading=0.0)
    assert stage.select() == ["ea#5"]
    assert check(stage.records, "prima+x1") == []


@pytest.mark.parametrize(
    ("policy", "first", "then"),
    [("prima+x1", "set-position", ""), ("prima+x1+x7", "", "set-position")],
)
def test_x1_after_the_third_turn_the_robot_still_goes_back(
    policy: str, first: str, then: str
) -> None:
    stage = Stage(policy)
    stage.request("ea", move(), ask())
    stage.select()
    stage.at(500).end("ea#1.1", x=1.0, y=0.0, heading=0.0)
    stage.select()
    stage.request("fa", command("set-speed-and-time", speed=0.5, time="1s"), cause=EVENT)
    stage.select()
    stage.at(1500).end("fa#1", x=3.0, y=0.0, heading=0.0)
    stage.select()
    stage.at(2000).mediator.ended("ea#2", True, {"outcome": "filled"}, inbound=False)
    stage.settle(lambda: stage.request("ea", say("All right."), say("It is there.")))
    made = []
    for time in range(3000, 6000, 1000):
        (name,) = stage.select()
        made.append(name)
        pose: dict[str, Any] = {"x": 1.0, "y": 0.0, "heading": 0.0} if "." in name else {}
        stage.at(time).end(name, **pose)
    commands = {record["behavior"]: record["command"] for record in stage.phases("request")}
    order = [commands[name.partition(".")[0]] for name in made]
    assert order == [one for one in (first, "speak", then, "speak") if one]
    assert check(stage.records, policy) == []


TOPIC = """<form id="a" resume-text="As I was saying:"><block><speak>A topic.</speak></block>
    <field name="q"><option>yes</option><prompt>Shall I tell you more?</prompt>
      <noinput><reprompt/></noinput>
      <filled><speak>All right.</speak><speak>The second part.</speak></filled></field></form>"""


@pytest.mark.parametrize(
    ("policy", "said"),
    [
        ("prima+x9+x10", ["As I was saying:", "All right."]),
        ("prima+x7+x9+x10", ["All right.", "As I was saying:"]),
    ],
)
def test_x9_the_third_turn_does_not_resume_the_topic(policy: str, said: list[str]) -> None:
    fa = document('<form id="a"><on event="touch"><speak>Oh!</speak></on></form>', "fa", "fa")
    bench = Bench(fa, document(TOPIC, "ea", "ea"), policy=policy)
    bench.finish("A topic.")
    bench.listens()
    bench.event("touch")
    bench.silence()
    bench.hears("yes")
    bench.finish("Oh!")
    for words in said:
        assert bench.saying() == [words]
        bench.finish(words)
    assert bench.saying() == ["The second part."]


def test_x9_a_loop_that_began_now_resumes_in_words() -> None:
    words = say("Again:")
    lead = Command("topological-move", {"to": "room"}, now=True)
    stage = Stage("prima+x9")
    stage.request("ea", say("Come."), words=words)
    stage.select()
    stage.at(500).end("ea#1", then=lambda: stage.request("ea", lead, words=words))
    assert stage.select() == ["ea#2.1"]
    stage.at(600).request("fa", say("Oh!"), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("ea#2.1", goal=False)
    assert stage.select() == []
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == [("X9", "speak")]
    stage.at(3000).end("ea#3")
    assert stage.select() == ["ea#2.2"]
    assert check(stage.records, "prima+x9") == []


@pytest.mark.parametrize("policy", ["prima", "prima+x9"])
def test_x9_words_are_looked_at_only_where_they_are_said(policy: str) -> None:
    stage = Stage(policy, refuses=True)
    stage.request("ea", say("Hello."), words=say("blah " * 4000))
    assert stage.select() == (["ea#1"] if policy == "prima" else [])


def test_x9_a_robot_that_shows_what_it_would_say_resumes_without_words() -> None:
    show = CommandType("show", "Show", "", frozenset({"screen"}), text="required")
    table = {**TABLE_4_2, "speak": replace(TABLE_4_2["speak"], substitute="show"), "show": show}
    stage = Stage("prima+x6+x9", table=table)
    stage.request("ea", say("Hello."), words=say("Again:"))
    assert stage.select() == ["ea#1"]


def test_x8_a_unit_around_items_that_comes_too_late_is_given_up() -> None:
    stage = Stage("prima+x8")
    stage.request("ea", say("A long story."))
    stage.select()
    unit = OpenUnit(5, 1, frozenset({"speaker"}), cause=EVENT, fresh=2000)
    stage.at(1000).mediator.ask("fa", unit)
    stage.request("fa", say("Oh!"), unit=5)
    assert stage.select() == []
    stage.at(3000).mediator.expire()
    assert stage.select() == [] and stage.told("fa") == ["expired.speak"]
    stage.close("fa", 5)
    stage.at(4000).end("ea#1")
    assert stage.select() == []
    assert check(stage.records, "prima+x8") == []


def test_x8_a_handler_that_goes_to_a_unit_says_for_how_long_it_is_worth_it() -> None:
    fa = document(
        """<form id="a"><on event="touch" fresh-for="1s"><goto next="#b"/></on></form>
        <form id="b"><iu><block><speak>Oh!</speak></block></iu>
          <on event="expired"><log>late</log></on></form>""",
        "fa",
        "fa",
    )
    ea = document('<form id="a"><block><speak>A story.</speak></block></form>', "ea", "ea")
    bench = Bench(fa, ea, policy="prima+x8")
    bench.event("touch")
    bench.step(at=5_000)
    bench.finish("A story.")
    assert bench.logs() == ["late"] and bench.said() == ["A story."]


def test_x4_a_field_that_opens_a_unit_faces_the_user_first() -> None:
    body = """<form id="a"><iu><field name="q" channel="connect"><prompt>Well?</prompt>
        <option>yes</option></field></iu></form>"""
    bench = Bench(body, policy="prima+x4")
    assert bench.saying() == ["face-human"]


def test_x4_who_has_waited_for_the_speaker_waits_no_longer_for_the_turn() -> None:
    """E6 counts for what is put in before the word that has waited."""
    stage = Stage("prima+x4", patience=10_000)
    stage.mediator.sees_user(True)
    stage.request("fa", say("On and on."))
    stage.select()
    stage.at(100).request("ea", say("A word."), connect=True)
    assert stage.select() == []
    time, last = 100, "fa#1"
    while time < 8_000:
        time += 2000
        stage.at(time)
        stage.end(last, then=lambda: stage.request("fa", say("On and on.")))
        (last,) = stage.select()
    assert last.startswith("fa")
    stage.mediator.sees_user(False)
    stage.at(time + 2000).end(last, then=lambda: stage.request("fa", say("On and on.")))
    assert stage.select() == ["ea#2"] and inserted(stage) == [("X4", "face-human")]
    stage.at(time + 4000).end("ea#2", then=lambda: stage.request("fa", say("On and on.")))
    stage.mediator.sees_user(True)
    assert stage.select() == ["ea#1"] and stage.rule("ea#1") == "E6"
    stage.at(time + 6000).end("ea#1")
    stage.select()
    assert check(stage.records, "prima+x4", patience=10_000) == []


def test_x4_the_time_of_the_turn_to_the_user_is_no_time_of_the_wait() -> None:
    """E6 counts until the turn starts, once."""
    stage = Stage("prima+x4", patience=10_000)
    stage.request("fa", say("First."), say("Second."))
    stage.select()
    stage.request("ea", say("A word."), connect=True)
    assert stage.select() == []
    stage.at(6000).end("fa#1")
    assert stage.select() == ["fa#2"]
    stage.at(9000).end("fa#2")
    assert stage.select() == ["ea#2"] and inserted(stage) == [("X4", "face-human")]
    stage.request("fa", say("Third."), cause=EVENT)
    stage.select()
    stage.at(11_000).end("ea#2")
    stage.mediator.sees_user(True)
    assert stage.select() == ["fa#3"]
    stage.at(12_000).end("fa#3")
    assert stage.select() == ["ea#1"] and stage.phases("starve") == []
    assert check(stage.records, "prima+x4", patience=10_000) == []


def test_x4_a_word_that_waits_after_the_turn_says_for_which_stream_anew() -> None:
    """X3 holds a stream, which keeps first the turn and then the word waiting (F2)."""
    stage = Stage("prima+x3+x4")
    stage.request("ea", say("Welcome."), hold=5000)
    stage.select()
    stage.request("fa", say("A word."), connect=True)
    assert stage.select() == []
    stage.at(1000).end("ea#1")
    stage.select()
    stage.at(1100).request("fa", command("move-head", pan=10), cause=EVENT)
    assert stage.select() == ["fa#3", "fa#2"]
    stage.at(1400).end("fa#3")
    stage.select()
    stage.at(1500).end("fa#2")
    assert stage.select() == []
    assert stage.holds("fa#1") == ["F2"] and stage.holds("fa#2") == ["S1", "F2"]
    assert check(stage.records, "prima+x3+x4") == []


TURN = command("set-direction", heading=90)


@pytest.mark.parametrize(
    ("own", "back"),
    [
        ([TURN, say("There.")], []),
        ([Group(chain(TURN, say("There.")))], []),
        ([Group(chain(say("Here."), TURN))], [("X1", "set-direction")]),
    ],
)
def test_x1_what_begins_with_a_turn_of_its_own_needs_no_turn_back(
    own: list[Command | Group], back: list[tuple[str, str]]
) -> None:
    stage = Stage("prima+x1")
    stage.request("ea", command("set-direction", heading=0), say("One."), *own)
    stage.select()
    stage.at(100).end("ea#1", x=0.0, y=0.0, heading=0.0)
    stage.select()
    stage.request("fa", command("turn", angle=180), cause=EVENT)
    stage.select()
    stage.at(1000).end("fa#1", x=0.0, y=0.0, heading=180.0)
    stage.at(2000).end("ea#2")
    assert stage.select()[0] == ("ea#4" if back else "ea#3")
    assert inserted(stage) == back


def test_x9_what_was_interrupted_though_wanted_now_resumes_in_words() -> None:
    stage = Stage("prima+x2+x9")
    stage.request("ea", say("A topic."), words=say("Again:"))
    stage.select()
    stage.at(500).end("ea#1")
    now = restartable(Command("speak", text="A long story.", now=True))
    stage.request("ea", now, words=say("Again:"))
    assert stage.select()[-1] == "ea#2"
    stage.at(600).request("fa", say("Oh!"), cause=EVENT)
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == [("X9", "speak")]


def test_x4_the_user_is_faced_before_the_words_with_which_a_topic_resumes() -> None:
    stage = Stage("prima+x4+x9")
    stage.request("ea", say("One."), words=say("Again:"))
    assert stage.select() == ["ea#1"]

    def goes_on() -> None:
        stage.request("ea", say("Two."), words=say("Again:"), connect=True)

    stage.at(500).request("fa", say("Oh!"), cause=EVENT)
    assert stage.select() == []
    stage.at(600).end("ea#1", then=goes_on)
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    started = []
    for time in (1001, 2000, 3000):
        (one,) = stage.select()
        started.append(one)
        stage.at(time).end(one)
    assert inserted(stage) == [("X4", "face-human"), ("X9", "speak")]
    assert started == ["ea#3", "ea#4", "ea#2"]
    assert check(stage.records, "prima+x4+x9") == []


def test_x1_a_way_back_is_not_overdue_with_the_word_behind_it() -> None:
    """E6 counts how long others have kept the speaker; the way back needs none."""
    stage = Stage("prima+x1", patience=10_000)
    nod = command("gesture", name="nod")
    told = [say("A"), nod, say("B"), nod, say("C"), command("turn", angle=90)]
    after: list[tuple[int, ...]] = [(), (0,), (1,), (2,), (3,), (3,)]
    stage.request("fa", steps=[Step(*one) for one in zip(told, after, strict=True)])
    stage.request("ea", command("set-direction", heading=0), say("One."))
    assert stage.select() == ["fa#1", "ea#1"]
    stage.at(100).end("ea#1", x=0.0, y=0.0, heading=0.0)
    assert stage.select() == []
    stage.at(200).request("fa", command("turn", angle=180), cause=EVENT)
    assert stage.select() == ["fa#7"]
    stage.at(1000).end("fa#7", x=0.0, y=0.0, heading=180.0)
    assert stage.select() == []
    for time, over, starts in (
        (3000, "fa#1", ["fa#2"]),
        (6000, "fa#2", ["fa#3"]),
        (9000, "fa#3", ["fa#4"]),
        (12_000, "fa#4", ["fa#5", "fa#6"]),
    ):
        stage.at(time).end(over)
        assert stage.select() == starts
    assert inserted(stage) == [("X1", "set-direction")]
    assert check(stage.records, "prima+x1", patience=10_000) == []
