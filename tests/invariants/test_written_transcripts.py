"""Transcripts with physics, whose times are written in seconds, are held to the rules."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.invariants import check
from prima.invariants.table import contradictions
from tests.helpers.rehearsing import rehearse
from tests.helpers.voice import vxml

ASKS = (
    '<form id="f"><field name="q" type="boolean"><prompt timeout="5s">Well?</prompt>'
    "<noinput><reprompt/></noinput></field></form>"
)
GOES = '<form id="f"><block><topological-move to="kidode-room"/></block></form>'
SPEAKS = '<form id="f"><block><speak>Welcome to our museum.</speak></block></form>'
LINKED = (
    '<form id="f"><block><speak>Welcome to our museum of modern art, my friends.</speak>'
    "<speak>Follow me.</speak></block></form>"
)
HELD = SPEAKS.replace('id="f"', 'id="f" stream="hold"')
AWAY = '<person x="-3" y="0"/>'


def test_the_user_is_absent_to_the_millisecond(tmp_path: Path) -> None:
    touched = '<when at="9002ms"><touch sensor="head"/></when>'  # 9.002 + 20 > 29.002 as floats
    made = rehearse(tmp_path, ASKS, AWAY + touched, other=GOES, until="60s")
    starts = [one for one in made.records if one["phase"] == "start" and one["app"] == "other"]
    assert starts[0]["time"] == 29.002 and check(made.records) == []


def test_an_application_that_is_loaded_again_is_another_one(tmp_path: Path) -> None:
    again = '<unload application="app"/><wait for="100ms"/><load application="app"/>'
    made = rehearse(tmp_path, SPEAKS, f'<when at="500ms">{again}</when>')
    said = [one["time"] for one in made.records if one["phase"] == "start"]
    ends = [one["time"] for one in made.records if one["phase"] == "end"]
    assert len(said) == 2 and said[1] == ends[0] > 0.6, made.table()
    assert check(made.records) == []


@pytest.mark.parametrize("body", [SPEAKS, LINKED, HELD])
def test_an_application_may_be_loaded_again_at_once(tmp_path: Path, body: str) -> None:
    again = '<unload application="app"/><load application="app"/>'
    made = rehearse(tmp_path, body, f'<when at="2s">{again}</when>', "prima+x3", until="9s")
    assert {2.0} == {one["time"] for one in made.records if one["phase"] == "unload"}
    assert check(made.records, "prima+x3") == []


def test_the_number_of_a_call_is_not_that_of_an_event(tmp_path: Path) -> None:
    call = '<transfer dest="tel:1" bridge="true"/>'
    asks = '<field name="f" type="boolean"><prompt>Well?</prompt></field>'
    (tmp_path / "app.vxml").write_text(vxml(f"<form>{call * 2}{asks}</form>"), encoding="utf-8")
    made = api.rehearse(api.stage([], [tmp_path / "app.vxml"], says=["yes"]))
    numbered = [(r["phase"], r["serial"]) for r in made.records if r.get("serial") == 2]
    assert numbered == [("send", 2), ("transferred", 2), ("event", 2)], made.table()
    assert check(made.records, calling=["app"]) == []


def test_an_end_of_which_records_do_not_show_whether_it_is_heard(tmp_path: Path) -> None:
    unit = (
        '<form id="f"><iu><field name="q" type="boolean"><prompt timeout="3s">Well?</prompt>'
        '<noinput><reprompt/></noinput></field><on event="touch"><stop-moving/>'
        "<speak>Hello, my friend.</speak></on></iu></form>"
    )
    late = '<when at="1s"><touch sensor="head"/></when><when at="4.2s"><say>no</say></when>'
    made = rehearse(tmp_path, unit, late, policy="prima+x10")
    (words,) = [one for one in made.records if one.get("event") == "speech"]
    assert words["rule"] == "X10", made.table()
    assert check(made.records, "prima+x10") == []


def test_commands_that_a_robot_adds_have_the_devices_that_it_says() -> None:
    """A robot may add a Command named as that of another robot."""
    request = {"command": "dance", "devices": ["arm"], "priority": "high"}
    assert list(contradictions(request)) == []
    assert list(contradictions({**request, "command": "speak"})) == ["it occupies arm"]
