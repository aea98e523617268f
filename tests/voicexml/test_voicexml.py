"""VoiceXML documents as applications: small cases written after the Recommendation's sections."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.messages import Ended, Occurred
from tests.helpers.voice import Call, vxml


def test_prompts_queue_until_the_application_waits() -> None:
    call = Call(
        """<form><block>Hello. <prompt>Welcome.</prompt><log>queued</log></block>
        <field name="city"><prompt>Where?</prompt><option>Kyoto</option></field></form>"""
    )
    assert call.logs() == ["queued"]
    assert call.play() == ["Hello.", "Welcome.", "Where?"]
    call.answer("kyoto")
    assert call.ended == "exit"


def test_nomatch_and_noinput_count_and_prompts_taper() -> None:
    call = Call(
        """<form><field name="city"><prompt>Where?</prompt><prompt count="2">Which city?</prompt>
        <option>Kyoto</option>
        <nomatch>No. <reprompt/></nomatch><noinput count="2"><exit/></noinput></field></form>"""
    )
    call.answer("Nara")
    call.silent()
    assert call.said() == ["Where?", "No.", "Which city?", "Which city?"]
    call.silent()
    assert call.ended == "exit"


def test_a_menu_goes_where_its_choice_leads() -> None:
    call = Call(
        """<menu dtmf="true"><prompt>Choose: <enumerate/></prompt>
          <choice next="#a">Sports</choice><choice next="#b">Weather</choice></menu>
        <form id="a"><block>Goal!</block></form><form id="b"><block>Sunny.</block></form>"""
    )
    assert call.play() == ["Choose: Sports; Weather"]
    call.answer("weather")
    assert call.said()[-1] == "Sunny."


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


def test_a_leaf_sees_its_root() -> None:
    call = Call(
        """<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">
        <form><block><log><value expr="application.greeting"/></log>
          <assign name="greeting" expr="'bye'"/><goto next="other.vxml"/></block></form></vxml>""",
        root="""<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml">
        <var name="greeting" expr="'hi'"/><catch event="odd"><log>caught</log></catch></vxml>""",
        other="""<vxml version="2.1" xmlns="http://www.w3.org/2001/vxml" application="root.vxml">
        <form><block><log><value expr="greeting"/></log><throw event="odd.thing"/></block></form>
        </vxml>""",
    )
    assert call.logs() == ["hi", "bye", "caught"]


def test_a_document_that_is_not_there_is_an_event() -> None:
    call = Call(
        """<catch event="error.badfetch"><log>none</log><exit/></catch>
        <form><block><goto next="nowhere.vxml"/></block></form>"""
    )
    assert (call.logs(), call.ended) == (["none"], "exit")


def test_an_event_from_outside_that_a_handler_takes_ends_the_wait() -> None:
    call = Call(
        """<catch event="touch"><prompt>You touched me.</prompt></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.listens()
    call.event("touch.head")
    call.play()
    assert call.said() == ["Well?", "You touched me."]


@pytest.mark.parametrize("attribute", ["", 'event=""', 'event="."', 'event="nomatch help"'])
def test_a_handler_for_all_events_takes_none_of_the_robot_and_its_surroundings(
    attribute: str,
) -> None:
    call = Call(
        f"""<catch {attribute}><log><value expr="_event"/></log><exit/></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    for name in ("human.found", "touch.head", "corner", "emergency.stop"):
        call.event(name)
    call.answer("yes")
    assert (call.logs(), call.said(), call.ended) == ([], ["Well?"], "exit")


@pytest.mark.parametrize(
    "own", ["message", "reply.weather", "connection.disconnect.hangup", "error.service.x"]
)
def test_a_handler_for_all_events_takes_what_is_meant_for_the_document(own: str) -> None:
    call = Call(
        """<catch><log><value expr="_event"/></log><exit/></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.step(Occurred(own, app="app"))
    assert (call.logs(), call.ended) == ([own], "exit")


def test_a_handler_for_all_events_takes_a_robot_s_event_that_the_document_throws() -> None:
    call = Call(
        """<catch><log>all</log></catch>
        <form><block><throw event="human.found"/></block>
        <field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    assert call.logs() == ["all"]


def test_an_event_of_the_robot_counts_for_those_handlers_alone_that_name_it() -> None:
    call = Call(
        """<catch count="2"><log>all</log></catch><catch event="human"><log>named</log></catch>
        <form><field name="f" type="boolean"><prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.event("human.found")
    call.event("human.found")
    assert call.logs() == ["named", "named"]


def test_mixed_initiative_fills_many_fields() -> None:
    call = Call(
        """<form>
        <grammar version="1.0" root="trip" xmlns="http://www.w3.org/2001/06/grammar"
            tag-format="semantics/1.0">
          <rule id="trip">from <ruleref uri="#city"/><tag>out.start = rules.latest();</tag>
            to <ruleref uri="#city"/><tag>out.end = rules.latest();</tag></rule>
          <rule id="city"><one-of><item>Kyoto</item><item>Nara</item></one-of></rule>
        </grammar>
        <initial><prompt>Your trip?</prompt></initial>
        <field name="start"><prompt>From?</prompt></field>
        <field name="end"><prompt>To?</prompt></field>
        <filled><log><value expr="start"/> <value expr="end"/></log></filled></form>"""
    )
    call.answer("from Kyoto to Nara")
    assert call.logs() == ["Kyoto Nara"]


def test_commands_of_the_robot_stand_among_prompts() -> None:
    call = Call(
        """<form xmlns:p="urn:prima:dialogue:1"><block>Look. <p:point-by-hand angle="30"/> There.
        </block></form>"""
    )
    call.play()
    assert [r["command"] for r in call.phases("start")] == ["speak", "point-by-hand", "speak"]


def test_data_is_a_read_only_dom() -> None:
    call = Call(
        """<form><block><data name="d" src="news.xml"/>
        <log><value expr="d.documentElement.getElementsByTagName('item').item(1).textContent"/></log>
        </block></form>""",
        **{"news.xml": "<news><item>one</item><item>two</item></news>"},
    )
    assert call.logs() == ["two"]


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


def test_a_document_may_hide_the_session_by_a_variable_of_its_own() -> None:  # 5.1.2
    call = Call(
        """<form><var name="session" expr="1"/><block><assign name="session" expr="2"/>
        <log expr="session"/></block></form>"""
    )
    assert call.logs() == ["2"]


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


def test_a_device_that_fails_is_told_with_line_and_column_and_recorded_with_its_line() -> None:
    call = Call(
        """<form><catch event="error.device"><log expr="_message"/></catch>
 <block>Hello.</block><field name="f" type="boolean">
 <prompt>Well?</prompt></field></form>"""
    )
    call.play()
    call.fail("Well?")
    assert call.logs() == ["app.vxml:2:23: broken"]
    requests = call.phases("request")
    assert next(one["source"] for one in requests if one["text"] == "Well?") == "app.vxml:2"


QUICK = """<property name="timeout" value="{}"/>
<form><field name="f"><option>tea</option><noinput/></field></form>"""


CALLING = """<form>
<transfer name="t" dest="tel:1" bridge="true" connecttimeout="{}"><filled><clear namelist="t"/>
</filled></transfer></form>"""
TURNS = """<var name="n" expr="0"/><form>
<field name="f"><option>tea</option><prompt timeout="1ms" cond="n % 2"/>
<prompt timeout="{}" cond="!(n % 2)"/><noinput><assign name="n" expr="n + 1"/><reprompt/></noinput>
</field></form>"""


@pytest.mark.parametrize(
    ("body", "timeout"),
    [(QUICK, "0s"), (QUICK, "1ms"), (QUICK, "15ms"), (CALLING, "0s"), (CALLING, "1ms"),
     (TURNS, "49ms")],
)  # fmt: skip
def test_waits_that_are_over_at_once_end_their_application_alone(
    body: str, timeout: str, tmp_path: Path
) -> None:
    quick, slow = tmp_path / "quick.vxml", tmp_path / "slow.vxml"
    quick.write_text(vxml(body.format(timeout)), encoding="utf-8")
    slow.write_text(vxml(QUICK.format("50s")), encoding="utf-8")
    transcript = api.rehearse(api.stage([], [str(quick), str(slow)]))
    assert transcript.outcome != "limit"
    (failure,) = transcript.failures
    assert failure.startswith("quick: error.semantic: quick.vxml:2:") and " it waited " in failure
    assert failure.endswith(" ms on an average: let what comes again and again wait longer")
    assert transcript.summary().seconds == 600
    assert len(transcript.records) < 25_000


def test_short_waits_with_a_longer_one_among_them_are_allowed() -> None:
    call = Call(QUICK.format("1ms"))
    for number in range(2500):
        call.step(at=call.now + (50_000 if number % 900 == 0 else 1) - 1)
        question = call.session.mediator.question()
        assert question is not None
        call.step(Ended(question.id, True, {"outcome": "noinput"}), at=call.now + 1)
    assert not call.ended
