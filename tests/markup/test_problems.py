"""Reading and validation: exact places, all problems at once, the author's words."""

from __future__ import annotations

import math
import time
from pathlib import Path

import pytest

from prima.devices.profile import read_robot
from prima.errors import DocumentError, Problem
from prima.interpreter.checks.robot import check_commands
from prima.interpreter.reader import read_document
from prima.language.arguments import check_argument
from prima.language.commands import TABLE_4_2, Argument
from prima.markup.reader import parse
from prima.script.names import script_names
from prima.sim.map import read_world
from prima.sim.scenario import read_scenario
from tests.helpers.robot import read, xml


def problems(body: str, kind: str = "fa") -> list[str]:
    return [f"{p.place.line}:{p.place.column} {p.severity} {p.code}" for p in read(body, kind)[1]]


def found(body: str, code: str, kind: str = "fa") -> Problem:
    made = [p for p in read(body, kind)[1] if p.code == code]
    assert len(made) == 1, [str(p) for p in read(body, kind)[1]]
    return made[0]


def test_all_problems_of_a_file_at_once_with_exact_places() -> None:
    body = """
<form id="a">
  <blok/>
  <block>
    <speak volume="3">Hi</speak>
    <topological-move
        to="x"
        too="y"/>
    <goto next="#bb"/>
    <assign name="nix" expr="1 +"/>
  </block>
</form>
<form id="b"><block><turn angle="ninety"/></block></form>
"""
    assert problems(body) == [
        "3:3 error unknown-element",
        "5:12 error unknown-attribute",
        "8:9 error unknown-attribute",
        "9:17 error no-such-form",
        "10:5 warning dead-content",
        "10:19 error undeclared-variable",
        "10:33 error bad-expression",
        "13:11 warning unreachable",
        "13:34 error bad-value",
    ]


LINK = """<link event="help"><grammar>help</grammar><grammar>aid</grammar></link>
<form id="a"><on event="help"><exit/></on></form>"""
WAITS = """<form id="a"><field name="f"><prompt timeout="{}">Hi?</prompt><option>yes</option>
<noinput><exit/></noinput></field></form>"""


@pytest.mark.parametrize(
    ("body", "code", "remedy"),
    [
        ('<form id="a"><block><speek>Hi</speek></block></form>', "unknown-element", '"speak"'),
        ('<form id="a"><catch event="x"/></form>', "unknown-element", '<on event="...">'),
        ('<form id="a"><speak>Hi</speak></form>', "misplaced-element", "block"),
        ('<form id="a"><block><prima/></block></form>', "misplaced-element", "It begins a document: give it its own file."),
        ('<form id="a"><block tame="x"/></form>', "unknown-attribute", '"name"'),
        ('<form id="a"><field name="x"><opt>a</opt></field></form>', "unknown-element", '"option"'),
        ('<form id="ask"><block><goto next="#aks"/></block></form>', "no-such-form", '"ask"'),
        ('<var name="goal"/><form id="a"><block><log expr="gaol"/></block></form>', "undeclared-variable", '"goal"'),
        ('<form id="a"><block>Hello</block></form>', "stray-text", "<speak>"),
        ('<form id="a"><block><assign name="session.time" expr="1"/></block></form>', "undeclared-variable", "a variable of your own"),
        ('<form id="a"><on event="touch"><assign name="event.data" expr="1"/></on></form>', "undeclared-variable", "a variable of your own"),
        (LINK, "misplaced-element", "into the first, as <one-of>"),
        ('<form id="a"><iu/><block><exit/></block></form>', "empty", "Write what must not be cut"),
        (WAITS.format("60s"), "long-turn", "Shorten its timeout."),
        (WAITS.format("600s"), "too-long", "Shorten its timeout."),
    ],
)  # fmt: skip
def test_a_problem_says_what_to_write_instead(body: str, code: str, remedy: str) -> None:
    assert remedy in found(body, code).remedy


@pytest.mark.parametrize(
    ("timeout", "told"),
    [("60s", "at least 60.15 s; 60 s"), ("59950ms", "at least 60.1 s;"), ("90s", "at least 90 s;")],
)
def test_a_time_that_is_just_too_long_is_told_exactly(timeout: str, told: str) -> None:
    assert told in found(WAITS.format(timeout), "long-turn").message


@pytest.mark.parametrize(
    ("command", "remedy", "fixes"),
    [
        ('<pause time="2min"/>', '"120s" is out of range: from 1ms to 60s.', []),
        ('<pause time="0.5min"/>', 'Write "30s".', ['Change to "30s"']),
        ('<turn angle="450deg"/>', '"450" is out of range: from -360 to 360.', []),
    ],
)
def test_no_value_is_suggested_that_is_out_of_range(
    command: str, remedy: str, fixes: list[str]
) -> None:
    problem = found(f'<form id="a"><block>{command}<exit/></block></form>', "bad-value")
    assert problem.remedy == remedy
    assert [fix.title for fix in problem.fixes] == fixes


@pytest.mark.parametrize(
    ("content", "code"),
    [
        ('<turn-and-speak angle="9O">Hello.</turn-and-speak>', "bad-value"),
        ('<turn-and-speak angle="900">Hello.</turn-and-speak>', "out-of-range"),
        ('<turn angle-expr=" "/>', "bad-value"),
        ('<turn angle-expr="Math.PI" foo="1"/>', "unknown-attribute"),
        ('<if cond=""><exit/></if>', "bad-value"),
        ("<speek>Hello.</speek>", "unknown-element"),
        ('<par><speek>Hello.</speek><turn angle="9"/></par>', "unknown-element"),
        ("<iu><speek>Hello.</speek></iu>", "unknown-element"),
        ("<iu><prompt>Hello.</prompt></iu>", "misplaced-element"),
        (
            "</block><field><prompt>Hi?</prompt><option>yes</option></field><block>",
            "missing-attribute",
        ),
    ],
)
def test_one_mistake_in_a_command_is_one_problem(content: str, code: str) -> None:
    document, told = read(f'<form id="a"><block>{content}<exit/></block></form>')
    told += check_commands(document, TABLE_4_2)
    assert [one.code for one in told] == [code]


ROUND = '<form id="a"><block><speak>x</speak></block>{}<on event="touch"><exit/></on></form>'


@pytest.mark.parametrize(
    ("handlers", "event"),
    [
        ('<on event="end.speak" reactive="true"><speak>y</speak></on>', "end.speak"),
        ('<on event="end" reactive="true"><log>z</log><speak>y</speak><gesture name="nod"/></on>', "end"),
        (
            '<on event="end.speak" reactive="true"><gesture name="nod"/></on>'
            '<on event="end.gesture" reactive="true"><speak>y</speak></on>',
            "end.speak",
        ),
        (
            '<on event="end.speak" reactive="true"><throw event="z"/></on>'
            '<on event="z" reactive="true"><speak>y</speak></on>',
            "end.speak",
        ),
    ],
)  # fmt: skip
def test_a_reaction_to_an_own_end_that_leads_to_itself_is_endless(
    handlers: str, event: str
) -> None:
    problem = found(ROUND.format(handlers), "endless")
    assert problem.message.startswith(f"This reaction to {event} leads to itself again")
    assert "<pause" in problem.remedy and 'reactive="true"' in problem.remedy


@pytest.mark.parametrize(
    "handlers",
    [
        '<on event="end.speak"><speak>y</speak></on>',
        '<on event="end.speak" reactive="true"><pause time="9s"/><speak>y</speak></on>',
        '<on event="end.speak" reactive="true"><gesture name="nod"/><speak>y</speak></on>',
        '<on event="end.speak" reactive="true"><gesture name="nod"/></on>',
        '<on event="end.speak" reactive="true"><exit/></on>',
        '<on event="end.speak" reactive="true" cond="session.time &lt; 9"><speak>y</speak></on>',
        '<on event="end.speak" reactive="true"><if cond="session.time &lt; 9"><speak>y</speak></if></on>',
        '<on event="end.speak" reactive="true"><goto next="#b"/></on></form>'
        '<form id="b"><field name="q" type="boolean"><prompt>q</prompt></field>',
    ],
)
def test_a_reaction_to_an_own_end_that_lets_others_in_is_not_endless(handlers: str) -> None:
    assert [one for one in read(ROUND.format(handlers), "fa")[1] if one.code == "endless"] == []


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("<speak>x</speak>", 1),
        ('<speak>x</speak><pause time="9s"/><speak>y</speak>', 1),
        ('<par><speak>x</speak><pause time="9s"/></par>', 1),
        ('<speak>x</speak><pause time="9s"/>', 0),
        ('<pause time="9s"/><log>y</log><speak>x</speak>', 0),
    ],
)
def test_a_form_that_goes_to_itself_lets_others_in_by_a_pause(content: str, told: int) -> None:
    made = read(f'<form id="a"><block>{content}<goto next="#a"/></block></form>')[1]
    assert [one.code for one in made] == ["endless"] * told
    assert all("<pause" in one.remedy for one in made)


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ('<form id="a"/><form id="a"/>', "duplicate-id"),
        ('<form id="a"><field name="x"><prompt>?</prompt></field></form>', "no-answer"),
        ('<form id="a"><block><turn angle="900"/></block></form>', "out-of-range"),
        ('<form id="a"><block><turn angle="1" angle-expr="2"/></block></form>', "exclusive"),
        ('<form id="a"><block><speak/></block></form>', "nothing-to-say"),
        ('<form id="a"><block><iu><speak>x</speak><tracking-human/></iu></block></form>', "not-in-unit"),
        ('<form id="a"><iu><block><topological-move to="x"/></block></iu></form>', "not-in-unit"),
        ('<form id="a"><block><par><speak>x</speak><stop-moving/></par></block></form>', "now-inside"),
        ('<form id="a"><block><seq><speak>x</speak><command type="stop-moving"/></seq></block></form>', "now-inside"),
        ('<form id="a"><block><if cond="1"><else/><elseif cond="1"/></if></block></form>', "after-else"),
        ('<form id="a"><field name="x" type="text"/><block name="x"/></form>', "duplicate-name"),
        ('<form id="a"><field name="x"><grammar><ruleref uri="#no"/></grammar></field></form>', "no-such-rule"),
        ('<form id="a"><block><goto/></block></form>', "missing-attribute"),
        ('<form id="a"><block><send to="x" event="y"/></block></form>', "exclusive"),
        ('<form id="a"><block><send/></block></form>', "missing-attribute"),
        ('<form id="a"><block><set-direction heading="1" toward="x"/></block></form>', "exclusive"),
        ('<form id="a"><link><grammar>x</grammar></link></form>', "missing-attribute"),
        ('<form id="a"><link next="#a" event="x"><grammar>x</grammar></link></form>', "exclusive"),
        ('<form id="a"><block><goto nextitem="b"/></block></form>', "no-such-item"),
        ('<form id="a"><block><set-direction/></block></form>', "missing-attribute"),
        ("", "no-form"),
    ],
)  # fmt: skip
def test_meaning(body: str, code: str) -> None:
    assert found(body, code).severity == "error"


@pytest.mark.parametrize(
    ("body", "code"),
    [
        ('<form id="a"><block><exit/></block></form><form id="b"><block><exit/></block></form>', "unreachable"),
        ('<form id="a"><block><speak>x</speak></block></form>', "dead-end"),
        ('<form id="a"><block><speak>x</speak></block></form><error><exit/></error>', "dead-end"),
        ('<form id="a"><block><speak>x</speak></block><on event="error.device"><exit/></on></form>', "dead-end"),
        ('<form id="a"><block><speak>x</speak></block></form><noinput><exit/></noinput>', "dead-end"),
        ('<form id="a"><block><exit/><speak>x</speak></block></form>', "dead-content"),
        ('<form id="a"><block><par><speak>x</speak><speak>y</speak></par><exit/></block></form>', "shared-device"),
        ('<form id="a"><block><tracking-human/><exit/></block></form>', "endless"),
        (f'<form id="a"><block><iu><speak>{"long " * 100}</speak></iu><exit/></block></form>', "long-unit"),
    ],
)  # fmt: skip
def test_warnings(body: str, code: str) -> None:
    assert found(body, code).severity == "warning"


def test_additional_arguments_are_for_an_fa_alone() -> None:
    body = '<form id="a"><block><speak>Hi<param name="volume" value="3"/></speak><exit/></block></form>'
    assert problems(body, "fa") == []
    assert found(body, "fa-only", "ea").place.line == 1


def test_an_expression_without_fault_is_left_in_peace() -> None:
    body = """<var name="n" expr="3"/><form id="a"><block>
      <var name="f" expr="function (a, b) { var c = a + b; return c * n; }"/>
      <var name="g" expr="[1, 2].map((x, i) => x * i).filter(y => y > n)"/>
      <var name="h" expr="{ a: n, b: 'n.m', c: /x+y/.test('z') }"/>
      <log expr="f(1, 2) + g.length + h.a + `t ${n}` + Math.max(n, 2) + (session ? 1 : 2)"/><exit/>
    </block></form>"""
    assert problems(body) == []


NAMES: list[tuple[str, set[str]]] = [
    ("({m(a) { return a }, get x() { return 1 }, set x(v) { this.y = v }})", set()),
    ("({a, b, 'c': 1, [d]: 2, ...e})", {"a", "b", "d", "e"}),
    ("({async m() {}, *g(a) { yield a }})", set()),
    ("var {a, b: c, d = n} = o; a + c + d", {"n", "o"}),
    ("const [x, , y = 2, ...z] = q, {k} = q; x + y + z + k", {"q"}),
    ("(a = n, {b, c: [d]}, ...r) => a + b + d + r", {"n"}),
    ("outer: for (let i = 0; i < m; i++) { continue outer }", {"m"}),
    ("for (const [k, v] of Object.entries(o)) k + v", {"o"}),
    ("function f(a, b = a) { return /foo+[/]bar/.test(a) + b } f(1)", set()),
    ("try { p() } catch ({message}) { message }", {"p"}),
    ("class A { x = 1; static y = z; m(q) { return this.x + q } }", {"z"}),
    ("x ? y : z", {"x", "y", "z"}),
    ("switch (v) { case A: break; default: B }", {"v", "A", "B"}),
    ("`a ${ `b ${c}` } d ${e}`", {"c", "e"}),
    ("a / b / c // d", {"a", "b", "c"}),
    ("get(1) + o.var + o?.p", {"get", "o"}),
]


@pytest.mark.parametrize(("code", "names"), NAMES)
def test_names_that_code_uses_without_declaring_them(code: str, names: set[str]) -> None:
    assert script_names(code).free.keys() == names
    assert all(code[start:].startswith(name) for name, start in script_names(code).free.items())


def test_names_that_code_declares() -> None:
    code = "var {a, b: c} = o, d\nlet [e] = f; function g() {} class H {} i = 1"
    assert script_names(code).declared == {"a", "c", "d", "e", "g", "H"}
    unsound = script_names("var a b = c;")
    assert (unsound.declared, {*unsound.free}) == ({"b"}, {"a", "c"})


@pytest.mark.parametrize(
    "code", ["'" + "\\'" * 99_999, "/*" * 99_999, "var [," * 30_000 + "]" * 30_000]
)
def test_names_are_found_in_time_in_hostile_code(code: str) -> None:
    began = time.monotonic()
    script_names(f"var x;{code}")
    assert time.monotonic() - began < 5


CALLING = '<form id="a"><subdialog src="#b"/></form><form id="b"><block>{}</block></form>'


@pytest.mark.parametrize(
    ("body", "remedies"),
    [
        (CALLING.format("<speak>x</speak>"), {"a": "<exit/>", "b": "<return/>"}),
        (CALLING.format("<return/>"), {"a": "<exit/>"}),
        (CALLING.format("<exit/>"), {}),
        (CALLING.format('<goto next="#c"/>') + '<form id="c"/>', {"a": "<exit/>", "c": "<return/>"}),
    ],
)  # fmt: skip
def test_a_dead_end_says_how_to_leave_it(body: str, remedies: dict[str, str]) -> None:
    made = [p for p in read(body)[1] if p.code == "dead-end"]
    assert len(made) == len(remedies)
    for name, remedy in remedies.items():
        assert any(f'"{name}"' in p.message and remedy in p.remedy for p in made)


DOCTYPE = '<!DOCTYPE prima PUBLIC "-//X//Y" "http://example.invalid/x.dtd">'


def test_an_external_doctype_is_accepted_and_an_internal_one_refused() -> None:
    body = xml('<form id="a"><block><exit/></block></form>')
    assert read_document("x.xml", DOCTYPE.encode() + body)[1] == []
    bomb = b'<!DOCTYPE prima [<!ENTITY a "aaaa">]>\n' + body
    with pytest.raises(DocumentError) as refused:
        read_document("x.xml", bomb)
    assert [p.code for p in refused.value.problems] == ["doctype"]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1", "shift_jis", "euc-jp"])
def test_listed_encodings_are_transcoded(encoding: str) -> None:
    word = (
        "café"
        if encoding == "iso-8859-1"
        else "日本語"
        if encoding != "utf-8"
        else "caf\u00e9 日本語"
    )
    text = (
        f'<?xml version="1.0" encoding="{encoding}"?>'
        + xml(
            f'<form id="a"><block><speak>{word}</speak><exit/></block></form>'.encode().decode()
        ).decode()
    )
    assert read_document("x.xml", text.encode(encoding))[1] == []


def test_columns_count_characters() -> None:
    body = '<form id="日本語"><block><speak>日本語</speak><x/></block></form>'
    place = found(body, "unknown-element").place
    assert place.column == xml(body).decode().index("<x/>") + 1


def test_lines_of_an_xml_declaration_count() -> None:
    declared = b"<?xml\n version='1.0'\n encoding='UTF-8'\n?>\n"
    world = b'<world xmlns="urn:prima:world:1" version="1.0" id="w"><palce/></world>'
    with pytest.raises(DocumentError) as wrong:
        read_world("w.xml", declared + world)
    assert str(wrong.value).startswith(f"w.xml:5:{world.index(b'<palce') + 1}: ")


def test_an_encoding_is_told_in_its_line() -> None:
    declared = b"<?xml version='1.0'\r\n encoding='UTF-0'?>"
    with pytest.raises(DocumentError) as wrong:
        read_world("w.xml", declared + b'<world xmlns="urn:prima:world:1" version="1.0" id="w"/>')
    assert str(wrong.value).startswith("w.xml:2:12: ")


def test_other_documents_are_checked_alike(tmp_path: Path) -> None:
    world = b'<world xmlns="urn:prima:world:1" version="1.0" id="w">\n<place id="a" x="0" y="0"/>\n<way from="a" to="b"/></world>'
    with pytest.raises(DocumentError) as wrong:
        read_world("w.xml", world)
    assert (
        str(wrong.value) == 'w.xml:3:19: error: There is no place "b". There is a. [no-such-name]'
    )
    robot = b'<robot xmlns="urn:prima:robot:1" version="1.0" id="r" speed="99"/>'
    with pytest.raises(DocumentError, match="out of range"):
        read_robot("r.xml", robot)
    scenario = b'<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w" robot="r"><when><say>x</say></when></scenario>'
    with pytest.raises(DocumentError) as several:
        read_scenario("s.xml", scenario)
    assert [p.code for p in several.value.problems] == ["missing-element", "missing-attribute"]
    two = scenario.replace(b"<when>", b'<application src="a"/><when at="1s" said="x">')
    with pytest.raises(DocumentError) as several:
        read_scenario("s.xml", two)
    assert [p.code for p in several.value.problems] == ["exclusive"]


def test_places_of_elements_and_of_characters_in_attributes_and_texts() -> None:
    text = '<a><!-- <x> --><![CDATA[<y>]]><?p <z>?><b\n c="1&gt;2 >\n&#10;x">d<!-- e -->&lt;<![CDATA[f]]></b></a>'
    [node] = parse("x.xml", text.encode()).nodes
    assert node.place[1:] == (1, 40)
    assert node.attribute_place("c")[1:] == (2, 5)
    assert [node.code_place("c", *at)[1:] for at in ((1, 3), (1, 6), (2, 1))] == [
        (2, 10),
        (2, 13),
        (3, 6),
    ]
    assert [node.code_place("", 1, column)[1:] for column in (1, 2, 3)] == [
        (3, 9),
        (3, 20),
        (3, 33),
    ]


@pytest.mark.parametrize(
    ("value", "kind", "message"),
    [
        (None, "id", "x (null or undefined) is not a name."),
        (math.nan, "number", 'x "NaN" is not a number.'),
        (math.inf, "number", 'x "Infinity" is not a number.'),
        (True, "number", 'x "true" is not a number.'),
        (1.5, "boolean", 'x "1.5" is not true or false.'),
        (0, "duration", 'x "0" is out of range: from 1s to 60s.'),
    ],
)
def test_values_in_messages_are_written_as_the_author_writes_them(
    value: object, kind: str, message: str
) -> None:
    with pytest.raises(ValueError) as wrong:
        check_argument("x", Argument(kind, "", 1000, 60_000), value)
    assert str(wrong.value) == message


@pytest.mark.parametrize(
    "body",
    [
        '<form id="a"><field name="x" type="boolean"/></form><noinput><exit/></noinput>',
        '<form id="a"><block><speak>x</speak></block></form><on event="error touch"><exit/></on>',
        '<form id="a"><block><speak>x</speak></block></form><on event="touch"><exit/></on>',
    ],
)
def test_a_handler_that_an_event_can_reach_leaves_a_state(body: str) -> None:
    assert [p for p in read(body)[1] if p.code == "dead-end"] == []
