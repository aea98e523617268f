"""Recordings of what the user says: VoiceXML 2.0, 2.3.6."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.dialogs import grammar
from tests.helpers.telephone import STOP, ZERO, ended, logs, record, run, shown
from tests.helpers.voice import Call, vxml


def says(*texts: str) -> str:
    return "".join(
        f'<when asked="Speak." count="{count}" after="1s"><say>{text}</say></when>'
        for count, text in enumerate(texts, 1)
    )


HELLO = "Hello Ann, here is Bob."
"""17 letters, 13 a second, and 300 ms: 1608 ms."""


def test_a_recording_is_what_is_said_and_as_long(place: Path) -> None:
    made = run(place, record(), says(HELLO))
    assert logs(made) == [f"{HELLO},1608,{len(HELLO)},,false"]


def test_the_size_is_that_of_what_is_submitted(place: Path) -> None:
    made = run(place, record(), says("Gr\u00fc\u00dfe."))
    assert logs(made)[0].split(",")[2] == "8"


def test_a_final_silence_takes_its_time_and_is_not_recorded(place: Path) -> None:
    first = run(place, record(), says(HELLO))
    later = run(place, record('finalsilence="2s"'), says(HELLO))
    assert logs(later) == logs(first)
    assert ended(later)[0] == pytest.approx(ended(first)[0] + 2)


def test_a_key_ends_a_recording_at_once(place: Path) -> None:
    for key in "#*":
        first = run(place, record(), says(HELLO))
        made = run(place, record('finalsilence="2s"'), says(HELLO + key))
        assert logs(made) == [f"{HELLO},1608,{len(HELLO)},{key},false"]
        assert ended(made)[0] == ended(first)[0]


def test_without_dtmfterm_keys_end_nothing(place: Path) -> None:
    made = run(place, record('dtmfterm="false"'), says(HELLO + "#"))
    assert logs(made)[0].startswith(f"{HELLO}#,1608,")
    assert logs(run(place, record('dtmfterm="false"'), says("12")))[0].startswith("12,")


def test_keys_end_nothing_where_voice_is_the_only_input(place: Path) -> None:  # 6.3.6
    app = '<property name="inputmodes" value="voice"/>' + record()
    assert logs(run(place, app, says(HELLO + "#")))[0].startswith(f"{HELLO}#,")


def test_a_key_before_anything_is_said_leaves_the_record_unfilled(place: Path) -> None:
    app = """<form><var name="key"/><record name="r" cond="key = application.lastresult$, true">
    <prompt>Speak.</prompt><noinput><log>silence</log></noinput>
    <filled><log expr="r + ' ' + key.utterance + key.inputmode"/></filled></record></form>"""
    made = run(place, app, says("#", HELLO))
    assert logs(made) == [f"{HELLO} #dtmf"]


def test_a_grammar_for_keys_ends_a_recording_as_well(place: Path) -> None:
    app = record('dtmfterm="false"', ZERO)
    assert logs(run(place, app, says("0", HELLO))) == [f"{HELLO},1608,{len(HELLO)},,false"]


HASH = ZERO.replace(">0<", ">#<")


def test_a_key_of_a_grammar_ends_what_is_being_recorded(place: Path) -> None:
    app = f"""<form><record name="r" dtmfterm="false"><prompt>Speak.</prompt>{HASH}
    <filled><log expr="[r, r$.termchar, application.lastresult$.utterance,
    application.lastresult$.inputmode].join()"/></filled></record></form>"""
    assert logs(run(place, app, says(HELLO + "#"))) == [f"{HELLO},,#,dtmf"]
    assert logs(run(place, app.replace(">#<", ">*<"), says(HELLO + "*")))[0].endswith(",,*,dtmf")
    kept = run(place, app.replace("application.lastresult$", "typeof r"), says(HELLO + "*"))
    assert logs(kept)[0].startswith(f"{HELLO}*,,")


@pytest.mark.parametrize(
    ("term", "expected"), [("false", ["undefined #"]), ("true", [f"{HELLO} #", "filled"])]
)
def test_a_key_of_a_grammar_outside_ends_a_recording_unfilled(
    place: Path, term: str, expected: list[str]
) -> None:
    app = f"""<link event="key">{HASH}</link><catch event="key"><log><value expr="r"/>
    <value expr="application.lastresult$.utterance"/></log><exit/></catch>
    <form><record name="r" modal="false" dtmfterm="{term}"><prompt>Speak.</prompt>
    <filled><log expr="r + ' ' + r$.termchar"/><log>filled</log></filled></record></form>"""
    assert logs(run(place, app, says(HELLO + "#"))) == expected


def test_a_key_for_another_field_ends_a_recording_and_the_form_goes_on(place: Path) -> None:
    key = HASH.replace(">#<", '>#<tag>out.f = "1";</tag><')
    app = f"""<form>{key}<record name="r" modal="false" dtmfterm="false"><prompt>Speak.</prompt>
    <noinput><log expr="[typeof r, f]"/><exit/></noinput></record>
    <field name="f" type="digits"><prompt>f?</prompt></field></form>"""
    assert logs(run(place, app, says(HELLO + "#"))) == ["undefined,1"]


def test_a_grammar_of_the_record_ends_it_with_what_was_said(place: Path) -> None:
    app = f"""<form><record name="r"><prompt>Speak.</prompt>{STOP}
    <filled><log expr="[r, r$.utterance, r$.confidence].join()"/></filled></record></form>"""
    assert logs(run(place, app, says("Stop it."))) == ["Stop it.,Stop it.,1"]


def test_maxtime_cuts_a_recording_off(place: Path) -> None:
    made = run(place, record('maxtime="1s" finalsilence="2s"'), says(HELLO))
    assert logs(made) == ["Hello Ann, here,1000,15,,true"]
    assert logs(run(place, record('maxtime="2s"'), says(HELLO)))[0].endswith("false")


def test_maxtime_cuts_even_a_first_word(place: Path) -> None:
    assert logs(run(place, record('maxtime="200ms"'), says("Supercalifragilistic")))[0] == (
        "Su,200,2,,true"
    )


def test_silence_is_noinput(place: Path) -> None:
    app = record().replace("<prompt>", '<prompt timeout="3s">')
    made = run(place, app)
    assert logs(made) == ["silence"]


def test_a_beep_is_heard_before_the_recording(place: Path) -> None:
    first = run(place, record(), says(HELLO))
    made = run(place, record('beep="true"'), says(HELLO))
    assert '"Speak. [beep]"' in shown(made)
    assert ended(made)[0] == pytest.approx(ended(first)[0] + 0.75)  # with the full stop's pause
    assert logs(made) == logs(first)
    bare = record('beep="true"').replace("<prompt>Speak.</prompt>", "")
    assert '"[beep]"' in shown(run(place, bare))


def test_hanging_up_keeps_what_was_recorded(place: Path) -> None:
    script = says(HELLO) + '<when asked="Speak." after="1900ms"><hang-up/></when>'
    made = run(place, record(), script)
    assert logs(made) == ["hangup: Hello Ann,, 900"]
    assert not any("here" in what for what in shown(made))


def test_hanging_up_in_the_final_silence_keeps_all(place: Path) -> None:
    script = says(HELLO) + '<when asked="Speak." after="3500ms"><hang-up/></when>'
    made = run(place, record('finalsilence="3s"'), script)
    assert logs(made) == [f"hangup: {HELLO}, 1608"]


def test_hanging_up_before_anything_is_said_records_nothing(place: Path) -> None:
    made = run(place, record(), '<when asked="Speak." after="1s"><hang-up/></when>')
    assert logs(made) == ["hangup: undefined, undefined"] or "error" in ended(made)[1]


@pytest.mark.parametrize("kind", ["audio/basic", "audio/x-wav", "audio/wav;codec=1", "Audio/Basic"])
def test_known_formats_are_recorded(place: Path, kind: str) -> None:
    assert logs(run(place, record(f'type="{kind}"'), says(HELLO)))[0].startswith(HELLO)


def test_other_formats_are_error_unsupported_format(place: Path) -> None:
    app = '<catch event="error"><log expr="_event"/><exit/></catch>' + record('type="video/mpeg"')
    made = run(place, app, says(HELLO))
    assert logs(made) == ["error.unsupported.format"]


@pytest.mark.parametrize("played", ['<value expr="r"/>', '<audio expr="r"/>'])
def test_a_recording_is_played_back(place: Path, played: str) -> None:
    app = f"""<form><record name="r"><prompt>Speak.</prompt></record>
    <block>You said: {played}</block></form>"""
    said = "A and/or b."
    assert f'"You said: {said}"' in shown(run(place, app, says(said)))


def test_a_recording_that_is_played_back_takes_its_own_time(place: Path) -> None:
    app = """<form><record name="r" maxtime="1s"><prompt>Speak.</prompt></record>
    <block><audio expr="r">No recording.</audio></block></form>"""
    made = run(place, app, says(HELLO))
    row = next(row for row in made.rows() if row.what == '"Hello Ann, here"' and row.actor == "R")
    assert ended(made)[0] == pytest.approx(row.time + 1)


def test_a_recording_is_submitted_as_its_text(place: Path) -> None:
    app = """<form><record name="r"><prompt>Speak.</prompt></record>
    <block><submit next="service:keep" namelist="r" method="post"/></block></form>"""
    kept = vxml("<form><block>Kept.</block></form>")
    script = says(HELLO) + '<service name="keep"><reply src="kept.vxml"/></service>'
    made = run(place, app, script, kept=kept)
    (sent,) = (one["data"] for one in made.records if one["phase"] == "send")
    assert sent["params"] == {"r": HELLO}


def test_a_device_that_does_not_tell_how_long_it_heard_is_guessed_for() -> None:
    call = Call(record())
    call.answer("abcde")
    assert call.logs() == ["abcde,500,5,,false"]


KEYS = """<script>var last; function note(found) { last = found; return true; }</script>
<form><record name="r" cond="note(application.lastresult$)"><prompt>Speak.</prompt>GRAMMAR
<noinput><log expr="last.utterance + last.interpretation + last.inputmode"/><exit/></noinput>
</record></form>"""


def test_keys_that_a_grammar_takes_have_its_meaning_in_the_last_result() -> None:  # 5.1.5
    call = Call(KEYS.replace("GRAMMAR", grammar("7", "out = 'end';", 'mode="dtmf"')))
    call.answer("7")
    call.silent()
    assert call.logs() == ["7enddtmf"]


@pytest.mark.parametrize(
    "item", ['record name="f"', 'transfer name="f" dest="tel:+1-555-1234" bridge="true"']
)
def test_words_that_end_an_item_are_recorded_for_it_too(item: str) -> None:  # 2.1, 7
    call = Call(f"""<property name="recordutterance" value="true"/><form><{item}>
    <prompt>Well?</prompt>{STOP}<filled><log expr="[f$.recording, f$.recordingsize,
    f$.recordingduration == application.lastresult$.recordingduration].join()"/></filled>
    </{item.partition(" ")[0]}></form>""")
    call.answer("stop it")
    assert call.logs() == ["stop it,7,true"]
