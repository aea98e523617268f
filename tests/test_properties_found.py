"""Violations that generated runs have found, each as small as it could be made.

They stay, so that nothing found once comes back.
"""

from __future__ import annotations

from prima.messages import Emergency, Inbound, Occurred, Record
from tests.generated import Ask, Go, Leave, Open, Play, Script, World, command, drive, perform
from tests.invariants import check
from tests.stage import Stage

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="{}">{}</prima>'
IDLE = HEAD.format("fa", '<form id="f1"/>')


def play(body: str, *events: tuple[int, Inbound]) -> Play:
    """One application, ``ea``, beside one that does nothing."""
    return Play((IDLE, HEAD.format("ea", body)), (0, 0), events, World())


def told(records: list[Record], behavior: str) -> list[tuple[int, str]]:
    return [(r["time"], r["phase"]) for r in records if r.get("behavior") == behavior]


def test_a_unit_that_was_left_does_not_come_back_after_an_emergency() -> None:
    # The unit is out of time, what runs in it finishes (U5); the emergency ends that, and
    # with it the unit. Yet the unit is put back among the waiting ones, and starts again.
    body = (
        '<form id="f1"><iu longest="1ms"><block><speak>Hello.</speak></block></iu>'
        '<on event="error"/></form>'
    )
    run = perform(play(body, (2, Emergency(True)), (3, Emergency(False))))
    assert check(run.records) + run.problems == []


def test_a_unit_that_is_left_during_an_emergency_is_concluded() -> None:
    # The application leaves the unit because it is told of the emergency. The unit waits then
    # for its release, starts again and keeps its devices for ever.
    body = (
        '<form id="f1"><iu><block><speak>Hello.</speak></block></iu>'
        '<on event="emergency.stop"><goto next="#f2"/></on></form><form id="f2"/>'
    )
    run = perform(play(body, (1, Emergency(True)), (2, Emergency(False))))
    assert check(run.records) + run.problems == []


def test_a_group_that_was_given_up_ends_whole_in_an_emergency() -> None:
    # The group (U4) is unheard since its state was left (O3). Halted, it is taken out of
    # working memory, but not its Commands: its stream stays open, and so does its floor.
    asked = Ask((("speak", "turn"),), ((),))
    events = ((1, ((asked,), ())), (2, ((Leave(),), ())))
    script = Script(((), ()), events, ((3, 1, True),), World())
    run = drive(script)
    assert check(run.records) + run.problems == []


def test_a_question_that_o2_leaves_running_finishes() -> None:
    # Only a device in common cuts an AB short (O2); only leaving the state ends a question
    # that listens (O3). Here a move of the same tree is cancelled, and the state goes on.
    stage = Stage()
    stage.request("ea", command("q-and-a"))
    stage.request("ea", command("turn"))
    stage.select()
    stage.at(10)
    stage.request("ea", command("stop-moving"))
    stage.select()
    assert "ea#1" in stage.running
    stage.at(20).mediator.listening("ea#1")
    stage.select()
    assert [r["phase"] for r in stage.records if r.get("behavior") == "ea#1"] == [
        "request",
        "start",
    ]


def test_a_question_in_a_unit_keeps_the_robot_from_leaving() -> None:
    # Without the <iu> the question goes first, having the higher priority (S2a), and K1 holds
    # the move. In a unit it starts after the selection: the robot drives off for one loop.
    asks = '<field name="q" type="boolean"><prompt>Well?</prompt></field>'
    moves = '<block><topological-move to="room"/></block>'
    documents = (
        HEAD.format("fa", f'<form id="f1"><iu>{asks}</iu></form>'),
        HEAD.format("ea", f'<form id="f1">{moves}</form>'),
    )
    run = perform(Play(documents, (0, 0), (), World()))
    assert check(run.records) == []


def test_the_same_question_without_a_unit_keeps_the_robot_from_leaving() -> None:
    asks = '<field name="q" type="boolean"><prompt>Well?</prompt></field>'
    moves = '<block><topological-move to="room"/></block>'
    documents = (
        HEAD.format("fa", f'<form id="f1">{asks}</form>'),
        HEAD.format("ea", f'<form id="f1">{moves}</form>'),
    )
    run = perform(Play(documents, (0, 0), (), World()))
    assert check(run.records) == []
    question = told(run.records, "fa#1")
    move = told(run.records, "ea#1.1")
    assert move[0][0] >= question[-1][0] > 0


def test_a_play_meets_touches_units_and_emergencies_without_harm() -> None:
    body = (
        '<form id="f1"><iu><block><speak>Hello.</speak></block></iu>'
        '<on event="touch"><turn angle="10"/></on></form>'
    )
    events = ((1, Occurred("touch")), (2, Emergency(True)), (900, Emergency(False)))
    run = perform(play(body, *events))
    assert check(run.records) + run.problems == []


def test_a_script_opens_a_unit_and_goes() -> None:
    unit = Open(frozenset({"speaker"}), None)
    asked = Ask(("speak",), ((),))
    run = drive(Script(((), ()), ((1, ((unit, asked, Go()), (asked,))),), (), World()))
    assert check(run.records) + run.problems == []
