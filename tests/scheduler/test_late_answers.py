"""X10 and X8: answers that come too late, and those that another question is offered."""

from __future__ import annotations

import pytest

from prima.invariants import check
from prima.messages import Heard
from tests.helpers.robot import Bench, document
from tests.helpers.stage import Stage, ask, say
from tests.helpers.violations import numbers

AGAIN = """<form id="ask">
  <field name="right" type="boolean"><prompt>Is it right?</prompt>
    <noinput>{}</noinput>
    <filled><log>right: <value expr="right"/></log></filled></field>
  {}
</form>"""
OFFER = """<form id="wait"><on event="touch"><goto next="#offer"/></on></form>
<form id="offer">
  <field name="wanted" type="boolean"><prompt>Shall I dance?</prompt>
    <noinput><goto next="#wait"/></noinput>
    <filled><log>dance: <value expr="wanted"/></log><goto next="#wait"/></filled></field>
</form>"""
ASK = AGAIN.format("<reprompt/>", "")
POLICY = "prima+x10"


def lapsed(asks: str = ASK, policy: str = POLICY) -> Bench:
    """The EA's question is not answered in time, and the FA has begun to ask another one."""
    bench = Bench(document(OFFER, "fa", "fa"), document(asks, "ea", "ea"), policy=policy)
    bench.listens()
    bench.event("touch")
    bench.silence()
    assert bench.saying() == ["Shall I dance?"]
    return bench


def hears(bench: Bench, text: str, after: int = 100, lasted: int = 0) -> None:
    """The user says something so many ms later, which took so long to say."""
    bench.step(Heard(text, {}, lasted), at=bench.now + after)


def test_x10_a_late_answer_goes_to_who_has_asked_before_it_is_asked_again() -> None:
    bench = lapsed()
    hears(bench, "yes")
    assert bench.logs() == ["right: true"]
    assert bench.saying() == ["Shall I dance?"], "the other question goes on"
    [heard] = [r for r in bench.phases("event") if r["event"] == "speech"]
    assert (heard["app"], heard["rule"]) == ("ea", "X10")
    assert check(bench.records, POLICY) == []


def test_x10_is_off_unless_it_is_asked_for() -> None:
    bench = lapsed(policy="prima")
    hears(bench, "yes")
    assert bench.logs() == ["dance: true"]
    assert numbers(check(bench.records, POLICY)) == {16}, "with it, that breaks the rule"


@pytest.mark.parametrize(
    ("after", "lasted", "whose"),
    [(2000, 0, "right"), (2001, 0, "dance"), (3000, 1000, "right"), (3000, 999, "dance")],
)
def test_x10_it_counts_when_the_user_began_to_speak(after: int, lasted: int, whose: str) -> None:
    bench = lapsed()
    bench.listens()
    bench.now -= 100
    hears(bench, "yes", after, lasted)
    assert bench.logs() == [f"{whose}: true"]
    assert check(bench.records, POLICY) == []


def test_x10_a_link_of_who_has_asked_takes_it() -> None:
    link = '<link next="#help"><grammar>help</grammar></link>'
    asks = AGAIN.format("", link) + '<form id="help"><block><log>helps</log></block></form>'
    bench = lapsed(asks)
    hears(bench, "help")
    assert bench.logs() == ["helps"]


def test_x10_else_it_is_an_event_of_that_application_alone() -> None:
    late = '<on event="late"><log>late: <value expr="event.data.text"/></log></on>'
    bench = lapsed(AGAIN.format("<goto next='#rest'/>", "") + f'<form id="rest">{late}</form>')
    hears(bench, "yes")
    assert bench.logs() == ["late: yes"]
    assert bench.saying() == ["Shall I dance?"]
    assert check(bench.records, POLICY) == []


def test_x10_nobody_else_hears_what_is_not_taken() -> None:
    bench = lapsed(AGAIN.format("<goto next='#rest'/>", "") + '<form id="rest"/>')
    hears(bench, "yes")
    assert bench.logs() == [] and bench.session.hearing.take_unheard() == "yes"


def test_x10_an_answer_to_who_has_ended_answers_nobody_else() -> None:
    bench = lapsed(AGAIN.format("<exit/>", ""))
    hears(bench, "yes")
    assert bench.logs() == [] and bench.session.hearing.take_unheard() == "yes"


def test_x10_what_follows_an_answer_that_comes_early_is_no_reaction() -> None:
    stage = Stage(POLICY)
    stage.request("fa", say("A long story."))
    stage.request("ea", ask(), say("Thank you."))
    assert stage.select() == ["fa#1"]
    question = stage.mediator.coming_question("ea")
    assert question is not None
    stage.at(1100).mediator.answered(question, {"outcome": "filled"}, "X10", 8)
    stage.select()
    stage.at(2000).end("fa#1")
    assert stage.select() == ["ea#2"]
    assert "cause" not in stage.phases("start")[-1]


def test_x10_a_question_that_listens_again_is_answered_as_ever() -> None:
    bench = Bench(document(ASK, "ea", "ea"), policy=POLICY)
    bench.listens()
    bench.silence()
    bench.listens()
    hears(bench, "yes")
    assert bench.logs() == ["right: true"]
    [heard] = [r for r in bench.phases("event") if r["event"] == "speech"]
    assert heard.get("rule") is None


@pytest.mark.parametrize("policy", [POLICY, "prima"])
def test_x10_a_question_is_answered_while_it_is_said_again(policy: str) -> None:
    asks = ASK.replace("<prompt>", '<prompt bargein="false">')
    bench = Bench(document(asks, "ea", "ea"), policy=policy)
    bench.listens()
    bench.silence()
    assert bench.saying() == ["Is it right?"]
    hears(bench, "yes")
    late = policy == POLICY
    assert (bench.logs(), bench.saying()) == (
        (["right: true"], []) if late else ([], ["Is it right?"])
    )
    assert check(bench.records, policy) == []


# X8 -------------------------------------------------------------------------------------


def offered(policy: str = "prima+x8") -> Bench:
    """The EA's question listens while the FA's waits, as a reaction."""
    bench = Bench(
        document(
            OFFER.replace("Shall I dance?", "What is it?")
            .replace('type="boolean"', "")
            .replace("<noinput>", "<option>dance</option><noinput>"),
            "fa",
            "fa",
        ),
        document(ASK, "ea", "ea"),
        policy=policy,
    )
    bench.listens()
    bench.event("touch")
    return bench


def test_x8_what_a_question_refuses_answers_a_reaction_that_waits() -> None:
    bench = offered()
    hears(bench, "dance")
    assert bench.logs() == ["dance: dance"]
    assert bench.saying() == ["Is it right?"], "that question goes on listening"
    hears(bench, "yes")
    assert bench.logs() == ["dance: dance", "right: true"]
    assert "What is it?" not in bench.said()
    assert check(bench.records, "prima+x8") == []


def test_x8_what_no_question_takes_is_a_nomatch() -> None:
    bench = offered()
    hears(bench, "something else")
    assert bench.logs() == []
    assert [r["outcome"] for r in bench.phases("end")] == ["nomatch"]


def test_x8_without_it_a_reaction_is_offered_nothing() -> None:
    bench = offered("prima")
    hears(bench, "dance")
    assert [r["outcome"] for r in bench.phases("end")] == ["nomatch"]


def test_x8_a_handler_says_for_how_long_its_reaction_is_worth_starting() -> None:
    remark = """<form id="wait"><on event="touch" fresh-for="1s">
      <speak>Oh!</speak><log>said</log></on>
      <on event="expired.speak"><log>too late</log></on></form>"""
    talk = '<form id="talk"><block><speak>A story.</speak></block></form>'
    bench = Bench(document(remark, "fa", "fa"), document(talk, "ea", "ea"), policy="prima+x8")
    bench.event("touch")
    bench.step(at=bench.session.deadline())
    assert bench.logs() == ["too late"], "what follows in the handler is abandoned"
    bench.finish("A story.")
    assert bench.said() == ["A story."]
    assert check(bench.records, "prima+x8") == []


def test_x8_the_time_goes_with_the_reaction_to_another_form() -> None:
    asks = OFFER.replace('<on event="touch">', '<on event="touch" fresh-for="1s">')
    talk = '<form id="talk"><block><speak>A story.</speak></block></form>'
    bench = Bench(document(asks, "fa", "fa"), document(talk, "ea", "ea"), policy="prima+x8")
    bench.event("touch")
    bench.step(at=bench.session.deadline())
    [cancel] = bench.phases("cancel")
    assert (cancel["command"], cancel["rule"]) == ("q-and-a", "X8")
