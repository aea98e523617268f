"""Calls that a scenario's telephone connects, refuses or ends: VoiceXML 2.0, 2.3.7; 2.1, 9."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.errors import DocumentError
from tests.helpers.telephone import ALL, STOP, ZERO, Quiet, ended, logs, run, shown, transfer
from tests.helpers.voice import Call


# 2.3.7.2 Bridge transfer --------------------------------------------------------------------
def test_without_a_word_in_the_scenario_nobody_answers(place: Path) -> None:
    assert logs(run(place, transfer())) == ["noanswer 0 undefined", "on"]


@pytest.mark.parametrize("outcome", ["busy", "noanswer", "network_busy"])
def test_a_call_that_nobody_answers_lasts_no_time(place: Path, outcome: str) -> None:
    made = run(place, transfer(), f'<transfer outcome="{outcome}" after="3s" lasts="20s"/>')
    assert logs(made) == [f"{outcome} 0 undefined", "on"]
    assert ended(made) == (3.0, "exit")


@pytest.mark.parametrize(
    "outcome",
    [
        "far_end_disconnect",
        "network_disconnect",
        "near_end_disconnect",
        "maxtime_disconnect",
        "unknown",
    ],
)
def test_an_answered_call_has_its_duration_in_seconds(place: Path, outcome: str) -> None:
    made = run(place, transfer(), f'<transfer outcome="{outcome}" after="3s" lasts="20500ms"/>')
    assert logs(made) == [f"{outcome} 20.5 undefined", "on"]
    assert ended(made) == (23.5, "exit")


def test_the_transcript_tells_of_a_call(place: Path) -> None:
    made = run(place, transfer(), '<transfer after="3s" lasts="20s"/>')
    assert shown(made)[1:4] == [
        "transfers to tel:+1-555-1234",
        "tel:+1-555-1234 answers",
        "tel:+1-555-1234 hangs up",
    ]
    made = run(place, transfer(), '<transfer outcome="busy"/>')
    assert shown(made)[1:3] == ["transfers to tel:+1-555-1234", "tel:+1-555-1234 is busy"]


def test_prompts_are_played_before_the_call(place: Path) -> None:
    made = run(place, transfer(inside="<prompt>I connect you.</prompt>"))
    assert shown(made)[1:3] == ['"I connect you."', "transfers to tel:+1-555-1234"]


def test_a_call_that_is_not_answered_within_connecttimeout_is_noanswer(place: Path) -> None:
    call = transfer('type="bridge" connecttimeout="5s"')
    made = run(place, call, '<transfer after="6s" lasts="20s"/>')
    assert logs(made) == ["noanswer 0 undefined", "on"]
    assert ended(made)[0] == 5.0
    assert shown(made)[2] == "ends the call to tel:+1-555-1234: noanswer"
    made = run(place, call, '<transfer after="5s" lasts="20s"/>')
    assert logs(made) == ["far_end_disconnect 20 undefined", "on"]


def test_a_call_is_cut_off_after_maxtime(place: Path) -> None:
    call = transfer('bridge="true" maxtime="10s"')
    made = run(place, call, '<transfer after="2s" lasts="11s"/>')
    assert logs(made) == ["maxtime_disconnect 10 undefined", "on"]
    assert ended(made)[0] == 12.0
    assert shown(made)[3] == "ends the call to tel:+1-555-1234: maxtime_disconnect"


def test_a_maxtime_of_zero_is_none(place: Path) -> None:
    made = run(place, transfer('bridge="true" maxtime="0s"'), '<transfer lasts="300s"/>')
    assert logs(made)[0] == "far_end_disconnect 300 undefined"


def test_transferaudio_is_heard_until_somebody_answers(place: Path) -> None:
    call = transfer('bridge="true" transferaudio="sound/music.wav"')
    made = run(place, call, '<transfer after="4s" lasts="5s"/>')
    assert shown(made)[1:4] == [
        '"[music.wav]"',
        "transfers to tel:+1-555-1234",
        "tel:+1-555-1234 answers",
    ] or shown(made)[1:4] == [
        "transfers to tel:+1-555-1234",
        '"[music.wav]"',
        "tel:+1-555-1234 answers",
    ]
    assert logs(made)[0] == "far_end_disconnect 5 undefined"


def test_a_grammar_of_the_transfer_ends_the_call(place: Path) -> None:
    app = f"""<form><transfer name="t" dest="tel:+1" bridge="true">{STOP}
    <filled><log expr="[t, t$.duration, t$.inputmode, t$.utterance, application.lastresult$.utterance]"/>
    </filled></transfer></form>"""
    script = """<transfer to="tel:+1" after="2s" lasts="60s"/>
    <when at="5s"><say>What a nice day.</say><wait for="1s"/><say>Stop it.</say></when>"""
    made = run(place, app, script)
    assert len(logs(made)) == 1
    value, lasted, mode, said, last = logs(made)[0].strip("[]").replace('"', "").split(",")
    assert (value, mode, said, last) == ("near_end_disconnect", "voice", "Stop it.", "Stop it.")
    assert 5 < float(lasted) < 7
    assert ended(made)[0] == 2 + float(lasted)
    assert "ends the call to tel:+1: near_end_disconnect" in shown(made)


def test_keys_end_a_call_that_has_a_grammar_for_them(place: Path) -> None:
    app = f"""<form><transfer name="t" dest="tel:+1" bridge="true">{ZERO}
    <filled><log expr="[t, t$.inputmode, t$.utterance].join()"/></filled></transfer></form>"""
    script = '<transfer lasts="60s"/><when at="5s"><say>0</say></when>'
    assert logs(run(place, app, script)) == ["near_end_disconnect,dtmf,0"]


def test_a_grammar_ends_a_call_before_it_is_answered(place: Path) -> None:
    script = '<transfer after="30s"/><when at="5s"><say>stop it</say></when>'
    made = run(place, transfer(inside=STOP), script)
    assert logs(made) == ["near_end_disconnect 0 string", "on"]
    assert not any("answers" in row for row in shown(made))


def test_what_a_grammar_takes_during_the_prompt_means_no_call(place: Path) -> None:
    inside = f"<prompt>I connect you with the office now, please wait.</prompt>{STOP}"
    script = '<transfer/><when at="500ms"><say>stop it</say></when>'
    made = run(place, transfer(inside=inside), script)
    assert logs(made) == ["near_end_disconnect 0 string", "on"]
    assert not any("transfers" in row for row in shown(made))


@pytest.mark.parametrize(
    ("first", "last", "made"), [("true", "true", False), ("true", "false", True)]
)
def test_a_call_may_be_stopped_during_the_first_of_two_prompts(
    place: Path, first: str, last: str, made: bool
) -> None:
    inside = (
        f'<prompt bargein="{first}">I connect you with the office now.</prompt>'
        f'<prompt bargein="{last}">Please wait.</prompt>{STOP}'
    )
    script = '<transfer lasts="20s"/><when at="500ms"><say>stop it</say></when>'
    done = run(place, transfer(inside=inside), script)
    assert any("transfers" in row for row in shown(done)) == made
    expected = "far_end_disconnect 20 undefined" if made else "near_end_disconnect 0 string"
    assert logs(done) == [expected, "on"]
    assert any("Please wait." in row for row in shown(done)) == made


def test_a_prompt_before_a_call_that_may_not_be_broken_in_on_is_not(place: Path) -> None:
    inside = f'<prompt bargein="false">I connect you with the office now.</prompt>{STOP}'
    script = '<transfer lasts="20s"/><when at="500ms"><say>stop it</say></when>'
    assert logs(run(place, transfer(inside=inside), script)) == [
        "far_end_disconnect 20 undefined",
        "on",
    ]


def test_a_silent_caller_with_a_grammar_is_connected_after_the_prompt(place: Path) -> None:
    inside = f"<prompt>I connect you.</prompt>{STOP}"
    made = run(place, transfer(inside=inside), '<transfer lasts="700s"/>')
    assert logs(made) == []  # the run has ended before
    made = run(place, transfer(inside=inside), '<transfer lasts="50s"/>')
    assert logs(made) == ["far_end_disconnect 50 undefined", "on"]


def test_a_question_of_ten_minutes_does_not_end_a_longer_call() -> None:
    call = Quiet(transfer(inside=STOP))
    call.told("answered")
    call.listens()
    call.silence()
    call.listens()
    call.hears("stop it")
    assert call.logs()[0].startswith("near_end_disconnect")


def test_grammars_outside_the_transfer_do_not_end_it(place: Path) -> None:
    app = f'<link event="odd">{STOP}</link><catch event="odd"><log>odd</log></catch>' + transfer()
    script = '<transfer lasts="20s"/><when at="5s"><say>stop it</say></when>'
    assert logs(run(place, app, script)) == ["far_end_disconnect 20 undefined", "on"]


# 2.3.7.3 Errors ---------------------------------------------------------------------------
@pytest.mark.parametrize("kind", ["bridge", "blind", "consultation"])
@pytest.mark.parametrize(
    "event",
    [
        "error.connection.noauthorization",
        "error.connection.baddestination",
        "error.connection.noroute",
        "error.connection.noresource",
        "error.connection.protocol.503",
        "error.unsupported.transfer.bridge",
        "error.unsupported.uri",
    ],
)
def test_an_outcome_that_is_an_error_is_thrown(place: Path, kind: str, event: str) -> None:
    made = run(place, transfer(f'type="{kind}"'), f'<transfer outcome="{event}" after="1s"/>')
    assert logs(made)[0] == f"{event} undefined"
    assert f"tel:+1-555-1234 fails: {event}" in shown(made)


@pytest.mark.parametrize("to", ["mailto:a@b.example", "http://a.example", "phone://1", "fax:1"])
def test_a_scheme_that_is_no_telephones_is_error_unsupported_uri(place: Path, to: str) -> None:
    made = run(place, transfer(to=to))
    assert logs(made)[0] == "error.unsupported.uri undefined"
    assert not any("transfers" in row for row in shown(made))


@pytest.mark.parametrize("to", ["tel:", "tel:hello", "5551234", "sip:", "tel:+", "sip: a b", "x"])
def test_a_destination_that_is_none_is_error_connection_baddestination(
    place: Path, to: str
) -> None:
    assert logs(run(place, transfer(to=to)))[0] == "error.connection.baddestination undefined"


@pytest.mark.parametrize(
    "to",
    ["tel:911", "tel:+1-(555) 123;postd=pp22", "sip:ann@example.org", "SIPS:a.example", "TEL:*70"],
)
def test_a_destination_of_a_telephone_is_called(place: Path, to: str) -> None:
    assert f"transfers to {to}" in shown(run(place, transfer(to=to)))


def test_a_very_long_destination_is_refused_at_once() -> None:
    call = Call(
        ALL
        + """<form><transfer name="t" bridge="true"
        destexpr="'tel:' + new Array(9000).join('0') + 'x'"/></form>"""
    )
    assert call.logs()[0].startswith("error.connection.baddestination")


def test_a_destination_by_an_expression_that_fails_is_error_semantic() -> None:
    call = Call(ALL + '<form><transfer name="t" bridge="true" destexpr="none.at.all"/></form>')
    assert call.logs()[0].startswith("error.semantic")


# 2.3.7.1 Blind; 2.1, 9 Consultation --------------------------------------------------------
@pytest.mark.parametrize("more", ["", 'bridge="false"', 'type="blind"'])
def test_a_blind_transfer_takes_the_caller_away(place: Path, more: str) -> None:
    made = run(place, transfer(more), '<transfer outcome="busy" after="2s"/>')
    assert logs(made)[0] == "connection.disconnect.transfer undefined"


def test_after_a_transfer_nothing_is_said_or_heard_any_more(place: Path) -> None:  # 1.5.4
    app = f"""<form><transfer name="t" dest="tel:+1"><prompt>Good bye.</prompt>
    <catch event="connection.disconnect.transfer"><log>gone</log>Too late.
    <assign name="t" expr="1"/></catch></transfer>
    <block><log>on</log>Too late.</block>
    <field name="f"><prompt>Hello?</prompt>{STOP}</field><block><log>never</log></block></form>"""
    made = run(place, app)
    assert logs(made) == ["gone", "on"]
    assert [what for what in shown(made) if what.startswith('"')] == ['"Good bye."']
    assert ended(made)[1] == "connection.disconnect.transfer"


@pytest.mark.parametrize("outcome", ["busy", "noanswer", "network_busy"])
def test_a_consultation_that_nobody_answers_comes_back(place: Path, outcome: str) -> None:
    made = run(
        place, transfer('type="consultation"'), f'<transfer outcome="{outcome}" after="2s"/>'
    )
    assert logs(made) == [f"{outcome} 0 undefined", "on"]
    assert ended(made)[0] == 2.0


def test_a_consultation_that_is_answered_takes_the_caller_away(place: Path) -> None:
    made = run(place, transfer('type="consultation"'), '<transfer after="2s" lasts="20s"/>')
    assert logs(made)[0] == "connection.disconnect.transfer undefined"
    assert ended(made)[0] == 2.0


def test_a_consultation_has_a_connecttimeout(place: Path) -> None:
    made = run(place, transfer('type="consultation" connecttimeout="1s"'), '<transfer after="2s"/>')
    assert logs(made) == ["noanswer 0 undefined", "on"]


def test_a_grammar_ends_a_consultation_before_it_is_answered(place: Path) -> None:
    script = '<transfer after="30s"/><when at="5s"><say>stop it</say></when>'
    made = run(place, transfer('type="consultation"', STOP), script)
    assert logs(made) == ["near_end_disconnect 0 string", "on"]


# Which <transfer> of a scenario -------------------------------------------------------------
def test_the_transfer_that_says_most_of_a_destination_counts(place: Path) -> None:
    app = "".join(
        f"""<transfer name="t{one}" dest="{to}" bridge="true"><filled><log expr="t{one}"/></filled>
        </transfer>"""
        for one, to in enumerate(["tel:+81-1", "tel:+1-2", "sip:a", "tel:+81-1", "tel:+81-1"])
    )
    script = """<transfer outcome="busy"/><transfer to="tel:" outcome="unknown"/>
    <transfer to="tel:+81" outcome="noanswer"/><transfer to="tel:+81" outcome="network_busy"/>"""
    assert logs(run(place, f"<form>{app}</form>", script)) == [
        "noanswer",
        "unknown",
        "busy",
        "network_busy",
        "network_busy",
    ]


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ('<transfer outcome="bussy"/>', 'Did you mean "busy"?'),
        ('<transfer outcome="answered"/>', "does not end"),
        ('<transfer after="soon"/>', "after"),
        ("<connection/><connection/>", "second <connection>"),
        ('<connection originator="me"/>', "originator"),
        ("<connection><redirect/></connection>", "uri"),
    ],
)
def test_what_is_wrong_with_a_scenarios_telephone_is_told_at_its_place(
    place: Path, wrong: str, told: str
) -> None:
    with pytest.raises(DocumentError) as caught:
        run(place, transfer(), wrong)
    assert "s.xml:3:" in str(caught.value)
    assert told in str(caught.value)


def test_events_during_a_call_come_at_the_next_wait(place: Path) -> None:
    app = f"""<catch event="touch"><log>touched</log><exit/></catch>
    <form><transfer name="t" dest="tel:+1" bridge="true"><filled><log expr="t"/></filled></transfer>
    <field name="f"><prompt>Well?</prompt>{STOP}</field></form>"""
    script = '<transfer lasts="60s"/><when at="5s"><touch sensor="head"/></when>'
    assert logs(run(place, app, script)) == ["far_end_disconnect", "touched"]


def test_disconnect_in_what_a_call_has_filled_ends_the_application(place: Path) -> None:
    app = """<form><transfer name="t" dest="tel:+1" bridge="true"><filled>Good bye.<disconnect/>
    </filled></transfer><catch event="connection.disconnect.hangup"><log>bye</log><exit/></catch>
    </form>"""
    made = run(place, app, "<transfer/>")
    assert logs(made) == ["bye"]
    assert '"Good bye."' in shown(made)


def test_exit_in_what_a_call_has_filled_ends_the_application(place: Path) -> None:
    app = transfer().replace("</filled>", "<exit expr='t'/></filled>")
    made = run(place, app, "<transfer outcome='busy'/>")
    assert logs(made) == ["busy 0 undefined", 'exit: "busy"']


def test_a_telephone_that_says_nothing_is_waited_for_a_minute() -> None:
    call = Quiet(transfer())
    deadline = call.session.deadline()
    assert deadline == call.now + 60_000
    call.step(at=deadline)
    assert call.logs() == ["noanswer 0 undefined", "on"]
    call.told("answered")
    assert call.logs() == ["noanswer 0 undefined", "on"]


def test_news_of_another_call_is_not_heeded() -> None:
    call = Quiet(transfer())
    call.told("busy", 7)
    assert call.logs() == []


def test_a_device_that_fails_during_a_call_ends_it() -> None:
    call = Quiet(transfer('bridge="true" transferaudio="music.wav"'))
    call.fail("music.wav")
    assert call.logs()[0].startswith("error.device.speaker")
    assert call.phases("send")[1]["data"]["transfer"] == "over"
