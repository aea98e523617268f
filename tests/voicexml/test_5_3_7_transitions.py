"""Executable content from goto to log: VoiceXML 2.0, 5.3.7 to 5.3.13."""

from __future__ import annotations

import pytest

from prima.voicexml.reading import read_page
from tests.helpers.dialogs import CITIES, FAIL, PAGE, PASS, YES, Case, Cases, block, logged, run
from tests.helpers.voice import HEAD, Call, Online, vxml

case = Cases()

case(
    "goto expritem computes the item",
    "5.3.7",
    """<form><block><goto expritem="'b' + 1"/></block><block name="a"><log>a</log></block>
    <block name="b1"><log>b1</log></block></form>""",
    logs=["b1", "a"],
)
case(
    "goto an item that is not there is error.badfetch",
    "5.3.7",
    """<form><catch event="error.badfetch"><log>bad</log></catch>
    <block><goto nextitem="nope"/></block></form>""",
    logs=["bad"],
)
case(
    "a goto to an item keeps the form's variables",
    "5.3.7",
    """<form><var name="n" expr="1"/><block><assign name="n" expr="5"/><goto nextitem="b"/></block>
    <block name="b"><log expr="n"/></block></form>""",
    logs=["5"],
)
case(
    "a document fetched again is initialised again",
    "5.3.7",
    """<var name="x" expr="1"/><form><block><assign name="x" expr="2"/>
    <goto next="app.vxml#t"/></block></form><form id="t"><block><log expr="x"/></block></form>""",
    logs=["1"],
    files={
        "app": f"{PAGE}<var name='x' expr='1'/><form/><form id='t'><block><log expr='x'/></block>"
        "</form></vxml>"
    },
)
case(
    "a dialog that is not there is error.badfetch",
    "5.3.7",
    logged("error.badfetch", "<block><goto next='#zz'/></block>"),
    logs=["error.badfetch"],
)
case(
    "a dialog that is not there in another document is error.badfetch",
    "5.3.7",
    logged("error.badfetch", "<block><goto next='other.vxml#zz'/></block>"),
    logs=["error.badfetch"],
    files={"other": f"{PAGE}<form/></vxml>"},
)
case(
    "a goto leaves the content at once",
    "5.3.7",
    """<form><block><goto next="#t"/><log>no</log></block></form>
    <form id="t"><block><log>t</log></block></form>""",
    logs=["t"],
)
case(
    "goto may be computed",
    "5.3.7",
    """<form><block><goto expr="'#' + 't'"/></block></form>
    <form id="t"><block><log>t</log></block></form>""",
    logs=["t"],
)
case(
    "goto another document's first dialog",
    "5.3.7",
    """<form><block><goto next="other.vxml"/></block></form>""",
    logs=["first"],
    files={"other": f"{PAGE}<form><block><log>first</log></block></form></vxml>"},
)
case(
    "a goto to an item from a menu is error.badfetch",
    "5.3.7",
    """<menu><choice event="a">news</choice><catch event="a"><goto nextitem="x"/></catch>
    <catch event="error.badfetch"><log>bad</log><exit/></catch></menu>""",
    "news",
    logs=["bad"],
)
case(
    "a computed goto to what is not declared is error.semantic",
    "5.3.7",
    logged("error.semantic", "<block><goto expr='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "submit fetches a document",
    "5.3.8",
    """<form><var name="n" expr="1"/><block><submit next="other.vxml" namelist="n"/></block></form>""",
    logs=["got"],
    files={"other": f"{PAGE}<form><block><log>got</log></block></form></vxml>"},
)
case(
    "submit of a variable that is not declared is error.semantic",
    "5.3.8",
    logged("error.semantic", "<block><submit next='other.vxml' namelist='zz'/></block>"),
    logs=["error.semantic"],
    files={"other": f"{PAGE}<form/></vxml>"},
)
case(
    "an exit in a subdialog ends the application",
    "5.3.9",
    """<form><subdialog name="s" src="#t"/><block><log>after</log></block></form>
    <form id="t"><block><exit/></block></form>""",
    logs=[],
    ended="exit",
)
case(
    "exit ends the application and throws nothing",
    "5.3.9",
    """<form><catch><log>no</log></catch><block>Bye.<exit/><log>no</log></block></form>""",
    said=["Bye."],
    logs=[],
    ended="exit",
)
case(
    "exit's expression is evaluated",
    "5.3.9",
    logged("error.semantic", "<block><exit expr='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "a handler may end the application",
    "5.3.9",
    """<form><catch event="a">Bye.<exit/></catch><block><throw event="a"/></block></form>""",
    said=["Bye."],
    ended="exit",
)
case(
    "a return without a namelist gives an empty object",
    "5.3.10",
    """<form><subdialog name="s" src="#t"/><block><log expr="JSON.stringify(s)"/></block></form>
    <form id="t"><block><return/></block></form>""",
    logs=["{}"],
)
case(
    "an undefined variable is returned as undefined",
    "5.3.10",
    """<form><subdialog name="s" src="#t"/><block><log expr="typeof s.a"/></block></form>
    <form id="t"><var name="a"/><block><return namelist="a"/></block></form>""",
    logs=["undefined"],
)
case(
    "a variable that is not declared cannot be returned",
    "5.3.10",
    """<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><subdialog name="s" src="#t"/></form>
    <form id="t"><block><return namelist="zz"/></block></form>""",
    logs=["semantic"],
)
case(
    "a returned event is thrown in the caller at the subdialog",
    "5.3.10",
    """<form><subdialog name="s" src="#t"><catch event="odd"><log expr="_event"/><exit/></catch>
    </subdialog></form><form id="t"><catch event="odd"><log>not here</log></catch>
    <block><return event="odd.one"/></block></form>""",
    logs=["odd.one"],
)
case(
    "a returned event may be computed and have a message",
    "5.3.10",
    """<form><subdialog name="s" src="#t"><catch event="odd"><log expr="_event + _message"/><exit/>
    </catch></subdialog></form><form id="t"><var name="n" expr="2"/>
    <block><return eventexpr="'odd.' + n" messageexpr="'m' + n"/></block></form>""",
    logs=["odd.2m2"],
)
case(
    "a return where no subdialog runs is error.semantic",
    "5.3.10",
    """<catch event="error.semantic"><log>semantic</log><exit/></catch>
    <form><block><return/></block></form>""",
    logs=["semantic"],
)
case(
    "a handler in a subdialog may return",
    "5.3.10",
    f"""<form><subdialog name="s" src="#t"><filled><log expr="s.n"/></filled></subdialog></form>
    <form id="t"><var name="n" expr="8"/><field name="f">{CITIES}
    <nomatch><return namelist="n"/></nomatch></field></form>""",
    "x",
    logs=["8"],
)
case(
    "disconnect throws connection.disconnect.hangup",
    "5.3.11",
    """<form><catch event="connection.disconnect.hangup"><log>hangup</log></catch>
    <block><disconnect/></block></form>""",
    logs=["hangup"],
)
case(
    "disconnect says what is queued first",
    "5.3.11",
    """<form><catch event="connection.disconnect.hangup"><log>hangup</log></catch>
    <block>Bye.<disconnect/></block></form>""",
    said=["Bye."],
    logs=["hangup"],
)
case(
    "a disconnect in a subdialog is the subdialog's event",
    "5.3.11",
    """<form><catch event="connection"><log>caller</log></catch><subdialog name="s" src="#t"/></form>
    <form id="t"><catch event="connection"><log>subdialog</log><exit/></catch>
    <block><disconnect/></block></form>""",
    logs=["subdialog"],
)
case(
    "a script's functions and variables are of the scope that the script is in",
    "5.3.12",
    """<script>var d = 1; function twice(x) { return x * 2; }</script>
    <form><script>var e = twice(d);</script><block><script>var f = e + 1;</script>
    <log expr="document.d + ',' + dialog.e + ',' + f"/></block>
    <block><log expr="typeof f"/></block></form>""",
    logs=["1,2,3", "undefined"],
)
case(
    "a script may be fetched",
    "5.3.12",
    """<script src="s.js"/><form><block><log expr="f(2)"/></block></form>""",
    logs=["4"],
    files={"s.js": "function f(x) { return x * x; }"},
)
case(
    "a script assigns variables of its scopes",
    "5.3.12",
    """<var name="x" expr="1"/><form><block><script>x = 7;</script><log expr="document.x"/></block>
    </form>""",
    logs=["7"],
)
case(
    "a script that is not there is error.badfetch",
    "5.3.12",
    logged("error.badfetch", "<block><script src='none.js'/></block>"),
    logs=["error.badfetch"],
)
case(
    "a script that fails is error.semantic",
    "5.3.12",
    logged("error.semantic", "<block><script>null.x;</script></block>"),
    logs=["error.semantic"],
)
case(
    "log takes text, values, an expression and a label",
    "5.3.13",
    """<form><block><log label="l" expr="1 + 1">a <value expr="'b'"/> </log></block></form>""",
    logs=["l: a b 2"],
)
case(
    "log says nothing",
    "5.3.13",
    "<form><block><log>quiet</log></block></form>",
    said=[],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_fragment_leads_to_a_dialog_of_another_document() -> None:  # 5.3.7
    call = Call(
        block('<goto next="other.vxml#b"/>'),
        other=vxml('<form id="a"><block><log>a</log></block></form>'
                   '<form id="b"><block><log>b</log></block></form>'),
    )  # fmt: skip
    assert call.logs() == ["b"]


def test_a_fragment_may_be_written_with_percent_signs() -> None:  # 6.1.1
    other = vxml('<form id="a"/><form id="é"><block><log>é</log></block></form>')
    start = '<form id="form"><block><goto next="other.vxml#%C3%A9"/></block></form>'
    text = vxml('<form id="a"><block><goto next="#f%6Frm"/></block></form>' + start)
    assert Call(text, other=other).logs() == ["é"]
    assert read_page("app.vxml", "app.vxml", text.encode()).warnings() == []


def test_a_fragment_alone_keeps_the_documents_variables() -> None:  # 5.3.7
    call = Call(
        '<var name="a" expr="1"/><form><block><assign name="a" expr="2"/><goto next="#b"/></block>'
        '</form><form id="b"><block><log expr="a"/></block></form>'
    )
    assert call.logs() == ["2"]


def test_a_goto_to_no_item_is_handled_in_the_dialogs_scope() -> None:  # 5.3.7
    call = run(
        f"""<form><catch event="error.badfetch">{PASS}</catch><field name="f">{YES}
        <catch event="error.badfetch">{FAIL}</catch>
        <filled><goto nextitem="none"/></filled></field></form>""",
        "yes",
    )
    assert call.logs() == ["pass"]


@pytest.mark.parametrize(
    "lead",
    [
        '<block><goto next="http://x/a"/></block>',
        '<subdialog src="http://x/a"><filled><goto next="#again"/></filled></subdialog>',
    ],
)
def test_a_document_from_outside_is_requested_each_time_and_its_root_once(lead: str) -> None:
    answered = f"""{HEAD[:-1]} application="http://x/root"><form><field name="f">
    <prompt>Again?</prompt>{YES}<filled><goto next="http://x/a"/></filled></field></form></vxml>"""
    root = vxml('<var name="r"/>')  # 6.1.2: nothing says how long an answer may be kept
    call = Online(
        {"http://x/a": answered, "http://x/root": root}, f'<form id="again">{lead}</form>'
    )
    call.answer("yes", "yes")
    asked = [order.data["to"] for order in call.orders if order.verb == "send"]
    assert asked == ["http://x/a", "http://x/root", "http://x/a", "http://x/a"]


@pytest.mark.parametrize("uri", ["##1", "#%231", "app.vxml##1"])
def test_a_dialog_without_an_id_has_no_uri(uri: str) -> None:
    lead = logged("error.badfetch", f'<block><goto next="{uri}"/></block>')
    assert Call(lead, **{"app.vxml": vxml(lead)}).logs() == ["error.badfetch"]


def test_exit_gives_its_values_to_the_transcript() -> None:  # 5.3.9
    assert Call(block("<exit expr=\"'done'\"/>")).logs() == ['exit: "done"']
    call = Call(block('<var name="a" expr="[1]"/><exit namelist="a"/>'))
    assert (call.logs(), call.ended) == (['exit: {"a": [1]}'], "exit")


def test_a_scripts_charset_is_accepted() -> None:  # 5.3.12
    call = Call(
        block('<script src="s.js" charset="UTF-8"/><log expr="a"/>'), **{"s.js": "var a = 'é';"}
    )
    assert call.logs() == ["é"]


def test_a_script_with_a_charset_that_is_none_is_read_as_utf_8() -> None:  # 5.3.12
    script = '<script src="s.js" charset="none-such"/><log expr="a"/>'
    assert Call(block(script), **{"s.js": "var a = 'é';"}).logs() == ["é"]


def test_what_fails_in_a_scripts_file_is_told_with_its_line() -> None:
    catch = '<catch event="error.semantic"><log expr="_message"/><exit/></catch>'
    (said,) = Call(
        f"{catch}<form><block><script src='s.js'/></block></form>",
        **{"s.js": "var a = 1;\nnone.b = a;"},
    ).logs()
    assert said.endswith(": s.js: line 2: ReferenceError: none is not defined")


def test_a_submit_to_a_service_names_a_dialog_that_there_is() -> None:
    catch = '<catch event="error.badfetch"><log expr="_message"/><exit/></catch>'
    call = Call(f"{catch}<form><block><submit next='service:x#none'/></block></form>")
    assert call.logs()[0].endswith('there is no dialog "none"')
    assert not [one for one in call.orders if one.verb == "send"]


def test_where_no_dialog_is_active_there_is_no_item_to_go_to() -> None:
    call = Call(
        """<var name="x" expr="none.y"/><catch event="error.semantic"><goto nextitem="a"/></catch>
        <catch event="error.badfetch"><log expr="_message"/><exit/></catch>
        <form><block name="a">Hi.</block></form>"""
    )
    assert call.logs()[0].endswith('there is no form item "a"') and call.said() == []


def test_what_another_form_hears_may_lead_to_any_of_its_items() -> None:  # 2.4
    call = Call(
        """<form><field name="x" type="digits"><prompt>A?</prompt></field></form>
        <form scope="document"><grammar version="1.0" mode="voice" root="r">
        <rule id="r">jump <tag>out.y = "z";</tag></rule></grammar>
        <field name="y"><filled><goto nextitem="last"/></filled></field>
        <block>First.</block><block name="last">Last.</block></form>"""
    )
    call.answer("jump")
    assert call.said() == ["A?", "Last.", "First."]


def test_a_scripts_text_may_be_cdata() -> None:  # 5.3.12
    call = Call(block('<script><![CDATA[var a = 1 < 2 && 3 > 2;]]></script><log expr="a"/>'))
    assert call.logs() == ["true"]


def test_submit_to_a_service_sends_and_the_reply_is_an_event() -> None:
    call = Call(
        """<catch event="reply.weather"><log expr="session.event.data.sky"/><exit/></catch>
        <form><block><var name="city" expr="'Nara'"/><submit next="service:weather#wait" namelist="city"/>
        </block></form><form id="wait"><field name="f"><prompt>One moment.</prompt>
        <option>stop</option></field></form>"""
    )
    assert [o.data for o in call.orders if o.verb == "send"] == [
        {"to": "weather", "params": {"city": "Nara"}}
    ]
    call.event("reply.weather", sky="blue")
    assert call.logs() == ["blue"]
