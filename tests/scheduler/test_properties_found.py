"""Violations that generated runs have found, each as small as it could be made.

They stay, so that nothing found once comes back.
"""

from __future__ import annotations

from dataclasses import replace

from prima.interpreter.reader import read_document
from prima.messages import (
    Command,
    Emergency,
    Ended,
    Group,
    Inbound,
    Loaded,
    Occurred,
    Record,
    Step,
    Unloaded,
)
from prima.scheduler.policy import policy_named
from prima.session import Session
from tests.helpers.generated import (
    TABLE,
    Ask,
    Go,
    Leave,
    Open,
    Play,
    Script,
    World,
    drive,
    perform,
)
from tests.helpers.stage import TRACK, Stage, ask, chain, command, move, say
from tests.invariants import check

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


# With the extensions ------------------------------------------------------------------


def restartable(what: Command) -> Command:
    return replace(what, restartable=True)


def test_x2_does_not_interrupt_what_has_just_been_preferred() -> None:
    # Of two reactions to one event the first starts (S2f), and in the same selection the
    # second, which it outranks, interrupts it.
    stage = Stage("prima+x2")
    stage.request("fa", steps=[Step(restartable(say("First."))), Step(say("Second."))], cause=1)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2") == []


def test_x2_an_earlier_reaction_does_not_interrupt_a_later_one_at_its_start() -> None:
    stage = Stage("prima+x2")
    stage.request("ea", say("First."), cause=1)
    stage.request("fa", restartable(say("Second.")), cause=2)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2") == []


def test_x2_a_reaction_that_leaves_does_not_go_before_what_outranks_it() -> None:
    # Two restartable Commands want the body; a reaction of low priority interrupts the one
    # that runs, and the other, which outranks it by S2a, is passed over.
    stage = Stage("prima+x2")
    turn = restartable(command("turn"))
    stage.request("ea", steps=[Step(turn), Step(restartable(command("turn")))])
    stage.select()
    stage.at(100).request("fa", move(), cause=1)
    stage.select()
    assert check(stage.records, "prima+x2") == []


def test_x2_nothing_is_interrupted_for_a_reaction_that_is_held_back() -> None:
    # The speaker is held back for the reaction that ranks first and waits for the body (S3):
    # the other reaction interrupts the story, and must then wait for the first one (S3).
    stage = Stage("prima+x2")
    stage.request("ea", steps=[Step(restartable(say("A story."))), Step(command("turn"))])
    stage.select()
    stage.at(100).request("ea", say("Soon."), cause=1)
    stage.request("fa", command("face-human-and-speak"), cause=2)
    stage.select()
    assert check(stage.records, "prima+x2") == []


def test_x2_a_unit_in_a_unit_is_interrupted_with_it() -> None:
    # The unit inside is taken out, but what runs in it goes on: it is never told to stop.
    stage = Stage("prima+x2")
    inside = Group(chain(say("One."), say("Two.")))
    stage.request("ea", Group([Step(inside)], restartable=True))
    stage.select()
    stage.at(100).request("fa", ask(), cause=1)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2") == []
    orders = [(order.verb, order.behavior) for order in stage.orders]
    assert orders == [("start", "ea#3"), ("interrupt", "ea#3"), ("start", "fa#1")]
    stage.at(900).end("fa#1")
    stage.select()
    assert check(stage.records, "prima+x2") == []


def test_x2_a_motion_that_can_be_composed_is_in_nobodys_way() -> None:
    # Of the move and the nod only the nod is in the dance's way (X5), and it is restartable.
    stage = Stage("prima+x2+x5", table=TABLE)
    nod = restartable(command("gesture"))
    stage.request("ea", steps=[Step(move()), Step(nod)])
    stage.select()
    stage.at(100).request("fa", Command("dance"), cause=1)
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x2+x5") == []


def test_x2_nothing_is_interrupted_where_a_composed_motion_stays_in_the_way() -> None:
    # A move and a spin share the body (X5). The spin gives way; the move does not.
    stage = Stage("prima+x2+x5", table=TABLE)
    stage.request("ea", move())
    stage.select()
    stage.at(50).request("ea", restartable(Command("spin")), cause=1)
    stage.select()
    stage.at(100).request("fa", command("turn"), cause=2)
    stage.select()
    assert check(stage.records, "prima+x2+x5") == []


def test_x5_two_dances_are_not_composed_with_one_move() -> None:
    # The move that has started last hides the first dance from the second.
    stage = Stage("prima+x5", table=TABLE)
    stage.request("ea", Command("dance"))
    stage.select()
    stage.at(50).request("ea", move(), cause=1)
    stage.select()
    stage.at(100).request("fa", Command("spin"), cause=2)
    stage.select()
    assert check(stage.records, "prima+x5") == []


def test_x5_two_moves_are_not_composed_with_one_dance() -> None:
    stage = Stage("prima+x5", table=TABLE)
    stage.request("ea", move())
    stage.select()
    stage.at(50).request("fa", Command("waltz"), cause=1)
    stage.select()
    stage.at(100).request("ea", command("set-position"), cause=2)
    stage.select()
    assert check(stage.records, "prima+x5") == []


def test_x3_a_unit_joins_the_stream_that_is_held() -> None:
    # Its stream stays held while the unit is of it, and its time runs out then.
    stage = Stage("prima+x3")
    stage.request("fa", say(), hold=5000)
    stage.select()
    stage.at(100).end("fa#1")
    stage.select()
    stage.at(200).open("fa", 1, "speaker")
    stage.select()
    stage.at(300).request("ea", command("turn"))
    stage.select()
    assert check(stage.records, "prima+x3") == []


def test_x3_the_floor_that_an_ending_stream_gives_back_is_taken() -> None:
    # Both streams end in one instant; the one to be held comes first and finds the floor
    # taken by the other, which ends then: nobody has it.
    stage = Stage("prima+x3")
    stage.request("ea", command("turn"), hold=5000)
    stage.select()
    stage.request("fa", say(), cause=1)
    stage.select()
    stage.at(100).end("ea#1")
    stage.end("fa#1")
    stage.select()
    stage.at(200).request("fa", command("turn"))
    assert stage.select() == []
    assert check(stage.records, "prima+x3") == []


def ends(stage: Stage, behavior: str, x: float, y: float) -> None:
    """An AB ends with the robot at a place."""
    stage.end(behavior, x=x, y=y, heading=0.0)
    stage.select()


def test_x1_a_unit_that_goes_on_beneath_the_floor_does_not_resume_its_stream() -> None:
    # F1 lets the unit finish. Its second Command counts as if the suspended stream had
    # resumed, so that nothing is restored when it does.
    stage = Stage("prima+x1")
    stage.request("ea", move(), Group(chain(say("One."), say("Two."))), say("Three."))
    stage.select()
    ends(stage.at(500), "ea#1.1", 4.0, 1.0)
    stage.request("fa", command("set-speed-and-time"), cause=1)
    stage.select()
    stage.at(600).end("ea#4")
    stage.select()
    stage.at(700).end("ea#5")
    stage.select()
    ends(stage.at(900), "fa#1", 0.0, 0.0)
    assert check(stage.records, "prima+x1") == []


def test_x1_a_held_stream_that_was_suspended_is_restored_too() -> None:
    # A reaction breaks in while nothing of the held stream is in working memory.
    stage = Stage("prima+x1+x3")
    stage.request("ea", move(), say("One."), hold=5000)
    stage.select()
    ends(stage.at(500), "ea#1.1", 4.0, 1.0)
    stage.at(600).end("ea#2")
    stage.select()
    stage.at(700).request("fa", command("set-speed-and-time"), cause=1)
    stage.select()
    ends(stage.at(900), "fa#1", 0.0, 0.0)
    stage.at(1000).request("ea", say("Two."), cause=2)
    stage.select()
    assert check(stage.records, "prima+x1+x3") == []


def test_x1_branches_go_back_once() -> None:
    # Each branch of the suspended stream is given a way back of its own.
    stage = Stage("prima+x1")
    steps = [
        Step(move()),
        Step(say("One."), (0,)),
        Step(say("Two."), (1,)),
        Step(command("gesture"), (1,)),
    ]
    stage.request("ea", steps=steps)
    stage.select()
    ends(stage.at(500), "ea#1.1", 4.0, 1.0)
    stage.request("fa", command("set-speed-and-time"), cause=1)
    stage.select()
    stage.at(700).end("ea#2")
    stage.select()
    ends(stage.at(900), "fa#1", 0.0, 0.0)
    assert check(stage.records, "prima+x1") == []


def test_e1_a_unit_in_a_unit_fails_with_it() -> None:
    # What runs in the inner unit is a part of the outer one, which fails as a whole (U4).
    stage = Stage()
    inner = Group([Step(say("In.")), Step(command("turn"))])
    stage.request("ea", Group([Step(command("move-head")), Step(inner)]))
    stage.select()
    stage.at(100).mediator.failed("ea#2", "neck", "it fails")
    stage.select()
    assert stage.running == set()
    assert check(stage.records, "prima") == []


def test_a_way_back_that_is_put_in_gives_up_neither_channel_nor_conversation() -> None:
    # X1 puts a move, which leaves the user, before a conversation that resumes. K1 then took
    # the stream for one that leaves him anyway, and another application's move went off; and F2
    # took its place for a low one, so that neither went on where K1 kept the other.
    sensing = "active-sensing-human"
    talk = Ask(("q-and-a", "q-and-a", sensing), ((), (), ()))
    reaction = Ask((sensing, sensing, "topological-move"), ((), (), ()))
    asked = (Ask(("set-position",), ((),)), talk, Ask((sensing,), ((),)))
    script = Script(
        ((), ()), ((0, ((), ())), (0, (asked, ())), (4000, ((), (reaction,)))), (), World()
    )
    for policy in ("prima+x1", "prima+all"):
        run = drive(script, policy)
        assert check(run.records, policy) + run.problems == []
        assert run.complete


def test_a_word_waits_for_the_user_also_while_the_way_back_is_gone() -> None:
    # X4 was left out while something that X1 had put in for another branch was there.
    sensing = Ask(("active-sensing-human",), ((),))
    first = Ask(("face-human", "active-sensing-human"), ((), ()))
    asked = (
        Ask((("face-human",), "q-and-a"), ((), ()), connect=True),
        Ask(("q-and-a",), ((),), connect=True),
    )
    script = Script(
        ((), (), ()),
        ((0, ((first,), (), (sensing,))), (0, ((sensing, sensing), (), asked))),
        (),
        World(),
    )
    for policy in ("prima+x1+x4", "prima+all"):
        run = drive(script, policy)
        assert check(run.records, policy) + run.problems == []


def stepped(content: str, *steps: tuple[int, tuple[Inbound, ...]]) -> tuple[Session, list[Record]]:
    """A session of one application that is told what its devices do, and its records."""
    text = HEAD.format("ea", f'<form id="f"><block>{content}</block></form>')
    document, _ = read_document("ea.xml", text.encode())
    session = Session([document], policy_named("prima"), TABLE)
    for now, inbound in steps:
        session.step(now, inbound)
    return session, session.drain()


NESTED = (
    "<iu>{}<par><speak>One.</speak><iu{}><gesture name='nod'/></iu></par></iu><speak>Over.</speak>"
)


def test_a_unit_of_which_only_what_was_out_of_time_is_left_ends_in_an_emergency() -> None:
    # The emergency gave up the inner unit, which was out of time; with it the outer one ended,
    # and was then put back among the waiting ones.
    session, records = stepped(
        NESTED.format("", " longest='1s'"),
        (0, (Loaded("ea"),)),
        (100, (Ended("ea#3"),)),
        (1200, ()),
        (1500, (Emergency(True),)),
        (3000, (Emergency(False),)),
    )
    assert told(records, "ea#4")[-1] == (1500, "cancel")
    assert told(records, "ea#1")[-1] == (1500, "end")
    assert session.idle


def test_an_application_that_is_loaded_again_gives_no_name_out_twice() -> None:
    # What its former life still runs may make ABs when the new one has made some.
    _, records = stepped(
        NESTED.format("<speak>Zero.</speak>", ""),
        (0, (Loaded("ea"),)),
        (50, (Unloaded("ea"),)),
        (60, (Loaded("ea"),)),
        (100, (Ended("ea#3"),)),
    )
    names = [record["behavior"] for record in records if record["phase"] == "request"]
    assert len(names) == len(set(names)) > 7


def test_of_those_who_have_waited_too_long_the_first_by_rank_starts_first() -> None:
    """E4, S2d: whose stream is suspended goes before one that has just resumed."""
    stage = Stage(apps=dict.fromkeys("abcd", "ea"), bound=1)
    stage.request("c", say("One."), say("Two."))
    stage.request("a", TRACK)
    stage.select()
    stage.at(10).request("b", steps=[Step(say("Three.")), Step(say("Four."))])
    stage.select()
    stage.at(20).request("d", command("gesture", name="nod"), cause=1)
    stage.select()
    for now, name, goal in (
        (30, "c#1", True),
        (40, "a#1.1", False),
        (50, "d#1", True),
        (60, "b#1", True),
    ):
        stage.at(now).end(name, goal)
        stage.select()
    started = [record["behavior"] for record in stage.records if record["phase"] == "start"]
    assert started.index("c#2") == len(started) - 1


# What the records tell, against the rules -----------------------------------------------

IN_ORDER = ("fa", "ea", "xa")
SEARCH = "<block><active-sensing-human>Where are you?</active-sensing-human></block>"


def test_f5_stops_a_search_that_now_cuts_short_without_moving_the_robot() -> None:
    # The search turns the robot. What is wanted now says something, and moves nothing.
    body = f'<form id="f1">{SEARCH}<on event="touch"><speak order="now">Wait.</speak></on></form>'
    run = perform(play(body, (10, Occurred("touch", "user"))))
    assert check(run.records, declared=IN_ORDER) == []


def test_a_decision_names_no_loser_that_s3_keeps_back() -> None:
    # Had the turn not started, "Hm." would still hold the speaker back from the search.
    reaction = '<par><turn angle="5"/><speak>Hm.</speak></par>'
    body = f'<form id="f1">{SEARCH}<on event="touch">{reaction}</on></form>'
    run = perform(play(body, (10, Occurred("touch", "user"))))
    assert check(run.records, declared=IN_ORDER) == []


def test_s2c_what_cancels_a_tree_follows_nothing_that_has_ended() -> None:
    # fa has waited for the wheels since 5 ms. What ea wants now cancels its own turn (O2):
    # its parent has not ended, so the earlier request goes first (S2e).
    waits = '<form id="f1"><on event="corner" reactive="false"><turn angle="5"/></on></form>'
    urgent = (
        '<form id="f1"><block><set-direction heading="5"/></block>'
        '<on event="touch" reactive="false"><turn angle="5" order="now"/></on></form>'
    )
    documents = (HEAD.format("fa", waits), HEAD.format("ea", urgent))
    events = ((5, Occurred("corner")), (10, Occurred("touch", "user")))
    run = perform(Play(documents, (0, 0), events, World()))
    assert check(run.records, declared=IN_ORDER) == []


def test_x2_what_is_linked_behind_what_waits_in_an_interrupted_unit_is_told_as_linked() -> None:
    stage = Stage("prima+x2")
    steps = [Step(say("One.")), Step(say("Two.")), Step(say("Three."), (1,))]
    stage.request("ea", Group(steps, restartable=True))
    stage.select()
    stage.at(100).request("fa", say("Ouch."), cause=1)
    assert stage.select() == ["fa#1"]
    outcomes = [r["outcome"] for r in stage.phases("cancel")]
    assert outcomes == ["running", "waiting", "linked"]
    assert check(stage.records, "prima+x2") == []
