"""Elements and attributes: those allowed, and errors in others."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from prima import loading
from prima.errors import DocumentError
from prima.voicexml.document import broken
from prima.voicexml.reading import read_page
from prima.voicexml.vocabulary import ALTERNATIVES
from tests import ROOT
from tests.helpers.dialogs import P, block, codes, problems, rule, run
from tests.helpers.voice import Call, vxml
from tests.helpers.work import steps


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ("<frm/>", "unknown-element"),
        ("<form><blok/></form>", "unknown-element"),
        ("<block/>", "misplaced-element"),
        ("<form><prompt>Hi</prompt></form>", "misplaced-element"),
        ("<form><form/></form>", "misplaced-element"),
        ("<form><block><field name='f'/></block></form>", "misplaced-element"),
        ("<form><block><else/></block></form>", "misplaced-element"),
        ("<menu><block/></menu>", "misplaced-element"),
        ("<form nam='a'/>", "unknown-attribute"),
        ("<form><field name='f' dtmf='1'/></form>", "unknown-attribute"),
        ("<form><block><goto/></block></form>", "missing-attribute"),
        ("<form><block><goto next='#a' expr='1'/></block></form>", "exclusive"),
        ("<form><block><goto next='#a' nextitem='b'/></block></form>", "exclusive"),
        ("<form><block><submit/></block></form>", "missing-attribute"),
        ("<form><block><submit next='a' expr='b'/></block></form>", "exclusive"),
        ("<form><block><throw/></block></form>", "missing-attribute"),
        ("<form><block><throw event='a' eventexpr='b'/></block></form>", "exclusive"),
        ("<form><block><throw event='a' message='a' messageexpr='b'/></block></form>", "exclusive"),
        ("<form><block><return event='a' namelist='b'/></block></form>", "exclusive"),
        ("<form><block><exit expr='a' namelist='b'/></block></form>", "exclusive"),
        ("<form><block><assign name='a'/></block></form>", "missing-attribute"),
        ("<form><block><var expr='1'/></block></form>", "missing-attribute"),
        ("<form><block><if>a</if></block></form>", "missing-attribute"),
        ("<form><block><value/></block></form>", "missing-attribute"),
        ("<form><block><audio/></block></form>", "missing-attribute"),
        ("<form><block><audio src='a' expr='b'/></block></form>", "exclusive"),
        ("<form><block><prompt><mark/></prompt></block></form>", "missing-attribute"),
        ("<form><block><prompt><mark name='a' nameexpr='b'/></prompt></block></form>", "exclusive"),
        ("<form><block><script/></block></form>", "missing-attribute"),
        ("<form><block><script src='a'>b</script></block></form>", "exclusive"),
        ("<form><block><script src='a' srcexpr='b'/></block></form>", "exclusive"),
        ("<form><block><data/></block></form>", "missing-attribute"),
        ("<form><block><data src='a' srcexpr='b'/></block></form>", "exclusive"),
        ("<form><block><foreach item='a'/></block></form>", "missing-attribute"),
        ("<form><block><foreach array='a'/></block></form>", "missing-attribute"),
        ("<form><grammar/></form>", "missing-attribute"),
        ("<form><grammar src='a' srcexpr='b'/></form>", "exclusive"),
        ("<form><grammar src='a'><rule id='r'>b</rule></grammar></form>", "exclusive"),
        ("<link/>", "missing-attribute"),
        ("<link next='#a' event='b'/>", "exclusive"),
        ("<menu><choice>a</choice></menu>", "missing-attribute"),
        ("<menu><choice next='#a' event='b'>a</choice></menu>", "exclusive"),
        ("<menu dtmf='true'><choice dtmf='3' event='b'>a</choice></menu>", "exclusive"),
        ("<form><subdialog/></form>", "missing-attribute"),
        ("<form><subdialog src='a' srcexpr='b'/></form>", "exclusive"),
        ("<form><subdialog src='a'><param name='a'/></subdialog></form>", "missing-attribute"),
        (
            "<form><subdialog src='a'><param name='a' expr='1' value='2'/></subdialog></form>",
            "exclusive",
        ),
        ("<form><transfer dest='a' destexpr='b'/></form>", "exclusive"),
        ("<form><transfer dest='a' bridge='true' type='blind'/></form>", "exclusive"),
        ("<property name='a'/>", "missing-attribute"),
        ("<meta name='a'/>", "missing-attribute"),
        ("<meta name='a' http-equiv='b' content='c'/>", "exclusive"),
        ("<form><block><prompt bargein='yes'>a</prompt></block></form>", "bad-value"),
        ("<form><block><prompt timeout='5'>a</prompt></block></form>", "bad-value"),
        ("<form><block><prompt count='0'>a</prompt></block></form>", "bad-value"),
        ("<form scope='global'/>", "bad-value"),
        ("<form><field name='f'><option accept='near'>a</option></field></form>", "bad-value"),
        ("<form><filled mode='some'/></form>", "bad-value"),
        ("<form><field name='f'><filled mode='all'/></field></form>", "unknown-attribute"),
        ("<form><field name='f'><filled namelist='f'/></field></form>", "unknown-attribute"),
        ("<form><block name='b'/><filled namelist='b'/></form>", "no-such-item"),
        ("<form><field name='f'/><filled namelist='g'/></form>", "no-such-item"),
        ("<form><field name='f'/><block name='f'/></form>", "duplicate-name"),
        ("<form id='a'/><menu id='a'/>", "duplicate-id"),
        ("<form>text</form>", "stray-text"),
        ("text", "stray-text"),
        ("<form><block><if cond='1'><else/><elseif cond='2'/></if></block></form>", "after-else"),
        ("<form xmlns:o='urn:o'><o:block/></form>", "wrong-namespace"),
        (f"<form {P}><block><p:dance/></block></form>", "unknown-element"),
        (f"<form {P}><block><p:turn angel='1'/></block></form>", "unknown-attribute"),
        (f"<form {P}><p:turn angle='1'/></form>", "misplaced-element"),
    ],
)
def test_what_is_wrong_has_a_code(body: str, code: str) -> None:  # 1.5 and each element's section
    assert codes(body) == [code]


def test_such_an_expression_is_error_semantic_when_it_is_reached() -> None:  # 5.2.6
    call = Call(
        '<catch event="error.semantic"><log>bad</log><exit/></catch>'
        + block('<log>before</log><if cond="1 +"><log>no</log></if>')
    )
    assert call.logs() == ["before", "bad"]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('<vxml xmlns="http://www.w3.org/2001/vxml"/>', ["1:1 missing-attribute"]),
        ('<vxml version="1.0" xmlns="http://www.w3.org/2001/vxml"/>', ["1:16 bad-value"]),
        ('<vxml version="2.0"><form/></vxml>', ["1:1 no-namespace"]),
        ('<vxml version="2.0" xmlns="http://www.w3.org/2001/VXML"/>', ["1:28 wrong-namespace"]),
        ('<vml version="2.0" xmlns="http://www.w3.org/2001/vxml"/>', ["1:1 wrong-root"]),
        ('<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">\n <form>\n  <blok/></form></vxml>',
         ["3:3 unknown-element"]),
        ('<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">\n <form nam="a"/></vxml>',
         ["2:8 unknown-attribute"]),
        ("<vxml", ["1:6 not-xml"]),
        ("", ["1:1 not-xml"]),
    ],
)  # fmt: skip
def test_problems_have_a_place(text: str, found: list[str]) -> None:
    assert problems(text) == found


@pytest.mark.parametrize(
    ("body", "remedy"),
    [
        ("<form><throw event='e'/></form>", "Put it into a <block>."),
        ("<form><block>Hi <break/></block></form>", "Put it into a <prompt>."),
        ("<form><field name='f'><noinput><s>Hm</s></noinput></field></form>", "into a <prompt>."),
        ("<form><option>tea</option></form>", "Put it into a <field>."),
        ("<field name='f'/>", "Put it into a <form>."),
        ("<form><form/></form>", "Close the first <form> before this one."),
        ("<form><block><field name='f'/></block></form>", "It is allowed in form."),
        ("<form><block><vxml/></block></form>", "It begins a document: give it its own file."),
    ],
)
def test_a_misplaced_element_is_told_where_it_belongs(body: str, remedy: str) -> None:
    (problem,) = read_page("a.vxml", "a.vxml", vxml(body).encode()).problems
    assert (problem.code, problem.remedy.endswith(remedy)) == ("misplaced-element", True)


def test_an_element_without_a_namespace_is_told_what_takes_it_away() -> None:
    text = vxml(block('<prompt xmlns="">Hi.</prompt><prompt xmlns="urn:x">Ho.</prompt>'))
    first, second = read_page("a.vxml", "a.vxml", text.encode()).problems
    assert first.remedy == 'It is ignored. Remove its xmlns="".'
    assert second.remedy == "It is ignored."


def test_a_pause_of_other_platforms_is_told_as_a_break() -> None:
    text = vxml(block("<prompt>Wait <pause>400</pause></prompt>"))
    (problem,) = read_page("a.vxml", "a.vxml", text.encode()).problems
    assert (problem.code, problem.message) == (
        "unknown-element", "There is no <pause> in VoiceXML."
    )  # fmt: skip
    assert problem.remedy.startswith('In a prompt write <break time="1s"/>; between Commands <p:')


DOCTYPE = (
    '<?xml version="1.0" encoding="UTF-8"?>\n<!DOCTYPE vxml PUBLIC "-//W3C//DTD VOICEXML 2.1//EN"'
    ' "http://www.w3.org/TR/voicexml21/vxml.dtd">\n'
)


def test_a_doctype_as_real_documents_have_is_accepted_and_never_fetched() -> None:  # B
    assert problems(DOCTYPE + vxml(block("Hi."))) == []
    assert Call(DOCTYPE + vxml(block("Hi."))).play() == ["Hi."]


def test_a_schema_location_is_accepted() -> None:  # O
    head = (
        '<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xsi:schemaLocation="http://www.w3.org/2001/vxml http://www.w3.org/TR/x.xsd">'
    )
    assert problems(vxml(block("Hi."), head)) == []


def test_a_doctype_that_declares_something_is_refused() -> None:
    text = '<!DOCTYPE vxml [<!ENTITY a "b">]>' + vxml(block("Hi."))
    assert problems(text) == ["1:1 doctype"]


def test_elements_of_foreign_namespaces_are_ignored_with_a_warning() -> None:
    text = vxml(
        '<form xmlns:o="urn:o"><o:block><log>no</log></o:block><block><o:log>no</o:log>'
        '<o:goto next="#none"/><log>yes</log></block></form>'
    )
    page = read_page("d.vxml", "d.vxml", text.encode())
    assert {p.severity for p in page.problems} == {"warning"} and broken(page) is None
    assert Call(text).logs() == ["yes"]


def test_attributes_of_foreign_namespaces_are_ignored() -> None:
    assert codes('<form xmlns:o="urn:o" o:a="b"/>') == []


def test_an_expression_that_does_not_compile_is_a_warning_for_who_asks() -> None:
    text = vxml(
        '<form><block>\n<assign name="a" expr="1 +"/><script>var = ;</script></block></form>'
    )
    page = read_page("d.vxml", "d.vxml", text.encode())
    assert page.problems == []
    found = [(p.place.line, p.severity, p.code) for p in page.warnings()]
    assert sorted(found) == [(2, "warning", "bad-expression")] * 2


def test_such_an_expression_that_is_never_reached_is_no_error() -> None:
    call = Call(block('<if cond="false"><log expr="1 +"/></if><log>after</log>'))
    assert (call.logs(), call.ended) == (["after"], "exit")


def test_a_dialog_that_is_not_there_is_a_warning_for_who_asks() -> None:
    page = read_page("d", "d", vxml(block('<goto next="#none"/>')).encode())
    assert [p.code for p in page.warnings()] == ["no-such-form"]


def test_validation_asks_for_warnings(tmp_path: Path) -> None:
    path = tmp_path / "a.vxml"
    path.write_text(vxml(block('<log expr="1 +"/>')))
    assert [(p.severity, p.code) for p in loading.validate([path])] == [
        ("warning", "bad-expression")
    ]


def test_a_wrong_document_is_no_vxml_at_all() -> None:
    with pytest.raises(DocumentError):
        read_page("d", "d", b'<prima xmlns="urn:prima:dialogue:1"/>')


def long_document(forms: int) -> bytes:
    form = (
        '<form id="f{0}"><var name="a" expr="{0} + 1"/><field name="x"><prompt>Say <value expr="a"/>'
        ' please, number {0}</prompt><option>one</option><option value="2">two</option>'
        '<nomatch count="2"><reprompt/></nomatch><filled><if cond="x == \'one\'">'
        '<goto next="#f0"/><else/><assign name="a" expr="a + 1"/></if></filled></field></form>\n'
    )
    return vxml("".join(form.format(n) for n in range(forms))).encode()


def test_the_work_for_a_document_grows_with_its_length() -> None:
    short, long = long_document(30), long_document(300)
    assert steps(lambda: read_page("d", "d", long)) < 11 * steps(lambda: read_page("d", "d", short))


def test_an_expression_of_an_attribute_may_have_commas() -> None:
    call = Call(
        """<form><block><goto expr="'#nowhere', '#b'"/></block></form>
        <form id="b"><block><log>b</log></block></form>"""
    )
    assert call.logs() == ["b"]


EITHER = {
    "goto": "<block><goto next='#a' expr='1'/></block>",
    "goto nextitem": "<block><goto next='#a' nextitem='b'/></block>",
    "goto nowhere": "<block><goto/></block>",
    "submit": "<block><submit next='a' expr='1'/></block>",
    "submit nowhere": "<block><submit namelist='x'/></block>",
    "throw": "<block><throw event='a' eventexpr='1'/></block>",
    "throw nothing": "<block><throw message='m'/></block>",
    "throw message": "<block><throw event='a' message='m' messageexpr='1'/></block>",
    "return": "<block><return event='a' namelist='x'/></block>",
    "return event": "<block><return event='a' eventexpr='x'/></block>",
    "return message": "<block><return event='a' message='m' messageexpr='x'/></block>",
    "exit": "<block><exit expr='1' namelist='x'/></block>",
    "script": "<block><script src='a.js'>var x;</script></block>",
    "script empty": "<block><script> </script></block>",
    "form script": "<script src='a.js' srcexpr='1'/><block/>",
    "data": "<block><data src='a' srcexpr='1'/></block>",
    "data of nothing": "<block><data name='d'/></block>",
    "audio": "<block><audio src='a' expr='1'/></block>",
    "audio of nothing": "<block><prompt><audio>words</audio></prompt></block>",
    "mark": "<block><prompt><mark name='a' nameexpr='1'/></prompt></block>",
    "subdialog": "<subdialog name='s' src='#a' srcexpr='1'/>",
    "subdialog nowhere": "<subdialog name='s'/>",
    "param": "<subdialog name='s' src='#a'><param name='p' value='1' expr='2'/></subdialog>",
    "param of nothing": "<subdialog name='s' src='#a'><param name='p'/></subdialog>",
    "transfer": "<transfer name='t' dest='tel:1' destexpr='1'/>",
    "transfer nowhere": "<transfer name='t'/>",
    "transfer type": "<transfer name='t' dest='tel:1' bridge='true' type='blind'/>",
    "grammar": "<field name='f'><prompt>Q?</prompt><grammar src='a' srcexpr='1'/></field>",
    "grammar empty": "<field name='f'><prompt>Q?</prompt><grammar> <!-- --> </grammar></field>",
    "grammar both": "<field name='f'><grammar src='a.gram'>#ABNF 1.0; $a = b;</grammar></field>",
    "link": f"<link next='#a' event='b'>{rule('x')}</link><block/>",
    "link nowhere": f"<link>{rule('x')}</link><block/>",
}


@pytest.mark.parametrize("content", EITHER.values(), ids=EITHER)
def test_a_document_with_attributes_that_exclude_each_other_is_not_run(content: str) -> None:
    other = '<form id="a"><block><return/></block></form>'
    text = vxml(f"<form><block><log>runs</log></block>{content}</form>{other}")
    errors = [one.partition(" ")[2] for one in problems(text)]
    assert errors in (["exclusive"], ["missing-attribute"])
    fetching = Call(
        """<catch event="error.badfetch"><log>refused</log><exit/></catch>
        <form><block><goto next="leaf.vxml"/></block></form>""",
        leaf=text.replace("<log>runs</log>", '<log>runs</log><throw event="error.badfetch"/>'),
    )
    assert (fetching.logs(), fetching.ended) == (["refused"], "exit")


def test_the_documentation_lists_the_attributes_that_exclude_each_other() -> None:
    page = (ROOT / "docs" / "voicexml.md").read_text(encoding="utf-8")
    table = page.partition("| Exactly one of |")[2].partition("\n\n")[0].splitlines()[2:]
    told: dict[str, set[str]] = {}
    for row in table:
        names, needed, most = (
            re.sub("[`,]", "", cell).split("|")[0] for cell in row.split("|")[1:4]
        )
        for name in names.split():
            lines = [f"{needed.strip()} !"] if needed.strip() else []
            told[name] = {*lines, *(one.strip() for one in most.split(";") if one.strip())}
    assert told == {name: set(lines) for name, lines in ALTERNATIVES.items()}


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
    ("content", "event"),
    [
        ('<clear namelist="9"/>', "error.semantic"),
        ('<submit next="service:keep" namelist="9"/>', "error.semantic"),
        ('<submit next="service:keep" namelist="a+a"/>', "error.semantic"),
        ('<goto nextitem=""/>', 'error.badfetch there is no form item ""'),
        ('<goto next=" "/>', "error.badfetch the URI is missing"),
        ('<data name="d" src=" "/>', "error.badfetch the URI is missing"),
    ],
)
def test_names_and_uris_that_are_none_are_events(content: str, event: str) -> None:
    logged = """<catch><log><value expr="_event + ' ' + _message"/></log><exit/></catch>"""
    (log,) = run(f"<var name='a'/>{logged}<form><block>{content}</block></form>").logs()
    assert re.sub(r"app.vxml:\d+:\d+: ", "", log).startswith(event)


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
    ("name", "why"),
    [
        ("a.b", "is not a name"),
        ("dialog.b", "names a scope; declare it there"),
        ("_b", "is a name of"),
    ],
)
def test_a_run_says_why_a_variable_cannot_have_its_name(name: str, why: str) -> None:
    text = "<catch><log expr='_message'/><exit/></catch>" + block(f'<var name="{name}" expr="1"/>')
    (logged,) = run(text).logs()
    assert f'"{name}" {why}' in logged


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("<var name='_a'/>", ['"_a" is reserved']),
        ("<var name=''/><form><block name=''/><field name=' ' type='boolean'/></form>", ['"" is not a name']),
        ("<form><block><foreach item=' ' array='[]'/></block></form>", ['"" is not a name']),
        ("<form><field name='a$'><option>x</option></field></form>", ['"a$" is reserved']),
        ("<form><block><foreach item='a.b' array='[]'/></block></form>", ['"a.b" is not a name']),
        ("<var name='a.b'/><var name='application.b'/>", ['"a.b" is not a name', '"application.b" names a scope']),
        ("<form><block><prompt><foreach item='1' array='[]'/></prompt></block></form>", ['"1" is not a name']),
        ("<form><block><assign name='session.a' expr='1'/></block></form>", ['"session.a" cannot be assigned']),
        ("<form><block><assign name='sessions.a' expr='1'/></block></form>", []),
        ("<form><block><assign name='' expr='1'/></block></form>", ['"" names no variable']),
        ("<var name='a'/><form><block><assign name='a + 1' expr='1'/></block></form>", ['"a + 1" names no variable']),
        ("<var name='a'/><form><block><assign name='a[0].b' expr='1'/></block></form>", []),
        ("<var name='a'/><form><block><clear namelist='a 9'/></block></form>", ['"9" names no variable']),
        ("<var name='a'/><form><block><exit namelist='a+a'/></block></form>", ['"a+a" names no variable']),
        ("<form><block><goto next=' '/></block></form>", ["next is empty"]),
        ("<form><block><script src=''/></block></form>", ["src is empty"]),
        ("<form><block><audio src=''/></block></form>", []),
        ("<form><block><goto nextitem=''/></block></form>", ['This form has no item ""']),
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
def test_names_keys_uris_and_events_that_are_none_are_warned_of(body: str, told: list[str]) -> None:
    problems = read_page("a.vxml", "a.vxml", vxml(body).encode()).warnings()
    assert all(one.severity == "warning" for one in problems)
    assert [one.message[: len(start)] for one, start in zip(problems, told, strict=True)] == told


@pytest.mark.parametrize(
    ("content", "place"),
    [
        ('<assign name="x" expr="1 + nothing"/>', "2:36"),
        ("<script>\n  nothing();</script>", "3:3"),
        ('<goto next="#nowhere"/>', "2:9"),
        ('<goto nextitem="nowhere"/>', "2:9"),
        ('<clear namelist="nothing"/>', "2:9"),
        ("<return/>", "2:9"),
        ('<goto next="nowhere.vxml"/>', "2:9"),
    ],
)
def test_an_error_is_told_with_its_line_and_column(content: str, place: str) -> None:
    call = Call(
        f"""<form><var name="x"/><catch event="error"><log expr="_message"/></catch>
 <block>{content}</block></form>"""
    )
    assert call.logs()[0].startswith(f"app.vxml:{place}: ")
