"""X9: a topic that resumes after others have spoken says so first."""

from __future__ import annotations

from dataclasses import replace

from prima.invariants import check
from prima.messages import Command, Group, Step
from tests.helpers.stage import Stage, ask, chain, command, inserted, move, say, search

TOUCH = 7
POLICY = "prima+x9"


def words() -> Command:
    return Command("speak", text="As I was saying:")


def broken(policy: str = POLICY, rest: tuple[Command, ...] = ()) -> Stage:
    """The EA's topic is broken after its first sentence by what the FA does about a touch."""
    stage = Stage(policy)
    told = rest or (say("Two."),)
    stage.request("ea", say("One."), *told, words=words())
    stage.select()
    stage.at(500).request("fa", say("Oh!"), cause=TOUCH)
    stage.select()
    stage.at(1000).end("ea#1")
    assert stage.select() == ["fa#1"]
    return stage


def test_x9_a_topic_resumes_in_words() -> None:
    stage = broken()
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#3"]
    assert inserted(stage) == [("X9", "speak")]
    assert stage.orders[-1].command and stage.orders[-1].command.text == "As I was saying:"
    assert [r["behavior"] for r in stage.phases("resume")] == ["ea#3"], "the words resume it"
    stage.at(3000).end("ea#3")
    assert stage.select() == ["ea#2"], "nothing is said twice"
    stage.at(4000).end("ea#2")
    stage.select()
    assert check(stage.records, POLICY) == []


def test_x9_is_off_unless_it_is_asked_for() -> None:
    stage = broken("prima")
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#2"]


def test_x9_a_break_in_which_nobody_spoke_needs_no_words() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("One."), say("Two."), words=words())
    stage.select()
    stage.at(500).request("fa", command("gesture", name="nod"), cause=TOUCH)
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("ea#1")
    assert stage.select() == [], "F2"
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#2"]
    assert check(stage.records, POLICY) == []


def test_x9_a_question_that_only_listens_says_nothing() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("One."), say("Two."), words=words())
    stage.select()
    stage.at(500).request("fa", Command("q-and-a"), cause=TOUCH)
    stage.select()
    stage.at(1000).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#2"]
    assert check(stage.records, POLICY) == []


def test_x9_a_turn_to_the_user_is_no_word() -> None:
    both = "prima+x4+x9"
    stage = Stage(both)
    stage.request("ea", say("One."), words=words(), connect=True)
    assert stage.select() == ["ea#2"] and inserted(stage) == [("X4", "face-human")]
    stage.at(500).request("fa", say("Oh!"), cause=TOUCH)
    stage.select()
    stage.at(1000).end("ea#2", x=0.0, y=0.0, heading=90.0)
    assert stage.select() == ["fa#1"]
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#1"], "nothing has been said yet"
    assert check(stage.records, both) == []


def test_x9_who_has_said_nothing_yet_resumes_no_topic() -> None:
    stage = Stage(POLICY)
    stage.request("ea", command("turn", angle=10), say("One."), words=words())
    stage.select()
    stage.request("fa", say("Oh!"), cause=TOUCH)
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("ea#1")
    stage.select()
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#2"]


def test_x9_the_words_come_before_a_question_and_before_a_move() -> None:
    for rest in (ask("Well?"), move()):
        stage = broken(rest=(rest,))
        stage.at(2000).end("fa#1")
        assert stage.select() == ["ea#3"]
        stage.at(3000).end("ea#3")
        assert stage.select()[0].startswith("ea#2")
        assert check(stage.records, POLICY) == []


def test_x9_each_break_has_its_words() -> None:
    stage = broken(rest=(say("Two."), say("Three.")))
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#4"]
    stage.at(2500).request("fa", say("Oh!"), cause=TOUCH + 1)
    stage.select()
    stage.at(3000).end("ea#4")
    assert stage.select() == ["fa#2"], "who breaks in again is heard before the topic"
    stage.at(4000).end("fa#2")
    assert stage.select() == ["ea#5"]
    stage.at(5000).end("ea#5")
    assert stage.select() == ["ea#2"]
    stage.at(6000).end("ea#2")
    assert stage.select() == ["ea#3"], "without a break there are none"
    assert check(stage.records, POLICY) == []


def test_x9_words_that_wait_for_their_turn_are_said_once() -> None:
    stage = broken()
    stage.at(1500).request("ea", say("What?"), cause=TOUCH + 1)
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == [("X9", "speak")]
    stage.at(2500).request("fa", say("Hm."), cause=TOUCH + 2)
    stage.at(3000).end("ea#3")
    assert stage.select() == ["fa#2"], "it goes before the words, which wait"
    stage.at(4000).end("fa#2")
    assert stage.select() == ["ea#4"]
    stage.at(5000).end("ea#4")
    assert stage.select() == ["ea#2"] and inserted(stage) == [("X9", "speak")]


def test_x9_another_topic_in_its_place_does_not_resume_it() -> None:
    stage = broken()
    other = Command("speak", text="Something else.", now=True)
    stage.at(1500).request("ea", other, words=words())
    stage.select()
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == []
    assert check(stage.records, POLICY) == []


def test_x9_all_branches_wait_for_the_words() -> None:
    stage = Stage(POLICY)
    steps = [Step(say("One.")), Step(search()), Step(say("Two."), (0,))]
    stage.request("ea", steps=steps, words=words())
    stage.select()
    stage.at(500).request("fa", command("face-human-and-speak", "Oh!"), cause=TOUCH)
    stage.select()
    stage.at(700).end("ea#2.1", goal=False)
    stage.select()
    stage.at(1000).end("ea#1")
    assert stage.select() == ["fa#1"]
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#4"]
    stage.at(3000).end("ea#4")
    assert stage.select() == ["ea#2.2", "ea#3"]
    assert check(stage.records, POLICY) == []


BACK = "prima+x1+x9"


def turned_away(*rest: Step) -> Stage:
    """The EA has turned the head and spoken, when the FA turns it away and speaks itself."""
    stage = Stage(BACK)
    first = [Step(command("move-head", pan=30)), Step(say("One."), (0,))]
    stage.request("ea", steps=[*first, *rest], words=words())
    stage.select()
    stage.at(500).end("ea#1")
    stage.select()
    stage.at(600).request("fa", command("move-head", pan=-30), say("Oh!"), cause=TOUCH)
    stage.select()
    stage.at(1000).end("ea#2")
    stage.select()
    stage.at(1100).end("fa#1")
    assert stage.select() == ["fa#2"]
    return stage


def test_x9_and_x1_the_robot_goes_back_before_it_says_so() -> None:
    stage = turned_away(Step(say("Two."), (1,)))
    stage.at(2000).end("fa#2")
    assert stage.select() == ["ea#4"]
    stage.at(2500).end("ea#4")
    assert stage.select() == ["ea#5"]
    assert inserted(stage) == [("X1", "move-head"), ("X9", "speak")]
    stage.at(3500).end("ea#5")
    assert stage.select() == ["ea#3"]
    assert check(stage.records, BACK) == []


def test_x9_words_that_fail_do_not_keep_the_topic() -> None:
    stage = broken()
    stage.at(2000).end("fa#1")
    stage.select()
    stage.at(2100).mediator.failed("ea#3", "speaker", "It is broken.")
    assert stage.select() == ["ea#2"]
    assert check(stage.records, POLICY) == []


def test_x9_an_answer_to_a_held_topic_resumes_it_without_words() -> None:
    """Neither it nor what follows it in the topic: the pause is over (X3)."""
    both = "prima+x3+x9"
    stage = Stage(both)
    stage.request("ea", say("One."), words=words(), cause=TOUCH - 1, hold=9000)
    stage.select()
    stage.at(500).end("ea#1")
    stage.request("fa", say("Oh!"), cause=TOUCH)
    assert stage.select() == ["fa#1"]
    stage.at(600).request("ea", say("Two."), words=words(), cause=TOUCH + 1)
    stage.select()
    stage.at(1000).end("fa#1")
    assert stage.select() == ["ea#2"]
    stage.at(1500).end("ea#2", then=lambda: stage.request("ea", say("Three."), words=words()))
    assert stage.select() == ["ea#3"] and inserted(stage) == []
    assert check(stage.records, both) == []


def test_x9_what_its_own_application_says_is_no_break() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("One."), say("Two."), words=words())
    stage.select()
    stage.at(500).request("fa", command("gesture", name="nod"), cause=TOUCH)
    stage.select()
    stage.at(1000).end("ea#1")
    stage.request("ea", say("Ouch!"), cause=TOUCH + 1)
    assert stage.select() == ["ea#3"]
    stage.at(2000).end("fa#1")
    stage.select()
    stage.at(3000).end("ea#3")
    assert stage.select() == ["ea#2"] and inserted(stage) == []
    assert check(stage.records, POLICY) == []


def test_x9_what_is_said_beside_a_topic_is_no_break() -> None:
    stage = Stage(POLICY)
    stage.request("ea", say("One."), command("turn", angle=5), words=words())
    stage.select()
    stage.at(500).end("ea#1")
    assert stage.select() == ["ea#2"]
    stage.at(600).request("fa", say("Hello."))
    assert stage.select() == ["fa#1"]
    stage.at(700).end("ea#2", then=lambda: stage.request("ea", say("Two."), words=words()))
    stage.select()
    stage.at(900).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == []
    assert check(stage.records, POLICY) == []


def test_x9_a_unit_resumes_in_words_which_have_a_place_of_their_own() -> None:
    stage = Stage(POLICY)
    placed = replace(words(), source="ea.xml:2:9")
    stage.request("ea", say("One."), Group(chain(say("Two."))), words=placed)
    stage.select()
    stage.at(500).request("fa", say("Oh!"), cause=TOUCH)
    stage.at(1000).end("ea#1")
    stage.select()
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#3"]
    assert stage.phases("request")[-1]["source"] == "ea.xml:2"
    stage.at(3000).end("ea#3")
    assert stage.select() == ["ea#2", "ea#4"]


def test_x9_whatever_is_in_the_stream_waits_for_the_words_behind_the_way_back() -> None:
    both_follow = [Step(say("Two."), (1,)), Step(command("point-by-hand", angle=5), (1,))]
    stage = turned_away(*both_follow)
    started = []
    for time, behavior in ((2000, "fa#2"), (2500, "ea#5"), (3500, "ea#6")):
        stage.at(time).end(behavior)
        started.append(stage.select())
    assert started == [["ea#5"], ["ea#6"], ["ea#3", "ea#4"]]
    assert check(stage.records, BACK) == []


def test_x9_what_is_wanted_now_waits_for_no_way_back() -> None:
    stage = turned_away(Step(say("Two."), (1,)))
    stage.at(2000).end("fa#2")
    assert stage.select() == ["ea#4"]
    stage.at(2100).request("ea", Command("speak", text="Wait!", now=True), words=words())
    assert stage.select() == ["ea#5"]
    assert inserted(stage) == [("X1", "move-head")]


def test_x9_the_response_to_an_answer_does_not_resume_the_topic() -> None:
    """X7, X10: the question is answered while another has the floor, before it is asked."""
    stage = Stage("prima+x7+x9+x10")
    stage.request("ea", say("Sorry?"), ask(), words=words())
    stage.select()
    steps = [Step(command("tracking-human")), Step(say("Oh!"))]
    stage.at(500).request("fa", steps=steps, cause=TOUCH)
    assert stage.select() == ["fa#1.1"]
    stage.at(1000).end("ea#1")
    assert stage.select() == ["fa#2"]
    question = stage.mediator.coming_question("ea")
    assert question is not None
    stage.at(1100).mediator.answered(question, {"outcome": "filled"}, "X10", TOUCH + 1)
    response = [say("Thank you."), say("Now.")]
    stage.settle(lambda: stage.request("ea", *response, words=words()))
    stage.at(2000).end("fa#2")
    assert stage.select() == ["ea#3"]
    stage.at(3000).end("ea#3")
    assert stage.select() == [] and inserted(stage) == []
    stage.at(3100).end("fa#1.1")
    assert stage.select() == ["ea#5"] and inserted(stage) == [("X9", "speak")]


def test_x9_what_was_wanted_now_resumes_after_an_emergency_in_words() -> None:
    """It has begun before: what starts again is the topic."""
    stage = Stage(POLICY)
    stage.request("ea", say("One."), words=words())
    stage.select()
    now = Command("face-human", now=True)
    stage.at(500).end("ea#1", then=lambda: stage.request("ea", now, words=words()))
    assert stage.select() == ["ea#2"]
    stage.at(600).mediator.emergency(True, True, TOUCH)
    stage.select()
    stage.at(800).mediator.emergency(False, True, TOUCH + 1)
    stage.request("fa", say("Oh!"), cause=TOUCH + 1)
    assert stage.select() == ["fa#1"]
    stage.at(1000).end("fa#1")
    assert stage.select() == ["ea#3"] and inserted(stage) == [("X9", "speak")]
    stage.at(2000).end("ea#3")
    assert stage.select() == ["ea#2"]
    assert check(stage.records, POLICY) == []
