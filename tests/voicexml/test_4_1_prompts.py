"""Prompts, queued, counted and tapered: VoiceXML 2.0, 4.1."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    OOPS,
    YES,
    Case,
    Cases,
    P,
    ask,
    block,
    check_page,
    question,
    run,
    said,
)
from tests.helpers.voice import Call

case = Cases()

case(
    "a prompt's condition decides whether it is said",
    "4.1",
    """<form><block><prompt cond="false">No.</prompt><prompt cond="true">Yes.</prompt></block></form>""",
    said=["Yes."],
)
case(
    "bare text in a field is a prompt of the first count",
    "4.1.2",
    f"""<form><field name="f">Where <value expr="1 + 1"/>?{CITIES}
    <prompt count="2">Which city?</prompt></field></form>""",
    "x",
    said=["Where 2?", OOPS, "Which city?"],
)
case(
    "prompts queued before a subdialog are said before its own",
    "4.1.8",
    """<form><block>One.</block><subdialog name="s" src="#t"><prompt>Two.</prompt></subdialog>
    <block>Four.</block></form><form id="t"><block>Three.<return/></block></form>""",
    said=["One.", "Two.", "Three.", "Four."],
)
case(
    "prompts queued before an error ends the application are said",
    "4.1.8",
    "<form><block>Hello.<throw event='odd'/></block></form>",
    said=["Hello."],
    ended="odd",
)
case(
    "prompts queued before a goto are said",
    "4.1.8",
    """<form><block>One.<goto next="#t"/></block></form><form id="t"><block>Two.</block></form>""",
    said=["One.", "Two."],
)
case(
    "the conditions of prompts are looked at before their counts",
    "4.1.6",
    f"""<form><field name="f"><prompt>One?</prompt><prompt count="9" cond="zz">Nine?</prompt>
    {CITIES}<catch event="error.semantic">Oh.<exit/></catch></field></form>""",
    said=["Oh."],
)
case(
    "a visit counts once its prompts are queued, not if one of them fails",
    "C",
    f"""<form><var name="k"/><field name="f"><prompt cond="k.x">One?</prompt>
    <prompt count="2">Two?</prompt>{CITIES}<nomatch><reprompt/></nomatch>
    <catch event="error.semantic"><assign name="k" expr="{{x: 1}}"/><reprompt/></catch>
    </field></form>""",
    "x",
    said=["One?", "Two?"],
)
case(
    "a visit does not count if a value in its prompts fails",
    "C",
    f"""<form><var name="k"/><field name="f"><prompt>One <value expr="k.x"/>?</prompt>
    <prompt count="2">Two?</prompt>{CITIES}<catch event="error.semantic">
    <assign name="k" expr="{{x: 1}}"/><reprompt/></catch></field></form>""",
    said=["One 1?"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_prompts_condition_is_evaluated() -> None:  # 4.1
    assert said('<prompt cond="1 > 2">No.</prompt><prompt cond="2 > 1">Yes.</prompt>') == ["Yes."]


def languages(call: Call) -> list[tuple[str, str]]:
    """Everything said, with its language."""
    call.play()
    return [
        (order.command.text or "", order.command.lang)
        for order in call.orders
        if order.verb == "start" and order.command is not None
    ]


def test_a_prompts_language_is_its_own_or_its_documents() -> None:  # 4.1
    call = Call(block('<prompt>Hello.</prompt><prompt xml:lang="ja">どうぞ。</prompt>'))
    assert languages(call) == [("Hello.", "en"), ("どうぞ。", "ja")]


def test_a_questions_language_is_its_prompts() -> None:  # 4.1
    call = Call(
        '<form><field name="f"><prompt xml:lang="ja">どこ？</prompt><option>a</option></field></form>'
    )
    assert languages(call) == [("どこ？", "ja")]


@pytest.mark.parametrize(
    ("body", "spoken"),
    [
        ('<p:speak xml:lang="ja">あ</p:speak>', [("あ", "ja")]),
        ('<p:seq><p:speak xml:lang="ja">あ</p:speak></p:seq>', [("あ", "ja")]),
        ('<prompt xml:lang="ja">あ<p:speak>い</p:speak></prompt>', [("あ", "ja"), ("い", "ja")]),
        (
            '<prompt xml:lang="ja">あ<p:speak xml:lang="en">a</p:speak></prompt>',
            [("あ", "ja"), ("a", "en")],
        ),
        (
            '<prompt xml:lang="ja"><p:speak>い<voice xml:lang="ja">う</voice></p:speak></prompt>',
            [("いう", "ja")],
        ),
    ],
)
def test_a_commands_language_is_its_own_or_what_is_around_it(
    body: str, spoken: list[tuple[str, str]]
) -> None:
    assert languages(Call(block(body.replace(">", f" {P}>", 1)))) == spoken


def test_prompts_in_another_document_have_its_language() -> None:  # 4.1
    other = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" xml:lang="ja">'
    call = Call(
        block('<goto next="o.vxml"/>'), o=f"{other}<form><block>はい。</block></form></vxml>"
    )
    assert languages(call) == [("はい。", "ja")]


@pytest.mark.parametrize(
    "attributes",
    ['bargeintype="speech"', 'bargeintype="hotword"', 'xml:base="sounds/"', 'count="1"'],
)
def test_other_attributes_of_a_prompt_are_accepted(attributes: str) -> None:  # 4.1
    assert said(f"<prompt {attributes}>Hi.</prompt>") == ["Hi."]


@pytest.mark.parametrize(
    ("markup", "words"),
    [
        ('<sub alias="World Wide Web">WWW</sub> here', "World Wide Web here"),
        ('<say-as interpret-as="date">May 5</say-as>', "May 5"),
        ("One<break/>two", "One two"),
        ('One<break time="500ms"/>two', "One two"),
        ("<emphasis>Very</emphasis> good", "Very good"),
        ("<p><s>One.</s><s>Two.</s></p>", "One. Two."),
        ("<p>One.</p><p>Two.</p>", "One. Two."),
        ('<voice gender="female">Hi</voice> there', "Hi there"),
        ('<prosody rate="slow">Slow</prosody>', "Slow"),
        ('<phoneme ph="x">tomato</phoneme>', "tomato"),
        ('<mark name="m"/>Hi', "Hi"),
        ('<lexicon uri="l.xml"/>Hi', "Hi"),
        ("<metadata><x>y</x></metadata>Hi", "Hi"),
        ('<audio src="a.wav">Hi<desc>a bell</desc></audio>', "Hi"),
        ('<value expr="1 + 1"/>', "2"),
        ("<value expr=\"'a' + 'b'\"/>c", "abc"),
        ('<value expr="[1, 2]"/>', "1,2"),
        ('<value expr="undefined"/>', "undefined"),
        ("Many\n   spaces", "Many spaces"),
        ("<![CDATA[1 < 2]]>", "1 < 2"),
    ],
)
def test_markup_is_read_for_its_words(markup: str, words: str) -> None:  # 4.1.1
    assert said(f"<prompt>{markup}</prompt>") == [words]


def test_a_part_of_a_prompt_may_be_of_another_language() -> None:  # 4.1.1
    call = Call(block('<prompt>Say <voice xml:lang="fr">bonjour</voice> now.</prompt>'))
    assert languages(call) == [("Say", "en"), ("bonjour", "fr"), ("now.", "en")]


@pytest.mark.parametrize(
    "wrong",
    ["<say-as>1</say-as>", "<sub>x</sub>", "<phoneme>x</phoneme>", "<break>x</break>"],
)
def test_speech_that_lacks_what_it_needs_is_refused(wrong: str) -> None:  # 4.1.1
    (problem,) = check_page(f"<form><block><prompt>{wrong}</prompt></block></form>")
    assert (problem.severity, problem.code in ("missing-attribute", "stray-text")) == (
        "error",
        True,
    )


@pytest.mark.parametrize(
    ("content", "wrong"),
    [
        ("<p>One <p>two</p></p>", "misplaced-element"),
        ("<paragraph>One <p>two</p></paragraph>", "misplaced-element"),
        ("<p>One <paragraph>two</paragraph></p>", "misplaced-element"),
        ("<desc>x</desc>", "misplaced-element"),
        ("<p><desc>x</desc></p>", "misplaced-element"),
        ("<s><lexicon uri='l'/></s>", "misplaced-element"),
        ("<voice><meta name='a' content='b'/></voice>", "misplaced-element"),
        ("<audio src='a'><metadata/></audio>", "misplaced-element"),
        ("<s xml:lang='e n'>x</s>", "bad-value"),
        ("<p xml:lang='123'>x</p>", "bad-value"),
        ("<sub alias='a' xml:lang='123'>x</sub>", "bad-value"),
        ("<lexicon uri='l'/><meta name='a' content='b'/><metadata/>x", ""),
        ("<audio src='a'><desc>x</desc><p>One <s>two</s></p></audio>", ""),
        ("<p xml:lang='zh-Hant-TW'>One <voice><s xml:lang=''>two</s></voice></p>", ""),
    ],
)
def test_speech_markup_stands_where_it_may(content: str, wrong: str) -> None:  # 4.1.1, SSML
    problems = check_page(f"<form><block><prompt>{content}</prompt></block></form>")
    assert [one.code for one in problems] == ([wrong] if wrong else [])


def test_text_and_values_without_a_prompt_are_one_prompt() -> None:  # 4.1.2
    assert said('<var name="n" expr="3"/>You have <value expr="n"/> letters.') == [
        "You have 3 letters."
    ]


def test_text_in_an_item_is_its_prompt() -> None:  # 4.1.2
    call = Call(
        '<form><field name="f">Pick <value expr="1 + 1"/> now.<option>a</option></field></form>'
    )
    assert call.play() == ["Pick 2 now."]


def test_a_recording_is_heard_as_its_text() -> None:  # 4.1.3
    assert said('<audio src="hello.wav">Hello!</audio>') == ["Hello!"]


def test_a_recording_without_text_is_named() -> None:  # 4.1.3
    assert said('<audio src="sounds/bell.wav"/>') == ["[bell.wav]"]


def test_a_recordings_name_may_be_an_expression() -> None:  # 4.1.3
    assert said("<audio expr=\"'be' + 'll.wav'\"/>") == ["[bell.wav]"]


def test_a_recording_whose_expression_is_undefined_is_not_heard_at_all() -> None:  # 4.1.3
    assert said('One. <audio expr="undefined">Two.</audio> Three.') == ["One. Three."]


def test_a_recording_whose_expression_gives_anything_else_is_heard() -> None:  # 4.1.3
    assert said('One. <audio expr="null">Two.</audio> Three.') == ["One. Two. Three."]
    assert said("<audio expr=\"['a.wav']\"/>") == ["[a.wav]"]


def test_a_recordings_text_may_hold_a_recording() -> None:  # 4.1.3
    assert said('<audio src="a.wav"><audio src="b.wav">Text.</audio></audio>') == ["Text."]


def test_an_undeclared_variable_in_a_value_is_error_semantic() -> None:  # 4.1.4
    call = Call('<catch event="error.semantic"><log>bad</log><exit/></catch>'
                + block('<value expr="none"/>'))  # fmt: skip
    assert call.logs() == ["bad"]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("['ham', 'eggs']", "ham,eggs"),
        ("new String('box')", "box"),
        ("new Error('full')", "Error: full"),
        ("{toString: function () { return 'mine'; }}", "mine"),
        ("{a: 1}", '{"a":1}'),
        ("null", "null"),
        ("Object.create(null)", "{}"),
    ],
)
def test_a_value_is_said_in_its_own_words(value: str, said: str) -> None:  # 4.1.4
    text = f'<form><var name="v" expr="{value}"/><block><value expr="v"/></block></form>'
    assert run(text).said() == [said]


def test_prompts_taper_by_their_counts() -> None:  # 4.1.6
    call = Call(
        """<form><field name="f"><prompt count="1">One?</prompt><prompt count="3">Three?</prompt>
        <option>yes</option><nomatch><reprompt/></nomatch></field></form>"""
    )
    for _ in range(3):
        call.answer("no")
    assert call.said() == ["One?", "One?", "Three?", "Three?"]


def test_a_count_whose_condition_fails_is_left_out() -> None:  # 4.1.6
    call = Call(
        """<form><field name="f"><prompt>One?</prompt><prompt count="2" cond="false">Two?</prompt>
        <option>yes</option><nomatch><reprompt/></nomatch></field></form>"""
    )
    call.answer("no")
    assert call.said() == ["One?", "One?"]


def test_all_prompts_of_one_count_are_said() -> None:  # 4.1.6
    call = Call(
        '<form><field name="f"><prompt>One.</prompt><prompt>Two?</prompt><option>y</option>'
        "</field></form>"
    )
    assert call.play() == ["One.", "Two?"]


def test_the_last_prompts_timeout_counts() -> None:  # 4.1.7
    call = Call(
        """<form><field name="f"><prompt timeout="1s">One.</prompt><prompt timeout="2s">Two?</prompt>
        <option>yes</option></field></form>"""
    )
    call.play()
    assert question(call)["timeout"] == 2000


def test_a_prompt_without_timeout_has_that_of_the_property() -> None:  # 4.1.7
    call = Call(
        """<form><property name="timeout" value="3s"/><field name="f">
        <prompt timeout="1s">One.</prompt><prompt>Two?</prompt><option>yes</option></field></form>"""
    )
    call.play()
    assert question(call)["timeout"] == 3000


@pytest.mark.parametrize(
    ("around", "prompt"),
    [
        ('<property name="timeout" value="7s"/><property name="bargein" value="false"/>', "Well?"),
        ("", '<prompt timeout="7s" bargein="false">Well?</prompt>'),
    ],
)
def test_a_prompts_settings_are_those_of_where_it_is_queued(around: str, prompt: str) -> None:
    # 4.1.7: "at the time the prompt is queued"
    call = Call(
        f"""<form>{around}<block>{prompt}<goto next="#b"/></block></form>
        <form id="b"><property name="timeout" value="1s"/><field name="f">{YES}</field></form>"""
    )
    call.play()
    assert (question(call)["timeout"], question(call)["bargein"]) == (7000, False)


def test_a_question_without_a_prompt_has_the_timeout_of_its_own_property() -> None:  # 4.1.7
    call = Call(
        f"""<form><property name="timeout" value="7s"/><field name="f"><prompt>Well?</prompt>{YES}
        <filled><goto nextitem="g"/></filled></field><field name="g">
        <property name="timeout" value="1s"/>{YES}</field></form>"""
    )
    call.answer("yes")
    assert question(call)["timeout"] == 1000


def test_without_any_timeout_it_is_the_platforms() -> None:  # 4.1.7
    call = Call(ask("<option>yes</option>"))
    call.play()
    assert question(call)["timeout"] == 5000


def test_the_timeout_of_a_prompt_that_was_played_before_is_over() -> None:  # 4.1.7
    text = f"""<form><transfer name="t" dest="tel:+1" type="bridge"><prompt timeout="2s">One moment.
        </prompt></transfer><field name="f">{YES}</field></form>"""
    call = Call(text)
    call.play()
    questions = [
        one.command for one in call.orders if one.command and "timeout" in one.command.args
    ]
    assert [one.args["timeout"] for one in questions][-1:] == [5000]


def test_prompts_of_many_blocks_queue_in_their_order() -> None:  # 4.1.8
    call = Call(
        """<form><block>One.</block><block><prompt>Two.</prompt><goto next="#b"/></block></form>
        <form id="b"><block>Three.</block></form>"""
    )
    assert call.play() == ["One.", "Two.", "Three."]


def test_queued_prompts_are_played_before_the_application_ends() -> None:  # 4.1.8
    call = Call(block("Bye.<exit/>"))
    assert (call.play(), call.ended) == (["Bye."], "exit")


def test_prompts_in_a_handler_are_queued() -> None:  # 4.1.8
    call = Call(
        '<form><catch event="odd">Oh. <exit/></catch><block>One. <throw event="odd"/></block></form>'
    )
    assert call.play() == ["One.", "Oh."]


def test_what_is_said_at_once_is_bounded() -> None:
    call = Call(
        block(
            """<script>var a = 'x'.repeat(5000); var n = []; for (var i = 0; i &lt; 300; i++) n.push(i);
            </script><foreach item="i" array="n"><value expr="a"/></foreach>"""
        )
    )
    assert "characters come out at once" in call.ended


def test_half_a_surrogate_pair_is_shown_as_a_letter_that_is_none() -> None:
    call = Call(
        r"""<form><var name="x" expr="'\ud83d\ude00z'"/><block><log expr="x.charAt(0)"/>
        <log expr="x"/><value expr="x.charAt(0)"/><var name="o" expr="{a: x.charAt(1)}"/>
        <exit namelist="o"/></block></form>"""
    )
    call.play()
    assert call.logs() == ["\ufffd", "\U0001f600z", 'exit: {"o": {"a": "\ufffd"}}']
    assert call.said() == ["\ufffd"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("Hear <audio src='a.wav'><desc>a bell</desc></audio>.", "Hear [a.wav] ."),
        ("Hear <audio src='a.wav'><desc>a bell</desc>a ring</audio>.", "Hear a ring ."),
        ("It is <sub alias=''>gone</sub> here.", "It is here."),
        ("It is <sub alias='away'>gone</sub> here.", "It is away here."),
        ("(<sub alias='Doctor'>Dr</sub>): <sub alias='come'>c</sub>.", "(Doctor): come."),
    ],
)
def test_a_description_and_what_has_an_alias_are_not_said(content: str, said: str) -> None:
    assert run(f"<form><block><prompt>{content}</prompt></block></form>").said() == [said]


def test_prompts_queue_until_the_application_waits() -> None:
    call = Call(
        """<form><block>Hello. <prompt>Welcome.</prompt><log>queued</log></block>
        <field name="city"><prompt>Where?</prompt><option>Kyoto</option></field></form>"""
    )
    assert call.logs() == ["queued"]
    assert call.play() == ["Hello.", "Welcome.", "Where?"]
    call.answer("kyoto")
    assert call.ended == "exit"


def test_nomatch_and_noinput_count_and_prompts_taper() -> None:
    call = Call(
        """<form><field name="city"><prompt>Where?</prompt><prompt count="2">Which city?</prompt>
        <option>Kyoto</option>
        <nomatch>No. <reprompt/></nomatch><noinput count="2"><exit/></noinput></field></form>"""
    )
    call.answer("Nara")
    call.silent()
    assert call.said() == ["Where?", "No.", "Which city?", "Which city?"]
    call.silent()
    assert call.ended == "exit"
