"""X9: a topic that resumes after others have spoken says so first."""

from __future__ import annotations

from prima.invariants import check
from prima.messages import Command, Step
from tests.helpers.stage import Stage, ask, command, inserted, move, say, search

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


def test_x9_and_x1_the_robot_goes_back_before_it_says_so() -> None:
    both = "prima+x1+x9"
    stage = Stage(both)
    stage.request("ea", command("move-head", pan=30), say("One."), say("Two."), words=words())
    stage.select()
    stage.at(500).end("ea#1")
    stage.select()
    stage.at(600).request("fa", command("move-head", pan=-30), say("Oh!"), cause=TOUCH)
    stage.select()
    stage.at(1000).end("ea#2")
    stage.select()
    stage.at(1100).end("fa#1")
    assert stage.select() == ["fa#2"]
    stage.at(2000).end("fa#2")
    assert stage.select() == ["ea#4"]
    stage.at(2500).end("ea#4")
    assert stage.select() == ["ea#5"]
    assert inserted(stage) == [("X1", "move-head"), ("X9", "speak")]
    stage.at(3500).end("ea#5")
    assert stage.select() == ["ea#3"]
    assert check(stage.records, both) == []


def test_x9_words_that_fail_do_not_keep_the_topic() -> None:
    stage = broken()
    stage.at(2000).end("fa#1")
    stage.select()
    stage.at(2100).mediator.failed("ea#3", "speaker", "It is broken.")
    assert stage.select() == ["ea#2"]
    assert check(stage.records, POLICY) == []
