"""Form items are visited in their order, and executable content runs in its own."""

from __future__ import annotations

import pytest

from tests.helpers.robot import Bench, read


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


def test_a_goto_to_a_computed_item_that_is_none_is_an_error() -> None:
    bench = Bench("""<form id="a"><block><goto nextitem-expr="'none'"/></block></form>""")
    (failure,) = bench.session.failures
    assert failure.startswith("app: error.badfetch: ") and 'no form item "none"' in failure


def test_an_answer_that_was_cleared_is_not_processed_further() -> None:  # VoiceXML 2.4
    bench = Bench(
        """<form id="a"><field name="x" type="boolean"><prompt>A?</prompt>
        <filled><log>1</log><if cond="!x"><clear namelist="x"/></if></filled>
        <filled><log>2</log></filled></field></form>"""
    )
    for said in ("no", "yes"):
        bench.listens()
        bench.hears(said)
    assert bench.logs() == ["1", "1", "2"]


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


@pytest.mark.parametrize("around", ["par", "seq", "iu"])
def test_what_begins_with_a_command_wanted_now_is_wanted_now(around: str) -> None:
    bench = Bench(
        f"""<form id="a">
          <block><topological-move to="x"/><speak>Here.</speak></block>
          <on event="touch">
            <gesture name="nod"/><{around}><stop-moving/><speak>Stopped.</speak></{around}>
          </on>
        </form>"""
    )
    assert bench.saying() == ["topological-move"]
    bench.event("touch")
    bench.finish("gesture")
    gone = [one["command"] for one in bench.phases("cancel") if one["rule"] == "O2"]
    assert sorted(gone) == ["speak", "topological-move"]


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


@pytest.mark.parametrize("script", ["", "<script>function f() { return 1; }</script>"])
def test_a_variable_declared_again_keeps_its_value(script: str) -> None:
    """VoiceXML 2.0, 5.3.1: without a value, that of the variable is left."""
    bench = Bench(
        f"""{script}<form id="a"><block>
          <var name="x" expr="3"/><var name="x"/><log expr="x"/>
          <foreach item="i" array="[1, 2]"><var name="q"/><log expr="String(q)"/>
            <assign name="q" expr="i"/></foreach>
          <var name="valueOf"/><log expr="String(valueOf)"/>
        </block>
        <block><var name="x"/><log expr="String(x)"/></block></form>"""
    )
    assert bench.logs() == ["3", "undefined", "1", "undefined", "undefined"]


def test_what_content_declares_is_unknown_to_the_items_after_it() -> None:
    bench = Bench(
        """<form id="a">
          <var name="x" expr="'form'"/>
          <block><var name="x" expr="'block'"/></block>
          <block cond="x == 'block'"><log>seen</log></block>
          <field name="f" type="boolean">
            <prompt><value expr="x"/></prompt>
            <filled><var name="x" expr="'filled'"/></filled>
          </field>
          <block cond="x == 'filled'"><log>seen</log></block>
          <block><log expr="x"/></block>
        </form>"""
    )
    bench.listens()
    bench.hears("yes")
    assert bench.said() == ["form"]
    assert bench.logs() == ["form"]


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
        ('<iu><speak>a<break time="50s"/></speak></iu>', "long-unit", ""),
    ],
)
def test_what_is_wrong_with_a_pause_is_told(content: str, code: str, remedy: str) -> None:
    _, problems = read(f"<form id='a'><block>{content}<exit/></block></form>")
    (problem,) = [one for one in problems if one.code != "long-turn"]  # a pause may be that, too
    assert problem.code == code and remedy in problem.remedy, problem


@pytest.mark.parametrize(
    ("longest", "said", "message"),
    [
        ("2s", "word " * 10, "about 3.4 s, beyond its longest duration"),
        ("1s", 'a<break time="2s"/>', "about 2.1 s, beyond its longest duration"),
        ("5s", "word " * 10, ""),
        ("60s", "word " * 80, "about 27 s: no reaction"),
    ],
)
def test_a_unit_that_its_own_speech_outlasts_is_told(longest: str, said: str, message: str) -> None:
    _, problems = read(
        f"<form id='a'><block><iu longest='{longest}'><speak>{said}</speak></iu><exit/></block></form>"
    )
    told = [one.message for one in problems if one.code == "long-unit"]
    assert len(told) == bool(message) and message in "".join(told)


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ('<form id="f"><block{}><speak>A.</speak><goto next="#f"/></block></form>', "endless"),
        ('<form id="f"><field name="a"><prompt{}>B?</prompt><option>c</option></field></form>', "no-noinput"),
        ("""<form id="f"><iu><block><speak>A.</speak></block></iu>
          <error{}><log>e</log></error></form><error><set-position x="1" y="0"/></error>""", ""),
    ],
)  # fmt: skip
def test_a_condition_that_is_the_default_changes_no_problem(body: str, code: str) -> None:
    plain, written = (
        {one.code for one in read(body.format(how))[1]} for how in ("", ' cond="true"')
    )
    assert written == plain and code in plain | {""}
