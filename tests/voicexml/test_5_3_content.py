"""Executable content from var to reprompt: VoiceXML 2.0, 5.3.1 to 5.3.6."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import CITIES, SILENT, Case, Cases, holds, logged, run
from tests.helpers.voice import Call

ASK = f"""<form><field name="f"><prompt>1?</prompt><prompt count="2">2?</prompt>
<prompt count="3">3?</prompt>{CITIES}%s</field><field name="g"><prompt>G?</prompt>{CITIES}</field>
</form>"""

case = Cases()

case(
    "a variable without an expr is undefined",
    "5.3.1",
    "<form><var name='x'/><block><log expr='typeof x'/></block></form>",
    logs=["undefined"],
)
case(
    "a variable's name has no scope prefix where it is declared",
    "5.3.1",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><var name="document.x" expr="1"/><log expr="document.x"/></block></form>""",
    logs=["semantic"],
)
case(
    "var in content makes an anonymous variable",
    "5.3.1",
    """<form><var name="x" expr="1"/><block><var name="x" expr="2"/><log expr="x"/></block>
    <block><log expr="x"/></block></form>""",
    logs=["2", "1"],
)
case(
    "assign sets the variable of the scope that its name begins with",
    "5.3.2",
    """<script>function f() { return 5; }</script><var name="x" expr="1"/>
    <form><catch event="error.semantic"><log>semantic</log></catch><var name="x" expr="2"/>
    <block><assign name="document.x" expr="f()"/><log expr="[x, document.x]"/>
    <assign name="dialog.q" expr="f()"/></block></form>""",
    logs=["2,5", "semantic"],
)
case(
    "an expr that is undefined leaves a variable undefined",
    "5.3.1",
    """<var name="x" expr="undefined"/><form><block><log expr="typeof x"/></block></form>""",
    logs=["undefined"],
)
case(
    "an assignment to one is error.semantic",
    "5.3.2",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><assign name="zz" expr="1"/></block></form>""",
    logs=["semantic"],
)
case(
    "an assignment to one of a named scope is error.semantic",
    "5.3.2",
    """<var name="x"/><form><catch event="error.semantic"><log>semantic</log></catch>
    <block><assign name="dialog.x" expr="1"/></block></form>""",
    logs=["semantic"],
)
case(
    "an object's property may be assigned",
    "5.3.2",
    """<form><var name="o" expr="({})"/><block><assign name="o.p" expr="4"/><log expr="o.p"/></block>
    </form>""",
    logs=["4"],
)
case(
    "a block is run again when it is cleared",
    "5.3.3",
    """<form><var name="n" expr="0"/><block name="b"><assign name="n" expr="n+1"/><log expr="n"/>
    </block><block cond="n &lt; 2"><clear namelist="b"/></block></form>""",
    logs=["1", "2"],
)
case(
    "clear resets an item's event and prompt counters",
    "5.3.3",
    """<form><field name="f"><prompt>1?</prompt><prompt count="2">2?</prompt><option>x</option>
    <nomatch><log>1</log><reprompt/></nomatch><nomatch count="2"><log>2</log></nomatch>
    <filled><clear namelist="f"/></filled></field></form>""",
    "y",
    "x",
    "y",
    logs=["1", "1"],
    said=["1?", "2?", "1?", "2?"],
)
case(
    "clear without a namelist clears all items and no variables",
    "5.3.3",
    """<form><var name="n" expr="0"/><block name="b"><assign name="n" expr="n + 1"/><log expr="n"/>
    </block><block><if cond="n &lt; 3"><clear/></if></block></form>""",
    logs=["1", "2", "3"],
)
case(
    "clear sets variables to undefined",
    "5.3.3",
    """<form><var name="n" expr="1"/><block><clear namelist="n"/><log expr="typeof n"/></block>
    </form>""",
    logs=["undefined"],
)
case(
    "clear of what is not declared is error.semantic",
    "5.3.3",
    logged("error.semantic", "<block><clear namelist='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "a subdialog's item is visited again when it is cleared",
    "5.3.3",
    """<form><var name="n" expr="0"/><subdialog name="s" src="#t"><filled>
    <assign name="n" expr="n + 1"/><if cond="n == 1"><clear namelist="s"/></if></filled></subdialog>
    </form><form id="t"><block><log>in</log><return/></block></form>""",
    logs=["in", "in"],
)
case(
    "if takes the first branch that holds",
    "5.3.4",
    """<form><block><if cond="false"><log>1</log><elseif cond="true"/><log>2</log>
    <elseif cond="true"/><log>3</log><else/><log>4</log></if></block></form>""",
    logs=["2"],
)
case(
    "else is for the rest",
    "5.3.4",
    """<form><block><if cond="false"><log>1</log><elseif cond="0"/><log>2</log>
    <else/><log>4</log></if><if cond="0"><log>5</log></if></block></form>""",
    logs=["4"],
)
case(
    "after a handler without reprompt nothing is asked again",
    "5.3.6",
    ASK % "<nomatch>No.</nomatch>",
    "x",
    said=["1?", "No."],
)
case(
    "a handler's prompt counts as the question, the counter stands still",
    "5.3.6",
    ASK % "<nomatch>No.</nomatch><noinput><reprompt/></noinput>",
    "x",
    SILENT,
    said=["1?", "No.", "2?"],
)
case(
    "reprompt asks after all that the handler says",
    "5.3.6",
    ASK % "<nomatch><reprompt/>No.</nomatch>",
    "x",
    said=["1?", "No.", "2?"],
)
case(
    "reprompt does not leave the handler",
    "5.3.6",
    ASK % "<nomatch><reprompt/><log>on</log></nomatch>",
    "x",
    logs=["on"],
)
case(
    "a goto to another item without reprompt is not asked",
    "5.3.6",
    ASK % "<nomatch>No.<goto nextitem='g'/></nomatch>",
    "x",
    said=["1?", "No."],
)
case(
    "a goto to another item with reprompt is asked",
    "5.3.6",
    ASK % "<nomatch>No.<reprompt/><goto nextitem='g'/></nomatch>",
    "x",
    said=["1?", "No.", "G?"],
)
case(
    "a dialog that a handler goes to is asked",
    "5.3.6",
    f"""<form id="a"><field name="f"><prompt>1?</prompt>{CITIES}
    <nomatch>No.<goto next="#a"/></nomatch></field></form>""",
    "x",
    said=["1?", "No.", "1?"],
)
case(
    "reprompt outside a handler does nothing",
    "5.3.6",
    f"""<form><field name="f"><prompt>1?</prompt>{CITIES}<nomatch>No.</nomatch>
    <filled><reprompt/><assign name="f" expr="undefined"/></filled></field></form>""",
    "kyoto",
    "x",
    said=["1?", "1?", "No."],
)
case(
    "only the next item goes without its prompts",
    "5.3.6",
    f"""<form><catch event="a">A.</catch><block><throw event="a"/></block>
    <block/><field name="f"><prompt>F?</prompt>{CITIES}</field></form>""",
    said=["A.", "F?"],
)
case(
    "a goto nextitem out of a filled asks as usual",
    "5.3.6",
    f"""<form><field name="f"><prompt>F?</prompt>{CITIES}<filled><goto nextitem="h"/></filled></field>
    <field name="g"><prompt>G?</prompt>{CITIES}</field>
    <field name="h"><prompt>H?</prompt>{CITIES}</field></form>""",
    "nara",
    "nara",
    said=["F?", "H?", "G?"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_variable_declared_again_without_expr_keeps_its_value() -> None:  # 5.3.1
    call = run(
        f"""<form><var name="x" expr="1"/><var name="x"/><block><var name="y" expr="1"/>
        <var name="y"/>{holds("x == 1 &amp;&amp; y == 1")}</block></form>"""
    )
    assert call.logs() == ["pass"]


def test_an_element_of_an_array_can_be_assigned() -> None:  # 5.3.2
    text = f"""<form><var name="o" expr="{{a: [1, {{b: 2}}]}}"/><block><assign name="o.a[1].b" expr="3"/>
        <assign name="dialog.o.a[0]" expr="4"/><assign name="o['c']" expr="5"/>
        {holds("o.a[0] == 4 &amp;&amp; o.a[1].b == 3 &amp;&amp; o.c == 5")}</block></form>"""
    assert run(text).logs() == ["pass"]


def test_clear_resets_the_prompts_counter() -> None:  # 5.3.3
    call = Call(
        """<form><field name="f"><prompt>One?</prompt><prompt count="2">Two?</prompt>
        <option>yes</option><nomatch><clear namelist="f"/><reprompt/></nomatch></field></form>"""
    )
    call.answer("no")
    assert call.said() == ["One?", "One?"]


def test_clear_may_name_a_scope() -> None:  # 5.3.3
    call = run(
        f"""<var name="x" expr="1"/><form><var name="x" expr="2"/><block>
        <clear namelist="document.x"/>{holds("x == 2 &amp;&amp; document.x === undefined")}</block></form>"""
    )
    assert call.logs() == ["pass"]


@pytest.mark.parametrize("name", ["x[1]", "o[f()]", "o[1", "1", "o, p", "o[1], p[2]"])
def test_what_is_no_variable_is_not_assigned(name: str) -> None:
    refused = "<catch event='error.semantic'><log>refused</log><exit/></catch>"
    text = f"""{refused}<form><var name="o" expr="[]"/><block><assign name="{name}" expr="1"/>
        </block></form>"""
    assert run(text).logs() == ["refused"]
