"""The user hangs up; what is known of the connection: VoiceXML 2.0, 1.5.4 and 5.1.4."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.telephone import STOP, Quiet, ended, logs, run, shown, transfer
from tests.helpers.voice import vxml


# 1.5.4 Hanging up ---------------------------------------------------------------------------
def test_the_user_hangs_up_at_a_question(place: Path) -> None:
    app = f"""<catch event="connection.disconnect.hangup"><log>bye</log>Are you there?</catch>
    <form><field name="f"><prompt>Well?</prompt>{STOP}</field></form>"""
    made = run(place, app, '<when asked="Well?" after="1s"><hang-up/></when>')
    assert (logs(made), ended(made)[1]) == (["bye"], "connection.disconnect.hangup")
    assert shown(made)[1:4] == ['"Well?"', "hangs up", "log: bye"]


def test_a_hangup_that_nothing_catches_ends_the_application(place: Path) -> None:
    app = f'<form><field name="f"><prompt>Well?</prompt>{STOP}</field></form>'
    made = run(place, app, '<when asked="Well?"><hang-up/></when>')
    assert ended(made)[1] == "connection.disconnect.hangup"


@pytest.mark.parametrize("end", ["", "<exit/>", '<throw event="error.odd"/>'])
def test_a_hangup_during_the_last_prompts_leaves_the_rest_unsaid(place: Path, end: str) -> None:
    app = f"""<catch event="connection.disconnect.hangup"><log>never</log></catch>
    <form><block><prompt>Have a nice day.</prompt><prompt>Good bye.</prompt>{end}</block></form>"""
    made = run(place, app, '<when at="500ms"><hang-up/></when>')
    assert shown(made)[1:3] == ['"Have a nice day."', "hangs up"]
    assert logs(made) == []
    assert '"Good bye."' not in shown(made)
    assert ended(made)[1].startswith("error.odd" if "throw" in end else "exit")


@pytest.mark.parametrize(
    ("at", "heard"), [("500ms", ["Just a moment."]), ("4s", ["Just a moment.", "Wait.", "[a.wav]"])]
)
def test_a_hangup_during_a_fetch_ends_what_is_played(
    place: Path, at: str, heard: list[str]
) -> None:
    app = f"""<catch event="connection.disconnect.hangup"><log>bye</log><exit/></catch>
    <form><block><prompt>Just a moment.</prompt><prompt>Wait.</prompt>
    <data src="service:slow" fetchaudio="a.wav"/><log>fetched</log></block>
    <field name="f"><prompt>Well?</prompt>{STOP}</field></form>"""
    script = f"""<service name="slow"><reply after="9s"/></service>
    <when at="{at}"><hang-up/></when>"""
    made = run(place, app, script)
    assert [what.strip('"') for what in shown(made) if what.startswith('"')] == heard
    assert (logs(made), ended(made)) == (["fetched", "bye"], (9.0, "exit"))


def test_after_a_hangup_values_can_be_submitted(place: Path) -> None:
    app = f"""<var name="a" expr="1"/><catch event="connection.disconnect.hangup">One moment.
    <submit next="service:keep" namelist="a" fetchaudio="hold.wav"/></catch>
    <form><field name="f"><prompt>Well?</prompt>{STOP}</field></form>"""
    kept = vxml(
        f"""<form><block><log>kept</log>Kept.</block><field name="g"><prompt>Well?</prompt>{STOP}
        </field><block><log>never</log></block></form>"""
    )
    script = """<service name="keep"><reply after="2s" src="kept.vxml"/></service>
    <when asked="Well?" after="1s"><hang-up/></when>"""
    made = run(place, app, script, kept=kept)
    assert logs(made) == ["kept"]
    assert [what for what in shown(made) if what.startswith('"')] == ['"Well?"']
    sent = [record["data"] for record in made.records if record["phase"] == "send"]
    assert sent[0]["params"] == {"a": 1}
    assert ended(made)[1] == "connection.disconnect.hangup"


@pytest.mark.parametrize("handled", ['<goto next="#end"/>', "<log>bye</log><disconnect/>"])
@pytest.mark.parametrize("first", ["", "<block>Bye.<disconnect/></block>"])
def test_a_disconnect_after_a_hangup_ends_the_application(
    place: Path, handled: str, first: str
) -> None:
    app = f"""<catch event="connection.disconnect.hangup">{handled}</catch>
    <form>{first}<field name="f"><prompt>Well?</prompt>{STOP}</field></form>
    <form id="end"><block><log>bye</log><disconnect/></block></form>"""
    made = run(place, app, '<when asked="Well?" after="1s"><hang-up/></when>')
    assert (logs(made), ended(made)[1]) == (["bye"], "connection.disconnect.hangup")


def test_a_disconnect_after_a_transfer_is_an_event_once(place: Path) -> None:
    app = """<catch event="connection.disconnect"><log expr="_event"/><disconnect/></catch>
    <form><transfer dest="tel:+1-555-1234" type="blind"/></form>"""
    made = run(place, app)
    assert logs(made) == ["connection.disconnect.transfer", "connection.disconnect.hangup"]
    assert ended(made)[1] == "connection.disconnect.hangup"


def test_the_user_hangs_up_during_a_bridged_call(place: Path) -> None:
    script = '<transfer lasts="60s"/><when at="5s"><hang-up/></when>'
    made = run(place, transfer(), script)
    assert logs(made)[0] == "connection.disconnect.hangup undefined"
    assert "ends the call to tel:+1-555-1234: connection.disconnect.hangup" in shown(made)
    assert not any("tel:+1-555-1234 hangs up" in what for what in shown(made))
    assert ended(made)[0] == 5.0


def test_the_user_hangs_up_before_and_during_a_call_that_listens(place: Path) -> None:
    for at in ("1s", "5s"):
        script = f'<transfer after="3s" lasts="60s"/><when at="{at}"><hang-up/></when>'
        made = run(place, transfer(inside=STOP), script)
        assert logs(made)[0] == "connection.disconnect.hangup undefined"


def test_what_came_along_with_the_call_goes_along_with_the_transfer() -> None:
    sent = Quiet(transfer('bridge="true" aai="order 7"')).phases("send")[0]["data"]
    assert sent == {"to": "tel:+1-555-1234", "transfer": "bridge", "params": {"aai": "order 7"}}
    sent = Quiet(transfer("bridge='true' aaiexpr=\"'a' + 1\"")).phases("send")[0]["data"]
    assert sent["params"] == {"aai": "a1"}


# 5.1.4 session.connection -------------------------------------------------------------------
CONNECTION = """<form><block><log expr="[session.connection.remote.uri, session.connection.local.uri,
  session.connection.protocol.name, session.connection.protocol.version, session.connection.aai,
  session.connection.originator === session.connection.remote,
  session.connection.redirect &amp;&amp; session.connection.redirect.length + ' '
  + session.connection.redirect[0].uri + ' ' + session.connection.redirect[0].reason].join()"/></block></form>"""


def test_what_a_scenario_says_of_the_connection_is_there(place: Path) -> None:
    script = """<connection remote="tel:+81-1" local="tel:+81-2" protocol="sip" version="2.0"
    aai="vip" originator="remote"><redirect uri="tel:+81-3" reason="busy"/>
    <redirect uri="tel:+81-4"/></connection>"""
    assert logs(run(place, CONNECTION, script)) == [
        "tel:+81-1,tel:+81-2,sip,2.0,vip,true,2 tel:+81-3 busy"
    ]


def test_what_it_does_not_say_is_undefined(place: Path) -> None:
    assert logs(run(place, CONNECTION)) == [",,,,,false,"]
    assert logs(run(place, CONNECTION, '<connection local="tel:+81-2"/>')) == [
        ",tel:+81-2,,,,false,"
    ]


def test_the_connection_cannot_be_changed(place: Path) -> None:
    app = """<catch event="error.semantic"><log>no</log><exit/></catch>
    <form><block><assign name="session.connection" expr="1"/></block></form>"""
    assert logs(run(place, app, '<connection aai="x"/>')) == ["no"]
