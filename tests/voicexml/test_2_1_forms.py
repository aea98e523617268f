"""Forms, the order of their items, and mixed initiative: VoiceXML 2.0, 2.1 and Appendix C."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.messages import Ended
from tests.helpers.dialogs import (
    CITIES,
    FAIL,
    MIXED,
    OOPS,
    PASS,
    TRIP,
    YES,
    Case,
    Cases,
    grammar,
    run,
)
from tests.helpers.voice import Call, vxml

case = Cases()

case(
    "an item visited next after a handler is not asked",
    "C",
    f"""<form><catch event="a">A.</catch><block><throw event="a"/></block>
    <field name="f"><prompt>F?</prompt>{CITIES}</field></form>""",
    said=["A."],
)
case(
    "form items are visited in document order",
    "2.1",
    f"""<form><block><log>a</log></block><field name="f">{CITIES}</field>
    <block><log expr="f"/></block></form>""",
    "nara",
    logs=["a", "Nara"],
    ended="exit",
)
case(
    "a form's variables are initialised each time it is entered",
    "2.1.2",
    """<var name="seen" expr="0"/><form id="a"><var name="n" expr="0"/><block>
    <assign name="n" expr="n + 1"/><assign name="seen" expr="seen + 1"/><log expr="n"/>
    <if cond="seen == 1"><goto next="#a"/></if></block></form>""",
    logs=["1", "1"],
)
case(
    "an item whose condition is false is not selected",
    "2.1.5",
    """<form><var name="n" expr="1"/><block cond="n == 2"><log>no</log></block>
    <block cond="n == 1"><log>yes</log></block></form>""",
    logs=["yes"],
)
case(
    "an item whose variable has an initial value is not visited",
    "2.1.5",
    f"""<form><field name="f" expr="'x'"><prompt>Where?</prompt>{CITIES}</field>
    <block><log expr="f"/></block></form>""",
    logs=["x"],
    said=[],
)
case(
    "assigning undefined to an item makes it eligible again",
    "2.1.5",
    """<form><var name="n" expr="0"/><block name="b"><assign name="n" expr="n + 1"/>
    <log expr="n"/></block><block cond="n == 1"><assign name="b" expr="undefined"/></block></form>""",
    logs=["1", "2"],
)
case(
    "one utterance fills many fields and their filled run in document order",
    "2.1.5",
    MIXED,
    "from Kyoto to Osaka",
    logs=["s:Kyoto", "e:Osaka", "Kyoto-Osaka-true"],
    said=["Your trip?"],
)
case(
    "a form's grammar listens in its fields",
    "2.1.5",
    MIXED,
    "from Nara",
    "from Kyoto to Osaka",
    logs=["s:Nara", "s:Kyoto", "e:Osaka", "Kyoto-Osaka-true"],
)
case(
    "a condition may look at what has been filled",
    "2.1.5",
    f"""<form>{TRIP}<field name="start"><prompt>From?</prompt></field>
    <field name="end" cond="start == 'Nara'"><prompt>To?</prompt></field>
    <block><log expr="typeof end"/></block></form>""",
    "from Kyoto",
    said=["From?"],
    logs=["undefined"],
)
case(
    "an item that was filled out of turn is not asked for",
    "2.1.5",
    f"""<form>{TRIP}<field name="start"><prompt>From?</prompt></field>
    <field name="end"><prompt>To?</prompt></field></form>""",
    "to Nara",
    "from Kyoto",
    said=["From?", "From?"],
    ended="exit",
)
case(
    "an item whose expr is undefined is visited",
    "2.1.5",
    f"""<form><field name="a" expr="undefined"><prompt>A?</prompt>{CITIES}</field></form>""",
    said=["A?"],
)
case(
    "false, nought, null and empty values fill an item",
    "2.1.5",
    """<form><block name="a" expr="false"><log>a</log></block><block name="b" expr="0"><log>b</log>
    </block><block name="c" expr="null"><log>c</log></block><block name="d" expr="''"><log>d</log>
    </block></form>""",
    logs=[],
    ended="exit",
)
case(
    "goto nextitem visits an item whose variable is filled",
    "2.1.5.1",
    """<form><var name="n" expr="0"/><block name="a"><assign name="n" expr="n + 1"/>
    <log expr="n"/></block><block><goto nextitem="a"/></block></form>""",
    logs=["1", "2"],
    ended="exit",
)
case(
    "a form that is exhausted is an implicit exit",
    "2.1.6",
    "<form><block>Bye.</block></form><form><block>Never.</block></form>",
    said=["Bye."],
    ended="exit",
)
case(
    "a form without items exits",
    "2.1.6",
    "<form><var name='x'/></form>",
    logs=[],
    ended="exit",
)
case(
    "a form of document scope is entered by what its grammar takes",
    "2.1.6",
    f"""<form><field name="f"><prompt>Where?</prompt>{CITIES}</field></form>
    <form scope="document">{TRIP}<block><log>never</log></block>
    <field name="start"><prompt>From?</prompt><filled><log expr="start"/><exit/></filled></field>
    </form>""",
    "from Osaka",
    logs=["Osaka"],
    said=["Where?"],
)
case(
    "a form so entered asks for what is missing",
    "2.1.6",
    f"""<form><field name="f"><prompt>Where?</prompt>{CITIES}</field></form>
    <form scope="document">{TRIP}<field name="start"><prompt>From?</prompt></field>
    <field name="end"><prompt>To?</prompt></field></form>""",
    "from Osaka",
    said=["Where?", "To?"],
)
case(
    "form variables and items are initialised in document order",
    "2.1.6.1",
    """<form><var name="a" expr="1"/><field name="f" expr="a + 1"/><var name="b" expr="f + 1"/>
    <script>var c = b + 1;</script><block><log expr="[a, f, b, c].join()"/></block></form>""",
    logs=["1,2,3,4"],
)
case(
    "a field's prompt counter is per field and starts again with the form",
    "2.1.6.1",
    f"""<form id="a"><field name="f"><prompt>One?</prompt><prompt count="2">Two?</prompt>{CITIES}
    <nomatch count="2"><goto next="#a"/></nomatch></field></form>""",
    "x",
    "x",
    said=["One?", OOPS, "Two?", "One?"],
)
case(
    "a handler at initialisation may go to an item",
    "2.1.6.1",
    """<form><catch event="error"><goto nextitem="b"/></catch><var name="x" expr="zz"/>
    <block><log>a</log></block><block name="b"><log>b</log><exit/></block></form>""",
    logs=["b"],
)
case(
    "an event at initialisation ends the dialog if its handler leads nowhere",
    "C",
    f"""<form><catch event="error"><log>odd</log></catch><var name="x" expr="zz"/>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    logs=["odd"],
    said=[],
    ended="exit",
)
case(
    "the item to which a handler at initialisation goes is asked: no iteration was before it",
    "C",
    f"""<form><catch event="error"><goto nextitem="f"/></catch><var name="x" expr="zz"/>
    <field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    "kyoto",
    said=["Well?"],
)
case(
    "an event at the selection of an item ends the dialog if its handler leads nowhere",
    "C",
    f"""<form><catch event="error"><log>odd</log><assign name="d" expr="1"/></catch>
    <var name="d" expr="0"/><block>First.</block>
    <field name="f" cond="d == 1 || zz"><prompt>Well?</prompt>{CITIES}</field></form>""",
    logs=["odd"],
    said=["First."],
    ended="exit",
)
case(
    "a handler of an event at the selection of an item may go to one",
    "C",
    f"""<form><catch event="error"><reprompt/><goto nextitem="f"/></catch>
    <block cond="zz">Never.</block><field name="f"><prompt>Well?</prompt>{CITIES}
    <filled><exit/></filled></field></form>""",
    "kyoto",
    said=["Well?"],
)
case(
    "a form's grammar fills a field without a name by its slot",
    "C",
    f"""<form>{TRIP}<field slot="start"><prompt>From?</prompt>{CITIES}<filled><log>start</log>
    </filled></field><field name="end"><prompt>To?</prompt>{CITIES}</field></form>""",
    "from Kyoto to Osaka",
    logs=["start"],
    said=["From?"],
)
case(
    "guards are looked at anew in each iteration",
    "2.1.6.2",
    """<form><var name="n" expr="1"/><block cond="n == 2"><log>first</log></block>
    <block><log>second</log><assign name="n" expr="2"/></block></form>""",
    logs=["second", "first"],
)
case(
    "goto nextitem visits an item whose condition is false",
    "2.1.6.2",
    """<form><block><goto nextitem="b"/></block><block name="a" cond="false"><log>a</log></block>
    <block name="b" cond="false"><log>b</log></block></form>""",
    logs=["b"],
)
case(
    "after goto nextitem selection goes on as usual",
    "2.1.6.2",
    """<form><block><goto nextitem="b"/></block><block name="a"><log>a</log></block>
    <block name="b"><log>b</log></block></form>""",
    logs=["b", "a"],
)
case(
    "initial is true before the filled of what it heard run",
    "2.1.6.2",
    f"""<form>{TRIP}<initial name="init"/><field name="start">{CITIES}
    <filled><log expr="init"/></filled></field></form>""",
    "from Nara",
    logs=["true"],
)
case(
    "an event in a filled leaves the others out",
    "2.1.6.2",
    f"""<form><catch event="odd"><log>odd</log></catch><field name="a">{CITIES}
    <filled><throw event="odd"/></filled><filled><log>two</log></filled></field>
    <filled><log>form</log></filled></form>""",
    "kyoto",
    logs=["odd"],
)
case(
    "a goto in a filled leaves the others out",
    "2.1.6.2",
    f"""<form><field name="a">{CITIES}<filled><goto nextitem="b"/></filled></field>
    <block name="b"><log>b</log></block><filled><log>form</log></filled></form>""",
    "kyoto",
    logs=["b"],
)
case(
    "a subdialog's result does not leave initial",
    "2.1.6.2",
    f"""<form>{TRIP}<subdialog name="s" src="#t"/><initial name="i"><prompt>Trip?</prompt></initial>
    <field name="start"/></form><form id="t"><block><return/></block></form>""",
    said=["Trip?"],
)
case(
    "a recording leaves initial before its filled runs",
    "2.3.3",
    f"""<form>{TRIP}<record name="r"><prompt>Speak.</prompt><filled><log expr="i"/></filled></record>
    <initial name="i"><prompt>Trip?</prompt></initial>
    <field name="start"><prompt>From?</prompt></field></form>""",
    "Hello.",
    logs=["true"],
    said=["Speak.", "From?"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


@pytest.mark.parametrize(
    ("expr", "logged"), [("null", []), ("false", []), ("void 0", ["in"]), ("undefined", ["in"])]
)
@pytest.mark.parametrize("name", ["", 'name="b"'])
def test_an_item_is_visited_while_its_variable_is_undefined(
    name: str, expr: str, logged: list[str]
) -> None:  # 2.1.6
    assert run(f'<form><block {name} expr="{expr}"><log>in</log></block></form>').logs() == logged


def test_what_fills_no_item_is_no_nomatch() -> None:  # 2.1.6, C
    call = run(
        f"""<form>{grammar("hi", "out.other = 1")}<nomatch>{FAIL}</nomatch>
        <field name="f"><prompt>Well?</prompt>{YES}<filled>{PASS}</filled></field></form>""",
        "hi",
        "yes",
    )
    assert (call.said(), call.logs()) == (["Well?", "Well?"], ["pass"])


@pytest.mark.parametrize(
    "text",
    [
        "<form id='a'><block><goto next='#a'/></block></form>",
        "<form><catch event='error'><clear/><goto nextitem='b'/></catch><block name='b'/>"
        "<block cond='zz'/></form>",
        "<form><catch event='error'/><subdialog name='s' src='none.vxml'/></form>",
        "<form><catch event='a'><clear/></catch><block><throw event='a'/></block></form>",
        "<catch event='error'><goto next='#a'/></catch><form id='a'><var name='x' expr='zz'/></form>",
        "<form id='a'><subdialog name='s' src='#a'/></form>",
    ],
)
def test_an_application_that_never_waits_is_stopped(text: str) -> None:
    """C: the algorithm has no bound, the robot has."""
    assert Call(text).ended.startswith("error.semantic")


def test_mixed_initiative_fills_many_fields() -> None:
    call = Call(
        """<form>
        <grammar version="1.0" root="trip" xmlns="http://www.w3.org/2001/06/grammar"
            tag-format="semantics/1.0">
          <rule id="trip">from <ruleref uri="#city"/><tag>out.start = rules.latest();</tag>
            to <ruleref uri="#city"/><tag>out.end = rules.latest();</tag></rule>
          <rule id="city"><one-of><item>Kyoto</item><item>Nara</item></one-of></rule>
        </grammar>
        <initial><prompt>Your trip?</prompt></initial>
        <field name="start"><prompt>From?</prompt></field>
        <field name="end"><prompt>To?</prompt></field>
        <filled><log><value expr="start"/> <value expr="end"/></log></filled></form>"""
    )
    call.answer("from Kyoto to Nara")
    assert call.logs() == ["Kyoto Nara"]


QUICK = """<property name="timeout" value="{}"/>
<form><field name="f"><option>tea</option><noinput/></field></form>"""
CALLING = """<form>
<transfer name="t" dest="tel:1" bridge="true" connecttimeout="{}"><filled><clear namelist="t"/>
</filled></transfer></form>"""
TURNS = """<var name="n" expr="0"/><form>
<field name="f"><option>tea</option><prompt timeout="1ms" cond="n % 2"/>
<prompt timeout="{}" cond="!(n % 2)"/><noinput><assign name="n" expr="n + 1"/><reprompt/></noinput>
</field></form>"""


@pytest.mark.parametrize(
    ("body", "timeout"),
    [(QUICK, "0s"), (QUICK, "1ms"), (QUICK, "15ms"), (CALLING, "0s"), (CALLING, "1ms"),
     (TURNS, "49ms")],
)  # fmt: skip
def test_waits_that_are_over_at_once_end_their_application_alone(
    body: str, timeout: str, tmp_path: Path
) -> None:
    quick, slow = tmp_path / "quick.vxml", tmp_path / "slow.vxml"
    quick.write_text(vxml(body.format(timeout)), encoding="utf-8")
    slow.write_text(vxml(QUICK.format("50s")), encoding="utf-8")
    transcript = api.rehearse(api.stage([], [str(quick), str(slow)]))
    assert transcript.outcome != "limit"
    (failure,) = transcript.failures
    assert failure.startswith("quick: error.semantic: quick.vxml:2:") and " it waited " in failure
    assert failure.endswith(" ms on an average: let what comes again and again wait longer")
    assert transcript.summary().seconds == 600
    assert len(transcript.records) < 25_000


def test_short_waits_with_a_longer_one_among_them_are_allowed() -> None:
    call = Call(QUICK.format("1ms"))
    for number in range(2500):
        call.step(at=call.now + (50_000 if number % 900 == 0 else 1) - 1)
        question = call.session.mediator.question()
        assert question is not None
        call.step(Ended(question.id, True, {"outcome": "noinput"}), at=call.now + 1)
    assert not call.ended
