"""Events and their handlers: VoiceXML 2.0, 5.2.1 to 5.2.3."""

from __future__ import annotations

import pytest

from tests.helpers.dialogs import (
    CITIES,
    GO,
    PASS,
    SILENT,
    Case,
    Cases,
    ask,
    logged,
    page,
    run,
    thrown,
)
from tests.helpers.voice import Call

COUNTED = """<form><var name="n" expr="0"/>{handlers}<field name="f"><option>x</option></field>
  <block><log>end</log></block></form>"""

case = Cases()

case(
    "after a handler the form goes on",
    "5.2",
    """<form><catch event="a"><log>a</log></catch><block><throw event="a"/><log>no</log></block>
    <block><log>on</log></block></form>""",
    logs=["a", "on"],
    ended="exit",
)
case(
    "a throw may be computed",
    "5.2.1",
    """<form><var name="n" expr="'a'"/><catch event="a"><log expr="_event + _message"/></catch>
    <block><throw eventexpr="n + '.b'" messageexpr="n + 1"/></block></form>""",
    logs=["a.ba1"],
)
case(
    "a thrown connection.disconnect is an event like others",
    "5.2.1",
    f"""<form><catch event="connection.disconnect"><log>caught</log></catch>
    <block><throw event="connection.disconnect.hangup"/></block>
    <block>On.</block><field name="f"><prompt>Well?</prompt>{CITIES}</field></form>""",
    logs=["caught"],
    said=["On.", "Well?"],
)
case(
    "a throw within foreach and if leaves all of it",
    "5.2.1",
    """<form><catch event="a"><log expr="typeof x"/></catch><block>
    <foreach item="x" array="[1, 2]"><if cond="x == 1"><log expr="x"/><throw event="a"/></if></foreach>
    </block></form>""",
    logs=["1", "undefined"],
)
case(
    "a computed throw of what is not declared is error.semantic",
    "5.2.1",
    logged("error.semantic", "<block><throw eventexpr='zz'/></block>"),
    logs=["error.semantic"],
)
case(
    "an event in a field's filled is the field's",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<filled><throw event="odd"/></filled>
    <catch event="odd"><log>field</log></catch></field><catch event="odd"><log>form</log></catch>
    </form>""",
    "kyoto",
    logs=["field"],
)
case(
    "an event in a form's filled is not the field's",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<catch event="odd"><log>field</log></catch></field>
    <filled><throw event="odd"/></filled><catch event="odd"><log>form</log></catch></form>""",
    "kyoto",
    logs=["form"],
)
case(
    "a handler without an event takes all",
    "5.2.2",
    thrown("<catch><log expr='_event'/></catch>"),
    logs=["a.b.c"],
)
case(
    "a handler may name many events",
    "5.2.2",
    thrown("<catch event='x y a'><log>x</log></catch>"),
    logs=["x"],
)
case(
    "the highest count that is reached is chosen",
    "5.2.2",
    COUNTED.format(
        handlers="<nomatch><log>1</log></nomatch><nomatch count='3'><log>3</log></nomatch>"
    ),
    "y",
    "y",
    "y",
    "y",
    logs=["1", "1", "3", "3"],
)
case(
    "events are counted by full names and prefixes",
    "5.2.2",
    """<form><catch event="a" count="3"><log>third</log></catch>
    <catch event="a.b" count="2"><log>second b</log></catch>
    <catch event="a"><log expr="_event"/></catch>
    <field name="f"><option>x</option>
    <nomatch><throw event="a.b"/></nomatch><noinput><throw event="a.c"/></noinput></field></form>""",
    "y",
    SILENT,
    "y",
    logs=["a.b", "a.c", "third"],
)
case(
    "each item counts for itself",
    "5.2.2",
    """<form><nomatch><log>1</log></nomatch><nomatch count="2"><log>2</log></nomatch>
    <field name="f"><option>x</option></field><field name="g"><option>x</option></field></form>""",
    "y",
    "x",
    "y",
    logs=["1", "1"],
)
case(
    "counters start again when the form is entered again",
    "5.2.2",
    """<form id="a"><field name="f"><option>x</option><nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log><goto next="#a"/></nomatch></field></form>""",
    "y",
    "y",
    "y",
    logs=["1", "2", "1"],
)
case(
    "a field's counters last while the form does",
    "5.2.2",
    """<form><field name="f"><option>x</option><nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch><filled><assign name="f" expr="undefined"/></filled>
    </field></form>""",
    "y",
    "x",
    "y",
    logs=["1", "2"],
)
case(
    "the form's own counters are not reset by clear",
    "5.2.2",
    """<form><field name="f"><option>x</option></field><filled><clear/><throw event="odd"/></filled>
    <catch event="odd"><log>1</log></catch><catch event="odd" count="2"><log>2</log></catch></form>""",
    "x",
    "x",
    logs=["1", "2"],
)
case(
    "the event's name and message are the handler's",
    "5.2.2",
    thrown(
        "<catch event='a'><log expr=\"_event + ': ' + _message\"/></catch>",
        attributes="message='m'",
    ),
    logs=["a.b.c: m"],
)
case(
    "without a message it is undefined",
    "5.2.2",
    thrown("<catch event='a'><log expr='typeof _message'/></catch>"),
    logs=["undefined"],
)
for how in ('<throw event="a" message=""/>', """<throw event="a" messageexpr="''"/>"""):
    case(
        f"an empty message is not a missing one: {how}",
        "5.2.2",
        f"""<form><catch event="a"><log expr="_message === ''"/></catch><block>{how}</block></form>""",
        logs=["true"],
    )
case(
    "a subdialog returns an event with an empty message",
    "5.2.2",
    """<form><subdialog name="s" src="#t"><catch event="a"><log expr="_message === ''"/><exit/></catch>
    </subdialog></form><form id="t"><block><return event="a" message=""/></block></form>""",
    logs=["true"],
)
case(
    "an error of the platform has a message",
    "5.2.2",
    """<form><catch event="error"><log expr="typeof _message + _event"/></catch>
    <block><assign name="zz" expr="1"/></block></form>""",
    logs=["stringerror.semantic"],
)
case(
    "the event's variables are seen in the handler alone",
    "5.2.2",
    """<form><catch event="a"><log>a</log></catch><block><throw event="a"/></block>
    <block><log expr="typeof _event"/></block></form>""",
    logs=["a", "undefined"],
)
case(
    "a variable called event is the document's own",
    "5.2.2",
    """<var name="event" expr="'mine'"/><form><catch event="a"><log expr="event"/></catch>
    <block><throw event="a"/></block></form>""",
    logs=["mine"],
)
case(
    "a handler may throw on",
    "5.2.2",
    """<catch event="b"><log expr="_event"/></catch>
    <form><catch event="a"><throw event="b"/></catch><block><throw event="a"/></block></form>""",
    logs=["b"],
)
case(
    "an event thrown in a handler is looked for from the same scope",
    "5.2.2",
    """<form><field name="f"><option>x</option><nomatch><throw event="b"/></nomatch>
    <catch event="b"><log>field</log></catch></field><catch event="b"><log>form</log></catch></form>""",
    "y",
    logs=["field"],
)
case(
    "a handler may end the handling by throwing to a higher count",
    "5.2.2",
    """<form><catch event="a"><log>1</log><throw eventexpr="_event"/></catch>
    <catch event="a" count="2"><log>2</log></catch><block><throw event="a"/></block></form>""",
    logs=["1", "2"],
)
case(
    "a handler that throws to itself for ever is stopped",
    "5.2.2",
    thrown("<catch event='a'><throw event='a'/></catch>"),
    ended="error.semantic",
)
case(
    "an error at a dialog's initialisation is handled",
    "5.2.2",
    """<form id="a"><catch event="error.semantic"><log>semantic</log><exit/></catch>
    <var name="x" expr="zz"/><block><log>no</log></block></form>""",
    logs=["semantic"],
)
case(
    "an error in a document's variables is handled by its handlers",
    "5.2.2",
    """<catch event="error.semantic"><log>semantic</log><goto next="#t"/></catch>
    <var name="x" expr="zz"/><form><block><log>no</log></block></form>
    <form id="t"><block><log>t</log></block></form>""",
    logs=["semantic", "t"],
)
case(
    "an error in a document's variables does not count with those of the dialog before",
    "5.2.2",
    """<form><var name="x" expr="zz"/><catch event="error.semantic"><log>form</log>
    <goto nextitem="b"/></catch><block name="b"><goto next="other.vxml"/></block></form>""",
    logs=["form", "first"],
    files={
        "other": page("""<var name="x" expr="zz"/>
        <catch event="error.semantic"><log>first</log></catch>
        <catch event="error.semantic" count="2"><log>second</log></catch><form/>""")
    },
)
case(
    "a nomatch that is thrown counts with those that were heard",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch><filled><clear namelist="zz"/></filled></field>
    <var name="zz"/></form>""",
    "x",
    "x",
    logs=["1", "2"],
)
case(
    "an event thrown in a filled is counted by its field",
    "5.2.2",
    f"""<form><field name="a">{CITIES}<nomatch><log>1</log></nomatch>
    <nomatch count="2"><log>2</log></nomatch>
    <filled><assign name="a" expr="undefined"/><throw event="nomatch"/></filled></field></form>""",
    "x",
    "nara",
    logs=["1", "2"],
)
case(
    "a form's handlers hear of what its last item threw",
    "5.2.2",
    """<form><block/><catch event="a"><log>a</log></catch><block><throw event="a"/></block></form>""",
    logs=["a"],
    ended="exit",
)
case(
    "the short names are handlers of their events",
    "5.2.3",
    """<form><error><log>error</log></error><block><throw event="error.odd"/></block>
    <help><log>help</log></help><block><throw event="help"/></block>
    <noinput><log>noinput</log></noinput><block><throw event="noinput"/></block>
    <nomatch><log>nomatch</log></nomatch><block><throw event="nomatch"/></block></form>""",
    logs=["error", "help", "noinput", "nomatch"],
)
case(
    "error takes every error",
    "5.2.3",
    """<form><error><log expr="_event"/><exit/></error><block><goto next="none.vxml"/></block></form>""",
    logs=["error.badfetch"],
)


@pytest.mark.parametrize("one", case.made)
def test_rule(one: Case) -> None:
    one.holds()


def test_an_event_from_outside_counts_at_the_item() -> None:
    """5.2.2."""
    call = Call(
        f"""<form><catch event="touch"><log>1</log></catch>
        <catch event="touch" count="2"><log>2</log></catch><field name="f">{CITIES}</field></form>"""
    )
    call.event("touch.head")
    call.event("touch.arm")
    assert call.logs() == ["1", "2"]


def test_events_count_under_the_names_that_handlers_have() -> None:  # 5.2.2
    call = run(
        f"""<form><catch event="a.b" count="2">{PASS}</catch><catch event="a"><log>1</log></catch>
        <block name="x"><throw event="a.b.c"/></block><block><log>on</log></block></form>"""
    )
    assert call.logs() == ["1", "on"]


def test_the_counters_of_a_menu_are_not_cleared() -> None:  # 5.2.2
    text = """<menu><prompt>Q?</prompt><choice next="#x">go</choice><nomatch count="1"><log>one</log>
        <clear/></nomatch><nomatch count="2"><log>two</log><exit/></nomatch></menu><form id="x"/>"""
    assert run(text, "no", "no").logs() == ["one", "two"]


def test_the_prompt_counter_of_a_menu_is_not_cleared() -> None:  # 4.1.6
    call = run(
        """<menu><prompt count="1">Q?</prompt><prompt count="2">Once more: Q?</prompt>
        <choice next="#x">go</choice><nomatch><clear/><reprompt/></nomatch></menu><form id="x"/>""",
        *("no", "go"),
    )
    assert call.said() == ["Q?", "Once more: Q?"]


def test_an_event_that_no_handler_takes_is_lost_on_the_application() -> None:
    call = Call(ask("<option>yes</option>"))
    call.play()
    call.event("touch.head")
    call.answer("yes")
    assert (call.logs(), call.ended) == (["yes"], "exit")


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


@pytest.mark.parametrize("event", ['event=""', "eventexpr=\"''\""])
@pytest.mark.parametrize(
    "body",
    [
        "<form>{catch}<block><throw {event}/></block></form>",
        "<menu>{catch}<choice {event}>go</choice></menu>",
        "<link {event}>{go}</link><form>{catch}<field><option>yes</option></field></form>",
        '<form><subdialog src="#b"/></form><form id="b">{catch}<block><return {event}/></block></form>',
    ],
)
def test_an_event_without_a_name_is_error_semantic(body: str, event: str) -> None:  # 5.2.1
    catch = '<catch><log expr="_event"/><exit/></catch>'
    call = Call(body.format(catch=catch, event=event, go=GO))
    if "<block>" not in body:
        call.answer("go")
    assert call.logs() == ["error.semantic"]


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
    call = run(text, said)
    if noted == "nothing":  # it is not listened to: the user's time goes on
        assert call.logs() == []
        call.silent()
    assert call.logs() == [noted]
