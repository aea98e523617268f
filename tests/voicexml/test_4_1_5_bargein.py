"""Answers before a question is asked to its end: VoiceXML 2.0, 4.1.5."""

from __future__ import annotations

import pytest

from prima.messages import Ended, Heard
from tests.helpers.dialogs import question
from tests.helpers.voice import Call, voice, vxml


@pytest.mark.parametrize(
    ("property_value", "attribute", "expected"),
    [("true", "false", False), ("false", "true", True), ("false", "", False), ("", "", True)],
)
def test_bargein_of_a_prompt_comes_before_the_property(
    property_value: str, attribute: str, expected: bool
) -> None:  # 4.1.5
    own = f'<property name="bargein" value="{property_value}"/>' if property_value else ""
    call = Call(
        f"""{own}<form><field name="f"><prompt {f'bargein="{attribute}"' if attribute else ""}>
        Well?</prompt><option>yes</option></field></form>"""
    )
    call.play()
    assert question(call)["bargein"] is expected


@pytest.mark.parametrize("prompt", ["", "<prompt>Here it is.</prompt>"])
@pytest.mark.parametrize("behind", ["", "<prompt><break time='1s'/></prompt>"])
def test_what_a_command_says_before_a_question_is_no_question(prompt: str, behind: str) -> None:
    call = Call(
        vxml(
            f"""<form xmlns:p="urn:prima:dialogue:1"><block>{prompt}<p:speak>A long story.</p:speak>{behind}</block>
            <field name="f"><option>red</option><filled><log expr="f"/></filled></field></form>"""
        )
    )
    call.hears("red")
    assert call.logs() == []
    call.play()
    call.hears("red")
    assert call.logs() == ["red"]


PROPERTY = '<property name="bargein" value="{}"/>'


@pytest.mark.parametrize("allowed", [True, False])
def test_the_property_holds_for_the_platforms_own_words(allowed: bool) -> None:  # 5.2.5
    call = Call(
        f"""{PROPERTY.format(str(allowed).lower())}<form><field name="f">
        <prompt bargein="true">Which?</prompt><option>red</option>
        <filled><log expr="f"/></filled></field></form>"""
    )
    call.listens()
    call.hears("blue")
    assert call.saying() != ["Which?"]
    call.hears("red")
    assert call.logs() == (["red"] if allowed else [])


WELCOME = """<form><block><prompt>One.</prompt><prompt {}>Two.</prompt></block>
<field name="f">{}<prompt>Which?</prompt><option dtmf="1">red</option>
<filled><log expr="f"/><prompt>Good.</prompt></filled></field></form>"""


@pytest.mark.parametrize(
    ("text", "open_"),
    [
        (PROPERTY.format("false") + WELCOME.format("", PROPERTY.format("true")), False),
        (WELCOME.format("", PROPERTY.format("true")), True),
        (WELCOME.format("", "").replace("<form>", f"<form>{PROPERTY.format('false')}"), False),
    ],
)
def test_the_property_holds_where_the_prompt_stands(text: str, open_: bool) -> None:  # 6.3
    call = Call(vxml(text))
    call.hears("red")
    assert call.logs() == (["red"] if open_ else [])


@pytest.mark.parametrize(("said", "logged"), [("red", "red"), ("1", "red")])
def test_what_is_said_during_a_prompt_before_a_question_answers_it(said: str, logged: str) -> None:
    call = Call(WELCOME.format("", ""))
    call.hears(said)
    assert call.saying() == ["One."], "what is being said is not cut (U1)"
    assert call.logs() == [logged]
    assert call.play() == ["One.", "Good."], "nothing more is said before the answer counts"
    assert {(r["rule"], r["text"]) for r in call.phases("cancel")} == {
        ("O3", "Two."),
        ("O3", "Which?"),
    }
    left = call.phases("leave")
    assert [one["state"] for one in left] == [1, 2], "by the answer, and by the dialog's end"
    assert call.ended == "exit"


@pytest.mark.parametrize("before", [["One."], ["One.", "Two."]])
def test_what_is_said_as_a_prompt_ends_answers_the_question_behind_it(before: list[str]) -> None:
    call = Call(WELCOME.format("", ""))
    for text in before[:-1]:
        call.finish(text)
    call.step(Ended(call._id(before[-1])), Heard("red"))
    assert call.logs() == ["red"]
    assert call.play() == [*before, "Good."]
    assert call.ended == "exit"


def test_what_is_said_as_a_prompt_ends_that_may_not_be_broken_in_on_is_no_answer() -> None:
    call = Call(WELCOME.format('bargein="false"', ""))
    call.finish("One.")
    call.step(Ended(call._id("Two.")), Heard("red"))
    assert (call.logs(), call.saying()) == ([], ["Which?"])


def test_a_question_is_not_answered_in_the_instant_in_which_it_is_asked_for() -> None:
    call = Call("<form><block>Other.</block></form>", voice(WELCOME.format("", ""), "asking"))
    call.step(Ended(call._id("Other.")), Heard("red"))
    assert (call.logs(), call.saying()) == ([], ["One."])


def test_what_no_grammar_takes_before_a_question_ends_nothing() -> None:
    call = Call(WELCOME.format("", ""))
    call.hears("blue")
    assert call.play() == ["One.", "Two.", "Which?"]
    call.answer("red")
    assert call.logs() == ["red"]


def test_what_may_not_be_broken_in_on_is_said_before_an_answer_counts() -> None:
    call = Call(WELCOME.format('bargein="false"', ""))
    call.hears("red")
    assert call.logs() == []
    call.finish("One.")
    call.hears("red")
    assert call.logs() == []
    call.answer("red")
    assert call.said() == ["One.", "Two.", "Which?", "Good."]


def test_prompts_may_be_broken_in_on_behind_one_that_may_not() -> None:
    text = WELCOME.replace("<prompt>One.", '<prompt bargein="false">One.')
    call = Call(text.format("", ""))
    call.hears("red")
    call.finish("One.")
    assert call.logs() == []
    call.hears("red")
    assert call.logs() == ["red"]
    assert call.play() == ["One.", "Two.", "Good."]


@pytest.mark.parametrize("own", [True, False])
def test_bargein_as_a_property_holds_for_prompts_before_a_question(own: bool) -> None:
    text = WELCOME.format(
        'bargein="true"' if own else "", '<property name="bargein" value="false"/>'
    )
    call = Call(text)
    call.finish("One.")
    call.hears("red")
    assert call.logs() == [], "the question itself may not be broken in on"
    text = WELCOME.format('bargein="true"' if own else "", "").replace(
        "<prompt>Which?", '<prompt bargein="true">Which?'
    )
    call = Call(vxml(f'<property name="bargein" value="false"/>{text}'))
    call.finish("One.")
    call.hears("red")
    assert call.logs() == (["red"] if own else [])


def test_what_is_said_before_a_recording_is_not_recorded() -> None:
    call = Call(
        """<form><block>One.</block><record name="r"><prompt>Speak.</prompt></record>
        <block><log expr="'later'"/></block></form>"""
    )
    call.hears("something")
    assert call.saying() == ["One."]
    call.finish("One.")
    assert call.saying() == ["Speak."]


def test_nobody_answers_a_question_before_anything_is_said_for_it() -> None:
    call = Call("<form><block>Other.</block></form>", voice(WELCOME.format("", ""), "asking"))
    call.hears("red")
    assert call.logs() == []
    call.finish("Other.")
    assert call.saying() == ["One."]
    call.hears("red")
    assert call.logs() == ["red"]


def test_a_link_may_be_taken_before_a_question() -> None:
    text = """<link next="#help"><grammar mode="voice" version="1.0" root="r">
    <rule id="r">help</rule></grammar></link>
    <form><block>One.</block><field name="f"><prompt>Which?</prompt><option>red</option></field></form>
    <form id="help"><block>Like this.</block></form>"""
    call = Call(text)
    call.hears("help")
    assert call.play() == ["One.", "Like this."]


def test_the_property_of_a_dialog_that_was_left_holds_for_its_prompts() -> None:
    call = Call(
        f"""<form id="a">{PROPERTY.format("false")}<block>Legal notice.<goto next="#b"/></block></form>
        <form id="b"><field name="f"><prompt>Which?</prompt><option>red</option>
        <filled><log expr="f"/></filled></field></form>"""
    )
    call.hears("red")
    assert call.logs() == []
    call.finish("Legal notice.")
    call.hears("red")
    assert call.logs() == ["red"]


@pytest.mark.parametrize("place", ["", "Come with me."])
def test_a_command_before_a_question_is_done_before_an_answer_counts(place: str) -> None:
    text = f"""<form><block>{place}<p:point-by-hand xmlns:p="urn:prima:dialogue:1" angle="30"/></block>
        <field name="f"><prompt>Which?</prompt><option>red</option>
        <filled><log expr="f"/></filled></field></form>"""
    call = Call(text)
    call.hears("red")
    assert call.logs() == []
    call.answer("red")
    assert "point-by-hand" in [r["command"] for r in call.phases("end")]
    assert call.logs() == ["red"]


def test_a_grammar_of_a_recording_takes_nothing_before_it() -> None:
    call = Call(
        """<form><block>One.</block><record name="r"><grammar version="1.0" root="g" mode="voice">
        <rule id="g">stop</rule></grammar><prompt>Speak.</prompt>
        <filled><log expr="'filled'"/></filled></record></form>"""
    )
    call.hears("stop")
    call.finish("One.")
    assert (call.saying(), call.logs()) == (["Speak."], [])
