"""Additions of VoiceXML 2.1: expressions for sources, marks, data, foreach, disconnect with names."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.markup.reader import parse
from prima.voicexml.access import host_of_page, may_read
from prima.voicexml.document import Page
from prima.voicexml.dom import plain_tree
from prima.voicexml.site import site_of
from tests.helpers.dialogs import (
    FAIL,
    PASS,
    YES,
    Case,
    Cases,
    ask,
    block,
    check_page,
    file,
    grammar,
    holds,
    logged,
    run,
    said,
)
from tests.helpers.spoken import Played
from tests.helpers.voice import Call

case = Cases()

case(
    "foreach runs its content for each element",
    "2.1, 6",
    """<form><var name="list" expr="['a', 'b']"/><block><foreach item="x" array="list">
    <if cond="x == 'a'"><log>first</log></if><log expr="x"/><prompt><value expr="x"/></prompt>
    </foreach></block></form>""",
    logs=["first", "a", "b"],
    said=["a", "b"],
)
case(
    "foreach of no array is error.semantic",
    "2.1, 6",
    logged("error.semantic", "<block><foreach item='x' array='5'><log>no</log></foreach></block>"),
    logs=["error.semantic"],
)
case(
    "foreach goes through a copy of the array",
    "2.1, 6",
    """<form><var name="list" expr="[1, 2]"/><block><foreach item="x" array="list">
    <script>list.push(x + 10);</script><log expr="x"/></foreach><log expr="list.length"/></block>
    </form>""",
    logs=["1", "2", "4"],
)
case(
    "foreach in a prompt says its content for each element",
    "2.1, 6",
    """<form><var name="list" expr="['a', 'b']"/><block><prompt>So
    <foreach item="x" array="list"><value expr="x"/> and </foreach> on.</prompt></block></form>""",
    said=["So a and b and on."],
)
case(
    "a subdialog's source may be computed",
    "2.3.4",
    """<form><subdialog name="s" srcexpr="'#' + 't'"/><block><log>back</log></block></form>
    <form id="t"><block><log>in</log><return/></block></form>""",
    logs=["in", "back"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_grammars_srcexpr_is_evaluated_when_it_listens() -> None:  # 2.1, 2
    call = Call(
        """<var name="n" expr="'a'"/><form><field name="f"><prompt>Well?</prompt>
        <grammar srcexpr="n + '.grxml'"/><nomatch><assign name="n" expr="'b'"/><reprompt/></nomatch>
        <filled><log expr="f"/></filled></field></form>""",
        **{"a.grxml": file("tea"), "b.grxml": file("coffee")},
    )
    call.answer("coffee", "coffee")
    assert call.logs() == ["coffee"]


def test_a_grammars_srcexpr_that_fails_is_error_semantic() -> None:  # 2.1, 2
    call = Call(
        '<catch event="error.semantic"><log>bad</log><exit/></catch>'
        + ask('<grammar srcexpr="none"/>')
    )
    assert call.logs() == ["bad"]


def test_foreach_may_stand_in_foreach() -> None:  # 2.1, 6
    assert said(
        """<prompt><foreach item="i" array="[[1, 2], [3]]"><foreach item="j" array="i">
        <value expr="j"/></foreach>;</foreach></prompt>"""
    ) == ["1 2; 3;"]


@pytest.mark.parametrize("element", ["script", 'data name="d"'])
def test_an_expression_that_gives_no_uri_is_error_badfetch(element: str) -> None:  # 2.1, 3 and 5
    content = f"<block><{element} srcexpr=\"''\"/></block>"
    assert Call(logged("error.badfetch", content)).logs() == ["error.badfetch"]


def test_a_scripts_srcexpr_is_evaluated() -> None:  # 2.1, 3
    call = Call(
        block('<var name="n" expr="\'s\'"/><script srcexpr="n + \'.js\'"/><log expr="a"/>'),
        **{"s.js": "var a = 4;"},
    )
    assert call.logs() == ["4"]


NEWS = (
    '<!-- c --><news xmlns:x="urn:x" date="today"><item id="a">one</item><x:item id="b">two</x:item>'
    "<empty/></news>"
)


@pytest.mark.parametrize(
    ("code", "value"),
    [
        ("d.documentElement.nodeName", "news"),
        ("d.nodeType", "9"),
        ("d.documentElement.nodeType == d.ELEMENT_NODE", "true"),
        ("d.documentElement.getAttribute('date')", "today"),
        ("d.documentElement.getAttribute('none') == ''", "true"),
        ("d.documentElement.attributes.getNamedItem('date').value", "today"),
        ("d.documentElement.childNodes.length", "3"),
        ("d.documentElement.firstChild.firstChild.data", "one"),
        ("d.documentElement.firstChild.nextSibling.nodeName", "x:item"),
        ("d.documentElement.lastChild.previousSibling.textContent", "two"),
        ("d.documentElement.lastChild.hasChildNodes()", "false"),
        ("d.documentElement.firstChild.parentNode.nodeName", "news"),
        ("d.documentElement.firstChild.ownerDocument == d", "true"),
        ("d.getElementsByTagName('item').length", "1"),
        ("d.getElementsByTagNameNS('urn:x', 'item').item(0).textContent", "two"),
        ("d.getElementsByTagName('*').length", "4"),
        ("d.getElementsByTagName('item').item(9) === null", "true"),
        ("d.getElementsByTagName('item').item(-1) === null", "true"),
        ("d.getElementsByTagName('item').item(0.7).textContent", "one"),
        ("d.getElementById('b').textContent", "two"),
        ("d.documentElement.lastChild.namespaceURI === null", "true"),
        ("(d.documentElement.nodeName = 'x', d.documentElement.nodeName)", "news"),
    ],
)
def test_data_gives_a_dom(code: str, value: str) -> None:  # 2.1, 5 and D
    call = Call(block(f'<data name="d" src="d.xml"/><log expr="{code}"/>'), **{"d.xml": NEWS})
    assert call.logs() == [value]


@pytest.mark.parametrize("held", ["{}", "<![CDATA[{}]]>"])
def test_the_text_between_two_tags_is_one_node(held: str) -> None:  # DOM 2, interface Text
    code = "[d.documentElement.childNodes.length, d.documentElement.firstChild.length].join()"
    text = held.format("a few words\n" * 2000)
    call = Call(
        block(f'<data name="d" src="d.xml"/><log expr="{code}"/>'), **{"d.xml": f"<r>{text}</r>"}
    )
    assert call.logs() == ["1,24000"]


def test_the_dom_cannot_be_changed() -> None:  # 2.1, D
    call = Call(
        block(
            """<data name="d" src="d.xml"/><script>var c = 0;
            try { d.documentElement.removeChild(d.documentElement.firstChild); }
            catch (e) { c = e.code; }</script><log expr="c"/>"""
        ),
        **{"d.xml": NEWS},
    )
    assert call.logs() == ["7"]


def test_data_may_stand_in_a_document_and_in_a_form() -> None:  # 2.1, 5
    call = Call(
        """<data name="d" srcexpr="'d' + '.xml'"/><form><data name="e" src="d.xml"/>
        <block><log expr="d.documentElement.nodeName + e.documentElement.nodeName"/></block></form>""",
        **{"d.xml": "<n/>"},
    )
    assert call.logs() == ["nn"]


@pytest.mark.parametrize("content", ["<a", "", "not xml"])
def test_data_that_is_not_xml_is_error_badfetch(content: str) -> None:  # 2.1, 5
    call = Call(block('<data name="d" src="d.xml"/>'), **{"d.xml": content})
    assert call.ended.startswith("error.badfetch")


@pytest.mark.parametrize(
    ("rules", "read"),
    [
        ("", True),
        ("<?other allow='none.example'?>", True),
        ("<?access-control allow='*'?>", True),
        ("<?access-control allow='a.example localhost'?>", True),
        ("<?access-control allow='a.example'?><?access-control allow='LOCALHOST'?>", True),
        ("<?access-control deny='*' allow='localhost'?>", True),
        ("<?access-control allow='a.example'?>", False),
        ("<?access-control allow='*' deny='localhost'?>", False),
        ("<?access-control allow='*' deny='*'?>", False),
        ("<?access-control?>", False),
    ],
)
def test_data_says_who_may_read_it(rules: str, read: bool) -> None:  # 2.1, 5
    refused = '<catch event="error.noauthorization"><log>refused</log><exit/></catch>'
    text = f"<form>{refused}<block><data name='d' src='d.xml'/><log>read</log></block></form>"
    assert Call(text, **{"d.xml": f"{rules}<n/>"}).logs() == ["read" if read else "refused"]


@pytest.mark.parametrize(
    ("rule", "read"),
    [
        ("allow='app.example.org'", True),
        ("allow='*.example.org'", True),
        ("allow='*' deny='*.example.org'", False),
        ("deny='*.example.org' allow='app.example.org'", True),
        ("allow='example.org'", False),
        ("allow='localhost'", False),
    ],
)
def test_who_may_read_data_is_known_by_the_host_of_the_document(rule: str, read: bool) -> None:
    root = parse("a.vxml", b"<vxml/>")
    page = Page("a.vxml", root, site=site_of("a.vxml", "http://App.example.org/x/a.vxml"))
    tree = plain_tree("d.xml", f"<?access-control {rule}?><n/>".encode(), "")
    assert may_read(tree, host_of_page(page)) is read


def test_data_without_name_is_fetched_and_forgotten() -> None:  # 2.1, 5
    call = Call(block('<data src="d.xml"/><log>on</log>'), **{"d.xml": "<n/>"})
    assert call.logs() == ["on"]


def test_data_that_is_not_there_is_error_badfetch() -> None:  # 2.1, 5
    call = Call(block('<data name="d" src="none.xml"/>'))
    assert call.ended.startswith("error.badfetch")


def test_the_last_mark_before_an_answer_is_told() -> None:  # 2.1, 4
    call = Call(
        """<form><field name="f"><prompt>One <mark name="a"/> two <mark nameexpr="'b' + 1"/>?</prompt>
        <option>yes</option><nomatch>No.<log expr="application.lastresult$.markname"/><reprompt/></nomatch>
        <filled><log expr="f$.markname"/>
        <log expr="application.lastresult$.markname"/></filled></field></form>"""
    )
    call.answer("no", "yes")
    assert call.logs() == ["b1", "b1", "b1"]


def test_without_marks_there_is_no_name_of_one() -> None:  # 2.1, 4
    call = Call(
        """<form><block><prompt><mark name="a"/>Hi.</prompt></block><field name="f"><prompt>Well?</prompt>
        <option>yes</option><filled><log expr="f$.markname"/></filled></field>
        <field name="g"><prompt>And?</prompt><option>yes</option>
        <filled><log expr="typeof g$.markname"/></filled></field></form>"""
    )
    call.answer("yes", "yes")
    assert call.logs() == ["a", "undefined"]


def test_disconnect_has_a_namelist() -> None:  # 2.1, 8
    call = Call(block('<var name="a" expr="1"/><disconnect namelist="a"/>'))
    assert (call.logs(), call.ended) == (
        ['disconnect: {"a": 1}'],
        "connection.disconnect.hangup",
    )


def test_disconnect_of_an_undeclared_variable_is_error_semantic() -> None:  # 2.1, 8
    call = Call(block('<disconnect namelist="none"/>'))
    assert call.ended.startswith("error.semantic")


def test_a_consultation_transfer_takes_the_caller_away() -> None:  # 2.1, 9
    call = Call(
        """<form><transfer name="t" dest="tel:+1" type="consultation"/>
        <catch event="connection.disconnect.transfer"><log>gone</log><exit/></catch></form>"""
    )
    call.play()
    assert call.logs() == ["gone"]


def test_an_expression_for_a_grammar_is_evaluated_once_for_a_wait() -> None:  # 2.1, 2
    call = run(
        """<var name="n" expr="0"/><script>function next() { n = n + 1; return n + '.grxml'; }
        </script><form><field name="f"><grammar srcexpr="next()" type="application/srgs+xml"/>
        <nomatch><log expr="n"/></nomatch><filled><log expr="n"/></filled></field></form>""",
        "no",
        "two",
        **{"1.grxml": grammar("one"), "2.grxml": grammar("two")},
    )
    assert call.logs() == ["1", "2"]


DATA = """<?xml version="1.0"?><!-- first --><?do this?><r xmlns="urn:d" xmlns:x="urn:x" a="1"
x:b="2"><!-- in --><x:k id="K">one</x:k><k><![CDATA[<c>]]></k><?do that?></r>"""


def test_data_is_declared_as_var_is() -> None:  # 2.1, 5
    call = run(
        f"""<var name="d" expr="1"/><form><catch event="error.semantic">{holds("d == 1")}</catch>
        <block><data name="d" src="d.xml"/></block>
        <block><data name="document.d" src="d.xml"/>{FAIL}</block></form>""",
        **{"d.xml": DATA},
    )
    assert call.logs() == ["pass"]


def test_a_fetched_document_can_be_given_to_a_subdialog() -> None:  # 2.1, 5
    text = f"""<form><data name="d" src="d.xml"/><subdialog name="s" src="#s">
        <param name="p" expr="d"/></subdialog></form><form id="s"><var name="p"/>
        <block>{holds("p.documentElement.nodeName == 'r'")}</block></form>"""
    assert run(text, **{"d.xml": "<r/>"}).logs() == ["pass"]


def test_what_is_undefined_in_an_array_stays_so() -> None:  # 2.1, 6
    text = """<form><block><foreach item="i" array="[null, undefined, 1]">
        <log expr="typeof i"/></foreach></block></form>"""
    assert run(text).logs() == ["object", "undefined", "number"]


EACH = '<foreach item="i" array="[1]">'
EXECUTABLE = ["<if cond='i'>x</if>", "<script>i</script>", "<log>x</log>", "<goto next='#f'/>"]
MARKUP = ["<break/>", "<emphasis>x</emphasis>", "<s>x</s>", "<mark name='m'/>", "<desc>x</desc>"]
BOTH = ["x", "<value expr='i'/>", "<audio src='a.wav'/>", f"{EACH}x</foreach>"]


@pytest.mark.parametrize(
    ("around", "good", "bad"),
    [
        ("<prompt>{}</prompt>", [*MARKUP[:4], *BOTH], [*EXECUTABLE, "<prompt>x</prompt>"]),
        ("<prompt><prosody>{}</prosody></prompt>", [*MARKUP[:4], *BOTH], EXECUTABLE),
        ("{}", [*EXECUTABLE, *BOTH, "<prompt>x</prompt>"], MARKUP),
        ("<if cond='1'>{}</if>", [*EXECUTABLE, *BOTH], MARKUP),
    ],
)
def test_a_foreach_holds_what_stands_where_it_stands(
    around: str, good: list[str], bad: list[str]
) -> None:  # 2.1, 6
    def codes(held: str) -> list[str]:
        whole = around.format(f"{EACH}{held}</foreach>")
        text = f"<form id='f'><block>{whole}</block></form>"
        return [one.code for one in check_page(text)]

    assert [codes(one) for one in good] == [[]] * len(good)
    assert [codes(one) for one in bad] == [["misplaced-element"]] * len(bad)


def test_audio_may_play_while_data_is_fetched() -> None:  # 2.1, 5
    assert check_page('<form><data src="a.xml" name="d" fetchaudio="b.wav"/></form>') == []


@pytest.mark.parametrize("around", ["{}", "<prompt>{}</prompt>"])
def test_the_item_of_a_foreach_is_a_variable_without_a_scope(around: str) -> None:  # 2.1, 6
    each = around.format("<foreach item='dialog.a' array='[1]'>x</foreach>")
    text = f"<form><catch event='error.semantic'>{PASS}</catch><block>{each}</block></form>"
    call = run(text)
    assert (call.logs(), call.said()) == (["pass"], [])


@pytest.mark.parametrize(
    "cond",
    [
        "d.childNodes.length == 3 && d.firstChild.nodeType == 8 && d.childNodes[1].target == 'do'",
        "d.doctype === null && d.implementation.hasFeature('Core', '2.0') && d.parentNode === null",
        "r.firstChild.nodeName == '#comment' && r.firstChild.data == ' in '",
        "r.lastChild.nodeType == 7 && r.lastChild.nodeName == 'do' && r.lastChild.data == 'that'",
        "r.lastChild.nextSibling === null && r.lastChild.previousSibling.nodeName == 'k'",
        "k.nodeName == 'x:k' && k.localName == 'k' && k.prefix == 'x' && k.namespaceURI == 'urn:x'",
        "d.getElementsByTagName('k').length == 1 && d.getElementsByTagNameNS('*', 'k').length == 2",
        "r.getAttribute('x:b') == '2' && r.getAttributeNS('urn:x', 'b') == '2'",
        "r.hasAttributeNS('urn:x', 'b') && !r.hasAttributeNS('urn:x', 'a') && r.hasAttributes()",
        "r.getAttributeNodeNS('urn:x', 'b').ownerElement === r",
        "r.attributes.getNamedItemNS('urn:x', 'b').nodeValue == '2' && r.attributes.length == 4",
        "r.getAttributeNode('a').firstChild.data == '1' && r.getAttributeNode('a').specified",
        "r.getAttributeNode('a').parentNode === null && r.getAttributeNode('none') === null",
        "r.getAttribute('xmlns:x') == 'urn:x' && r.getAttribute('xmlns') == 'urn:d'",
        "k.nextSibling.firstChild.nodeType == 4 && k.nextSibling.firstChild.data == '<c>'",
        "k.firstChild.substringData(1, 2) == 'ne' && k.firstChild.length == 3",
        "failed(function () { k.firstChild.substringData(9, 1); }) == DOMException.INDEX_SIZE_ERR",
        "failed(function () { r.removeChild(k); }) == DOMException.NO_MODIFICATION_ALLOWED_ERR",
        "failed(function () { r.attributes.removeNamedItem('a'); }) == 7",
        "k.nodeType == Node.ELEMENT_NODE && k.nodeType == k.ELEMENT_NODE && k === r.childNodes[1]",
        "(k.firstChild.nodeValue = 'x', k.firstChild.nodeValue) == 'one' && r.textContent == 'one<c>'",
    ],
)
def test_the_dom_is_whole(cond: str) -> None:
    code = cond.replace("&", "&amp;").replace("<", "&lt;")
    call = run(
        f"""<form><block><data name="d" src="d.xml"/><var name="r" expr="d.documentElement"/>
        <script>var k = d.getElementById('K');
        function failed(what) {{ try {{ what(); }} catch (e) {{ return e.code; }} }}</script>
        {holds(code)}</block></form>""",
        **{"d.xml": DATA},
    )
    assert call.logs() == ["pass"]


def test_what_a_foreach_cannot_hold_is_told_by_where_it_stands() -> None:
    (problem,) = check_page(
        f"<form><block><prompt>{EACH}<log>x</log></foreach></prompt></block></form>"
    )
    assert problem.message == "<log> is not allowed in a <foreach> of a prompt."
    assert "foreach" not in problem.remedy


@pytest.mark.parametrize(
    "cond",
    [
        "f$.recording == 'yes'",
        "f$.recordingsize == 3",
        "f$.recordingduration &gt; 0",
        "application.lastresult$.recording == 'yes'",
        "application.lastresult$[0].recordingduration &gt; 0",
    ],
)
def test_an_utterance_is_recorded_where_that_is_asked_for(cond: str) -> None:
    field = f"<prompt>Q?</prompt>{YES}<filled>{holds(cond)}</filled>"
    on = '<property name="recordutterance" value="true"/>'
    assert run(f'{on}<form><field name="f">{field}</field></form>', "yes").logs() == ["pass"]
    assert run(f'<form><field name="f">{field}</field></form>', "yes").logs() == ["fail"]


def test_what_leads_to_another_dialog_is_recorded_where_it_was_said() -> None:  # 2.1, 7
    on = '<property name="recordutterance" value="true"/>'
    text = f"""<form>{{}}<field name="q"><prompt>Q?</prompt>{YES}</field></form>
    <form scope="document">{{}}{grammar("go", "out.f = 1;")}
    <field name="f"><filled><log expr="f$.recording"/></filled></field></form>"""
    assert run(text.format(on, ""), "go").logs() == ["go"]
    assert run(text.format("", on), "go").logs() == ["undefined"]


def test_what_nobody_understood_is_recorded_and_played_back() -> None:
    text = f"""<property name="recordutterance" value="true"/><form><field name="f"><prompt>Q?</prompt>
        {YES}<nomatch>You said <audio expr="application.lastresult$.recording"/><exit/></nomatch>
        </field></form>"""
    assert run(text, "perhaps").said()[-1] == "You said perhaps"


def test_data_is_a_read_only_dom() -> None:
    call = Call(
        """<form><block><data name="d" src="news.xml"/>
        <log><value expr="d.documentElement.getElementsByTagName('item').item(1).textContent"/></log>
        </block></form>""",
        **{"news.xml": "<news><item>one</item><item>two</item></news>"},
    )
    assert call.logs() == ["two"]


@pytest.mark.parametrize(
    ("on", "kind", "logged"),
    [
        ("true", "audio/basic", "yes"),
        ("true", "audio/foo", "unsupported"),
        ("false", "audio/foo", "yes"),
    ],
)
def test_what_is_said_is_recorded_in_formats_that_there_are(
    on: str, kind: str, logged: str
) -> None:  # 2.1, 7.2
    text = f"""<property name="recordutterance" value="{on}"/>
    <property name="recordutterancetype" value="{kind}"/><form>
    <catch event="error.unsupported.format"><log>unsupported</log><exit/></catch>
    <field name="f"><prompt>Q?</prompt>{YES}<filled><log expr="f"/><exit/></filled></field></form>"""
    says = () if logged == "unsupported" else ("yes",)
    assert run(text, *says).logs() == [logged]


def test_data_of_a_service_has_the_encoding_that_it_declares(
    played: Played, tmp_path: Path
) -> None:
    """Its transcript replays, though its bytes are no UTF-8."""
    text = '<?xml version="1.0" encoding="ISO-8859-1"?><d>caf\xe9</d>'
    (tmp_path / "menu.xml").write_bytes(text.encode("latin-1"))
    made = played(
        block('<data name="d" src="service:menu"/><log expr="d.documentElement.firstChild.data"/>'),
        more='<service name="menu"><reply src="menu.xml"/></service>',
    )
    assert [one["message"] for one in made.records if one["phase"] == "log"] == ["caf\xe9"]
