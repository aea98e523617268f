"""The simulated user and recogniser: answers, silence, interruptions, leaving."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.errors import DocumentError
from tests import ROOT
from tests.helpers.rehearsing import rehearse, told, when


def test_pauses_last_as_long_as_they_say(tmp_path: Path) -> None:
    body = (
        """<form id="a"><block><speak>One.{}</speak>{}<gesture name="bow"/><exit/></block></form>"""
    )
    starts = []
    for pauses in (("", ""), ('<break time="800ms"/>', ""), ("", '<pause time="1.2s"/>')):
        transcript = rehearse(tmp_path, body.format(*pauses))
        (start,) = [
            one
            for one in transcript.records
            if one["phase"] == "start" and one["command"] == "gesture"
        ]
        starts.append(start["time"])
    plain, broken, paused = starts
    assert (round(broken - plain, 3), round(paused - plain, 3)) == (0.8, 1.2)


def test_a_user_speaks_as_fast_to_a_robot_that_speaks_slowly(tmp_path: Path) -> None:
    body = '<form id="a"><block><pause time="30s"/><exit/></block></form>'
    usual = rehearse(tmp_path, body, '<when at="1s"><say>はいそうです。</say></when>')
    slow = tmp_path / "slow.xml"
    robot = (ROOT / "documents" / "robots" / "papero.xml").read_text(encoding="utf-8")
    slow.write_text(robot.replace('lang="ja" rate="8"', 'lang="ja" rate="2"'), encoding="utf-8")
    other = api.rehearse(api.load_scenario(tmp_path / "scenario.xml", robot=str(slow)))
    assert when(other, "はい") == when(usual, "はい") == pytest.approx(1 + 6 / 8 + 0.3, abs=0.001)


def test_the_recogniser_of_a_scenario_may_be_unsure(tmp_path: Path) -> None:
    body = """<form id="a"><field name="town"><prompt>Which town?</prompt>
      <option>Boston</option><option>Austin</option>
      <nomatch><reprompt/></nomatch><noinput><exit/></noinput>
      <filled><log expr="town + ' ' + town$.confidence"/><exit/></filled></field></form>"""
    script = """<answer to="Which town" times="1" confidence="0.4">Boston
        <alternative confidence="0.3">Austin</alternative></answer>
      <when asked="Which town" count="2" after="1s"><say confidence="0.7">Bosten
        <alternative confidence="0.6">Austin</alternative>
        <alternative confidence="0.2">Houston</alternative></say></when>"""
    transcript = rehearse(tmp_path, body, script)
    table = transcript.table(columns=200)
    assert '"Boston" (confidence 0.4, or "Austin" 0.3)' in table
    assert '"Bosten" (confidence 0.7, or "Austin" 0.6, or "Houston" 0.2)' in table
    assert "log: Austin 0.6" in table
    again = api.replay(transcript, tmp_path / "scenario.xml")
    assert again.dumps() == transcript.dumps()


def test_a_recogniser_that_is_sure_reports_what_is_assumed(tmp_path: Path) -> None:
    body = """<form id="a"><field name="town"><prompt>Which town?</prompt><option>Boston</option>
      <filled><log expr="town$.confidence"/><exit/></filled></field></form>"""
    script = '<answer to="Which town"{}>Boston</answer>'
    sure, written = (
        rehearse(tmp_path, body, script.format(how)).table() for how in ("", ' confidence="1"')
    )
    assert written == sure and "log: 1" in sure


def test_an_alternative_is_not_likelier_than_what_is_heard(tmp_path: Path) -> None:
    script = """<answer to="a" confidence="0.4">b
      <alternative confidence="0.5">c</alternative><alternative>d</alternative></answer>
      <answer to="b">c<alternative confidence="1.5">c</alternative></answer>"""
    with pytest.raises(DocumentError) as caught:
        rehearse(tmp_path, "<form id='a'/>", script)
    told = [(one.code, one.place.line) for one in caught.value.problems if one.severity == "error"]
    assert ("out-of-range", 2) in told and ("missing-attribute", 2) in told
    assert ("out-of-range", 3) in told


def test_the_user_answers_late_stays_silent_or_interrupts(tmp_path: Path) -> None:
    body = """<form id="a"><field name="x" type="boolean">
        <prompt timeout="3s">May I tell you a very long story about robots?</prompt>
        <noinput><speak>No answer.</speak><exit/></noinput>
        <filled><speak>Thanks.</speak><exit/></filled></field></form>"""
    silent = rehearse(tmp_path, body)
    assert '"No answer."' in told(silent)
    late = rehearse(tmp_path, body, '<answer to="very long story" after="2.9s">Yes.</answer>')
    assert '"Thanks."' in told(late), "beginning to speak in time is enough"
    early = rehearse(tmp_path, body, '<when at="1s"><say>Yes.</say></when>')
    assert when(early, "Thanks.") < when(late, "Thanks.") - 2, "the question is cut short"


LONG = "Well, let me think, I should like to see the one that hangs beside the window, please."
"""What takes longer to say than a question waits."""


ASKING = """<form id="a"><field name="q" type="text">
    <prompt timeout="2s">Which painting would you like to see first?</prompt>
    <noinput><log>silence</log></noinput><filled><log expr="q"/><exit/></filled></field></form>"""


@pytest.mark.parametrize("at", ["0s", "1s", "5s"], ids=["before it", "in it", "after it"])
@pytest.mark.parametrize("bargein", ["true", "false"])
def test_a_question_waits_while_the_user_speaks(tmp_path: Path, at: str, bargein: str) -> None:
    body = ASKING.replace('<prompt timeout="2s">', f'<prompt timeout="2s" bargein="{bargein}">')
    body = body.replace("<field", "<block><speak>Hello.</speak></block><field")
    transcript = rehearse(tmp_path, body, f'<when at="{at}"><say>{LONG}</say></when>')
    assert [r["message"] for r in transcript.records if r["phase"] == "log"] == [LONG]


def test_a_touch_does_not_begin_the_timeout_while_the_user_speaks(tmp_path: Path) -> None:
    script = f"""<when at="4s"><say>{LONG}</say></when>
      <when at="4.5s"><touch sensor="head"/></when>"""
    transcript = rehearse(tmp_path, ASKING, script)
    assert [r["message"] for r in transcript.records if r["phase"] == "log"] == [LONG]


def test_the_timeout_begins_again_when_the_user_hangs_up_as_he_speaks(tmp_path: Path) -> None:
    script = f"""<when at="1s"><say>{LONG}</say></when><when at="6s"><hang-up/></when>"""
    transcript = rehearse(tmp_path, ASKING, script, until="20s")
    logs = [(r["time"], r["message"]) for r in transcript.records if r["phase"] == "log"]
    assert logs[0] == (8.0, "silence")


def test_leaving_is_noticed_even_when_nothing_else_happens(tmp_path: Path) -> None:
    body = '<form id="a"><on event="human.lost"><speak>Come back.</speak><exit/></on></form>'
    script = '<person x="1" y="0"/><when at="2s"><leave/></when>'
    assert 2.9 < when(rehearse(tmp_path, body, script), "Come back.") < 3.2


def test_a_japanese_application(tmp_path: Path) -> None:
    body = """<form id="質問"><field name="行き先">
        <prompt>どちらへいらっしゃいますか。</prompt>
        <option value="kidode">木戸出先生の部屋</option>
        <filled><speak><value expr="行き先"/>へ行きましょう。</speak><exit/></filled></field></form>"""
    script = '<answer to="どちらへ">木戸出先生 の部屋、です</answer><answer to="いらっしゃい">木戸出先生の部屋。</answer>'
    transcript = rehearse(tmp_path, body, script, lang="ja")
    assert '"kidodeへ行きましょう。"' in told(transcript)
    question = next(r["time"] for r in transcript.records if r["phase"] == "listening")
    assert 1.5 < question < 2.5, "thirteen kana take about two seconds"


@pytest.mark.parametrize(
    "script",
    ['<answer to="A drink"/>', '<when asked="A drink"><say> </say></when>'],
    ids=["answer", "say"],
)
def test_who_says_nothing_stays_silent(tmp_path: Path, script: str) -> None:
    body = """<form id="f"><field name="d" type="boolean"><prompt>A drink?</prompt>
      <noinput count="2"><exit/></noinput></field></form>"""
    person = '<person x="0.9" y="0.5"/>'
    silent = rehearse(tmp_path, body, person)
    spoken = rehearse(tmp_path, body, person + script)
    assert [row.key for row in spoken.rows()] == [row.key for row in silent.rows()]
    (problem,) = api.validate([tmp_path / "scenario.xml"])
    assert (problem.severity, problem.code) == ("warning", "empty")
