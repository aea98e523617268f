"""The Form Interpretation Algorithm and executable content, on small documents."""

from __future__ import annotations

import re

import pytest

from prima.interpreter.application import Interpreter
from prima.interpreter.elements import Expression
from prima.interpreter.frame import Fiber
from prima.interpreter.sensors import sensors_read
from prima.interpreter.units import units_of
from prima.messages import Heard, Loaded, Sensed, Unloaded
from tests.helpers.robot import Bench, document, read

# Items and content -------------------------------------------------------------------


def test_items_are_visited_in_document_order_while_undefined_and_their_condition_holds() -> None:
    bench = Bench(
        """<form id="a">
          <block name="one" cond="false"><log>one</log></block>
          <block name="two" expr="true"><log>two</log></block>
          <block name="three"><log>three</log><clear namelist="two"/></block>
          <block name="four"><log>four</log></block>
        </form>"""
    )
    assert bench.logs() == ["three", "two", "four"]


def test_what_stands_behind_commands_runs_when_they_have_ended() -> None:
    bench = Bench(
        """<form id="a"><block>
          <log>before</log><speak>One.</speak><speak>Two.</speak><log>after</log>
        </block></form>"""
    )
    assert bench.logs() == ["before"]
    bench.finish("One.")
    assert bench.logs() == ["before"], "both are one run"
    bench.finish("Two.")
    assert bench.logs() == ["before", "after"]


def test_a_handler_that_does_not_leave_the_state_lets_it_go_on() -> None:
    bench = Bench(
        """<form id="a">
          <block><speak>A story.</speak><log>told</log></block>
          <on event="touch"><move-head pan="20"/><log>nodded</log></on>
        </form>"""
    )
    bench.event("touch.head")
    assert bench.saying() == ["A story.", "move-head"]
    bench.finish("move-head")
    bench.finish("A story.")
    assert bench.logs() == ["nodded", "told"]


def test_goto_leaves_the_state_and_what_it_had_not_begun() -> None:
    bench = Bench(
        """<form id="a">
          <block><speak>One.</speak><speak>Two.</speak></block>
          <on event="touch"><goto next="#b"/></on>
        </form>
        <form id="b"><block><speak>Here.</speak></block></form>"""
    )
    bench.event("touch")
    assert bench.saying() == ["One."]
    bench.finish("One.")
    assert bench.saying() == ["Here."]


def test_goto_takes_effect_when_the_commands_before_it_have_ended() -> None:
    bench = Bench(
        """<form id="a"><block><speak>Bye.</speak><goto next="#b"/></block></form>
        <form id="b"><block><speak>Gone.</speak><exit/></block></form>"""
    )
    assert bench.saying() == ["Bye."]
    bench.finish("Bye.")
    assert bench.saying() == ["Gone."]
    bench.finish("Gone.")
    assert bench.session.over


def test_now_inside_content_comes_after_what_stands_before_it() -> None:
    bench = Bench(
        """<form id="a"><block>
          <topological-move to="x"/><stop-moving/><speak>There.</speak>
        </block></form>"""
    )
    assert bench.saying() == ["topological-move"]
    bench.finish("topological-move", goal=True)
    assert bench.saying() == ["stop-moving"]
    bench.finish("stop-moving")
    assert bench.saying() == ["There."]


def test_cancelled_content_is_given_up_and_the_form_waits() -> None:
    bench = Bench(
        """<form id="a">
          <block><topological-move to="x"/></block>
          <block><speak>I am there.</speak></block>
          <on event="touch"><stop-moving/><speak>Yes?</speak></on>
          <on event="cancel.topological-move"><log>gave up</log></on>
        </form>"""
    )
    bench.event("touch")
    bench.finish("stop-moving")
    bench.finish("Yes?")
    assert bench.saying() == [], "it must not say that it is there"
    assert bench.logs() == ["gave up"]


def test_a_waiting_form_goes_on_when_a_handler_makes_an_item_eligible() -> None:
    bench = Bench(
        """<form id="a">
          <var name="ready" expr="false"/>
          <block cond="ready"><speak>Now.</speak></block>
          <on event="go"><assign name="ready" expr="true"/></on>
        </form>"""
    )
    assert bench.saying() == []
    bench.event("go")
    assert bench.saying() == ["Now."]


def test_conditions_loops_and_scopes() -> None:
    bench = Bench(
        """<var name="n" expr="1"/>
        <script>function twice(x) { return 2 * x; }</script>
        <form id="a"><var name="m" expr="n + 1"/>
          <block>
            <var name="list" expr="[1, 2, 3]"/>
            <foreach item="one" array="list">
              <if cond="one == 1"><log expr="'first ' + one"/>
              <elseif cond="one == 2"/><log expr="'second ' + twice(one)"/>
              <else/><log>last <value expr="m"/></log></if>
            </foreach>
            <assign name="document.n" expr="n + 10"/><assign name="m" expr="m + n"/>
            <log expr="document.n + ' ' + dialog.m + ' ' + typeof list"/>
          </block>
          <block><log expr="typeof list"/></block>
        </form>"""
    )
    assert bench.logs() == ["first 1", "second 4", "last 2", "11 13 object", "undefined"]


def test_par_and_seq_make_one_tree() -> None:
    bench = Bench(
        """<form id="a"><block>
          <par>
            <seq><speak>One.</speak><speak>Two.</speak></seq>
            <move-head pan="10"/>
          </par>
          <speak>Three.</speak><log>done</log>
        </block></form>"""
    )
    assert bench.saying() == ["One.", "move-head"]
    bench.finish("One.")
    bench.finish("Two.")
    assert bench.saying() == ["move-head"], "what follows a par waits for all branches"
    bench.finish("move-head")
    assert bench.saying() == ["Three."]
    assert len({record["tree"] for record in bench.phases("request")}) == 1


# Pauses in texts --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "said", "cues"),
    [
        ('Look.<break time="1s"/>There.', "Look. There.", [(5, 1000)]),
        (' <break time="500ms"/> Well ', "Well", [(0, 500)]),
        (
            'a <value expr="1 + 1"/> <break time="20ms"/>\n b<break time="1s"/>',
            "a 2 b",
            [(3, 20), (5, 1000)],
        ),
        ('a<break time="1s"/><break time="2s"/>b', "a b", [(1, 1000), (1, 2000)]),
        ('<value expr="\'\'"/><break time="1s"/>b', "b", [(0, 1000)]),
    ],
)
def test_a_break_is_a_pause_in_what_is_said(
    text: str, said: str, cues: list[tuple[int, int]]
) -> None:
    bench = Bench(f"<form id='a'><block><speak>{text}</speak></block></form>")
    (record,) = bench.phases("request")
    assert record["text"] == said
    assert [(one["at"], one["pause"]) for one in record["cues"]] == cues


def test_breaks_of_prompts_stand_where_they_are_said() -> None:
    bench = Bench(
        """<form id="a"><field name="f" type="boolean"><prompt>So, <break time="1s"/> well?</prompt>
        <prompt cond="false">No <break time="3s"/>.</prompt><prompt>Or <break time="2s"/> not?</prompt>
        </field></form>"""
    )
    (record,) = bench.phases("request")
    assert record["text"] == "So, well? Or not?"
    assert record["cues"] == [{"at": 3, "pause": 1000}, {"at": 12, "pause": 2000}]


@pytest.mark.parametrize(
    ("content", "code", "remedy"),
    [
        ('<speak><break time="1s"/></speak>', "nothing-to-say", '<pause time="1s"/>'),
        ('<active-sensing-human><break time="1s"/></active-sensing-human>', "nothing-to-say", ""),
        ("<speak>a<break/></speak>", "missing-attribute", 'time="..."'),
        ('<speak>a<break time="1"/></speak>', "bad-value", '"1s"'),
        ('<speak>a<break time="90s"/></speak>', "out-of-range", "60s"),
        ('<pause time="0s"/>', "out-of-range", "1ms"),
        ("<pause/>", "missing-attribute", 'time="..."'),
        ('<break time="1s"/>', "misplaced-element", '<pause time="1s"/>'),
        ('<speak>a<pause time="1s"/></speak>', "misplaced-element", '<break time="1s"/>'),
        ('<iu><speak>a<break time="60s"/></speak></iu>', "long-unit", ""),
    ],
)
def test_what_is_wrong_with_a_pause_is_told(content: str, code: str, remedy: str) -> None:
    _, problems = read(f"<form id='a'><block>{content}<exit/></block></form>")
    (problem,) = problems
    assert problem.code == code and remedy in problem.remedy, problem


# Questions --------------------------------------------------------------------------------

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


def test_handlers_are_chosen_by_count_over_the_whole_list() -> None:
    handlers = """<noinput><log>first</log><reprompt/></noinput>
      <noinput count="3"><log>third</log></noinput>"""
    bench = Bench(
        '<noinput count="2"><log>document second</log><reprompt/></noinput>' + ASK.format(handlers)
    )
    for _ in range(4):
        bench.silence()
    assert bench.logs() == ["first", "document second", "third", "third"]


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


# Events and errors ----------------------------------------------------------------------------


def test_the_first_command_because_of_an_event_is_a_reaction_even_through_goto_and_throw() -> None:
    bench = Bench(
        """<form id="a"><on event="touch"><throw event="my.own"/></on>
          <on event="my"><goto next="#b"/></on></form>
        <form id="b"><block><assign name="n" expr="1"/><speak>One.</speak></block>
          <block><speak>Two.</speak></block><var name="n"/></form>"""
    )
    bench.event("touch")
    bench.finish("One.")
    flags = [record["reactive"] for record in bench.phases("request")]
    assert flags == [True, False]


def test_a_handler_may_say_that_it_is_no_reaction() -> None:
    bench = Bench(
        '<form id="a"><on event="touch" reactive="false"><speak>Later.</speak></on></form>'
    )
    bench.event("touch")
    assert [record["reactive"] for record in bench.phases("request")] == [False]


def test_end_events_of_commands_reach_handlers_in_the_command_and_in_scope() -> None:
    bench = Bench(
        """<form id="a">
          <block><speak>One.<on event="end"><log>in the command</log></on></speak>
            <speak>Two.</speak></block>
          <on event="end.speak"><log>in the form</log></on>
        </form>"""
    )
    bench.finish("One.")
    bench.finish("Two.")
    assert bench.logs() == ["in the command", "in the form"]


def test_a_failing_device_is_an_event_with_its_place() -> None:
    bench = Bench(
        """<form id="a">
          <block><speak>One.</speak><log>never</log></block>
          <block><log>next</log></block>
          <error><log expr="event.name + ' ' + event.message"/></error>
        </form>"""
    )
    bench.fail("One.")
    assert bench.logs() == ["error.device.speaker app.xml:2:18: broken", "next"]


def test_an_error_that_nobody_handles_ends_this_application_alone() -> None:
    bad = document(
        '<form id="a"><block><log expr="nowhere.to"/></block></form>'.replace(
            "nowhere.to", "JSON.nowhere.to"
        ),
        name="bad",
    )
    good = document('<form id="a"><block><speak>Fine.</speak></block></form>', name="good")
    bench = Bench(bad, good)
    assert bench.saying() == ["Fine."]
    assert bench.session.failures == [
        "bad: error.semantic: bad.xml:1:101: JSON.nowhere.to: TypeError: cannot read property 'to'"
        " of undefined"
    ]


@pytest.mark.parametrize(
    ("expr", "told"),
    [
        ("''", '""'),
        ("'a..b'", '"a..b"'),
        ("'a b'", '"a b"'),
        ("null", "(null or undefined)"),
        ("[]", '"[]"'),
    ],
)
def test_what_is_no_events_name_cannot_be_thrown(expr: str, told: str) -> None:
    bench = Bench(
        f"""<form id="a"><block><throw event-expr="{expr}"/></block>
        <on event="error.semantic"><log expr="event.data.message"/></on></form>"""
    )
    remedy = 'is not an event name. Write one such as "touch.head".'
    assert bench.logs() == [f"app.xml:1:90: event {told} {remedy}"]


@pytest.mark.parametrize("expr", ["'a.b'", "'a' + '.b'", "'a.b.'"])
def test_an_events_name_may_be_computed(expr: str) -> None:
    bench = Bench(
        f"""<form id="a"><block><throw event-expr="{expr}"/></block>
        <on event="a.b"><log>taken</log></on></form>"""
    )
    assert bench.logs() == ["taken"]


@pytest.mark.parametrize(
    "expr",
    [
        "(function () { throw new Error('thrown'); })()",
        "(function () { for (;;); })()",
        "(function f() { return f(); })()",
        "'x'.repeat(1e9)",
        "(() => { const a = []; for (;;) a.push('x'.repeat(1000) + a.length); })()",
        "/(a+)+$/.test('a'.repeat(40) + 'b')",
        "Symbol('s').nothing.more",
    ],
)
def test_an_expression_that_fails_is_a_timely_error_semantic(expr: str) -> None:
    escaped = expr.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    bench = Bench(
        f"""<form id="a"><block><assign name="x" expr="{escaped}"/></block><var name="x"/>
        <on event="error.semantic"><log expr="event.message"/></on></form>"""
    )
    assert len(bench.logs()) == 1
    assert bench.logs()[0].startswith("app.xml:1:1")
    assert not bench.session.over


@pytest.mark.parametrize(
    "body",
    [
        '<form id="a"><block><goto next="#b"/></block></form><form id="b"><block><goto next="#a"/></block></form>',
        '<form id="a"><block name="x"><clear/></block></form>',
        '<form id="a"><on event="t"><throw event="t"/></on><block><throw event="t"/></block></form>',
        '<form id="a"><subdialog src="#a"/></form>',
        '<form id="a"><on event="e"><log>x</log></on><block><foreach item="i" array="Array(9999).fill(0)">'
        '<foreach item="j" array="Array(9999).fill(0)"><log>x</log></foreach></foreach></block></form>',
    ],
)
def test_a_document_that_loops_without_waiting_ends(body: str) -> None:
    bench = Bench(body)
    assert bench.session.over
    assert "error.semantic" in bench.session.failures[0]


def test_applications_do_not_see_each_others_variables() -> None:
    one = document(
        '<var name="secret" expr="1"/><form id="a"><block><script>globalThis.leak = 1; Math.leak = 2;</script>'
        "</block></form>",
        name="one",
    )
    two = document(
        '<form id="a"><block><log expr="typeof secret + typeof leak + typeof Math.leak"/></block></form>'.replace(
            "typeof secret + typeof leak", "typeof globalThis.secret + typeof globalThis.leak"
        ),
        name="two",
    )
    assert Bench(one, two).logs() == ["undefinedundefinedundefined"]


def test_a_document_scripts_random_numbers_are_the_same_in_every_run() -> None:
    body = '<form id="a"><block><log expr="Math.random()"/></block></form>'
    assert Bench(body).logs() == Bench(body).logs()


# Subdialogs -------------------------------------------------------------------------------------


def test_a_subdialog_has_its_own_context_and_gives_values_back() -> None:
    bench = Bench(
        """<var name="n" expr="1"/>
        <form id="a"><subdialog name="r" src="#sub"><param name="p" expr="n + 1"/>
            <filled><log expr="r.q + ' ' + n"/></filled></subdialog>
          <block><log>after</log></block></form>
        <form id="sub"><var name="p"/><var name="q"/>
          <block><assign name="n" expr="99"/><speak>Inside.</speak>
            <assign name="q" expr="p * 10"/><return namelist="q"/></block></form>"""
    )
    assert bench.saying() == ["Inside."]
    bench.finish("Inside.")
    assert bench.logs() == ["20 1", "after"]


def test_a_subdialog_that_never_waits_and_one_that_goes_on_elsewhere() -> None:
    bench = Bench(
        """<form id="a"><subdialog name="r" src="#sub"><filled><log expr="r.x"/></filled></subdialog></form>
        <form id="sub"><block><goto next="#more"/></block></form>
        <form id="more"><var name="x" expr="7"/><block><return namelist="x"/></block></form>"""
    )
    assert bench.logs() == ["7"]


def test_a_subdialog_may_return_an_event() -> None:
    bench = Bench(
        """<form id="a"><subdialog name="r" src="#sub"><on event="nope"><log>nope</log></on></subdialog></form>
        <form id="sub"><block><speak>Hm.</speak><return event="nope"/></block></form>"""
    )
    bench.finish("Hm.")
    assert "nope" in bench.logs()


# Units ------------------------------------------------------------------------------------------

UNIT = """<form id="a">
  <iu name="u" longest="20s">
    <field name="x" type="boolean"><prompt>May I?</prompt>{}</field>
    <block cond="x"><speak>Smile!</speak></block>
  </iu>
  <block><speak>Bye.</speak></block>
  <on event="error.unit.timeout"><log>too long</log></on>
</form>"""


def test_a_unit_around_items_owns_its_devices_from_question_to_the_last_word() -> None:
    other = document(
        '<form id="a"><on event="touch"><speak>Ouch.</speak></on></form>', name="other"
    )
    bench = Bench(document(UNIT.format(""), name="photo"), other)
    bench.event("touch")
    assert bench.saying() == ["May I?", "iu"]
    bench.hears("yes")
    assert bench.saying() == ["Smile!", "iu"]
    bench.finish("Smile!")
    assert bench.saying() == ["Ouch."], "the unit has ended; the reaction goes before Bye"
    bench.finish("Ouch.")
    assert bench.saying() == ["Bye."]


ANSWER = (
    '<var name="n"/><form id="a"><block><speak>The answer is</speak><move-head pan="30"/>{}'
    "<speak>forty two.</speak><exit/></block></form>"
)
TRAINS = '<form id="a"><on event="touch" reactive="false"><speak>I like trains.</speak></on></form>'


@pytest.mark.parametrize(
    ("between", "said"),
    [("", ["move-head"]), ('<assign name="n" expr="42"/>', ["I like trains.", "move-head"])],
)
def test_f6_what_is_not_requested_yet_keeps_no_topic_together(
    between: str, said: list[str]
) -> None:
    bench = Bench(document(ANSWER.format(between), name="answer"), document(TRAINS, name="other"))
    bench.event("touch")
    bench.finish("The answer is")
    assert sorted(bench.saying()) == said


REACHING = """<form id="a">{form}
  <iu name="u">{unit}
    <field name="x" type="boolean"><prompt>May I?</prompt>{field}</field>
    <block>{block}</block>
  </iu>
  <block><exit/></block>
</form><form id="b"><block><topological-move to="hall"/><exit/></block></form>{document}"""
TURNS = '<on event="{}"><turn angle="90"/></on>'
GOES = '<on event="{}"><topological-move to="hall"/></on>'


def reaching(**parts: str) -> str:
    given = dict.fromkeys(("form", "unit", "field", "block", "document"), "") | parts
    return REACHING.format(**given)


@pytest.mark.parametrize(
    "parts",
    [
        {"field": '<filled><throw event="x.y"/></filled>', "document": TURNS.format("x")},
        {"block": '<throw event="x"/>', "form": TURNS.format("x")},
        {"block": "<throw event-expr='x'/>", "document": TURNS.format("z")},
        {"form": TURNS.format("noinput")},
        {"field": TURNS.format("touch")},
        {"unit": TURNS.format("touch")},
        {"form": '<filled><turn angle="90"/></filled>'},
        {"form": '<filled namelist="x"><turn angle="90"/></filled>'},
        {"document": TURNS.format("error.device")},
        {"block": "<speak>Hi.</speak>", "document": TURNS.format("error.unsupported.speak")},
        {
            "block": '<throw event="x"/>',
            "form": '<on event="x"><throw event="y"/></on>',
            "document": TURNS.format("y"),
        },
        {
            "field": '<noinput><throw event="y"/></noinput>',
            "document": TURNS.format("y") + "<noinput><turn angle='9'/></noinput>",
        },
        {"field": "<noinput count='2'><reprompt/></noinput>", "document": TURNS.format("noinput")},
        {
            "field": "<noinput cond='x'><reprompt/></noinput>",
            "document": TURNS.format("noinput"),
        },
    ],
)
def test_u5_a_unit_owns_what_the_handlers_need_that_it_can_reach(parts: dict[str, str]) -> None:
    made, _ = read(reaching(**parts))
    (unit,) = [unit for _, unit in units_of(made)]
    assert unit.devices == {"speaker", "speech-recognition", "locomotion"}
    assert "turn" in unit.types


@pytest.mark.parametrize(
    "parts",
    [
        {"form": TURNS.format("touch")},
        {"document": TURNS.format("x")},
        {"document": TURNS.format("error.unit.timeout")},
        {"document": TURNS.format("error.unsupported.speak")},
        {"field": "<noinput><reprompt/></noinput>", "document": TURNS.format("noinput")},
        {"unit": "<noinput><reprompt/></noinput>", "form": TURNS.format("noinput")},
        {"form": '<field name="y" type="boolean"/><filled namelist="y"><turn angle="9"/></filled>'},
    ],
)
def test_u5_a_unit_owns_nothing_for_handlers_that_it_cannot_reach(parts: dict[str, str]) -> None:
    made, _ = read(reaching(**parts))
    (unit,) = [unit for _, unit in units_of(made)]
    assert unit.devices == {"speaker", "speech-recognition"}


CHOOSES = '<filled><throw event-expr="{}"/></filled>'
GIVEN = '<var name="e" expr="old ? \'y\' : \'z\'"/><var name="old" expr="true"/>'


@pytest.mark.parametrize(
    ("code", "document", "reached"),
    [
        ("x ? 'y' : 'z'", "", False),
        ("x ? 'x' : 'z'", "", True),
        ("'x' + x", "", True),
        ("x", "", True),
        ("e", GIVEN, False),
        ("e", GIVEN.replace("'z'", "'x'"), True),
        ("e", GIVEN.replace("'z'", "old"), True),
        ("e", GIVEN + "<script>e = 'x';</script>", True),
        ("e", GIVEN + TURNS.format("touch").replace("<turn", "<log expr=\"e = 'x'\"/><turn"), True),
        ("e", GIVEN + TURNS.format("a").replace("<turn", "<assign name='e' expr=\"'x'\"/><turn"), True),
        ("e", GIVEN + TURNS.format("a").replace("<turn", "<assign name='e' expr=\"'w'\"/><turn"), False),
    ],
)  # fmt: skip
def test_u5_an_expression_reaches_the_events_that_it_may_name(
    code: str, document: str, reached: bool
) -> None:
    parts = {"field": CHOOSES.format(code), "document": document + GOES.format("x")}
    _, problems = read(reaching(**parts))
    codes = [one.code for one in problems if one.severity == "error"]
    assert codes == (["not-in-unit"] if reached else [])


def test_u5_an_expression_that_may_name_any_event_is_told() -> None:
    parts = {"field": CHOOSES.format("x"), "document": GOES.format("z")}
    _, problems = read(reaching(**parts))
    (problem,) = [one for one in problems if one.severity == "error"]
    told = 'reaches it by the event "z", which the expression "x" may name; it cannot stand'
    assert told in problem.message
    assert "as a text, x ? 'this' : 'that', or leave the <iu> with <goto> first." in problem.remedy


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        (
            {"field": '<filled><throw event="x"/></filled>', "document": GOES.format("x")},
            "<topological-move> leaves the user, and the unit in line 2 reaches it by the event"
            ' "x"; it cannot stand in a unit. Handle "x" in the <iu> as well,'
            " or leave the <iu> with <goto> first.",
        ),
        (
            {"form": "<noinput><tracking-human/></noinput>"},
            "<tracking-human> works in a feedback loop, and the unit in line 2 reaches it by the"
            ' event "noinput"; it cannot stand',
        ),
        (
            {"form": '<filled><topological-move to="hall"/></filled>'},
            "and the unit in line 2 reaches it; it cannot stand in a unit. Leave the <iu> with",
        ),
        ({"field": GOES.format("touch")}, "<topological-move> leaves the user; it cannot stand"),
    ],
)
def test_u5_no_command_that_a_unit_reaches_leaves_the_user(
    parts: dict[str, str], says: str
) -> None:
    _, problems = read(reaching(**parts))
    (problem,) = [one for one in problems if one.severity == "error"]
    assert problem.code == "not-in-unit" and says in f"{problem.message} {problem.remedy}"


@pytest.mark.parametrize(
    "parts",
    [
        {"form": GOES.format("touch")},
        {"document": GOES.format("error.unit.timeout")},
        {"document": '<noinput><goto next="#b"/></noinput>'},
        {"field": "<noinput><exit/></noinput>", "document": GOES.format("noinput")},
    ],
)
def test_u5_a_command_that_no_unit_reaches_may_leave_the_user(parts: dict[str, str]) -> None:
    _, problems = read(reaching(**parts))
    assert [one for one in problems if one.code == "not-in-unit"] == []


def test_leaving_a_unit_by_goto_ends_it() -> None:
    bench = Bench(
        UNIT.format('<noinput><goto next="#b"/></noinput>')
        + '<form id="b"><block><speak>Never mind.</speak></block></form>'
    )
    bench.silence()
    assert bench.saying() == ["Never mind."]


def test_a_unit_that_takes_too_long_throws_and_ends() -> None:
    bench = Bench(UNIT.format(""))
    bench.listens()
    bench.step(at=20_100)
    assert bench.logs() == ["too long"]
    assert bench.saying() == ["May I?", "iu"], "the Command that runs finishes"
    bench.silence()
    assert bench.saying() == ["Bye."]


# Services, timers, watches ------------------------------------------------------------------------


def test_send_asks_a_service_and_its_answer_is_a_reaction() -> None:
    bench = Bench(
        """<form id="a"><block><send to="library"><param name="title" value="C"/></send></block>
        <on event="reply.library"><speak><value expr="event.data.shelf"/></speak></on></form>"""
    )
    assert [order.data for order in bench.orders] == [{"to": "library", "params": {"title": "C"}}]
    bench.event("reply.library", shelf="Shelf 7")
    assert bench.saying() == ["Shelf 7"]
    assert bench.phases("request")[0]["reactive"] is True


def test_an_unhandled_service_failure_ends_the_application() -> None:
    bench = Bench('<form id="a"><block><send to="x"/></block></form>')
    bench.event("error.service.x", message="down")
    assert bench.session.failures == ["app: error.service.x: down"]


def test_a_delayed_event_comes_unless_its_state_is_left() -> None:
    body = """<form id="a"><block><send event="late" delay="2s"/></block>
      <on event="late"><log>late</log></on><on event="go"><goto next="#b"/></on></form>
      <form id="b"><on event="late"><log>wrong</log></on></form>"""
    bench = Bench(body)
    assert bench.session.deadline() == 2100
    bench.step(at=2100)
    assert bench.logs() == ["late"]
    left = Bench(body)
    left.event("go")
    assert left.session.deadline() is None


def test_too_many_delayed_events_are_told_with_their_line() -> None:
    bench = Bench(
        """<form id="a"><block><foreach item="i" array="Array(300)">
        <send event="late" delay="2s"/></foreach></block></form>"""
    )
    (failure,) = bench.session.failures
    assert re.fullmatch(
        r"app: error.semantic: app.xml:\d+:\d+: more than 256 delayed events", failure
    )


def test_a_watch_is_raised_when_its_condition_turns_true_and_armed_again() -> None:
    from prima.messages import Sensed

    bench = Bench(
        """<form id="a"><watch name="near" when="sensor.human.distance &lt; 1"/>
        <on event="near"><speak>Hello.</speak></on></form>"""
    )
    for distance in (3, 0.8, 0.5, 2, 0.9):
        bench.step(Sensed({"human.distance": distance}))
    assert len([r for r in bench.phases("event") if r["event"] == "near"]) == 2
    assert bench.phases("request")[0]["reactive"] is True


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


# Errors that a document can handle, wherever they arise ------------------------------

CAUGHT = '<on event="error.semantic"><log expr="_event"/></on>'


def test_a_condition_of_a_handler_that_fails_is_an_event() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <block><speak>A story.</speak><log>told</log></block>
          <on event="touch" cond="null.thing"><log>never</log></on>
        </form>"""
    )
    bench.event("touch")
    assert bench.logs() == ["error.semantic"]
    bench.finish("A story.")
    assert bench.logs() == ["error.semantic", "told"]


def test_a_condition_of_a_handler_that_fails_in_content_is_an_event() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <block><throw event="own.trouble"/></block>
          <block><log>next</log></block>
          <on event="own" cond="null.thing"><log>never</log></on>
        </form>"""
    )
    assert bench.logs() == ["error.semantic", "next"]


def test_a_watch_that_fails_is_an_event_and_others_go_on() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <watch name="odd" when="sensor.nosuch.thing == 1"/>
          <watch name="warm" when="sensor.heat == 1"/>
          <on event="warm"><log>warm</log></on>
        </form>"""
    )
    bench.step(Sensed({"heat": 1}))
    assert bench.logs() == ["error.semantic", "warm"]
    bench.step(Sensed({"heat": 2}))
    assert bench.logs() == ["error.semantic", "warm"], "nothing that it looks at has changed"
    bench.step(Sensed({"nosuch.other": 2}))
    assert bench.logs() == ["error.semantic", "warm"], "now it does not fail"


def test_what_a_document_watches_for_may_be_so_when_it_is_loaded() -> None:
    watching = """<watch name="low" when="sensor.battery?.level &lt; 20"/>
      <form id="a"><on event="low"><log>low</log></on></form>"""
    bench = Bench('<form id="a"/>', document(watching, "ea", "late"))
    bench.step(Unloaded("late"))
    bench.step(Sensed({"battery.level": 10}))
    bench.step(Loaded("late"))
    assert bench.logs() == ["low"]
    bench.step(Sensed({"battery.level": 9}))
    assert bench.logs() == ["low"]


@pytest.mark.parametrize("script", ["", "<script>function f(x) { return x; }</script>"])
def test_a_state_without_watches_sees_what_was_told_last(script: str) -> None:
    bench = Bench(
        script
        + """<form id="a"><watch name="low" when="sensor.battery?.level &lt; 20"/>
          <on event="go"><goto next="#b"/></on></form>
        <form id="b"><on event="show"><log expr="sensor.battery.level"/></on></form>"""
    )
    bench.step(Sensed({"battery.level": 50}))
    bench.event("go")
    for level in range(10, 17):
        bench.step(Sensed({"battery.level": level}))
        bench.event("show")
    assert bench.logs() == [str(level) for level in range(10, 17)]


def test_a_watch_that_is_always_true_where_it_leads_ends_its_application_alone() -> None:
    round_and_round = """<form id="a"><watch name="w" when="!sensor.moving"/>
      <on event="w"><goto next="#a"/></on></form>"""
    other = '<form id="b"><on event="touch"><log>here</log></on></form>'
    bench = Bench(round_and_round, document(other, "ea", "other"))
    bench.step(Sensed({"moving": False}))
    (failure,) = bench.session.failures
    assert "loops without ever waiting" in failure
    bench.event("touch")
    assert bench.logs() == ["here"]


def test_a_watch_sees_the_variables_of_its_form() -> None:
    bench = Bench(
        """<var name="most" expr="5"/>
        <form id="a"><block><speak>Hm.</speak><goto next="#b"/></block></form>
        <form id="b"><var name="least" expr="1"/>
          <watch name="fair" when="sensor.heat &gt; least &amp;&amp; sensor.heat &lt; most"/>
          <on event="fair"><log>fair</log></on>
        </form>"""
    )
    bench.step(Sensed({"heat": 3}))
    bench.finish("Hm.")
    assert bench.logs() == ["fair"]


@pytest.mark.parametrize(
    "head", ['<var name="x" expr="null.thing"/>', "<script>null.thing</script>"]
)
def test_a_variable_or_script_of_the_document_that_fails_is_an_event(head: str) -> None:
    bench = Bench(f'{CAUGHT}{head}<form id="a"><block><log>on</log></block></form>')
    assert bench.logs() == ["error.semantic", "on"]


def test_a_value_to_return_that_fails_is_an_event() -> None:
    bench = Bench(
        f"""{CAUGHT}<form id="a">
          <subdialog name="s" src="#b"/>
          <block><log expr="s.x === null"/></block>
        </form>
        <form id="b"><block><assign name="x" expr="1"/><clear namelist="x"/>
          <script>dialog.y = {{}}; dialog.y.me = dialog.y;</script><assign name="x" expr="dialog.y"/>
          <return namelist="x"/></block>
          <var name="x"/>
          <on event="error.semantic"><log>circular</log><assign name="x" expr="null"/>
            <return namelist="x"/></on></form>"""
    )
    assert bench.logs() == ["circular", "true"]


def test_an_error_that_nobody_handles_ends_its_application_alone() -> None:
    bench = Bench(
        '<form id="a"><on event="touch" cond="null.thing"><log>never</log></on></form>',
        document('<form id="a"><on event="touch"><log>here</log></on></form>', "ea", "other"),
    )
    bench.event("touch")
    assert bench.logs() == ["here"]
    assert bench.session.failures and bench.session.failures[0].startswith("app: error.semantic")


def test_slow_scripts_of_one_instant_end_their_application_alone() -> None:
    slow = "let n = 0; while (n &lt; 3e6) n++;"
    bench = Bench(
        f"""<form id="a"><block>
          <foreach item="i" array="new Array(1000).fill(0)"><script>{slow}</script></foreach>
        </block></form>""",
        document('<form id="a"><block><log>here</log></block></form>', "ea", "other"),
    )
    assert bench.logs() == ["here"]
    assert "its scripts take too long" in bench.session.failures[0]


def test_what_comes_out_in_one_instant_is_bounded() -> None:
    bench = Bench(
        """<form id="a"><block>
          <foreach item="i" array="new Array(10000).fill(0)"><log expr="'x'.repeat(90000)"/></foreach>
        </block></form>"""
    )
    assert "characters come out at once" in bench.session.failures[0]
    assert sum(len(text) for text in bench.logs()) <= 1_000_000
    assert max(len(text) for text in bench.logs()) == 90_000


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


def test_an_error_in_a_script_is_told_at_its_own_line() -> None:
    bench = Bench(
        """<form id="a"><block><script>
          let a = 1;
          a.b.c();
        </script></block></form>"""
    )
    assert bench.session.failures[0].startswith("app: error.semantic: app.xml:3:11: ")


def test_an_event_that_nobody_handles_is_told_with_its_place() -> None:
    bench = Bench(
        """<form id="a"><block>
          <throw event="foo"/></block></form>"""
    )
    assert bench.session.failures == ["app: foo: app.xml:2:11"]


def test_what_is_asked_for_instead_of_a_refused_command_is_the_reaction() -> None:
    bench = Bench(
        """<form id="a">
          <block><topological-move to="room"/></block>
          <on event="corner"><command type="fly"/></on>
          <on event="error.semantic"><turn-and-speak angle="9">There.</turn-and-speak></on>
        </form>"""
    )
    bench.event("corner")
    [asked] = [r for r in bench.phases("request") if r["command"] == "turn-and-speak"]
    assert asked["reactive"] and asked["cause"]


def test_a_watch_is_looked_at_only_when_its_sensor_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench(
        """<var name="n" expr="0"/><form id="a">
        <watch name="low" when="sensor.battery.level &lt; 15"/>
        <watch name="odd" when="sensor.front &lt; 1 &amp;&amp; n == 0"/>
        <on event="low"><log>low</log></on></form>"""
    )
    looked: list[str] = []
    (app,) = bench.session.apps.values()
    assert isinstance(app, Interpreter)
    condition = app.execute.condition

    def noted(expr: Expression, fiber: Fiber) -> bool:
        looked.append(expr.code)
        return condition(expr, fiber)

    monkeypatch.setattr(app.execute, "condition", noted)
    bench.step(Sensed({"battery.level": 50.0, "front": 2.0}))
    bench.step(Sensed({"front": 1.5}))
    assert len(looked) == 2 + 1, "the battery has not changed; the other looks at a variable too"
    bench.step(Sensed({"battery.level": 10.0}))
    bench.step(Sensed({"front": 1.0}))
    assert bench.logs() == ["low"]


LOG = '<form id="a"><block><log><value expr="{}"/></log></block></form>'
WATCH = '<watch name="w" when="{}"/>' + LOG.format("1")


@pytest.mark.parametrize(
    ("body", "read"),
    [
        (WATCH.format("sensor.x &gt; 1"), {"x"}),
        (WATCH.format("sensor.x?.y &gt; sensor?.z.a"), {"x", "z"}),
        (LOG.format("sensor .a + application.sensor.b"), {"a", "b"}),
        ("<script>var a = 1;</script>" + LOG.format("a"), set()),
        ('<form id="a"><block><speak>A sensor\'s application.</speak></block></form>', set()),
        ('<var name="n" expr="1"/>' + WATCH.format("sensor.x &gt; n"), None),
        (LOG.format("sensor"), None),
        (LOG.format("sensor['x']"), None),
        (LOG.format("application"), None),
        (LOG.format("application['sensor']"), None),
        (LOG.format("application.valueOf()['sen' + 'sor'].x"), None),
        (LOG.format("application.mine"), set()),
        (LOG.format("'this application of a sensor'"), set()),
        (
            "<script>var a = \"don't\"; // isn't this it\nvar b = 'x';</script>" + LOG.format("b"),
            set(),
        ),
        (
            "<script>var f = function () { /* ' */ return this; }; // '\n</script>"
            + LOG.format("1"),
            None,
        ),
        ("<script>var f = () => `${sensor.x}`;</script>" + LOG.format("1"), {"x"}),
        ("<script>// all\nfunction f() { return this; }</script>" + LOG.format("1"), None),
        (
            "<script>application.all = function () { return this; };</script>" + LOG.format("1"),
            None,
        ),
        ("<script>for (const k in ap\u01c0) k;</script>" + LOG.format("1"), None),
        ('<var name="Infinity" expr="1"/>' + WATCH.format("sensor.x &lt; Infinity"), None),
        ("<script>function f() { return sens\\u006fr.x; }</script>" + LOG.format("1"), None),
        ("<script>function f() { return eval('sen' + 'sor.x'); }</script>" + LOG.format("1"), None),
        ("<script>function f(s) { return s.sensor; }</script>" + LOG.format("1"), None),
    ],
)
def test_which_sensors_a_document_looks_at(body: str, read: set[str] | None) -> None:
    found = sensors_read(document(body))
    assert (found if found is None else set(found)) == read


def test_a_watch_that_a_subdialog_may_hide_looks_at_whatever_changes() -> None:
    watching = '<form id="a"><watch name="w" when="sensor.x &gt; 1"/>{}</form>'
    assert sensors_read(document(watching.format(""))) == frozenset({"x"})
    calls = '<subdialog name="s" src="#b"/>'
    other = '<form id="b"><block><return/></block></form>'
    assert sensors_read(document(watching.format(calls) + other)) is None


def test_a_watch_knows_what_changed_while_a_subdialog_had_its_place() -> None:
    bench = Bench(
        """<form id="a"><watch name="near" when="sensor.x &gt; 1"/>
          <on event="near"><log>near</log></on>
          <block><speak>First.</speak></block><subdialog name="s" src="#b"/></form>
        <form id="b"><block><speak>Inside.</speak></block>
          <on event="touch"><return/></on></form>"""
    )
    bench.step(Sensed({"x": 0, "y": 0}))
    bench.finish("First.")
    bench.step(Sensed({"x": 5}))
    bench.event("touch")
    assert bench.logs() == []
    bench.step(Sensed({"y": 1}))
    assert bench.logs() == ["near"]


@pytest.mark.parametrize(("name", "when"), [("sensor", "sensor.x"), ("Infinity", "Infinity")])
def test_a_watch_sees_a_variable_that_hides_what_it_takes_for_granted(name: str, when: str) -> None:
    bench = Bench(
        f"""<form id="a"><var name="{name}" expr="0"/>
          <watch name="near" when="{when} &gt; 1 || sensor.x == 'no'"/>
          <on event="near"><log>near</log></on>
          <on event="message"><assign name="{name}" expr="event.data.it"/></on></form>"""
    )
    bench.step(Sensed({"x": 0}))
    bench.event("message", it={"x": 3} if name == "sensor" else 3)
    bench.step(Sensed({"y": 0}))
    assert bench.logs() == ["near"]


def test_handlers_that_wait_in_what_others_throw_are_counted() -> None:
    bench = Bench(
        """<form id="a"><on event="touch"><throw event="own.x"/></on>
        <on event="own"><speak>So.</speak></on></form>"""
    )
    for _ in range(100):
        bench.event("touch")
    (end,) = bench.phases("unload")
    assert "too many handlers under way" in end["outcome"]


def test_code_that_is_text_knows_the_event() -> None:
    bench = Bench(
        """<form id="a"><on event="touch"><log expr="eval('eve' + 'nt.name')"/></on></form>"""
    )
    bench.event("touch")
    assert bench.logs() == ["touch"]


def test_many_pieces_of_code_in_one_place_take_no_longer_than_scripts_may(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("prima.script.engine.MAX_SCRIPT_SECONDS", 0.05)
    slow = '<value expr="(function () { for (var i = 0; i &lt; 1e4; i++); return 1 })()"/>'
    bench = Bench(f'<form id="a"><block><log>{slow * 2000}</log></block></form>', isolate="none")
    (end,) = bench.phases("unload")
    assert "scripts take too long" in end["outcome"]


@pytest.mark.parametrize("head", ["", "<script>var own = 1</script>"])
def test_a_subdialog_may_give_what_is_not_a_number(head: str) -> None:
    bench = Bench(
        f"""{head}<form id="a"><subdialog name="s" src="#b"/>
          <block><log><value expr="s.p"/> <value expr="s.q.r"/></log></block></form>
        <form id="b"><var name="p" expr="0 / 0"/><var name="q"/>
          <block><var name="q" expr="{{r: 1}}"/><return namelist="p q"/></block></form>"""
    )
    assert bench.logs() == ["NaN 1"]
