"""X7: nobody speaks between a user's answer and what the asker says to it."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

import pytest

from prima.invariants import check
from prima.language.commands import TABLE_4_2, CommandType
from prima.messages import Command, Group, Step
from prima.scheduler import interruption, thirdturn
from tests.helpers.rebinding import rebind
from tests.helpers.stage import TRACK, Stage, ask, chain, command, inserted, move, restartable, say

TOUCH = 7
HEAD = command("move-head", pan=30)


def answer(stage: Stage, behavior: str, then: Any = None, outcome: str = "filled") -> None:
    """The user answers a question."""
    stage.mediator.ended(behavior, True, {"outcome": outcome}, inbound=False)
    stage.settle(then)


def touched_while_asked(
    policy: str = "prima+x7", table: Mapping[str, CommandType] = TABLE_4_2
) -> Stage:
    """The EA asks, and the user strokes the robot: the FA wants to say something to that."""
    stage = Stage(policy, {"fa": "fa", "ea": "ea", "third": "ea"}, table)
    stage.request("ea", ask())
    stage.select()
    stage.at(1000).request("fa", say("That feels good."), cause=TOUCH)
    assert stage.select() == []
    return stage


def test_x7_the_asker_has_the_first_word_after_an_answer() -> None:
    stage = touched_while_asked()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", say("Thank you.")))
    assert stage.select() == ["ea#2"]
    assert (stage.rule("ea#2"), stage.losers("ea#2")) == ("X7", ["fa#1"])
    stage.at(3000).end("ea#2")
    assert stage.select() == ["fa#1"], "the price is one utterance"
    assert check(stage.records, "prima+x7") == []


def test_x7_is_off_unless_it_is_asked_for() -> None:
    stage = touched_while_asked("prima")
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", say("Thank you.")))
    assert stage.select() == ["fa#1"]


def test_x7_nobody_speaks_while_the_robot_turns_its_head_before_its_word() -> None:
    stage = touched_while_asked()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", HEAD, say("Thank you.")))
    assert stage.select() == ["ea#2"]
    assert stage.holds("fa#1")[-1] == "X7"
    stage.at(2400).request("third", command("turn", angle=3), cause=TOUCH + 1)
    assert stage.select() == ["third#1"], "it says nothing"
    stage.at(2500).end("ea#2")
    assert stage.select() == ["ea#3"]
    stage.at(3000).end("ea#3")
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x7") == []


def test_x7_what_says_nothing_reacts_at_once_and_keeps_the_floor() -> None:
    stage = Stage("prima+x7")
    stage.request("ea", ask())
    stage.select()
    stage.at(1000).request("fa", TRACK, cause=TOUCH)
    assert stage.select() == ["fa#1.1"] and stage.floor == ["fa:1"]
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", say("Thank you."), say("Now.")))
    assert stage.select() == ["ea#2"]
    assert stage.rule("ea#2") == "X7", "F2 would have kept it"
    assert stage.floor == ["fa:1"]
    assert not [r for r in stage.phases("resume") if r["tree"] == "ea:1"], "its stream waits on"
    stage.at(3000).end("ea#2")
    assert stage.select() == [] and stage.holds("ea#3")[-1] == "F2"
    assert check(stage.records, "prima+x7") == []


def test_x7_a_response_takes_no_floor_from_a_stream_with_a_waiting_sentence() -> None:
    stage = Stage("prima+x7")
    stage.request("ea", ask())
    stage.select()
    reactions = [Step(TRACK), Step(say("That feels good."))]
    stage.at(1000).request("fa", steps=reactions, cause=TOUCH)
    assert stage.select() == ["fa#1.1"] and stage.floor == ["fa:1"]
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", say("Thank you.")))
    assert (stage.select(), stage.rule("ea#2")) == (["ea#2"], "X7")
    assert stage.floor == ["fa:1"]
    assert check(stage.records, "prima+x7") == []


def test_x7_a_response_that_was_interrupted_goes_before_nobody() -> None:
    stage = Stage("prima+x2+x7", apps={"fa": "fa", "ea": "ea", "third": "fa"})
    stage.request("ea", ask())
    stage.select()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", restartable(say("Thank you."))))
    assert stage.select() == ["ea#2"]
    stage.at(2100).request("fa", say("That feels good."), cause=TOUCH)
    assert stage.select() == ["fa#1"], "it reacts to a later event"
    stage.at(2200).request("third", say("Oh!"), cause=TOUCH + 1)
    assert stage.select() == []
    stage.at(3000).end("fa#1")
    assert stage.select() == ["third#1"]
    assert check(stage.records, "prima+x2+x7") == []


def test_x7_a_response_that_waits_for_another_device_holds_the_speaker_back() -> None:
    stage = Stage("prima+x7", apps={"fa": "fa", "ea": "ea", "third": "fa"})
    stage.request("ea", ask())
    stage.select()
    stage.at(500).request("fa", command("turn", angle=90))
    stage.request("third", say("Oh!"))
    assert stage.select() == ["fa#1"]
    facing = command("face-human-and-speak", "Thank you.")
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", facing))
    assert stage.select() == []
    assert (stage.holds("ea#2"), stage.holds("third#1")[-1]) == (["S1"], "S3")
    stage.at(2500).end("fa#1")
    assert stage.select() == ["ea#2"]
    assert check(stage.records, "prima+x7") == []


@pytest.mark.parametrize("outcome", ["noinput", "nomatch"])
def test_x7_only_an_answer_is_answered(outcome: str) -> None:
    stage = touched_while_asked()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", say("Well.")), outcome)
    assert stage.select() == ["fa#1"]


@pytest.mark.parametrize(
    "then",
    [
        (ask("And when?"),),
        (move(), say("Here we are.")),
        (TRACK, say("There you are.")),
        (ask("And when?"), say("I see.")),
    ],
    ids=["a question", "behind a move", "behind a loop", "behind a question"],
)
def test_x7_what_may_last_is_not_waited_for(then: tuple[Command, ...]) -> None:
    stage = touched_while_asked()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", *deepcopy(then)))
    assert "fa#1" in stage.select()


def test_x7_what_waits_does_not_break_it_off_but_a_later_event_does() -> None:
    """X2: the reaction was to go behind it, and not to interrupt it at its start."""
    stage = touched_while_asked("prima+x2+x7")
    word = restartable(say("Thank you."))
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", word))
    assert stage.select() == ["ea#2"]
    stage.at(2100).request("fa", say("Ouch."), cause=TOUCH + 1)
    assert stage.select() == ["fa#2"]
    assert [(r["behavior"], r["by"]) for r in stage.phases("interrupt")] == [("ea#2", "fa#2")]
    assert check(stage.records, "prima+x2+x7") == []


def turning_its_head_before_it_answers() -> Stage:
    """The user answers while the robot turns its head, after which the asker has a word to say."""
    stage = Stage("prima+x2+x7")
    steps = [Step(ask()), Step(restartable(HEAD)), Step(say("Thank you."), (1,))]
    stage.request("ea", steps=steps)
    assert stage.select() == ["ea#1", "ea#2"]
    return stage


def test_x7_what_comes_before_the_response_goes_before_a_later_reaction() -> None:
    stage = turning_its_head_before_it_answers()
    answer(stage.at(2000), "ea#1")
    assert stage.select() == []
    stage.at(2100).request("fa", command("move-head", pan=0), cause=TOUCH)
    assert (stage.select(), stage.phases("interrupt")) == ([], [])
    stage.at(2200).end("ea#2")
    assert stage.select() == ["ea#3", "fa#1"]
    assert check(stage.records, "prima+x2+x7") == []


def test_x7_the_check_of_a_run_sees_what_is_interrupted_before_the_response() -> None:
    stage = turning_its_head_before_it_answers()
    answer(stage.at(2000), "ea#1")
    stage.select()
    stage.at(2100).request("fa", command("move-head", pan=0), cause=TOUCH)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(interruption, "third_turn", lambda ab, memory: False)
        assert stage.select() == ["fa#1"]
    (found,) = check(stage.records, "prima+x2+x7")
    assert "invariant 16 (X7) at 2.100 s: ea#2 is interrupted" in found


def test_x7_a_command_yields_when_nobody_has_answered() -> None:
    stage = turning_its_head_before_it_answers()
    stage.at(2100).request("fa", command("move-head", pan=0), cause=TOUCH)
    assert stage.select() == ["fa#1"]
    assert [(r["behavior"], r["by"]) for r in stage.phases("interrupt")] == [("ea#2", "fa#1")]
    assert check(stage.records, "prima+x2+x7") == []


def test_x7_what_a_reaction_interrupts_kept_the_response_from_the_speaker_till_then() -> None:
    """A unit has the speaker while the asker turns its head; it gives way to a later reaction (X2)."""
    stage = Stage("prima+x2+x7", apps={"fa": "fa", "ea": "ea", "third": "fa"})
    stage.request("ea", ask())
    stage.select()
    unit = Group(chain(say("Hm."), command("turn", angle=9)), restartable=True)
    stage.at(400).request("fa", unit, cause=TOUCH)
    stage.request("third", HEAD, cause=TOUCH + 1)
    assert stage.select() == ["third#1"]
    then = chain(HEAD, say("Thank you."))
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", steps=then))
    assert "fa#1" in stage.select()
    stage.at(2100).end("third#1")
    assert (stage.select(), stage.rule("ea#2")) == (["ea#2"], "X7")
    stage.at(2200).end("ea#2")
    assert (stage.select(), stage.holds("ea#3")[-1]) == ([], "S1")
    stage.at(2300).request("third", command("turn", angle=90), cause=TOUCH + 2)
    assert stage.select() == ["third#2", "ea#3"]
    assert [(r["behavior"], r["by"]) for r in stage.phases("interrupt")] == [("fa#1", "third#2")]
    assert check(stage.records, "prima+x2+x7") == []


def test_x7_the_check_of_a_run_sees_a_response_that_nothing_kept_from_the_speaker() -> None:
    stage = Stage("prima+x2+x7", apps={"fa": "fa", "ea": "ea", "third": "fa"})
    stage.request("ea", ask())
    stage.select()
    stage.at(400).request("fa", restartable(command("turn", angle=9)), cause=TOUCH)
    assert stage.select() == ["fa#1"]
    with pytest.MonkeyPatch.context() as patch:
        rebind(patch, thirdturn, "owe", lambda mediation: None)
        answer(stage.at(2000), "ea#1", lambda: stage.request("ea", say("Thank you.")))
        stage.request("third", command("turn", angle=90), cause=TOUCH + 1)
        assert stage.select() == ["third#1"]
    found = check(stage.records, "prima+x2+x7")
    assert "invariant 12 (X7) at 2.000 s: third#1 starts before ea#2, which outranks it" in found


def test_x7_nobody_waits_for_what_waits_for_a_device_itself() -> None:
    stage = Stage("prima+x7", {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.request("ea", ask())
    stage.request("eb", command("gesture", name="nod"))
    assert stage.select() == ["ea#1", "eb#1"]
    stage.at(1000).request("fa", say("That feels good."), cause=TOUCH)
    stage.select()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", HEAD, say("Thank you.")))
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x7") == []


def test_x7_two_commands_before_the_response_come_before_it() -> None:
    stage = touched_while_asked()
    then = [HEAD, command("point-by-hand", angle=9), say("Thank you.")]
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", *then))
    assert (stage.select(), stage.rule("ea#2")) == (["ea#2"], "S1")
    assert stage.holds("fa#1")[-1] == "X7"
    stage.at(2500).end("ea#2")
    assert stage.select() == ["ea#3"]
    assert stage.holds("fa#1")[-1] == "X7"
    assert check(stage.records, "prima+x7") == []


def test_x7_nobody_waits_if_the_first_of_two_commands_waits_for_a_device() -> None:
    stage = Stage("prima+x7", {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.request("ea", ask())
    stage.request("eb", command("gesture", name="nod"))
    stage.select()
    stage.at(1000).request("fa", say("That feels good."), cause=TOUCH)
    stage.select()
    then = [HEAD, command("turn", angle=3), say("Thank you.")]
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", *then))
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x7") == []


def test_x7_what_leaves_the_user_is_not_waited_for_even_if_it_makes_no_loops() -> None:
    go = replace(TABLE_4_2["topological-move"], feedback=False)
    stage = touched_while_asked(table={**TABLE_4_2, "topological-move": go})
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", move(), say("Here we are.")))
    assert "fa#1" in stage.select()


def test_x7_a_unit_of_questions_is_not_waited_for() -> None:
    stage = touched_while_asked()
    answer(stage.at(2000), "ea#1", lambda: stage.open("ea", 5, "speaker"))
    assert stage.select() == ["fa#1"]


def test_x7_inside_a_unit_the_unit_keeps_the_speaker() -> None:
    stage = Stage("prima+x7")
    stage.open("ea", 5, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=5)
    assert stage.select() == ["ea#1", "ea#2"]
    stage.at(1000).request("fa", say("That feels good."), cause=TOUCH)
    assert stage.select() == []
    answer(stage.at(2000), "ea#2", lambda: stage.request("ea", say("Thank you."), unit=5))
    assert stage.select() == ["ea#3"]
    assert stage.holds("fa#1") == ["S1"]


def test_x7_is_not_needed_inside_a_unit_even_while_the_head_turns_before_the_word() -> None:
    stage = Stage("prima+x7")
    stage.open("ea", 5, "speaker", "speech-recognition", "neck")
    stage.request("ea", ask(), unit=5)
    stage.select()
    stage.at(1000).request("fa", say("That feels good."), cause=TOUCH)
    stage.select()
    answer(stage.at(2000), "ea#2", lambda: stage.request("ea", HEAD, say("Thank you."), unit=5))
    assert stage.select() == ["ea#3"]
    assert stage.holds("fa#1") == ["S1"], "the unit owns the speaker"
    assert check(stage.records, "prima+x7") == []


def test_x7_an_answer_with_which_a_unit_ends_is_answered_behind_it() -> None:
    stage = Stage("prima+x7")
    stage.open("ea", 5, "speaker", "speech-recognition")
    stage.request("ea", ask(), unit=5)
    stage.select()
    stage.at(1000).request("fa", say("That feels good."), cause=TOUCH)
    stage.select()

    def thank() -> None:
        stage.close("ea", 5)
        stage.request("ea", say("Thank you."))

    answer(stage.at(2000), "ea#2", thank)
    assert stage.select() == ["ea#3"]
    assert (stage.rule("ea#3"), stage.losers("ea#3")) == ("X7", ["fa#1"])
    assert check(stage.records, "prima+x7") == []


def test_x7_who_says_nothing_to_an_answer_keeps_nobody() -> None:
    stage = touched_while_asked()
    answer(stage.at(2000), "ea#1")
    assert stage.select() == ["fa#1"]


def test_x7_an_application_that_ends_owes_nothing() -> None:
    stage = touched_while_asked()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", HEAD, say("Thank you.")))
    stage.select()
    stage.at(2100).leave("ea")
    stage.mediator.unload("ea", "exit")
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x7") == []


def test_x7_an_application_that_gives_up_both_its_word_and_what_comes_before_owes_nothing() -> None:
    stage = Stage("prima+x7", {"fa": "fa", "ea": "ea", "eb": "ea"})
    stage.request("ea", ask())
    stage.request("eb", command("gesture", name="nod"))
    assert stage.select() == ["ea#1", "eb#1"]
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", HEAD, say("Thank you.")))
    assert stage.select() == []
    stage.at(2100).leave("ea")
    stage.request("fa", say("Well."))
    assert stage.select() == ["fa#1"]
    assert check(stage.records, "prima+x7") == []


def test_x7_an_answer_that_comes_early_is_answered_behind_what_is_being_said() -> None:
    """X10: the question is asked once more as the user begins to answer it."""
    stage = Stage("prima+x7+x10")
    stage.request("ea", say("Sorry?"), ask())
    assert stage.select() == ["ea#1"]
    stage.at(1000).request("fa", say("That feels good."), cause=TOUCH)
    assert stage.select() == []
    question = stage.mediator.coming_question("ea")
    assert question is not None
    stage.at(1100).mediator.answered(question, {"outcome": "filled"}, "X10", TOUCH + 1)
    stage.settle(lambda: stage.request("ea", HEAD, say("Thank you.")))
    stage.select()
    stage.at(2000).end("ea#1")
    stage.select()
    assert {"ea#3", "ea#4"} & stage.running and "fa#1" not in stage.running


def test_x7_an_answer_that_comes_while_its_topic_resumes_in_words_does_not_wait_for_them() -> None:
    """X9, X10: the response waits for the speaker alone; its other Commands start at once."""
    policy = "prima+x7+x9+x10"
    stage = Stage(policy)
    words = say("As I was saying.")
    stage.request("ea", say("Well."), ask(), words=words)
    assert stage.select() == ["ea#1"]
    stage.request("fa", say("That feels good."), cause=TOUCH)
    assert stage.select() == []
    stage.at(1000).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == [("X9", "speak")]
    question = stage.mediator.coming_question("ea")
    assert question is not None
    stage.at(2100).mediator.answered(question, {"outcome": "filled"}, "X10", TOUCH + 1)
    stage.settle(lambda: stage.request("ea", HEAD, say("Thank you."), words=words))
    assert stage.select() == ["ea#4"] and stage.holds("ea#5") == []
    stage.at(2200).end("ea#4")
    assert stage.select() == [] and stage.holds("ea#5") == ["S1"]
    stage.at(3000).end("ea#3")
    assert stage.select() == ["ea#5"]
    found = check(stage.records, policy)
    assert [one for one in found if "nobody has said anything" not in one] == []


def test_x7_its_own_reaction_waits_as_well() -> None:
    stage = Stage("prima+x7")
    stage.request("ea", ask())
    stage.select()
    stage.at(1000).request("ea", say("Oh!"), cause=TOUCH)
    stage.select()
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", HEAD, say("Thank you.")))
    assert stage.select() == ["ea#3"]
    assert stage.holds("ea#2")[-1] == "X7"
    assert check(stage.records, "prima+x7") == []


def test_x7_a_reaction_in_the_askers_stream_is_no_response() -> None:
    stage = Stage("prima+x7")
    stage.request("ea", ask(), HEAD)
    stage.select()
    beside = [Step(replace(HEAD, now=True)), Step(say("Oh!"))]
    stage.at(1000).request("ea", steps=beside, cause=TOUCH)
    assert stage.select() == ["ea#3"], "it takes the place of what was to follow (O2)"
    stage.at(1100).request("fa", say("That feels good."), cause=TOUCH + 1)
    assert stage.select() == []
    answer(stage.at(2000), "ea#1")
    assert stage.select() == ["fa#1"], "it reacts to the later event"
    assert (stage.rule("fa#1"), stage.losers("fa#1")) == ("S2b", ["ea#4"])
    assert check(stage.records, "prima+x7") == []


def test_x7_a_response_may_be_wanted_now() -> None:
    stage = touched_while_asked()
    stage.request("ea", say("Goodbye."))
    stage.select()
    thanks = replace(say("Thank you."), now=True)
    answer(stage.at(2000), "ea#1", lambda: stage.request("ea", thanks))
    assert (stage.select(), stage.rule("ea#3")) == (["ea#3"], "X7")
    assert check(stage.records, "prima+x7") == []
