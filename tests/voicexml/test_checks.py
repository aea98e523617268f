"""Checks of one VoiceXML document before a run: variables, questions, events, arguments."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api, loading
from tests.helpers.validating import VXML, in_the_passage, told
from tests.helpers.voice import Call


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<form><block><log expr="x"/></block></form>', "x"),
        ('<var name="a" expr="b"/><form/>', "b"),
        ('<form><block><assign name="x" expr="1"/></block></form>', "x"),
        ('<form><block><assign name="x.y" expr="1"/></block></form>', "x"),
        (
            '<form><var name="a"/><block><submit next="service:s" namelist="a b"/></block></form>',
            "b",
        ),
        ('<form><block cond="ready"/></form>', "ready"),
        ('<form id="a"><var name="x"/></form><form><block><log expr="x"/></block></form>', "x"),
        ('<catch event="e"><log expr="x"/></catch><form/>', "x"),
        (
            '<form xmlns:p="urn:prima:dialogue:1"><block><p:turn angle-expr="x"/></block></form>',
            "x",
        ),
        ("<form><block><script>var y = x;</script></block></form>", "x"),
        ("<script>function f(y) { return x + y; }</script><form><var name='x'/></form>", "x"),
        ("<form><block><script>x++;</script></block></form>", "x"),
        ("<form><block><log expr='(x = 1)'/></block></form>", "x"),
        ('<form><block><disconnect namelist="x"/></block></form>', "x"),
        ('<form><block><data src="service:s" namelist="x"/></block></form>', "x"),
        ('<form><block><var name="x"/></block><block><log expr="x"/></block></form>', "x"),
        ('<form><block><script>x = 1;</script></block><block><log expr="x"/></block></form>', "x"),
        ('<form><filled><var name="x"/></filled><catch><log expr="x"/></catch></form>', "x"),
        ('<catch event="e"><var name="x"/></catch><form><block><log expr="x"/></block></form>', "x"),
        ('<form><subdialog name="s" src="#a"><filled><log expr="s$.y"/></filled></subdialog></form>'
         '<form id="a"><block><return/></block></form>', "s$"),
        ('<var name="x"/><form><block><log expr="x$"/></block></form>', "x$"),
    ],
)  # fmt: skip
def test_a_variable_that_nothing_declares_is_told(tmp_path: Path, content: str, name: str) -> None:
    (one,) = told(tmp_path, content)
    assert f'undeclared-variable The variable "{name}" is not declared' in one


@pytest.mark.parametrize(
    ("content", "remedy"),
    [
        ("<if cond='n == tea'/>", """<var name="tea"/>. For the text itself write 'tea'."""),
        ("<assign name='n' expr=' tea '/>", "For the text itself write 'tea'."),
        ("<if cond='tea == n'/>", '<var name="tea"/>.'),
        ("<value expr='tea'/>", '<var name="tea"/>.'),
        ("<assign name='tea' expr='1'/>", '<var name="tea"/>.'),
        ("<if cond='n == True'/>", "Write true."),
        ("<script>n == tea;</script>", '<var name="tea"/>.'),
    ],
)
def test_a_text_without_quotes_is_told_as_one(tmp_path: Path, content: str, remedy: str) -> None:
    (one,) = told(tmp_path, f"<var name='n'/><form><block>{content}</block></form>")
    assert one.startswith("main.vxml undeclared-variable") and one.endswith(remedy)


@pytest.mark.parametrize(
    "code",
    [
        """<if cond="typeof q != 'undefined' &amp;&amp; q == 1"/>""",
        """<log expr="typeof q == 'undefined' ? 0 : q"/>""",
        """<script>if (typeof (q) != "undefined") { var z = q; }</script>""",
        """<if cond="typeof q != 'undefined'"><log expr="q"/></if>""",
    ],
)
def test_a_variable_that_is_tested_may_be_missing(tmp_path: Path, code: str) -> None:
    assert told(tmp_path, f"<form><block>{code}</block></form>") == []
    (one,) = told(tmp_path, f'<form><block>{code}<log expr="p"/></block></form>')
    assert 'The variable "p" is not declared' in one


@pytest.mark.parametrize(
    ("uri", "says"),
    [
        ("grammar/bolean", 'built-in type "builtin:grammar/bolean". Did you mean "boolean"?'),
        ("dtmf/digits?minlength=3;maxlength=2", "minlength is more than maxlength."),
        (
            "grammar/digits?size=3",
            'digits has no parameter "size". Write length, maxlength or minlength',
        ),
        (
            "dtmf/number?length=5",
            'no parameter "length". Only digits has it: write "digits?length=5".',
        ),
        ("grammar/date?y=5", "Remove it: only boolean and digits have parameters."),
        ("grammar/boolean", ""),
        ("dtmf/digits?length=4", ""),
    ],
)
def test_a_built_in_grammar_is_checked_as_a_type_is(
    tmp_path: Path, uri: str, says: str
) -> None:  # 2.3.1.2
    grammar = f'<grammar src="builtin:{uri}"/>'
    found = told(tmp_path, f'<form><field name="f">{grammar}</field></form>')
    assert len(found) == bool(says) and says in "".join(found)


@pytest.mark.parametrize("written", ['src="a.txt"', "srcexpr=\"'a.txt'\""])
def test_a_grammar_of_another_format_is_told(tmp_path: Path, written: str) -> None:  # 3.1.1.4
    (tmp_path / "a.txt").write_text("yes | no")
    field = f'<field name="f"><grammar {written} type="text/foo"/></field>'
    [found] = told(tmp_path, f"<form>{field}</form>")
    assert found.startswith('main.vxml format Grammars of type "text/foo" are not supported.')


GOTO = '<catch event="e"><goto nextitem="{}"/></catch>'


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (f"<form>{GOTO}<block name='pay'/></form>", 'form has no item "{}" to go to'),
        ("<form><block name='pay'><goto nextitem='{}'/></block></form>", 'form has no item "{}"'),
        (f"<menu>{GOTO}<choice event='e'>pay</choice></menu>", 'menu has no item "{}"'),
    ],
)
def test_an_item_to_go_to_that_is_not_there_is_told(
    tmp_path: Path, content: str, message: str
) -> None:  # 5.3.7
    end = '<form id="end"/>'
    (one,) = told(tmp_path, content.format("play") + end)
    assert one.startswith("main.vxml no-such-item This " + message.format("play"))
    assert one.endswith('Did you mean "pay"?') == ("<form>" in content)
    (one,) = told(tmp_path, content.format("end") + end)
    assert one.endswith('It is a dialog: write next="#end".')


def test_an_item_to_go_to_that_is_there_is_none_to_tell(tmp_path: Path) -> None:
    form = """<form><p:iu xmlns:p="urn:prima:dialogue:1" name="u"><block name="b"/></p:iu>
    <block><if cond="true"><goto nextitem="b"/><elseif cond="false"/><goto expritem="'u'"/></if>
    <goto nextitem="u"/></block></form>"""
    assert told(tmp_path, GOTO.format("b") + form) == []


@pytest.mark.parametrize(
    "holder",
    ['<menu><choice next="#a">{}a</choice></menu>', '<link event="e">{}</link>'],
    ids=["choice", "link"],
)
def test_a_grammar_of_a_choice_or_link_has_no_scope(tmp_path: Path, holder: str) -> None:  # 3.1.3
    grammar = RULES.format(' scope="document"')
    (one,) = told(tmp_path, holder.format(grammar) + '<form id="a"><block/></form>')
    assert "unknown-attribute <grammar> in <" in one and 'has no "scope"' in one


FIELD = '<field name="a"{}><prompt>Q?</prompt>{}</field>'
RULES = '<grammar version="1.0" root="r"{}><rule id="r">a</rule></grammar>'
UNIVERSALS = '<property name="universals" value="all"/>'


@pytest.mark.parametrize(
    "content",
    [
        f"<form>{FIELD.format('', '')}</form>",
        f'<form><p:iu xmlns:p="urn:prima:dialogue:1">{FIELD.format("", "")}</p:iu></form>',
        "<form>" + FIELD.format(' modal="true"', "") + "</form><link event='e' dtmf='1'/>",
        f"<form>{FIELD.format('', '')}</form><form>{RULES.format('')}</form>",
        f"<form>{FIELD.format('', '<option/>')}</form>",
        f"<form>{FIELD.format('', '')}</form><link event='e'/>",
        f"<form>{FIELD.format('', '')}</form><form scope='document'/>",
    ],
)
def test_a_question_of_voicexml_at_which_no_grammar_listens_is_told(
    tmp_path: Path, content: str
) -> None:
    (one,) = told(tmp_path, content)
    assert one.startswith("main.vxml no-answer No grammar listens at the <field> a: ")


@pytest.mark.parametrize(
    "content",
    [
        "<form>" + FIELD.format(' type="boolean"', "") + "</form>",
        f"<form>{FIELD.format('', '<option>tea</option>')}</form>",
        f"<form>{FIELD.format('', RULES.format(''))}</form>",
        f"<form>{RULES.format('')}<initial/>{FIELD.format('', '')}</form>",
        f"<form>{FIELD.format('', '')}<link event='e' dtmf='1'/></form>",
        f"<form>{FIELD.format('', '')}</form><link event='e' dtmf='1'/>",
        f"<form>{FIELD.format('', '')}</form><form scope='document'>{RULES.format('')}</form>",
        f"<form>{FIELD.format('', '')}</form><form>"
        + RULES.format(' scope="document"')
        + "</form>",
        f"{UNIVERSALS}<form>{FIELD.format('', '')}</form>",
        f"<form>{FIELD.format('', UNIVERSALS)}</form>",
        "<form>" + FIELD.format(' expr="1"', "") + "</form>",
        f"<form><block><assign name='a' expr='1'/></block>{FIELD.format('', '')}</form>",
    ],
)
def test_a_question_of_voicexml_at_which_something_listens_is_fine(
    tmp_path: Path, content: str
) -> None:
    assert [one for one in told(tmp_path, content) if "no-answer" in one] == []


@pytest.mark.parametrize(
    ("content", "warned"),
    [
        ('<menu id="m"><choice event="e"/></menu>', True),
        ('<menu id="m"><choice event="e"><audio src="a.wav"/></choice></menu>', True),
        ('<menu id="m"><choice event="e"><audio src="a.wav">Tea</audio></choice></menu>', False),
        ('<menu id="m"><choice event="e" dtmf="1"/></menu>', False),
        ('<menu id="m" dtmf="true"><choice event="e"/></menu>', False),
        ('<menu id="m"><choice event="e"/></menu><link event="e" dtmf="1"/>', False),
    ],
)
def test_a_menu_of_which_nothing_can_be_chosen_is_told(
    tmp_path: Path, content: str, warned: bool
) -> None:
    says = "no-answer No grammar listens at the <menu> m: it takes no answer at all."
    assert [says in one for one in told(tmp_path, content) if "no-answer" in one] == [True] * warned
    assert Call(content).ended.startswith("error.semantic") == warned


def test_what_listens_in_an_application_root_listens_in_its_leaves(tmp_path: Path) -> None:
    root, leaf = (
        VXML.format("", "<link event='e' dtmf='1'/>"),
        f"<form>{FIELD.format('', '')}</form>",
    )
    assert told(tmp_path, leaf, ' application="root.vxml"', root=root) == []
    assert (
        "no-answer" in told(tmp_path, leaf, ' application="root.vxml"', root=VXML.format("", ""))[0]
    )


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<var name="session"/><form/>', "session"),
        ("<script>var session = 5;</script><form/>", "session"),
        ("<form><block><script>function dialog() {}</script></block></form>", "dialog"),
        ('<form><field name="document" type="boolean"/></form>', "document"),
        ("<script>function f(session) { var application; return session; }</script><form/>", ""),
    ],
)
def test_a_variable_that_hides_a_scope_is_told(tmp_path: Path, content: str, name: str) -> None:
    found = [one for one in told(tmp_path, content) if " hides " in one]
    assert len(found) == bool(name)
    assert all(f'bad-value The variable "{name}" hides the ' in one for one in found)


MEMBERS = """<form><var name="own"/><block>{}</block></form>"""


@pytest.mark.parametrize(
    ("content", "holder", "name"),
    [
        (MEMBERS.format('<assign name="document.q" expr="1"/>'), "document", "q"),
        (MEMBERS.format('<assign name="application.q" expr="1"/>'), "application", "q"),
        (MEMBERS.format('<assign name="dialog.q.z" expr="1"/>'), "dialog", "q"),
        (MEMBERS.format('<clear namelist="own dialog.q"/>'), "dialog", "q"),
        (MEMBERS.format('<value expr="dialog.q.foo"/>'), "dialog", "q"),
        (MEMBERS.format('<value expr="document.own.length"/>'), "document", "own"),
        (MEMBERS.format("<script>var a = dialog.q.z;</script>"), "dialog", "q"),
        (
            '<catch event="e"><assign name="application.q" expr="1"/></catch><form/>',
            "application",
            "q",
        ),
        (
            '<form><var name="q"/></form>' + MEMBERS.format('<value expr="dialog.q.z"/>'),
            "dialog",
            "q",
        ),
    ],
)
def test_a_member_of_a_scope_that_nothing_declares_there_is_told(
    tmp_path: Path, content: str, holder: str, name: str
) -> None:
    (one,) = told(tmp_path, content)
    says = f'undeclared-variable The scope "{holder}" declares no variable "{name}": this will be'
    assert says in one


@pytest.mark.parametrize(
    "content",
    [
        '<form><block><log expr="the visitor"/></block></form>',
        '<form><block><if cond="what is it?"/></block></form>',
        "<form><script>var a = the visitor;</script></form>",
        '<form><block><value expr="the document.visitor.name"/></block></form>',
    ],
)
def test_words_of_a_text_in_place_of_code_are_one_mistake(tmp_path: Path, content: str) -> None:
    (one,) = told(tmp_path, content)
    assert "bad-expression" in one


@pytest.mark.parametrize(
    ("content", "name"),
    [
        ('<var name="a" expr="x"/><var name="x" expr="1"/><form/>', "x"),
        ('<form><var name="a" expr="x"/><var name="x" expr="1"/></form>', "x"),
        ('<form><var name="a" expr="x"/><field name="x" type="boolean"/></form>', "x"),
        ('<form><field name="a" type="boolean" expr="x"/><var name="x"/></form>', "x"),
        ('<form><script>var a = x;</script><var name="x"/></form>', "x"),
        ('<form><var name="a" expr="x()"/><script>function x() {}</script></form>', "x"),
        ('<form><block><log expr="x"/><var name="x"/></block></form>', "x"),
        ('<form><block><assign name="x" expr="1"/><var name="x"/></block></form>', "x"),
    ],
)
def test_a_variable_that_is_used_before_it_is_declared_is_told(
    tmp_path: Path, content: str, name: str
) -> None:
    (one,) = told(tmp_path, content)
    assert f'undeclared-variable The variable "{name}" is declared after this: this will be' in one
    assert one.endswith("Declare it before.")


@pytest.mark.parametrize(
    "content",
    [
        '<var name="x"/><form><block><log expr="x + document.x + application.y"/></block></form>',
        MEMBERS.format('<log expr="dialog.q"/><log expr="dialog.q &amp;&amp; dialog.q.z"/>'),
        MEMBERS.format('<if cond="dialog.q"><log expr="dialog.q.z"/></if>'),
        MEMBERS.format('<log expr="dialog.q?.z + application.lastresult$.confidence"/>'),
        MEMBERS.format('<script>dialog.q = {};</script><log expr="dialog.q.z"/>'),
        MEMBERS.format(
            '<script>f(dialog); function f(a) { a.q = 1; }</script><log expr="dialog.q.z"/>'
        ),
        MEMBERS.format('<assign name="dialog.own" expr="1"/><clear namelist="dialog.own"/>'),
        '<catch event="e"><log expr="document.q.z + dialog.own.z"/></catch>' + MEMBERS.format(""),
        '<var name="a" expr="function() { return x; }"/><var name="x"/><form/>',
        '<script>function f() { return x; }</script><var name="x"/><form/>',
        """<var name="a" expr="typeof x == 'undefined' ? 1 : x"/><var name="x"/><form/>""",
        '<form><block name="x"/><field name="a" type="boolean" expr="x"/></form>',
        '<form><block name="x"/><block><clear namelist="x dialog.x"/></block></form>',
        '<form><block cond="x"><log expr="x"/></block><var name="x"/></form>',
        '<form><block><foreach item="i" array="[1, 2]"><if cond="i == 2"><log expr="x"/></if>'
        '<var name="x"/></foreach></block></form>',
        '<form><block><if cond="true"><var name="x"/></if><log expr="x"/></block></form>',
        '<form><grammar version="1.0" root="r"><rule id="r">a</rule></grammar>'
        '<subdialog name="s" src="#a"><filled><log expr="s$.utterance"/></filled></subdialog></form>'
        '<form id="a"><block><return/></block></form>',
        '<form><field name="x" type="boolean"><filled><log expr="x$.utterance"/></filled></field></form>',
        '<form><block><log expr="typeof x"/></block></form>',
        '<form><block><script>var x = 1; y = 2;</script><log expr="x + y"/></block></form>',
        r'<script>this.x = 1; var \u0079 = 2;</script><form><block><log expr="x + y"/></block></form>',
        '<script src="x.js"/><form><block><log expr="fromfile(1)"/></block></form>',
        '<script src="gone.js"/><form><block><log expr="anything"/></block></form>',
        '<form><block><foreach item="x" array="[1]"><log expr="x"/></foreach></block></form>',
        '<form><block><log expr="session.connection + lastresult$.length"/></block></form>',
        '<form><block><log expr="connection.local.uri + telephone.ani"/></block></form>',
        '<catch event="e"><log expr="_event + x"/></catch><form><var name="x"/></form>',
        '<form><var name="x"/><block><script>y = x; a: while (y--) break a;</script></block></form>',
        "<script>with (Math) { var y = floor(PI); } function f() { return g() + y; }"
        "function g() { try { f(); } catch (e) { return e; } }</script><form/>",
        "<script>if (typeof x != 'undefined') eval('x');</script><form/>",
    ],
)
def test_a_variable_that_something_declares_is_none_to_tell(tmp_path: Path, content: str) -> None:
    (tmp_path / "x.js").write_text("function fromfile(a) { return a; }")
    assert [one for one in told(tmp_path, content) if "undeclared-variable" in one] == []


def test_variables_of_the_application_root_are_declared(tmp_path: Path) -> None:
    root = VXML.format("", '<var name="shared"/>')
    content = '<form><block><log expr="shared + own"/></block></form>'
    (one,) = told(tmp_path, content, ' application="root.vxml"', root=root)
    assert '"own"' in one
    assert 'no file "gone.vxml"' in told(tmp_path, content, ' application="gone.vxml"')[0]
    assert len(told(tmp_path, content, ' application="gone.vxml"')) == 1, "nobody knows the rest"


ROBOT = ' xmlns:p="urn:prima:dialogue:1" xml:lang="en"'
STANDING = [
    "<form><block>{}</block></form>",
    "<form><block><prompt>Look {}</prompt></block></form>",
    "<form><field name='f' type='boolean'><prompt>Well? {}</prompt></field></form>",
    "<form><field name='f' type='boolean'><filled>{}</filled></field></form>",
    "<catch event='e'>{}</catch><form/>",
    "<form><block><if cond='true'>{}</if></block></form>",
    "<form><block><foreach item='i' array='[1]'>{}</foreach></block></form>",
    "<form><block><p:par>{}</p:par></block></form>",
    "<form><block><p:seq>{}</p:seq></block></form>",
    "<form><block><p:iu><p:seq>{}</p:seq></p:iu></block></form>",
]


@pytest.mark.parametrize("around", STANDING)
@pytest.mark.parametrize(
    ("command", "code", "at"),
    [
        ("<p:gesture/>", "missing-attribute", "<p:gesture"),
        ("<p:pause/>", "missing-attribute", "<p:pause"),
        ("<p:point-by-hand/>", "missing-attribute", "<p:point"),
        ("<p:point-by-hand angle='900'/>", "out-of-range", "900"),
        ("<p:turn angle='far'/>", "bad-value", "far"),
        ("<p:gesture><param name='name' value='4 2'/></p:gesture>", "bad-value", "4 2"),
        ("<p:point-by-hand angle='3' toward='a'/>", "exclusive", "<p:point"),
        ("<p:gesture name='nod'>Hi.</p:gesture>", "stray-text", "<p:gesture"),
        ("<p:speak/>", "nothing-to-say", "<p:speak"),
    ],
)
def test_wrong_arguments_of_commands_in_voicexml_are_told(
    tmp_path: Path, around: str, command: str, code: str, at: str
) -> None:
    path = tmp_path / "main.vxml"
    path.write_text(text := VXML.format(ROBOT, around.format(command)))
    [one] = [one for one in loading.validate([path]) if one.code == code]
    assert one.severity == "warning", "at run time it is an event, which may be handled"
    assert one.place.column == text.index(at) + 1


@pytest.mark.parametrize(
    "command",
    [
        "<p:gesture name='nod'/>",
        "<p:gesture name-expr='1 + 1'/>",
        "<p:gesture><param name='name' expr='1 + 1'/></p:gesture>",
        "<p:point-by-hand angle-expr='900'/>",
        "<p:point-by-hand toward='door'/>",
        "<p:pause time='1s'/>",
        "<p:speak><value expr='1'/></p:speak>",
    ],
)
def test_right_arguments_of_commands_in_voicexml_are_none_to_tell(
    tmp_path: Path, command: str
) -> None:
    assert told(tmp_path, f"<form><block>{command}<exit/></block></form>", ROBOT) == []


def test_the_name_of_a_gesture_is_no_variable(tmp_path: Path) -> None:
    content = '<form><block><p:gesture name="zz1"/><log expr="zz1 + zz2"/><exit/></block></form>'
    first, second = told(tmp_path, content, ROBOT)
    assert '"zz1" is not declared' in first
    assert 'Declare it: <var name="zz2"/>.' in second


CATCHES = VXML.format("", '<catch event="{}"><exit/></catch><form><block>{}</block></form>')


@pytest.mark.parametrize(
    ("event", "meant"),
    [
        *(("tuch", "touch"), ("tuch.head", "touch.head"), ("human.fuond", "human.found")),
        *(("conection.disconnect.hangup", "connection.disconnect.hangup"), ("no-input", "noinput")),
        *(("error.badfetsh", "error.badfetch"), ("order.cancled", "order.cancelled")),
        *(
            ("touch", ""),
            ("touch.head", ""),
            ("order", ""),
            ("order.cancelled", ""),
            ("menu.left", ""),
        ),
        *(
            ("error.badfetch.http.404", ""),
            ("error.mine", ""),
            (".", ""),
            ("order.", ""),
            ("exit", ""),
        ),
        *(("error.unsupported.fly", ""), ("maxspeechtimeout", ""), ("connection", "")),
        ("error.connection.protocol.486", ""),
    ],
)
def test_a_handler_of_voicexml_whose_event_is_a_slip_is_told(
    tmp_path: Path, event: str, meant: str
) -> None:
    thrown = '<throw event="order.cancelled"/>'
    path = tmp_path / "main.vxml"
    path.write_text(text := CATCHES.format(event, thrown))
    told = [(one.message, one.remedy, one.place.column) for one in loading.validate([path])]
    right = f'Nothing raises an event "{event}".', f'Did you mean "{meant}"?', text.index(event) + 1
    assert told == ([right] if meant else [])


def test_a_touch_sensor_that_voicexml_misspells_is_told(tmp_path: Path) -> None:
    thrown = '<throw event="touch.own"/>'
    (tmp_path / "a.vxml").write_text(CATCHES.format("touch.hed touch.head touch.own", thrown))
    (one,) = in_the_passage(tmp_path, "a.vxml")
    assert one == 'a.vxml The robot has no touch sensor "hed". Did you mean "head"?'


def test_an_argument_of_a_command_in_voicexml_that_is_given_twice(tmp_path: Path) -> None:
    path = tmp_path / "a.vxml"
    path.write_text(
        '<vxml xmlns="http://www.w3.org/2001/vxml" version="2.1" xmlns:p="urn:prima:dialogue:1">'
        '<form><block><p:turn angle="30" angle-expr="40"/></block></form></vxml>'
    )
    (problem,) = api.validate([str(path)])
    assert problem.code == "exclusive"
    assert problem.message == '<p:turn> has both "angle" and "angle-expr".'
