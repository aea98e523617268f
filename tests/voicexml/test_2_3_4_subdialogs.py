"""Subdialogs, their parameters and what they give back: VoiceXML 2.0, 2.3.4 and 6.4."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    FAIL,
    LEAF,
    PAGE,
    PASS,
    TRIP,
    Case,
    Cases,
    holds,
    leaf,
    page,
    run,
)
from tests.helpers.voice import Call

case = Cases()

case(
    "a param's value and expr reach the subdialog's variables",
    "2.3.4",
    """<form><var name="n" expr="20"/><subdialog name="s" src="#t"><param name="a" expr="n + 1"/>
    <param name="b" value="n + 1"/></subdialog></form>
    <form id="t"><var name="a" expr="0"/><var name="b"/><block><log expr="a"/><log expr="b"/>
    <return/></block></form>""",
    logs=["21", "n + 1"],
)
case(
    "a param replaces the expr of the variable",
    "2.3.4",
    """<form><subdialog name="s" src="#t"><param name="a" expr="7"/></subdialog></form>
    <form id="t"><var name="a" expr="0"/><var name="b" expr="a + 1"/><block><log expr="b"/>
    <return/></block></form>""",
    logs=["8"],
)
case(
    "a param whose value is undefined leaves the variable undefined",
    "2.3.4",
    """<form><var name="u"/><subdialog name="s" src="#t"><param name="a" expr="u"/></subdialog></form>
    <form id="t"><var name="a" expr="1"/><block><log expr="typeof a"/><return/></block></form>""",
    logs=["undefined"],
)
case(
    "a param for a variable that is not declared is error.semantic",
    "2.3.4",
    """<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><subdialog name="s" src="#t"><param name="zz" expr="7"/></subdialog></form>
    <form id="t"><block><log>in</log><return/></block></form>""",
    logs=["semantic"],
)
case(
    "a param cannot set a form item's variable",
    "2.3.4",
    f"""<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><subdialog name="s" src="#t"><param name="f" expr="7"/></subdialog></form>
    <form id="t"><field name="f">{CITIES}</field></form>""",
    logs=["semantic"],
)
case(
    "an object is passed to a subdialog by value",
    "2.3.4",
    """<form><var name="o" expr="({n: 1})"/><subdialog name="s" src="#t"><param name="a" expr="o"/>
    <filled><log expr="o.n"/></filled></subdialog></form>
    <form id="t"><var name="a"/><block><assign name="a.n" expr="5"/><return/></block></form>""",
    logs=["1"],
)
case(
    "an object's member is passed as a member whatever its name is",
    "2.3.4",
    """<form><var name="o" expr="JSON.parse('{&quot;__proto__&quot;: {&quot;n&quot;: 1}}')"/>
    <subdialog name="s" src="#t"><param name="a" expr="o"/>
    <filled><log expr="JSON.stringify(s.a) + s.a.n"/></filled></subdialog></form>
    <form id="t"><var name="a"/><block><return namelist="a"/></block></form>""",
    logs=['{"__proto__":{"n":1}}undefined'],
)
case(
    "what is returned becomes properties of the subdialog's variable",
    "2.3.4",
    """<form><subdialog name="s" src="#t"><filled><log expr="s.a + s.b.c"/></filled></subdialog></form>
    <form id="t"><var name="a" expr="1"/><var name="b" expr="({c: 2})"/>
    <block><return namelist="a b"/></block></form>""",
    logs=["3"],
)
case(
    "a field's value is returned by its name",
    "2.3.4",
    f"""<form><subdialog name="s" src="#t"/><block><log expr="s.f"/></block></form>
    <form id="t"><field name="f"><prompt>Where?</prompt>{CITIES}<filled><return namelist="f"/>
    </filled></field></form>""",
    "nara",
    logs=["Nara"],
)
case(
    "after a returned event the subdialog is not filled",
    "2.3.4",
    """<form><var name="n" expr="0"/><subdialog name="s" src="#t"><catch event="odd">
    <assign name="n" expr="n + 1"/><log expr="typeof s"/></catch>
    <catch event="odd" count="2"><log>twice</log><exit/></catch><filled><log>no</log></filled>
    </subdialog></form><form id="t"><block><return event="odd"/></block></form>""",
    logs=["undefined", "twice"],
)
case(
    "a subdialog whose form is exhausted ends the application",
    "2.3.4",
    """<form><subdialog name="s" src="#t"/><block><log>after</log></block></form>
    <form id="t"><block><log>in</log></block></form>""",
    logs=["in"],
    ended="exit",
)
case(
    "the caller's dialog variables are not seen in a subdialog",
    "2.3.4",
    """<form><var name="n" expr="1"/><subdialog name="s" src="#t"/></form>
    <form id="t"><block><log expr="typeof n"/><return/></block></form>""",
    logs=["undefined"],
)
case(
    "the caller's document is initialised anew for a subdialog in it",
    "2.3.4",
    """<var name="n" expr="1"/><form><block><assign name="n" expr="2"/></block>
    <subdialog name="s" src="#t"/><block><log expr="n"/></block></form>
    <form id="t"><block><log expr="n"/><return/></block></form>""",
    logs=["1", "2"],
)
case(
    "the caller's handlers take nothing thrown in a subdialog",
    "2.3.4",
    """<form><catch event="odd"><log>caller</log></catch><subdialog name="s" src="#t"/></form>
    <form id="t"><block><throw event="odd"/></block></form>""",
    logs=[],
    ended="odd",
)
case(
    "the caller's form grammar does not listen in a subdialog",
    "2.3.4",
    f"""<form>{TRIP}<subdialog name="s" src="#t"/><field name="start"/></form>
    <form id="t"><field name="f">{CITIES}<nomatch><log>no</log></nomatch></field></form>""",
    "from Nara",
    logs=["no"],
)
case(
    "a subdialog may go through many dialogs before it returns",
    "2.3.4",
    """<form><subdialog name="s" src="#t"/><block><log expr="s.n"/></block></form>
    <form id="t"><block><goto next="#u"/></block></form>
    <form id="u"><var name="n" expr="4"/><block><return namelist="n"/></block></form>""",
    logs=["4"],
)
case(
    "a subdialog may be in another document with a root of its own",
    "2.3.4",
    """<var name="n" expr="1"/><form><subdialog name="s" src="other.vxml#t"/>
    <block><log expr="s.n + n"/></block></form>""",
    logs=["11"],
    files={
        "other": f"{LEAF}<form/><form id='t'><var name='n' expr='application.m'/><block>"
        "<return namelist='n'/></block></form></vxml>",
        "root": f"{PAGE}<var name='m' expr='10'/></vxml>",
    },
)
case(
    "the first dialog of a document is the subdialog where none is named",
    "2.3.4",
    """<form><subdialog name="s" src="other.vxml"/><block><log>back</log></block></form>""",
    logs=["in", "back"],
    files={"other": f"{PAGE}<form><block><log>in</log><return/></block></form></vxml>"},
)
case(
    "a subdialog's document that is not there is error.badfetch in the caller",
    "2.3.4",
    """<form><subdialog name="s" src="none.vxml"><catch event="error.badfetch"><log>bad</log><exit/>
    </catch></subdialog></form>""",
    logs=["bad"],
)
case(
    "a subdialog within a subdialog comes back to it",
    "2.3.4",
    """<form><subdialog name="s" src="#t"/><block><log expr="s.n"/></block></form>
    <form id="t"><var name="n"/><subdialog name="s" src="#u"/>
    <block><assign name="n" expr="s.m + 1"/><return namelist="n"/></block></form>
    <form id="u"><var name="m" expr="1"/><block><return namelist="m"/></block></form>""",
    logs=["2"],
)
case(
    "a subdialog's condition is its guard",
    "2.3.4",
    """<form><subdialog name="s" src="#t" cond="false"/><block><log>after</log></block></form>
    <form id="t"><block><log>in</log><return/></block></form>""",
    logs=["after"],
)
case(
    "a subdialog's handler of a returned event may go to another item",
    "2.3.4",
    """<form><subdialog name="s" src="#t"><catch event="odd"><goto nextitem="b"/></catch></subdialog>
    <block><log>no</log></block><block name="b"><log>b</log><exit/></block></form>
    <form id="t"><block><return event="odd"/></block></form>""",
    logs=["b"],
)
case(
    "after a returned event the caller's document is as it was",
    "2.3.4",
    """<var name="n" expr="1"/><catch event="odd"><log expr="document.n"/><exit/></catch>
    <form><block><assign name="n" expr="2"/></block><subdialog name="s" src="#t"/></form>
    <form id="t"><block><return event="odd"/></block></form>""",
    logs=["2"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_subdialog_of_the_same_root_has_one_of_its_own() -> None:  # 2.3.4
    call = run(
        leaf(
            f"""<form><block><assign name="n" expr="9"/></block><subdialog name="s" src="b.vxml"/>
            <block>{holds("s.v == 1 &amp;&amp; n == 9")}</block></form>"""
        ),
        root=page('<var name="n" expr="1"/><form><block/></form>'),
        b=leaf('<form><var name="v" expr="n"/><block><return namelist="v"/></block></form>'),
    )
    assert call.logs() == ["pass"]


def test_a_param_has_an_expression_or_a_value() -> None:  # 6.4
    call = Call(
        """<form><subdialog name="r" src="#s"><param name="a" expr="1 + 1"/>
        <param name="b" value="x" valuetype="data"/><filled><log expr="r.c"/></filled></subdialog></form>
        <form id="s"><var name="a"/><var name="b"/><var name="c"/>
        <block><assign name="c" expr="a + b"/><return namelist="c"/></block></form>"""
    )
    assert call.logs() == ["2x"]


def test_a_parameter_without_a_variable_is_first_the_subdialogs_to_handle() -> None:  # 6.4
    catch = f'<catch event="error.semantic">{PASS}</catch>'
    text = """<form><subdialog name="s" src="b.vxml"><param name="q" expr="1"/>{}
    </subdialog></form>"""
    inner = page(f"<form>{catch}<block><return/></block></form>")
    assert run(text.format(f'<catch event="error">{FAIL}</catch>'), b=inner).logs() == ["pass"]
    bare = page("<form><block><return/></block></form>")
    assert run(text.format(catch), b=bare).logs() == ["pass"]


GIVES = """<form id="s"><var name="n" expr="null"/><var name="d" expr="new Date(0)"/>
<var name="o" expr="{c: undefined, x: NaN, f: /a/}"/><var name="u"/>
<block><return namelist="n d o u"/></block></form>"""


@pytest.mark.parametrize(
    "cond",
    [
        "s.n === null",
        "s.d.getTime() === 0",
        "'c' in s.o &amp;&amp; s.o.c === undefined",
        "isNaN(s.o.x)",
        "s.o.f.test('a')",
        "'u' in s &amp;&amp; s.u === undefined",
    ],
)
def test_what_a_subdialog_gives_back_is_what_it_was(cond: str) -> None:
    text = f'<form><subdialog name="s" src="#s"/><block>{holds(cond)}</block></form>{GIVES}'
    assert run(text).logs() == ["pass"]


@pytest.mark.parametrize(
    ("given", "cond"),
    [
        ("null", "p === null"),
        ("undefined", "p === undefined"),
        ("new Date(0)", "p.getTime() === 0"),
        ("[1, undefined, null]", "p[1] === undefined &amp;&amp; p[2] === null"),
        ("function () { return 3; }", "p() === 3"),
        ("(function () { var o = {}; o.o = o; return o; })()", "p.o === p"),
        ("[1,,3,,]", "p.length == 4 &amp;&amp; !(1 in p)"),
    ],
)
def test_a_parameter_is_what_it_was(given: str, cond: str) -> None:
    text = f"""<form><subdialog name="s" src="#s"><param name="p" expr="{given}"/></subdialog></form>
        <form id="s"><var name="p"/><block>{holds(cond)}</block></form>"""
    assert run(text).logs() == ["pass"]


def test_a_subdialog_changes_nothing_of_its_caller() -> None:
    text = f"""<form><var name="o" expr="{{n: [1]}}"/><subdialog name="s" src="#s">
        <param name="p" expr="o"/></subdialog><block>{holds("o.n[0] == 1 &amp;&amp; s.p.n[0] == 2")}
        </block></form><form id="s"><var name="p"/><block><assign name="p.n" expr="[2]"/>
        <return namelist="p"/></block></form>"""
    assert run(text).logs() == ["pass"]


def test_a_subdialog_has_a_context_of_its_own() -> None:
    call = Call(
        """<var name="n" expr="1"/>
        <form id="a"><subdialog name="r" src="#s"><param name="p" expr="n + 1"/>
          <filled><log><value expr="r.q"/> <value expr="n"/></log></filled></subdialog></form>
        <form id="s"><var name="p"/><var name="q"/>
          <block><assign name="n" expr="99"/><assign name="q" expr="p * 10"/>
          <return namelist="q"/></block></form>"""
    )
    assert call.logs() == ["20 1"]
