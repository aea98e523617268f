"""X8: reactions that come too late are given up, or shrink to what can be done at once."""

from __future__ import annotations

from prima.invariants import check
from prima.messages import Command, Group, Step
from tests.helpers.stage import Stage, ask, chain, command, move, say

TOUCH = 7
POLICY = "prima+x8"
NOD = command("gesture", name="nod")


def busy(*whats: Command | Group, policy: str = POLICY, steps: list[Step] | None = None) -> Stage:
    """The EA speaks, and the FA wants to react within two seconds."""
    stage = Stage(policy)
    stage.request("ea", say("A long story."))
    stage.select()
    stage.at(1000).request("fa", *whats, steps=steps, cause=TOUCH, fresh=2000)
    stage.select()
    return stage


def late(stage: Stage, time: int = 3000) -> list[str]:
    """Time goes on: what is too late goes, and others start."""
    stage.at(time).mediator.expire()
    return stage.select()


def test_x8_a_reaction_that_comes_too_late_is_given_up() -> None:
    stage = busy(say("Oh!"), say("Who was that?"))
    assert stage.mediator.deadline() == 3000
    assert late(stage) == []
    assert stage.told("fa") == ["expired.speak", "expired.speak"]
    assert [notice.what for _, notice in stage.notices] == ["cancelled", "cancelled"]
    stage.at(4000).end("ea#1")
    assert stage.select() == []
    assert check(stage.records, POLICY) == []


def test_x8_in_time_it_is_said() -> None:
    stage = busy(say("Oh!"))
    stage.at(2999).end("ea#1")
    assert stage.select() == ["fa#1"]
    assert stage.mediator.deadline() != 3000
    assert check(stage.records, POLICY) == []


def test_x8_what_ends_in_the_last_instant_lets_it_start() -> None:
    stage = busy(say("Oh!"))
    stage.at(3000).end("ea#1")
    assert late(stage) == ["fa#1"]
    assert check(stage.records, POLICY) == []


def test_x8_what_became_stale_in_an_emergency_is_given_up() -> None:
    stage = busy(say("Oh!"))
    stage.at(2000).mediator.emergency(True, True, 8)
    stage.select()
    stage.at(9000).mediator.emergency(False, True, 9)
    assert late(stage, 9000) == ["ea#1"]
    assert stage.told("fa") == ["expired.speak"]


def test_x8_is_off_unless_it_is_asked_for() -> None:
    stage = busy(say("Oh!"), policy="prima")
    late(stage)
    stage.at(4000).end("ea#1")
    assert stage.select() == ["fa#1"]


def test_x8_a_reaction_without_a_time_waits() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("A long story."))
    stage.select()
    stage.at(1000).request("fa", say("Oh!"), cause=TOUCH)
    stage.select()
    assert late(stage, 90_000) == [] and stage.told("fa") == []
    stage.at(90_000).end("ea#1")
    assert stage.select() == ["fa#1"]


def test_x8_it_shrinks_to_what_needs_only_free_devices() -> None:
    stage = busy(say("Oh!"), NOD)
    assert late(stage) == ["fa#2"]
    [start] = [r for r in stage.phases("start") if r["behavior"] == "fa#2"]
    assert start["reactive"] and start["cause"] == TOUCH
    assert stage.told("fa") == ["expired.speak"]
    assert stage.notices[0][1].what == "expired", "the rest goes on"
    stage.at(4000).end("fa#2")
    assert [notice.what for _, notice in stage.notices[1:]] == ["ended", "done"]
    assert check(stage.records, POLICY) == []


def test_x8_a_reaction_that_has_begun_is_not_given_up() -> None:
    stage = busy(NOD, say("Oh!"))
    assert stage.running == {"ea#1", "fa#1"}
    assert late(stage) == [] and stage.told("fa") == []


def test_x8_a_branch_that_has_not_started_is() -> None:
    stage = busy(steps=[Step(NOD), Step(say("Oh!"))])
    stage.at(2000).end("fa#1")
    stage.select()
    assert late(stage) == []
    assert [(n.what, n.event) for _, n in stage.notices[1:]] == [
        ("expired", "expired.speak"),
        ("done", ""),
    ], "what began is done"
    assert check(stage.records, POLICY) == []


def test_x8_what_the_floor_keeps_is_given_up_whole() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("Watch out!"), cause=TOUCH)
    stage.select()
    stage.at(1000).request("fa", say("Oh!"), NOD, cause=TOUCH, fresh=500)
    stage.select()
    assert stage.holds("fa#1") == ["F2"]
    assert late(stage, 1500) == []
    assert stage.told("fa") == ["expired.speak", "expired.gesture"]
    assert check(stage.records, POLICY) == []


def test_x8_a_question_that_refuses_offers_what_was_said_to_a_reaction_that_waits() -> None:
    stage = busy(say("Oh!"), ask("What's the matter?"), move())
    question = stage.mediator.offered()
    assert question is not None and question.id == "fa#2"
    stage.at(1500).mediator.answered(question, {"outcome": "filled"}, "X8", TOUCH + 1)
    assert stage.select() == []
    assert [n.what for _, n in stage.notices] == ["ended"]
    stage.at(2000).end("ea#1")
    assert stage.select() == ["fa#1"], "what comes before it is said still"


def test_x8_what_follows_an_answered_question_reacts_to_the_answer() -> None:
    stage = busy(ask("What's the matter?"), say("Thank you."))
    question = stage.mediator.offered()
    assert question is not None and question.id == "fa#1"
    stage.at(1500).mediator.answered(question, {"outcome": "filled"}, "X8", TOUCH + 1)
    stage.select()
    stage.at(2000).end("ea#1")
    assert stage.select() == ["fa#2"]
    [start] = [r for r in stage.phases("start") if r["behavior"] == "fa#2"]
    assert start["cause"] == TOUCH + 1
    [answered] = stage.phases("cancel")
    assert (answered["outcome"], answered["data"]) == ("answered", {"outcome": "filled"})


def test_x8_what_is_requested_after_an_answered_reaction_reacts_to_the_answer() -> None:
    stage = busy(ask("What's the matter?"))
    question = stage.mediator.offered()
    assert question is not None
    stage.at(1500).mediator.answered(question, {"outcome": "filled"}, "X8", TOUCH + 1)
    stage.settle()
    assert [(n.what, n.cause) for _, n in stage.notices] == [("ended", None), ("done", TOUCH + 1)]


def test_x8_what_waits_for_more_than_an_answered_question_reacts_to_nothing_new() -> None:
    steps = [Step(ask("What's the matter?")), Step(say("Oh!")), Step(say("Well."), (0, 1))]
    stage = busy(steps=steps)
    question = stage.mediator.offered()
    assert question is not None
    stage.at(1500).mediator.answered(question, {"outcome": "filled"}, "X8", TOUCH + 1)
    stage.select()
    stage.at(2000).end("ea#1")
    assert stage.select() == ["fa#2"]
    stage.at(2500).end("fa#2")
    assert stage.select() == ["fa#3"]
    [start] = [r for r in stage.phases("start") if r["behavior"] == "fa#3"]
    assert "cause" not in start


def test_x8_nothing_is_offered_to_what_is_no_reaction() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("A long story."))
    stage.select()
    stage.request("fa", ask("What's the matter?"))
    assert stage.select() == [] and stage.mediator.offered() is None


def test_x8_with_x4_the_turn_to_the_user_goes_with_it() -> None:
    both = "prima+x4+x8"
    stage = Stage(both)
    stage.request("ea", say("A long story."))
    stage.select()
    stage.at(1000).request("fa", ask("Yes?"), cause=TOUCH, fresh=2000, connect=True)
    stage.select()
    assert late(stage) == [] and stage.told("fa") == ["expired.q-and-a"]
    assert check(stage.records, both) == []


def test_x8_nothing_is_given_up_while_the_robot_is_stopped() -> None:
    stage = busy(say("Oh!"))
    stage.at(2000).mediator.emergency(True, True, 8)
    assert late(stage, 3500) == [] and stage.told("fa") == []
    assert stage.mediator.deadline() is None
    stage.at(4000).mediator.emergency(False, True, 9)
    assert late(stage, 4000) == ["ea#1"] and stage.told("fa") == ["expired.speak"]


def test_x8_what_an_emergency_kept_waiting_is_given_up_whole() -> None:
    stage = busy(say("Oh!"), say("Who was that?"))
    stage.at(2000).mediator.emergency(True, True, 8)
    stage.at(4000).mediator.emergency(False, True, 9)
    assert late(stage, 4000) == ["ea#1"], "its second half alone says nothing"
    assert stage.told("fa") == ["expired.speak", "expired.speak"]


def test_x8_nor_when_something_else_is_over_meanwhile() -> None:
    stage = Stage("prima+x3+x8")
    stage.request("ea", say(), cause=TOUCH - 1, hold=2500)
    stage.select()
    stage.at(1000).end("ea#1")
    stage.select()
    stage.request("fa", say("Oh!"), cause=TOUCH, fresh=2000)
    stage.mediator.emergency(True, True, 8)
    assert late(stage, 3500) == [] and stage.told("fa") == []
    assert [one["outcome"] for one in stage.phases("held")] == ["begun", "over"]


def test_x8_whoever_cannot_start_in_the_last_instant_is_given_up_in_the_next() -> None:
    """It could have started when the others ended, but then another reaction was asked for."""
    stage = busy(say("Oh!"))
    stage.at(3000).end("ea#1")
    stage.mediator.expire()
    stage.request("ea", say("News!"), cause=TOUCH + 1)
    assert stage.select() == ["ea#2"] and stage.told("fa") == []
    assert stage.mediator.deadline() == 3001
    assert late(stage, 3001) == [] and stage.told("fa") == ["expired.speak"]


def test_x8_a_branch_that_another_kept_waiting_starts_when_that_is_given_up() -> None:
    turning = command("turn-and-speak", "Oh!", angle=9)
    stage = busy(steps=[Step(turning), Step(command("turn", angle=3)), Step(NOD, (1,))])
    assert stage.holds("fa#2") == ["S3"], "its devices are free, but the first branch wants them"
    assert late(stage) == ["fa#2"]
    assert stage.told("fa") == ["expired.turn-and-speak"]
    assert check(stage.records, POLICY) == []


def test_x8_what_follows_goes_first_and_its_application_hears_of_all() -> None:
    stage = busy(say("Oh!"), Group(chain(say("Who?"), say("You!"))), say("Well."))
    assert late(stage) == []
    gone = [(one["behavior"], one["outcome"]) for one in stage.phases("cancel")]
    assert gone == [("fa#3", "linked"), ("fa#2", "linked"), ("fa#1", "waiting")]
    told = [(one.what, one.event) for _, one in stage.notices]
    assert told == [
        ("cancelled", "expired.speak"),
        ("cancelled", "expired.iu"),
        ("cancelled", "expired.speak"),
    ]
    assert all(one.command is not None for _, one in stage.notices)


def test_x8_what_waits_for_something_else_as_well_is_not_given_up_with_it() -> None:
    stage = busy(steps=[Step(say("Oh!")), Step(NOD), Step(say("Well."), (0, 1))])
    assert late(stage) == [] and stage.told("fa") == ["expired.speak"]
    stage.at(3500).end("fa#2")
    stage.at(4000).end("ea#1")
    assert stage.select() == ["fa#3"]
    stage.at(5000).end("fa#3")
    told = [one.what for app, one in stage.notices if app == "fa"]
    assert told == ["expired", "ended", "ended", "done"]


def test_x8_what_follows_two_of_them_goes_once() -> None:
    ah, eh = Step(say("Ah!"), (0,)), Step(say("Eh!"), (0,))
    stage = busy(steps=[Step(say("Oh!")), ah, eh, Step(say("Well."), (1, 2))])
    assert late(stage) == [] and stage.told("fa") == ["expired.speak"] * 4
    assert [one["behavior"] for one in stage.phases("cancel")] == ["fa#4", "fa#3", "fa#2", "fa#1"]


def test_x8_a_branch_that_is_given_up_whole_ends_what_began_once() -> None:
    stage = busy(steps=[Step(NOD), Step(say("Oh!")), Step(say("Ah!"), (1,))])
    stage.at(2000).end("fa#1")
    stage.select()
    late(stage)
    assert [(one.what, one.event) for _, one in stage.notices] == [
        ("ended", ""),
        ("expired", "expired.speak"),
        ("expired", "expired.speak"),
        ("done", ""),
    ]


def test_x8_an_application_that_has_left_the_state_or_has_gone_hears_nothing() -> None:
    left, gone = busy(say("Oh!")), busy(say("Oh!"))
    left.leave("fa")
    gone.mediator.unload("fa", "crash")
    for stage in (left, gone):
        late(stage)
        assert stage.told("fa") == []


def test_x8_an_answer_is_offered_to_the_first_question_of_reactions_alone() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("A long story."))
    stage.select()
    stage.request("fa", ask("Between us?"))
    stage.request("fa", Group(chain(say("Now."), ask("In a unit?"))), ask("You?"), cause=TOUCH)
    stage.select()
    question = stage.mediator.offered()
    assert question is not None and question.command is not None
    assert question.command.text == "You?"


def test_x8_nobody_is_given_up_before_their_time_because_something_else_is_over() -> None:
    stage = Stage("prima+x3+x8")
    stage.request("ea", say(), cause=TOUCH - 1, hold=2500)
    stage.select()
    stage.at(1000).end("ea#1")
    stage.request("fa", command("turn", angle=5), cause=TOUCH)
    assert stage.select() == ["fa#1"]
    stage.request("fa", command("turn", angle=9), cause=TOUCH + 1, fresh=9000)
    stage.select()
    assert late(stage, 3500) == [] and stage.told("fa") == []
    assert stage.mediator.deadline() == 10_000


def test_x8_what_is_left_of_it_may_start_in_that_instant_alone() -> None:
    stage = busy(say("Oh!"), NOD)
    stage.at(3000).mediator.expire()
    stage.request("ea", NOD, cause=TOUCH + 1)
    assert stage.select() == ["ea#2"] and stage.told("fa") == ["expired.speak"]
    assert stage.mediator.deadline() == 3001
    assert late(stage, 3001) == [] and stage.told("fa")[1:] == ["expired.gesture"]


def test_x8_an_answered_question_is_not_given_up_with_what_comes_before_it() -> None:
    stage = busy(say("Oh!"), ask("What's the matter?"), say("Well."))
    question = stage.mediator.offered()
    assert question is not None
    stage.at(1500).mediator.answered(question, {"outcome": "filled"}, "X8", TOUCH + 1)
    stage.select()
    assert late(stage) == []
    assert stage.told("fa") == ["ended", "expired.speak", "expired.speak"]


def test_x8_what_is_left_of_it_follows_nothing_and_goes_behind_an_earlier_reaction() -> None:
    """S2c: the third application's reaction to the same event was asked for before."""
    stage = Stage(POLICY, {"fa": "fa", "ea": "ea", "third": "ea"})
    stage.request("ea", steps=[Step(say("A long story.")), Step(command("turn", angle=9))])
    stage.select()
    both = Group([Step(NOD), Step(command("turn", angle=3))])
    stage.at(900).request("third", both, cause=TOUCH)
    stage.select()
    stage.at(1000).request("fa", say("Oh!"), NOD, cause=TOUCH, fresh=2000)
    stage.select()
    assert late(stage) == [] and stage.holds("fa#2") == ["S3"]
    assert late(stage, 3001) == [] and stage.told("fa") == ["expired.speak", "expired.gesture"]
    stage.at(3500).end("ea#2")
    assert stage.select() == ["third#1", "third#2", "third#3"], "a unit of two"
    assert check(stage.records, POLICY) == []
