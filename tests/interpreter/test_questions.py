"""Questions: answers, links, silence, and utterances that no grammar takes."""

from __future__ import annotations

import pytest

from prima.messages import Heard
from tests.helpers.robot import Bench, document

ASK = """<form id="a"><field name="colour">
  <prompt>Which colour?</prompt><prompt count="2">Red or blue?</prompt>
  <option value="r">red</option><option>blue</option>
  {}
  <filled><log expr="colour + '/' + colour$.utterance"/></filled>
</field></form>"""


@pytest.mark.parametrize(
    ("said", "value"),
    [("Red!", "r/Red!"), ("ＢＬＵＥ", "blue/ＢＬＵＥ"), (" blue. ", "blue/ blue.")],
)
def test_options_fold_case_width_and_punctuation(said: str, value: str) -> None:
    bench = Bench(ASK.format(""))
    bench.hears(said)
    assert bench.logs() == [value]


SURE = """{}<form id="a">{}<field name="f">{}<prompt>Well?</prompt>
  <option>red</option><option>blue</option>
  <nomatch><log expr="'no ' + event.data.utterance + ' ' + event.data.confidence"/></nomatch>
  <filled><log expr="f + ' ' + f$.utterance + ' ' + f$.confidence"/></filled>
</field></form>"""
LEVEL = '<property name="confidencelevel" value="{}"/>'


@pytest.mark.parametrize(
    ("levels", "sure", "logged"),
    [
        (("", "", ""), None, "red Red 1"),
        (("", "", ""), 0.5, "red Red 0.5"),
        (("", "", ""), 0.49, "no Red 0.49"),
        (("0.9", "", ""), 0.8, "no Red 0.8"),
        (("0.9", "0.7", ""), 0.8, "red Red 0.8"),
        (("0.9", "0.7", "0.85"), 0.8, "no Red 0.8"),
        (("", "", "0"), 0.0, "red Red 0"),
    ],
)
def test_an_answer_of_which_the_recogniser_is_not_sure_enough_is_nomatch(
    levels: tuple[str, str, str], sure: float | None, logged: str
) -> None:
    bench = Bench(SURE.format(*(LEVEL.format(level) if level else "" for level in levels)))
    bench.hears("Red", sure)
    assert bench.logs() == [logged]


def test_the_likeliest_words_that_a_question_takes_are_the_answer() -> None:
    bench = Bench(SURE.format("", "", ""))
    bench.hears("wed", 0.8, blue=0.6, red=0.7)
    assert bench.logs() == ["red red 0.7"]
    (heard,) = [one for one in bench.phases("event") if one["event"] == "speech"]
    assert heard["text"] == "wed" and heard["data"]["confidence"] == 0.8
    bench = Bench(SURE.format("", "", ""))
    bench.hears("wed", 0.8, red=0.4)
    assert bench.logs() == ["no wed 0.8"]


def test_a_link_takes_only_what_the_recogniser_is_sure_of() -> None:
    text = (
        f"{LEVEL.format('0.6')}<link event='stop'><grammar>stop</grammar></link>"
        "<form id='a'><on event='stop'><log>stopped</log></on></form>"
    )
    for sure, logged in ((0.5, []), (0.7, ["stopped"])):
        bench = Bench(text)
        bench.hears("stop", sure)
        assert bench.logs() == logged
    bench = Bench(text)
    bench.hears("shop", 0.9, stop=0.8)
    assert bench.logs() == ["stopped"]


@pytest.mark.parametrize(
    "data",
    [
        {"confidence": "much"},
        {"confidence": 7},
        {"confidence": True},
        {"confidence": None},
        {"alternatives": "blue"},
        {"alternatives": ["blue", None, {}]},
    ],
)
def test_what_a_recogniser_tells_wrongly_is_as_if_it_told_nothing(data: dict[str, object]) -> None:
    bench = Bench(SURE.format("", "", ""))
    bench.step(Heard("Red", data))
    assert bench.logs() == ["red Red 1"]


def test_signs_at_the_end_of_a_word_tell_answers_apart() -> None:
    languages = "<option>C</option><option>C#</option><option>The C++ Primer</option>"
    for said, value in (("c.", "C"), ("C#!", "C#"), ("the Ｃ＋＋ primer", "The C++ Primer")):
        bench = Bench(ASK.format(languages))
        bench.hears(said)
        assert bench.logs() == [f"{value}/{said}"]


def test_without_handlers_silence_and_nonsense_ask_again_with_tapered_prompts() -> None:
    bench = Bench(ASK.format(""))
    bench.silence()
    bench.hears("green")
    bench.hears("red")
    assert bench.said() == ["Which colour?", "Red or blue?", "Red or blue?"]
    assert bench.logs() == ["r/red"]


def test_a_handler_without_reprompt_listens_without_asking_again() -> None:
    bench = Bench(ASK.format("<noinput><speak>Hello?</speak></noinput>"))
    bench.silence()
    bench.finish("Hello?")
    assert bench.said() == ["Which colour?", "Hello?"]
    assert bench.saying() == ["q-and-a"]
    bench.silence()
    bench.finish("Hello?")
    bench.hears("red")
    assert bench.logs() == ["r/red"]


@pytest.mark.parametrize(
    "before",
    [
        '<block><throw event="oops"/></block><on event="oops"><speak>Oh.</speak></on>',
        """<field name="p" type="boolean"><prompt>Sure?</prompt>
          <noinput><speak>Oh.</speak><assign name="p" expr="true"/></noinput></field>""",
    ],
)
def test_an_event_before_a_question_does_not_keep_it_silent(before: str) -> None:
    bench = Bench(ASK.format("").replace('id="a">', f'id="a">{before}'))
    if "Sure?" in before:
        bench.silence()
    bench.finish("Oh.")
    assert bench.said()[-1] == "Which colour?"


@pytest.mark.parametrize(
    "field",
    [
        """<filled><throw event="oops"/></filled><on event="oops"><log>Oh.</log></on></field>
          <on event="touch"><clear namelist="q"/></on>""",
        """<noinput><assign name="off" expr="true"/></noinput></field>
          <on event="touch"><assign name="off" expr="false"/></on>""",
        """<noinput><clear namelist="hint"/></noinput></field>""",
    ],
)
def test_a_question_is_silent_only_if_it_listens_again_at_once(field: str) -> None:
    """As in VoiceXML: a handler without reprompt concerns the next selection of an item alone."""
    bench = Bench(
        f"""<form id="a"><var name="off" expr="false"/>
          <block name="hint"><speak>I can wait.</speak></block>
          <field name="q" type="boolean" cond="!off"><prompt>Well?</prompt>{field}</form>"""
    )
    bench.finish("I can wait.")
    if "filled" in field:
        bench.hears("yes")
    else:
        bench.silence()
    if "touch" in field:
        bench.event("touch.head")
    else:
        bench.finish("I can wait.")
    assert bench.said()[-1] == "Well?"
    assert bench.said().count("Well?") == 2


def test_handlers_are_chosen_by_count_over_the_whole_list() -> None:
    handlers = """<noinput><log>first</log><reprompt/></noinput>
      <noinput count="3"><log>third</log></noinput>"""
    bench = Bench(
        '<noinput count="2"><log>document second</log><reprompt/></noinput>' + ASK.format(handlers)
    )
    for _ in range(4):
        bench.silence()
    assert bench.logs() == ["first", "document second", "third", "third"]


@pytest.mark.parametrize(
    "prompt",
    ['<prompt cond="size.known">One?</prompt>', '<prompt>One<value expr="size.none"/>?</prompt>'],
)
def test_a_question_whose_prompt_fails_has_not_been_asked(prompt: str) -> None:
    bench = Bench(
        f"""<form id="a"><var name="size"/><field name="f">{prompt}
        <prompt count="2">Two?</prompt><option>red</option>
        <error><assign name="size" expr="{{known: true, none: ''}}"/><reprompt/></error>
        <noinput><reprompt/></noinput></field></form>"""
    )
    bench.silence()
    assert bench.said() == ["One?", "Two?"]


def test_a_prefix_takes_an_event_token_by_token_and_the_innermost_scope_wins() -> None:
    bench = Bench(
        """<on event="touch"><log>document</log></on>
        <form id="a">
          <on event="touch.he"><log>not a token</log></on>
          <on event="touch.head" cond="false"><log>condition</log></on>
          <on event="touch.back touch.head"><log expr="'form ' + event.name"/></on>
        </form>"""
    )
    bench.event("touch.head")
    bench.event("touch.side")
    assert bench.logs() == ["form touch.head", "document"]


@pytest.mark.parametrize(
    ("kind", "said", "value"),
    [
        ("boolean", "Yes, please.", "true"),
        ("boolean", "いいえ", "false"),
        ("number", "twenty one", "21"),
        ("number", "１２", "12"),
        ("digits", "0 4 2", '"042"'),
        ("time", "7 p.m.", '"19:00"'),
        ("date", "2026-11-21", '"2026-11-21"'),
        ("text", "  Whatever  you say. ", '"Whatever you say."'),
    ],
)
def test_built_in_types(kind: str, said: str, value: str) -> None:
    bench = Bench(
        f"""<form id="a"><field name="x" type="{kind}"><prompt>?</prompt>
        <filled><log expr="JSON.stringify(x)"/></filled></field></form>"""
    )
    bench.hears(said)
    assert bench.logs() == [value]


def test_a_grammar_of_rules() -> None:
    bench = Bench(
        """<form id="a"><field name="x"><prompt>?</prompt>
          <grammar root="order">
            <rule id="order"><item repeat="0-1">please</item> bring me
              <ruleref uri="#drink"/> <item repeat="0-2">now</item></rule>
            <rule id="drink"><one-of><item>tea <tag>T</tag></item><item>coffee <tag>C</tag></item></one-of></rule>
          </grammar>
          <filled><log expr="x"/></filled></field></form>"""
    )
    bench.hears("Please bring me, coffee. Now! Now!")
    assert bench.logs() == ["C"]
    again = Bench(
        """<form id="a"><field name="x"><prompt>?</prompt>
        <grammar><item>tea</item></grammar><nomatch><log>no</log></nomatch></field></form>"""
    )
    again.hears("teapot")
    assert again.logs() == ["no"]


def test_the_answer_goes_first_to_the_question_then_to_links_then_is_no_match() -> None:
    asking = document(ASK.format("<nomatch><log>nomatch</log></nomatch>"), name="asker")
    other = document(
        """<link event="stop"><grammar>stop it</grammar></link>
        <form id="a"><on event="stop"><log>stopping</log></on></form>""",
        name="other",
    )
    bench = Bench(asking, other)
    bench.listens()
    bench.hears("stop it")
    assert bench.logs() == ["stopping"]
    assert bench.saying() == ["Which colour?"], "the question goes on listening"
    bench.hears("what?")
    assert bench.logs() == ["stopping", "nomatch"]


def test_a_question_without_barge_in_does_not_hear_before_it_is_said() -> None:
    bench = Bench(
        """<property name="bargein" value="false"/>"""
        + ASK.format("<nomatch><log>nomatch</log></nomatch>")
    )
    bench.hears("red")
    assert bench.logs() == []
    bench.listens()
    bench.hears("red")
    assert bench.logs() == ["r/red"]


def test_form_level_filled_waits_for_all_or_any() -> None:
    body = """<form id="a">
      <field name="x" type="number"><prompt>x?</prompt></field>
      <field name="y" type="number"><prompt>y?</prompt></field>
      <filled mode="any" namelist="x y"><log>any</log></filled>
      <filled><log expr="'all ' + (x + y)"/></filled>
    </form>"""
    bench = Bench(body)
    bench.hears("1")
    bench.hears("2")
    assert bench.logs() == ["any", "any", "all 3"]


def test_what_a_form_level_filled_throws_is_handled_and_counted_by_the_form() -> None:
    """As in VoiceXML 2.0, 5.2.2 and 5.2.4: the field has been left."""
    bench = Bench(
        """<form id="a">
          <field name="x"><prompt>Tea?</prompt><option>yes</option><option>no</option>
            <on event="odd"><log>field</log></on>
            <filled><if cond="x == 'no'"><throw event="odd"/></if></filled></field>
          <filled><throw event="odd"/></filled>
          <filled><log>not reached</log></filled>
          <on event="odd" count="2"><log>form 2</log></on>
          <on event="odd"><log>form 1</log><clear namelist="x"/><reprompt/></on>
          <block><log expr="'then ' + x"/><clear/></block>
        </form>"""
    )
    for answer in ("yes", "yes", "no"):
        bench.hears(answer)
    assert bench.logs() == ["form 1", "form 2", "then yes", "field", "then no"]


@pytest.mark.parametrize(
    "grammar",
    [
        '<item repeat="0-"><item repeat="0-"><one-of><item>a</item><item>a a</item></one-of></item></item>',
        '<rule id="r"><ruleref uri="#r"/>a</rule>',
        '<rule id="r"><item repeat="0-1"><ruleref uri="#r"/></item><item repeat="0-999"/>a</rule>',
        '<rule id="r"><item repeat="0-999"><item repeat="0-999">a</item></item></rule>',
    ],
)
def test_a_grammar_that_explodes_or_refers_to_itself_is_matched_in_time(grammar: str) -> None:
    from time import process_time

    bench = Bench(
        f"""<form id="a"><field name="x"><prompt>?</prompt><grammar>{grammar}</grammar>
        <nomatch><log>no</log></nomatch></field></form>"""
    )
    began = process_time()
    bench.hears("a " * 60 + "b")
    assert bench.logs() == ["no"]
    assert process_time() - began < 5


def test_a_link_of_its_own_ends_the_question_that_listens() -> None:
    bench = Bench(
        """<form id="a"><field name="q" type="boolean"><prompt>Well?</prompt>
          <help><speak>Say yes or no.</speak></help></field>
        <link event="help"><grammar><item>help me</item></grammar></link></form>"""
    )
    bench.listens()
    bench.hears("help me")
    assert bench.saying() == ["Say yes or no."]
    bench.finish("Say yes or no.")
    assert bench.saying() == ["q-and-a"], "it listens again; a reprompt would ask again"


@pytest.mark.parametrize("leaves", ['<goto next="#b"/>', '<move-head order="now"/>'])
def test_a_link_is_followed_while_a_question_that_nobody_waits_for_is_asked(leaves: str) -> None:
    """Nobody would learn that it had ended the question (O2, O3), and the words would be lost."""
    bench = Bench(
        f"""<link event="stop"><grammar>stop it</grammar></link>
        <on event="stop"><log>stopping</log></on>
        <form id="a"><field name="q" type="boolean"><prompt>Well?</prompt></field>
          <on event="touch" reactive="false"><move-head pan="30"/></on>
          <on event="door">{leaves}</on></form>
        <form id="b"/>"""
    )
    bench.event("touch")
    bench.event("door")
    bench.hears("stop it")
    assert bench.logs() == ["stopping"]


@pytest.mark.parametrize("asks", [True, False])
def test_the_event_of_a_link_has_what_was_said_with_and_without_a_question(asks: bool) -> None:
    bench = Bench(
        '<link event="stop"><grammar>stop it</grammar></link>'
        + (ASK.format("") if asks else '<form id="a"/>')
        + '<on event="stop"><log expr="event.data.text"/></on>'
    )
    if asks:
        bench.listens()
    bench.hears("Stop it!")
    assert bench.logs() == ["Stop it!"]


def test_a_link_of_the_robots_own_application_lets_the_question_listen_on() -> None:
    bench = Bench(
        document(
            '<form id="a"><field name="q" type="boolean"><prompt>Well?</prompt></field></form>',
            "ea",
        ),
        document(
            """<form id="a"><link event="lamp"><grammar><item>light on</item></grammar></link>
            <on event="lamp"><move-head pan="10"/></on></form>""",
            "fa",
            "other",
        ),
    )
    bench.listens()
    bench.hears("light on")
    assert bench.saying() == ["Well?", "move-head"]


def test_a_condition_of_a_handler_knows_the_event_and_not_what_threw_it() -> None:
    bench = Bench(
        """<form id="a">
          <var name="x" expr="'form'"/>
          <field name="f" type="boolean">
            <prompt>Yes?</prompt>
            <nomatch cond="event.data.utterance == 'maybe'"><throw event="unsure"/></nomatch>
            <nomatch count="2"><var name="x" expr="'handler'"/><throw event="lost"/></nomatch>
          </field>
          <on event="lost" cond="x == 'handler'"><log>seen</log></on>
          <on event="lost unsure" cond="event.name != 'found'"><log expr="event.name"/></on>
        </form>"""
    )
    for words in ("maybe", "perhaps"):
        bench.listens()
        bench.hears(words)
    assert bench.logs() == ["unsure", "lost"]
