"""Variables and their scopes: VoiceXML 2.0, 5.1."""

from __future__ import annotations

import pytest

from prima.voicexml.reading import read_page
from tests.helpers.dialogs import (
    CITIES,
    GRAMMAR,
    HOME,
    LEAF,
    PAGE,
    SILENT,
    YES,
    Case,
    Cases,
    ask,
    asked,
    block,
    grammar,
    holds,
    leaf,
    rule,
    run,
)
from tests.helpers.voice import Call, vxml

case = Cases()

case(
    "a variable that is not declared is error.semantic",
    "5.1.1",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><log expr="zz"/></block></form>""",
    logs=["semantic"],
)
case(
    "variables of a document are declared in order",
    "5.1.1",
    """<var name="a" expr="1"/><script>var b = a + 1;</script><var name="c" expr="b + 1"/>
    <form><block><log expr="c"/></block></form>""",
    logs=["3"],
)
case(
    "a variable may be declared again in its scope",
    "5.1.1",
    """<form><block><var name="a" expr="1"/><var name="a" expr="2"/><log expr="a"/></block></form>""",
    logs=["2"],
)
case(
    "inner variables shadow outer ones and scopes reach them",
    "5.1.2",
    f"""{LEAF}<var name="x" expr="'doc'"/><form><var name="x" expr="'dlg'"/><block>
    <var name="x" expr="'anon'"/>
    <log expr="[x, dialog.x, document.x, application.x].join()"/></block></form></vxml>""",
    logs=["anon,dlg,doc,app"],
    files={"root": f"{PAGE}<var name='x' expr=\"'app'\"/></vxml>"},
)
case(
    "without a root the document is the application",
    "5.1.2",
    """<var name="x" expr="1"/><form><block><log expr="application.x"/>
    <assign name="application.x" expr="2"/><log expr="document.x"/></block></form>""",
    logs=["1", "2"],
)
case(
    "a root's variables are its document's as well",
    "5.1.2",
    f"""{LEAF}<form><block><goto next="root.vxml"/></block></form></vxml>""",
    logs=["3,3"],
    files={
        "root": f"{PAGE}<var name='x' expr='3'/><form><block>"
        "<log expr='[document.x, application.x].join()'/></block></form></vxml>"
    },
)
case(
    "an anonymous variable ends with its element",
    "5.1.2",
    """<form><block><var name="x" expr="1"/></block><block><log expr="typeof x"/></block></form>""",
    logs=["undefined"],
)
case(
    "an anonymous scope is each filled's and catch's own",
    "5.1.2",
    f"""<form><catch event="odd"><var name="y" expr="1"/><log expr="typeof x"/></catch>
    <field name="f">{CITIES}<filled><var name="x" expr="1"/><throw event="odd"/></filled></field>
    <block><log expr="typeof y"/></block></form>""",
    "kyoto",
    logs=["undefined", "undefined"],
)
case(
    "an if has no scope of its own",
    "5.1.2",
    """<form><block><if cond="true"><var name="x" expr="1"/></if><log expr="x"/></block></form>""",
    logs=["1"],
)
case(
    "a dialog's variables end with it",
    "5.1.2",
    """<form><var name="x" expr="1"/><block><goto next="#t"/></block></form>
    <form id="t"><block><log expr="typeof x"/></block></form>""",
    logs=["undefined"],
)
case(
    "a variable may have the name of what every object has",
    "5.1",
    f"""<var name="toString" expr="1"/><form><var name="constructor" expr="'mine'"/>
    <field name="valueOf"><prompt>Where?</prompt>{CITIES}<filled><assign name="constructor" expr="constructor + valueOf"/>
    <log expr="constructor"/><log expr="dialog.constructor + toString"/></filled></field></form>
    """,
    "Kyoto",
    logs=["mineKyoto", "mineKyoto1"],
)
case(
    "a scope is an object, as text and with the method that says what it has",
    "5.1.2",
    """<form><var name="x"/><block><log expr="1 + dialog"/>
    <log expr="dialog.hasOwnProperty('x') + ' ' + dialog.hasOwnProperty('y')"/></block></form>""",
    logs=["1[object Object]", "true false"],
)
case(
    "a field may have the name of a global that the platform itself uses",
    "5.1.5",
    f"""<form><field name="Object"><prompt>Where?</prompt>{CITIES}</field><block>
    <script>Object = null; x = 1;</script><log expr="x"/>
    <log expr="application.lastresult$.utterance"/></block></form>""",
    "Kyoto",
    logs=["1", "Kyoto"],
)
case(
    "a form item begins undefined, whatever a variable of its name had",
    "C",
    f"""<form><var name="f" expr="'before'"/><script>var g = 1;</script>
    <field name="f"><prompt>Where?</prompt>{CITIES}</field><field name="g">{CITIES}</field>
    <block><log expr="f + g"/></block></form>""",
    "Kyoto",
    "Nara",
    logs=["KyotoNara"],
)
for name in ("_x", "x$", "class", "true", "1a", "a b", "a-b"):
    item = f'<field name="{name}">{CITIES}</field>'
    for declared in (f'<var name="{name}"/>', item, f'<block><var name="{name}"/></block>'):
        case(
            f"{name} cannot name the variable of {declared[1:4]}",
            "5.1",
            f"""<form>{declared}<block><log>on</log></block>
            <catch event="error.semantic"><log>wrong</log><exit/></catch></form>""",
            logs=["wrong"],
        )
case(
    "a document's variables last from dialog to dialog",
    "5.1.2",
    """<var name="x" expr="1"/><form><block><assign name="x" expr="2"/><goto next="#t"/></block></form>
    <form id="t"><block><log expr="x"/></block></form>""",
    logs=["2"],
)
case(
    "a document's variables end with it",
    "5.1.2",
    """<var name="x" expr="1"/><form><block><goto next="other.vxml"/></block></form>""",
    logs=["undefined"],
    files={"other": f"{PAGE}<form><block><log expr='typeof x'/></block></form></vxml>"},
)
case(
    "a function of the root sees the root's variables",
    "5.1.2",
    f"""{LEAF}<var name="x" expr="'leaf'"/><form><block><log expr="f()"/></block></form></vxml>""",
    logs=["root"],
    files={
        "root": f"{PAGE}<var name='x' expr=\"'root'\"/><script>function f() {{ return x; }}</script></vxml>"
    },
)
case(
    "a field shadows a document's variable of its name",
    "5.1.2",
    f"""<var name="f" expr="1"/><form><field name="f">{CITIES}</field>
    <block><log expr="f + document.f + dialog.f"/></block></form>""",
    "nara",
    logs=["Nara1Nara"],
)
case(
    "a handler's variable is its own in each run",
    "5.1.2",
    f"""<form><field name="f">{CITIES}<nomatch><log expr="typeof n"/><var name="n" expr="1"/></nomatch>
    </field></form>""",
    "x",
    "x",
    logs=["undefined", "undefined"],
)
case(
    "an assignment reaches the innermost variable",
    "5.1.3",
    """<var name="x" expr="'doc'"/><form><var name="x" expr="'dlg'"/><block>
    <assign name="x" expr="'new'"/><log expr="dialog.x + document.x"/></block></form>""",
    logs=["newdoc"],
)
case(
    "an assignment may name its scope",
    "5.1.3",
    """<var name="x" expr="'doc'"/><form><var name="x" expr="'dlg'"/><block>
    <assign name="document.x" expr="'new'"/><log expr="dialog.x + document.x"/></block></form>""",
    logs=["dlgnew"],
)
case(
    "the session's connection may be looked at",
    "5.1.4",
    """<form><block><log expr="typeof session.connection.remote.uri"/>
    <log expr="typeof session.connection.protocol.name"/></block></form>""",
    logs=["undefined", "undefined"],
)
case(
    "the session's connection cannot be assigned",
    "5.1.4",
    """<form><catch event="error.semantic"><log>semantic</log></catch>
    <block><assign name="session.connection" expr="1"/></block></form>""",
    logs=["semantic"],
)
case(
    "an utterance that a link takes is the last result",
    "5.1.5",
    f"""<link next="#t">{HOME}</link><form><field name="f">{CITIES}</field></form>
    <form id="t"><block><log expr="application.lastresult$.utterance"/></block></form>""",
    "go home",
    logs=["go home"],
)
case(
    "the last result has its properties and is an array",
    "5.1.5",
    f"""<form><field name="f">{CITIES}</field><block>
    <log expr="var_(application.lastresult$)"/></block>
    <script>function var_(r) {{ return [r.length, r[0].utterance, r.utterance, r.inputmode,
      r.interpretation, r[0].confidence].join(); }}</script></form>""",
    "Nara",
    logs=["1,Nara,Nara,voice,Nara,1"],
)
case(
    "no last result outlasts the wait of a subdialog",
    "5.1.5",
    f"""<form><field name="f">{CITIES}</field><subdialog src="#s"/><block>
    <log expr="typeof application.lastresult$"/></block></form>
    <form id="s"><field name="g">{CITIES}</field><block><return/></block></form>""",
    "Nara",
    "Kyoto",
    logs=["undefined"],
)
case(
    "the last result is the root's in a leaf",
    "5.1.5",
    f"""{LEAF}<form><field name="f">{CITIES}</field><block><goto next="other.vxml"/></block></form>
    </vxml>""",
    "Nara",
    logs=["Nara"],
    files={
        "root": f"{PAGE}</vxml>",
        "other": f"{LEAF}<form><block><log expr='application.lastresult$.utterance'/></block></form>"
        "</vxml>",
    },
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_a_leaf_hides_the_roots_variable_of_the_same_name() -> None:  # 5.1.2
    call = Call(
        leaf('<var name="a" expr="1"/>' + block('<log expr="a"/><log expr="application.a"/>')),
        root=vxml("<var name='a' expr='7'/>"),
    )
    assert call.logs() == ["1", "7"]


CHANGES = [
    '<assign name="session" expr="1"/>',
    '<assign name="session.x" expr="1"/>',
    '<assign name="session.connection" expr="1"/>',
    '<assign name="session.connection.remote.uri" expr="1"/>',
    '<assign name="connection" expr="1"/>',
    '<assign name="session.session" expr="1"/>',
    '<clear namelist="session.connection"/>',
    '<clear namelist="session"/>',
    "<script>session = 1</script>",
    "<script>session.x = 1</script>",
    "<script>'use strict'; session.connection = 1</script>",
    "<script>session.connection.local.uri = 'tel:1'</script>",
    "<script>delete session.connection</script>",
    "<script>Object.defineProperty(session, 'x', {value: 1})</script>",
    "<script>Object.assign(session.connection, {x: 1})</script>",
    "<script>Object.setPrototypeOf(session, null)</script>",
    "<script>Object.freeze(session.connection)</script>",
    "<script>session.connection.redirect.push(1)</script>",
    "<script>Object.getOwnPropertyDescriptor(session, 'connection').value.x = 1</script>",
    "<script>Object.values(session.connection)[0].x = 1</script>",
    '<var name="c" expr="session.connection"/><assign name="c.x" expr="1"/>',
]


@pytest.mark.parametrize("change", CHANGES)
def test_session_variables_are_read_only(change: str) -> None:  # 5.1.2
    call = Call(
        f"""<form><catch event="error.semantic"><log expr="_message"/></catch>
        <block>{change}<log>changed</log></block>
        <block><log expr="JSON.stringify(session.connection)"/></block></form>"""
    )
    found = call.logs()
    why = ("session variables are read-only", "is not declared", "of undefined")
    assert any(one in found[0] for one in why)
    assert found[1:] == ['{"local":{},"remote":{},"protocol":{}}']


def test_a_document_may_hide_the_session_by_a_variable_of_its_own() -> None:  # 5.1.2
    call = Call(
        """<form><var name="session" expr="1"/><block><assign name="session" expr="2"/>
        <log expr="session"/></block></form>"""
    )
    assert call.logs() == ["2"]


def test_lastresult_has_the_n_best_as_many_as_maxnbest_says() -> None:  # 5.1.5
    call = Call(
        '<property name="maxnbest" value="2"/>'
        + """<form><field name="f"><prompt>Well?</prompt>
        <option accept="approximate">red car</option><option accept="approximate">red bus</option>
        <option accept="approximate">red boat</option>
        <filled><log expr="application.lastresult$.length"/>
        <log expr="application.lastresult$[1].interpretation"/>
        <log expr="application.lastresult$.interpretation"/></filled></field></form>"""
    )
    call.answer("red")
    assert call.logs() == ["2", "red bus", "red car"]


N_BEST = """<property name="maxnbest" value="{}"/><form><field name="f"><prompt>Well?</prompt>
<option value="B">Boston</option><option value="A">Austin</option><option value="H">Houston</option>
<option value="A">Aston</option><nomatch><foreach item="one" array="application.lastresult$"><log expr="'no ' + one.utterance + ' '
 + one.confidence"/></foreach></nomatch>
<filled><foreach item="one" array="application.lastresult$"><log expr="one.utterance + ' ' +
 one.confidence + ' ' + one.interpretation + ' ' + one.inputmode"/></foreach>
<log expr="f + ' ' + f$.utterance + ' ' + f$.confidence + ' ' + f$.interpretation + ' ' + f$.inputmode"/>
</filled></field></form>"""


@pytest.mark.parametrize(
    ("most", "said", "logged"),
    [
        (
            3,
            ("Boston", {"Austin": 0.6, "Houston": 0.5}),
            ["Boston 0.7 B voice", "Austin 0.6 A voice", "Houston 0.5 H voice"],
        ),
        (
            2,
            ("Boston", {"Austin": 0.6, "Houston": 0.5}),
            ["Boston 0.7 B voice", "Austin 0.6 A voice"],
        ),
        (1, ("Boston", {"Austin": 0.6}), ["Boston 0.7 B voice"]),
        (3, ("Austin", {"Aston": 0.6}), ["Austin 0.7 A voice", "Aston 0.6 A voice"]),
        (3, ("Bosten", {"Houston": 0.6, "Austin": 0.3}), ["Houston 0.6 H voice"]),
    ],
)
def test_lastresult_has_what_else_the_recogniser_has_heard(
    most: int, said: tuple[str, dict[str, float]], logged: list[str]
) -> None:  # 5.1.5
    call = Call(N_BEST.format(most))
    call.play()
    call.listens()
    call.hears(said[0], 0.7, **said[1])
    town, sure, code, _ = logged[0].split()
    assert call.logs() == [*logged, f"{code} {town} {sure} {code} voice"]


def test_of_several_results_the_surest_comes_first_and_fills_the_field() -> None:  # 5.1.5
    """What a grammar passes over as garbage makes it less sure of the rest."""
    call = Call(
        f"""<property name="maxnbest" value="2"/><form><field name="f"><prompt>Sure?</prompt>
        <grammar {GRAMMAR} root="r"><rule id="r"><ruleref special="GARBAGE"/>
        <one-of><item>yes</item><item>no</item></one-of></rule></grammar>
        <filled><foreach item="one" array="application.lastresult$"><log expr="one.utterance + ' ' +
        one.confidence"/></foreach><log expr="f"/></filled></field></form>"""
    )
    call.play()
    call.listens()
    call.hears("um yes", 0.9, no=0.8)
    assert call.logs() == ["no 0.8", "um yes 0.675", "no"]


def test_what_the_recogniser_is_not_sure_of_is_nomatch_and_lastresult_tells() -> None:  # 5.1.5
    call = Call(N_BEST.format(2))
    call.play()
    call.listens()
    call.hears("Boston", 0.4, Austin=0.3, Houston=0.2)
    assert call.logs() == ["no Boston 0.4", "no Austin 0.3"]


def test_lastresult_has_one_result_unless_more_are_asked_for() -> None:  # 5.1.5
    call = Call(
        """<form><field name="f"><prompt>Well?</prompt><option>tea</option>
        <filled><log expr="application.lastresult$.length"/>
        <log expr="application.lastresult$[0].utterance"/>
        <log expr="application.lastresult$.confidence"/></filled></field></form>"""
    )
    call.answer("tea")
    assert call.logs() == ["1", "tea", "1"]


def test_nomatch_sets_lastresult() -> None:  # 5.1.5
    call = Call(
        ask(
            '<option>tea</option><nomatch><log expr="application.lastresult$.utterance"/></nomatch>'
        )
    )
    call.answer("coffee")
    assert call.logs() == ["coffee"]


def test_a_links_choice_sets_lastresult() -> None:  # 5.1.5
    call = Call(
        f'<link event="odd">{rule("operator")}</link>' + ask("<option>yes</option>")
        + '<catch event="odd"><log expr="application.lastresult$.utterance"/><exit/></catch>'
    )  # fmt: skip
    call.answer("operator")
    assert call.logs() == ["operator"]


def test_lastresult_is_kept_until_the_next_wait() -> None:  # 5.1.5
    result = "application.lastresult$"
    call = run(
        f"""<form><field name="f"><prompt>One?</prompt>{YES}</field>
        <block><log expr="{result}.utterance"/></block>
        <field name="g"><prompt><value expr="{result}.utterance"/>?</prompt>{YES}
        <noinput><log expr="{result}"/></noinput></field></form>""",
        "yes",
        SILENT,
    )
    assert call.said() == ["One?", "yes?"]
    assert call.logs() == ["yes", "undefined"]


def test_lastresult_is_undefined_during_a_call() -> None:  # 5.1.5
    call = run(
        f"""<form><field name="f"><prompt>One?</prompt>{YES}</field>
        <transfer name="t" dest="tel:1" bridge="true"><filled>
        <log expr="application.lastresult$"/></filled></transfer></form>""",
        "yes",
    )
    assert call.logs() == ["undefined"]


def test_lastresult_has_no_more_than_what_fits() -> None:  # 5.1.5
    head = '<property name="maxnbest" value="5"/>'
    logged = asked(
        '<option>tea</option><option>coffee</option><filled><log expr="application.lastresult$.length"/></filled>',
        "tea",
        head=head,
    )
    assert logged == ["1", "tea"]


def test_what_fills_no_item_is_the_last_result() -> None:  # 5.1.5
    result = "application.lastresult$"
    call = run(
        f"""<form>{grammar("hi", "out.other = 1")}
        <field name="f" cond="{result} === undefined">{YES}</field>
        <block>{holds(f"{result}.interpretation.other == 1")}</block></form>""",
        "hi",
    )
    assert call.logs() == ["pass"]


@pytest.mark.parametrize(
    ("name", "warned"), [("a-b", True), ("class", True), ("1x", True), ("größe", False), ("$", False), ("of", False)]
)  # fmt: skip
def test_a_variable_that_no_expression_can_name_is_warned_of(name: str, warned: bool) -> None:
    text = f'<form><field name="{name}"><prompt>Q?</prompt>{YES}</field></form>'  # 5.1.1
    found = read_page("a.vxml", "a.vxml", vxml(text).encode()).warnings()
    assert [one.code for one in found] == ["bad-value"] * warned


@pytest.mark.parametrize("scope", ["dialog", "application"])
def test_a_scope_that_a_script_has_frozen_takes_no_answer(scope: str) -> None:  # 5.1.5
    freeze = f"<block><script>Object.freeze({scope});</script></block>"
    field = f"<field name='f'><prompt>Q?</prompt>{YES}</field>"
    catch = '<catch event="error.semantic"><log expr="_event"/><exit/></catch>'
    assert run(f"<form>{catch}{freeze}{field}</form>", "yes").logs() == ["error.semantic"]


def test_session_variables_can_be_read_in_every_way() -> None:
    reads = {
        "session.connection === session.connection": "true",
        "session === session.session": "true",
        "Object.keys(session.connection).join()": "local,remote,protocol",
        "typeof connection.remote.uri": "undefined",
        "'connection' in session": "true",
        "[...Object.entries(session.telephone)].length": "2",
    }
    logs = "".join(f'<log expr="{code}"/>' for code in reads)
    assert Call(f"<form><block>{logs}</block></form>").logs() == list(reads.values())
