"""VoiceXML against the Recommendations, sentence by sentence: each document says pass or fail.

What other tests hold already is not said again here.
"""

from __future__ import annotations

import pytest

from prima.errors import Problem
from prima.voicexml.document import read_page
from tests.helpers.voice import Call, vxml

PASS = "<log>pass</log><exit/>"
FAIL = "<log>fail</log><exit/>"
YES = "<option>yes</option>"
SILENT = ""
VXML = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"'


def page(body: str) -> str:
    """A further document."""
    return f"{VXML}>{body}</vxml>"


def leaf(body: str) -> str:
    """A document of the application of root.vxml."""
    return f'{VXML} application="root.vxml">{body}</vxml>'


def grammar(words: str, tag: str = "", attributes: str = "") -> str:
    """A grammar of one phrase, and what it means."""
    meaning = f"<tag>{tag}</tag>" if tag else ""
    return f"""<grammar version="1.0" root="r" xml:lang="en" tag-format="semantics/1.0" {attributes}
    xmlns="http://www.w3.org/2001/06/grammar"><rule id="r">{words}{meaning}</rule></grammar>"""


def holds(cond: str) -> str:
    """Pass if a condition holds, else fail."""
    return f'<if cond="{cond}">{PASS}<else/>{FAIL}</if>'


def run(text: str, *says: str, **files: str) -> Call:
    """Run a document to its end, or to a question that nobody answers."""
    call = Call(text, **files)
    for one in says:
        if one == SILENT:
            call.silent()
        else:
            call.answer(one)
    call.play()
    return call


GO = grammar("go")


# 1.5 and 5.3.7: documents ----------------------------------------------------------------


def test_a_root_that_goes_to_itself_by_its_uri_begins_anew() -> None:  # 1.5.2, 5.3.7
    text = f"""<var name="n" expr="0"/><form><block><assign name="n" expr="n + 1"/>
        <goto next="app.vxml#b"/></block></form><form id="b"><block>{holds("n == 0")}</block></form>"""
    assert run(text, app=page(text)).logs() == ["pass"]


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


# 2.1 and appendix C: the algorithm -----------------------------------------------------------


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


def test_what_fills_no_item_is_the_last_result() -> None:  # 5.1.5
    result = "application.lastresult$"
    call = run(
        f"""<form>{grammar("hi", "out.other = 1")}
        <field name="f" cond="{result} === undefined">{YES}</field>
        <block>{holds(f"{result}.interpretation.other == 1")}</block></form>""",
        "hi",
    )
    assert call.logs() == ["pass"]


def test_a_simple_result_of_a_forms_grammar_fills_no_item() -> None:  # 3.1.6.1
    call = run(
        f"""<form>{grammar("hi", "out = 5")}<field name="f">{YES}
        <filled>{holds("f == 'yes'")}</filled></field></form>""",
        "hi",
        "yes",
    )
    assert call.logs() == ["pass"]


@pytest.mark.parametrize(
    "held",
    [
        "{}<field name='n'><prompt>Which?</prompt></field>",
        "<field name='n'>{}<prompt>Which?</prompt></field>",
        "<field name='n' slot='a.n'>{}<prompt>Which?</prompt></field>",
    ],
)
def test_a_slot_that_is_null_fills_its_item(held: str) -> None:  # 3.1.6
    taken = grammar("none", "out = {n: null, a: {n: null}}")
    text = f"<form>{held.format(taken)}<block>{holds('n === null')}</block></form>"
    assert run(text, "none").logs() == ["pass"]


def test_a_slot_that_is_undefined_fills_no_item() -> None:  # 3.1.6
    taken = grammar("none", "out = {m: 1, n: undefined}")
    text = f"<form>{taken}<field name='m'/><field name='n'/><filled mode='any'>{holds('n == void 0')}</filled></form>"
    assert run(text, "none").logs() == ["pass"]


def test_a_goto_to_no_item_is_handled_in_the_dialogs_scope() -> None:  # 5.3.7
    call = run(
        f"""<form><catch event="error.badfetch">{PASS}</catch><field name="f">{YES}
        <catch event="error.badfetch">{FAIL}</catch>
        <filled><goto nextitem="none"/></filled></field></form>""",
        "yes",
    )
    assert call.logs() == ["pass"]


def test_a_variable_declared_again_without_expr_keeps_its_value() -> None:  # 5.3.1
    call = run(
        f"""<form><var name="x" expr="1"/><var name="x"/><block><var name="y" expr="1"/>
        <var name="y"/>{holds("x == 1 &amp;&amp; y == 1")}</block></form>"""
    )
    assert call.logs() == ["pass"]


def test_clear_may_name_a_scope() -> None:  # 5.3.3
    call = run(
        f"""<var name="x" expr="1"/><form><var name="x" expr="2"/><block>
        <clear namelist="document.x"/>{holds("x == 2 &amp;&amp; document.x === undefined")}</block></form>"""
    )
    assert call.logs() == ["pass"]


def test_a_parameter_without_a_variable_is_first_the_subdialogs_to_handle() -> None:  # 6.4
    catch = f'<catch event="error.semantic">{PASS}</catch>'
    text = """<form><subdialog name="s" src="b.vxml"><param name="q" expr="1"/>{}
    </subdialog></form>"""
    inner = page(f"<form>{catch}<block><return/></block></form>")
    assert run(text.format(f'<catch event="error">{FAIL}</catch>'), b=inner).logs() == ["pass"]
    bare = page("<form><block><return/></block></form>")
    assert run(text.format(catch), b=bare).logs() == ["pass"]


# 2.2 and 2.5: menus and links --------------------------------------------------------------


@pytest.mark.parametrize(
    "item",
    [
        "<block><enumerate/></block>",
        f"""<field name="f"><prompt><enumerate/></prompt>{GO}</field>""",
        f"""<field name="f"><prompt><enumerate><enumerate/></enumerate></prompt>{YES}</field>""",
    ],
)
def test_enumerate_without_choices_is_error_semantic(item: str) -> None:  # 2.2.4
    call = run(f'<form><catch event="error.semantic">{PASS}</catch>{item}</form>')
    assert call.logs() == ["pass"]


def test_a_links_expression_is_evaluated_where_it_is_heard() -> None:  # 2.5
    call = run(
        leaf(
            f"""<form><var name="to" expr="'#y'"/><field name="f">{YES}</field></form>
            <form id="y"><block>{PASS}</block></form>"""
        ),
        "go",
        root=page(f"""<var name="to" expr="'#z'"/><link expr="to">{GO}</link>"""),
    )
    assert call.logs() == ["pass"]


def test_an_utterance_for_another_menu_goes_to_it_first() -> None:  # 3.1.4
    call = run(
        f"""<form><catch event="x">{FAIL}</catch><field name="f">{YES}</field></form>
        <menu scope="document"><choice event="x">go</choice><catch event="x">{PASS}</catch></menu>""",
        "go",
    )
    assert call.logs() == ["pass"]


def test_a_modal_field_hears_its_own_links() -> None:  # 2.3.1, 3.1.4
    call = run(
        f"""<link event="y">{grammar("away")}</link><form><field name="f" modal="true">{YES}
        <link event="x">{GO}</link><catch event="x">{PASS}</catch><catch event="y">{FAIL}</catch>
        <nomatch><log>no</log></nomatch></field></form>""",
        "away",
        "go",
    )
    assert call.logs() == ["no", "pass"]


# 3.1 and 6.3: input ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "item",
    [
        '<field name="f"><prompt>Well?</prompt></field>',
        "<initial><prompt>Well?</prompt></initial>",
        f'<field name="f" modal="true"/><link event="x">{GO}</link>',
    ],
)
def test_to_listen_without_a_grammar_is_error_semantic(item: str) -> None:  # 3.1.4
    call = run(f'<form>{item}<catch event="error.semantic">{PASS}</catch></form>')
    assert call.logs() == ["pass"]


@pytest.mark.parametrize(
    ("key", "typed", "outcome"),
    [
        ("#", "12#", "12"),
        ("*", "12*", "12"),
        ("*", "12", "12"),
        ("*", "12#", "nomatch"),
        ("", "12#", "nomatch"),
    ],
)
def test_the_key_that_ends_an_input(key: str, typed: str, outcome: str) -> None:  # 6.3.3
    call = run(
        f"""<form><property name="termchar" value="{key}"/><field name="f" type="digits">
        <filled><log expr="f"/><exit/></filled><nomatch><log>nomatch</log><exit/></nomatch>
        </field></form>""",
        typed,
    )
    assert call.logs() == [outcome]


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


# 5.2: events ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("lang", "words"),
    [("en-GB", ["There is no help here."]), ("ja", ["ヘルプはありません。"]), ("fr", [])],
)
def test_the_platforms_help_is_in_the_documents_language(lang: str, words: list[str]) -> None:
    """5.2.5."""
    call = run(
        f"""{VXML} xml:lang="{lang}"><form><block><throw event="help"/></block></form></vxml>"""
    )
    assert call.said() == words


def test_events_count_under_the_names_that_handlers_have() -> None:  # 5.2.2
    call = run(
        f"""<form><catch event="a.b" count="2">{PASS}</catch><catch event="a"><log>1</log></catch>
        <block name="x"><throw event="a.b.c"/></block><block><log>on</log></block></form>"""
    )
    assert call.logs() == ["1", "on"]


# VoiceXML 2.1, 5 and appendix D: data ----------------------------------------------------------

DATA = """<?xml version="1.0"?><!-- first --><?do this?><r xmlns="urn:d" xmlns:x="urn:x" a="1"
x:b="2"><!-- in --><x:k id="K">one</x:k><k><![CDATA[<c>]]></k><?do that?></r>"""


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


def test_data_is_declared_as_var_is() -> None:  # 2.1, 5
    call = run(
        f"""<var name="d" expr="1"/><form><catch event="error.semantic">{holds("d == 1")}</catch>
        <block><data name="d" src="d.xml"/></block>
        <block><data name="document.d" src="d.xml"/>{FAIL}</block></form>""",
        **{"d.xml": DATA},
    )
    assert call.logs() == ["pass"]


# What is hostile -------------------------------------------------------------------------------

NAME = "'a.' + 'b.'.repeat(40000) + 'c'"


@pytest.mark.parametrize(
    "text",
    [
        "<form id='a'><block><data name='d' src='d.xml'/><goto next='#a'/></block></form>",
        f"<form><catch event='a'><clear/></catch><block><throw eventexpr=\"{NAME}\"/></block></form>",
        "<catch><throw event='x'/></catch><form><block><throw event='a'/></block></form>",
        "<form id='a'><catch event='error'><goto next='#a'/></catch>"
        "<block><script>while (true) {}</script></block></form>",
        "<form><block>" + "<foreach array='[1, 2]' item='i'>" * 60 + "x" + "</foreach>" * 60
        + "</block></form>",
        "<menu><prompt>" + "<enumerate><value expr='_prompt'/></enumerate>" * 200 + "</prompt>"
        + "<choice next='#a'>word word</choice>" * 200 + "</menu>",
        "<form><subdialog name='s' src='#b'><filled><clear/></filled></subdialog></form>"
        "<form id='b'><block><return/></block></form>",
    ],
    ids=["data", "long names", "throws", "scripts", "foreach", "enumerate", "subdialogs"],
)  # fmt: skip
def test_what_never_waits_ends_with_one_error(text: str) -> None:
    call = run(text, **{"d.xml": "<r>" + "<k/>" * 5000 + "</r>"})
    assert call.ended.startswith("error.semantic")
    assert len(call.phases("error")) == 1


def test_an_event_of_a_very_long_name_is_taken_in_no_time() -> None:
    call = run(
        f"""<form><catch event="a"><log>pass</log></catch><block><throw eventexpr="{NAME}"/>
        </block></form>"""
    )
    assert (call.logs(), call.ended) == (["pass"], "exit")


def test_a_submit_to_the_own_root_starts_it_anew() -> None:  # 1.5.2
    root = vxml('<var name="n" expr="1"/><form><block><log expr="n"/></block></form>')
    head = '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">'
    for leave, seen in (("submit", "1"), ("goto", "8")):
        body = f'<form><block><assign name="n" expr="8"/><{leave} next="root.vxml"/></block></form>'
        assert Call(vxml(body, head), root=root).logs() == [seen]


def test_keys_of_a_grammar_without_tags_are_all_the_keys() -> None:  # 3.1.6
    grammar = (
        '<grammar mode="dtmf" version="1.0" root="r" xmlns="http://www.w3.org/2001/06/grammar">'
        '<rule id="r"><item repeat="2-4"><ruleref uri="#d"/></item></rule><rule id="d"><one-of>'
        "<item>1</item><item>2</item><item>3</item></one-of></rule></grammar>"
    )
    call = Call(
        f'<form><field name="q"><prompt>Number?</prompt>{grammar}'
        '<filled><log expr="q"/></filled></field></form>'
    )
    call.answer("1 2 3")
    assert call.logs() == ["123"]


def test_a_private_rule_does_not_listen_for_a_document() -> None:  # SRGS 3.2
    abnf = "#ABNF 1.0; language en; root $one; public $one = no; private $two = big;"
    call = Call(
        '<catch event="error.badfetch"><log>refused</log><exit/></catch><form><field name="q">'
        '<prompt>Well?</prompt><grammar src="a.gram#two" type="application/srgs"/></field></form>',
        **{"a.gram": abnf},
    )
    assert call.logs() == ["refused"]


def test_half_a_surrogate_pair_is_shown_as_a_letter_that_is_none() -> None:
    call = Call(
        r"""<form><var name="x" expr="'\ud83d\ude00z'"/><block><log expr="x.charAt(0)"/>
        <log expr="x"/><value expr="x.charAt(0)"/><var name="o" expr="{a: x.charAt(1)}"/>
        <exit namelist="o"/></block></form>"""
    )
    call.play()
    assert call.logs() == ["\ufffd", "\U0001f600z", 'exit: {"o": {"a": "\ufffd"}}']
    assert call.said() == ["\ufffd"]


def test_parameters_that_exclude_each_other_are_badfetch() -> None:  # Appendix P
    for kind in ("digits?minlength=5;maxlength=3", "digits?length=3;minlength=1"):
        call = Call(
            '<catch event="error.badfetch"><log>refused</log><exit/></catch>'
            f'<form><field name="q" type="{kind}"><prompt>Well?</prompt></field></form>'
        )
        assert call.logs() == ["refused"]


# 3.1.4: grammars of one precedence ----------------------------------------------------------

THIS, OTHER = grammar("go", "out='this'"), grammar("go", "out='other'")
LEAVES = f'<link event="left">{GO}</link>'
BY_LINK = '<catch event="left"><log>link</log><exit/></catch>'


@pytest.mark.parametrize(
    ("document", "first"),
    [
        (f'<form>{LEAVES}{THIS}<field name="f"><prompt>Q?</prompt>{YES}</field></form>', "link"),
        (f'<form><field name="f"><prompt>Q?</prompt>{LEAVES}{THIS}</field></form>', "link"),
        (
            f'<form><field name="f"><prompt>Q?</prompt>{THIS}{LEAVES}<filled><log expr="f"/></filled></field></form>',
            "this",
        ),
        (
            f'<form><field name="f"><prompt>Q?</prompt><option value="option">go</option>{THIS}<filled><log expr="f"/></filled></field></form>',
            "option",
        ),
        (
            f'<form><field name="f"><prompt>Q?</prompt>{YES}</field></form>'
            f'<form scope="document">{grammar("go", "out.g=1")}<field name="g">{YES}<filled><log>form</log><exit/></filled></field></form>{LEAVES}',
            "form",
        ),
        (
            f'<form><field name="f"><prompt>Q?</prompt>{YES}</field></form>{LEAVES}'
            f'<form scope="document">{grammar("go", "out.g=1")}<field name="g">{YES}</field></form>',
            "link",
        ),
    ],
)  # fmt: skip
def test_of_grammars_of_one_precedence_the_first_in_the_document_wins(
    document: str, first: str
) -> None:
    assert run(BY_LINK + document, "go").logs()[:1] == [first]


def test_further_results_come_from_all_grammars_of_a_document() -> None:  # 3.1.4, 5.1.5
    forms = "".join(
        f'<form scope="document">{grammar("go", f"out.{name}=1")}<field name="{name}">{YES}<filled>'
        f'<log expr="application.lastresult$.length"/><exit/></filled></field></form>'
        for name in "gh"
    )
    asks = f'<form><field name="f"><prompt>Q?</prompt>{YES}</field></form>'
    assert run(f'<property name="maxnbest" value="3"/>{asks}{forms}', "go").logs() == ["2"]


# 2.3.4 and 6.4: what goes into a subdialog and comes out of it --------------------------------

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


def test_a_fetched_document_can_be_given_to_a_subdialog() -> None:  # 2.1, 5
    text = f"""<form><data name="d" src="d.xml"/><subdialog name="s" src="#s">
        <param name="p" expr="d"/></subdialog></form><form id="s"><var name="p"/>
        <block>{holds("p.documentElement.nodeName == 'r'")}</block></form>"""
    assert run(text, **{"d.xml": "<r/>"}).logs() == ["pass"]


# Odds and ends ---------------------------------------------------------------------------------


def test_an_element_of_an_array_can_be_assigned() -> None:  # 5.3.2
    text = f"""<form><var name="o" expr="{{a: [1, {{b: 2}}]}}"/><block><assign name="o.a[1].b" expr="3"/>
        <assign name="dialog.o.a[0]" expr="4"/><assign name="o['c']" expr="5"/>
        {holds("o.a[0] == 4 &amp;&amp; o.a[1].b == 3 &amp;&amp; o.c == 5")}</block></form>"""
    assert run(text).logs() == ["pass"]


@pytest.mark.parametrize("name", ["x[1]", "o[f()]", "o[1", "1", "o, p", "o[1], p[2]"])
def test_what_is_no_variable_is_not_assigned(name: str) -> None:
    refused = "<catch event='error.semantic'><log>refused</log><exit/></catch>"
    text = f"""{refused}<form><var name="o" expr="[]"/><block><assign name="{name}" expr="1"/>
        </block></form>"""
    assert run(text).logs() == ["refused"]


def test_a_field_may_be_called_as_what_all_objects_have() -> None:  # 2.3.1
    text = f"""<form><field name="constructor"><prompt>Q?</prompt>{YES}<filled>{PASS}</filled></field>
        </form>"""
    assert run(text, "yes").logs() == ["pass"]


def test_what_is_undefined_in_an_array_stays_so() -> None:  # 2.1, 6
    text = """<form><block><foreach item="i" array="[null, undefined, 1]">
        <log expr="typeof i"/></foreach></block></form>"""
    assert run(text).logs() == ["object", "undefined", "number"]


def test_keys_are_enumerated_one_by_one() -> None:  # 2.2.4
    text = """<menu><prompt><enumerate><value expr="_prompt"/> is <value expr="_dtmf"/>.</enumerate>
        </prompt><choice dtmf="42" next="#a">news</choice></menu><form id="a"/>"""
    call = Call(text)
    call.play()
    assert call.said()[:1] == ["news is 4 2."]


def test_the_counters_of_a_menu_are_not_cleared() -> None:  # 5.2.2
    text = """<menu><prompt>Q?</prompt><choice next="#x">go</choice><nomatch count="1"><log>one</log>
        <clear/></nomatch><nomatch count="2"><log>two</log><exit/></nomatch></menu><form id="x"/>"""
    assert run(text, "no", "no").logs() == ["one", "two"]


def test_the_timeout_of_a_prompt_that_was_played_before_is_over() -> None:  # 4.1.7
    text = f"""<form><transfer name="t" dest="tel:+1" type="bridge"><prompt timeout="2s">One moment.
        </prompt></transfer><field name="f">{YES}</field></form>"""
    call = Call(text)
    call.play()
    questions = [
        one.command for one in call.orders if one.command and "timeout" in one.command.args
    ]
    assert [one.args["timeout"] for one in questions][-1:] == [5000]


def test_words_around_what_is_meant_are_no_reason_for_a_nomatch() -> None:  # SRGS 2.2.3
    text = f"""<form><field name="f"><prompt>Q?</prompt><grammar version="1.0" root="r"
        xmlns="http://www.w3.org/2001/06/grammar" xml:lang="en"><rule id="r">
        <ruleref special="GARBAGE"/> pizza</rule></grammar><filled>{PASS}</filled></field></form>"""
    assert run(text, "well I would really like a pizza").logs() == ["pass"]


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


def check_page(body: str) -> list[Problem]:
    return read_page("a.vxml", "a.vxml", vxml(body).encode()).problems


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


def test_what_a_foreach_cannot_hold_is_told_by_where_it_stands() -> None:
    (problem,) = check_page(
        f"<form><block><prompt>{EACH}<log>x</log></foreach></prompt></block></form>"
    )
    assert problem.message == "<log> cannot stand in a <foreach> of a prompt."
    assert "foreach" not in problem.remedy


@pytest.mark.parametrize(
    ("name", "value", "remedy"),
    [
        ("timeout", "1", 'Write "1s".'),
        ("confidencelevel", "1.1", "Write a number from 0 to 1."),
        ("maxnbest", "x", "Write a whole number from 1."),
        ("bargein", "yes", "Write false or true."),
        ("fetchtimeout", "3s", None),
        ("sensitivity", "0.5", None),
        ("com.example.timeout", "?", None),
    ],
)
def test_a_property_that_holds_nothing_is_warned_of(
    name: str, value: str, remedy: str | None
) -> None:  # 6.3
    text = f'<property name="{name}" value="{value}"/><form><block/></form>'
    found = read_page("a.vxml", "a.vxml", vxml(text).encode()).warnings()
    assert [(one.severity, one.remedy) for one in found] == [("warning", remedy)] * (
        remedy is not None
    )


@pytest.mark.parametrize(
    ("name", "warned"), [("a-b", True), ("class", True), ("1x", True), ("größe", False), ("$", False), ("of", False)]
)  # fmt: skip
def test_a_variable_that_no_expression_can_name_is_warned_of(name: str, warned: bool) -> None:
    text = f'<form><field name="{name}"><prompt>Q?</prompt>{YES}</field></form>'  # 5.1.1
    found = read_page("a.vxml", "a.vxml", vxml(text).encode()).warnings()
    assert [one.code for one in found] == ["bad-value"] * warned


def test_a_confidence_that_nothing_can_reach_counts_for_nothing() -> None:  # 6.3.2
    text = f"""<property name="confidencelevel" value="1.1"/><form><field name="f">
        <prompt>Q?</prompt>{YES}<filled>{PASS}</filled></field></form>"""
    assert run(text, "yes").logs() == ["pass"]


# 5.1.5 and 6.3.6: keys and words that nobody takes -----------------------------------------------

NOTED = """<nomatch><log expr="[application.lastresult$.utterance,
application.lastresult$.inputmode]"/><exit/></nomatch><noinput><log>nothing</log><exit/></noinput>"""


@pytest.mark.parametrize(
    ("modes", "said", "noted"),
    [
        ("dtmf voice", "1 2 #", "12,dtmf"),
        ("dtmf voice", "*", "*,dtmf"),
        ("dtmf voice", "12", "12,dtmf"),
        ("dtmf voice", "perhaps", "perhaps,voice"),
        ("dtmf", "1 2 #", "12,dtmf"),
        ("dtmf", "perhaps", "nothing"),
        ("voice", "12#", "nothing"),
        ("voice", "12", "12,voice"),
    ],
)
def test_what_nobody_takes_is_noted_as_what_it_is(modes: str, said: str, noted: str) -> None:
    text = f"""<property name="inputmodes" value="{modes}"/><form>{NOTED}
        <field name="f" type="digits?length=4"><prompt>Q?</prompt></field></form>"""
    assert run(text, said).logs() == [noted]


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


def test_audio_may_play_while_data_is_fetched() -> None:  # 2.1, 5
    assert check_page('<form><data src="a.xml" name="d" fetchaudio="b.wav"/></form>') == []


# 2.1, 7: what is said can be recorded --------------------------------------------------------------


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


def test_what_nobody_understood_is_recorded_and_played_back() -> None:
    text = f"""<property name="recordutterance" value="true"/><form><field name="f"><prompt>Q?</prompt>
        {YES}<nomatch>You said <audio expr="application.lastresult$.recording"/><exit/></nomatch>
        </field></form>"""
    assert run(text, "perhaps").said()[-1] == "You said perhaps"


TELLS = "<catch><log><value expr=\"_event + ': ' + _message\"/></log><exit/></catch>"


@pytest.mark.parametrize(
    ("content", "logged"),
    [
        ("<throw event=\"e\" messageexpr=\"new Error('boom')\"/>", "e: Error: boom"),
        ('<throw event="e" messageexpr="[1,2]"/>', "e: 1,2"),
        ('<throw event="e" messageexpr="null"/>', "e: null"),
        ("<throw eventexpr=\"['e']\" messageexpr=\"new String('s')\"/>", "e: s"),
        ("<throw eventexpr=\"new Date(0).getTime()\" messageexpr=\"({})\"/>", "0: [object Object]"),
        ("<goto expr=\"new String('#b')\"/>", "b"),
        ("<goto expr=\"['#b']\"/>", "b"),
        ("<goto expritem=\"new String('two')\"/>", "two"),
    ],
)  # fmt: skip
def test_what_an_attributes_expression_gives_becomes_text(content: str, logged: str) -> None:
    text = f"""{TELLS}<form><block>{content}</block><block name="one"><exit/></block>
        <block name="two"><log>two</log><exit/></block></form>
        <form id="b"><block><log>b</log></block></form>"""
    assert run(text).logs() == [logged]


@pytest.mark.parametrize(
    "content",
    [
        '<throw eventexpr="undefined"/>',
        '<throw eventexpr="null"/>',
        '<throw event="e" messageexpr="void 0"/>',
        '<goto expr="void 0"/>',
        '<goto expr="null"/>',
        '<goto expritem="void 0"/>',
        '<submit expr="null"/>',
        '<script srcexpr="void 0"/>',
        '<data name="d" srcexpr="null"/>',
        '<prompt>One <mark nameexpr="void 0"/> two.</prompt>',
    ],
)
def test_an_attributes_expression_without_a_value_is_error_semantic(content: str) -> None:
    logged = f'<catch><log><value expr="_event"/></log><exit/></catch><form><block>{content}'
    assert run(f"{logged}</block></form>").logs() == ["error.semantic"]


@pytest.mark.parametrize(
    "item",
    [
        '<transfer name="t" destexpr="void 0"/>',
        '<subdialog name="s" srcexpr="void 0"/>',
        '<subdialog name="s" src="#sub"/>',
    ],
)
def test_an_items_expression_without_a_value_is_error_semantic(item: str) -> None:
    text = f"""<form><catch><log><value expr="_event"/></log><exit/></catch>{item}</form>
        <form id="sub"><catch><log>in</log><return event="error.semantic"/></catch>
        <block><return eventexpr="void 0"/></block></form>"""
    assert run(text).logs()[-1:] == ["error.semantic"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("Hear <audio src='a.wav'><desc>a bell</desc></audio>.", "Hear [a.wav] ."),
        ("Hear <audio src='a.wav'><desc>a bell</desc>a ring</audio>.", "Hear a ring ."),
        ("It is <sub alias=''>gone</sub> here.", "It is here."),
        ("It is <sub alias='away'>gone</sub> here.", "It is away here."),
    ],
)
def test_a_description_and_what_has_an_alias_are_not_said(content: str, said: str) -> None:
    assert run(f"<form><block><prompt>{content}</prompt></block></form>").said() == [said]


@pytest.mark.parametrize("tag", ["s", "sentence", "emphasis"])
def test_the_choices_may_be_enumerated_in_a_sentence(tag: str) -> None:  # 2.2.4
    text = f"""<menu><prompt>Say <{tag}>one of <enumerate/></{tag}></prompt>
        <choice event="exit">tea</choice><choice event="exit">milk</choice></menu>"""
    assert run(text).said() == ["Say one of tea; milk"]


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("<var name='_a'/>", ['"_a" is reserved']),
        ("<form><field name='a$'><option>x</option></field></form>", ['"a$" is reserved']),
        ("<form><block><foreach item='a.b' array='[]'/></block></form>", ['"a.b" is not a name']),
        ("<form><block><prompt><foreach item='1' array='[]'/></prompt></block></form>", ['"1" is not a name']),
        ("<menu><choice dtmf='1 x' event='e'>a</choice></menu>", ['dtmf "1 x"']),
        ("<menu><choice dtmf='1 2*#A' event='e.f-g_1'>a</choice></menu>", []),
        ("<form><field name='f'><option dtmf='one'>a</option></field></form>", ['dtmf "one"']),
        ("<link dtmf='' event='e'/>", ['dtmf ""']),
        ("<link dtmf='9' event=''/>", ['event ""']),
        ("<form><block><throw event=''/></block></form>", ['event ""']),
        ("<form><block><throw event='a b'/></block></form>", ['event "a b"']),
        ("<form><block><throw event='a..b'/></block></form>", ['event "a..b"']),
        ("<catch event='a,b'/>", ['event "a,b"']),
        ("<catch event='error. a.b'/><catch event='.'/><catch event=''/><catch/>", []),
    ],
)  # fmt: skip
def test_names_keys_and_events_that_are_none_are_warned_of(body: str, told: list[str]) -> None:
    problems = read_page("a.vxml", "a.vxml", vxml(body).encode()).warnings()
    assert all(one.severity == "warning" for one in problems)
    assert [one.message[: len(start)] for one, start in zip(problems, told, strict=True)] == told


@pytest.mark.parametrize("around", ["{}", "<prompt>{}</prompt>"])
def test_the_item_of_a_foreach_is_a_variable_without_a_scope(around: str) -> None:  # 2.1, 6
    each = around.format("<foreach item='dialog.a' array='[1]'>x</foreach>")
    text = f"<form><catch event='error.semantic'>{PASS}</catch><block>{each}</block></form>"
    call = run(text)
    assert (call.logs(), call.said()) == (["pass"], [])
