"""The simulated robot: every Command, its camera, and devices that fail or hang."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima import api
from prima.scheduler.policy import policy_named
from prima.sim import devices
from prima.sim.map import Map
from prima.sim.rehearsal import Rehearsal
from prima.sim.world import World
from tests.helpers.rehearsing import PROFILE, rehearse, told, when


@pytest.mark.parametrize(
    ("person", "sees"),
    [
        ((2.0, 0.0), True),
        ((2.0, 1.1), True),
        ((2.0, 1.3), False),
        ((-2.0, 0.0), False),
        ((4.5, 0.0), False),
        ((3.5, 0.2), False),
    ],
    ids=["ahead", "inside the angle", "outside it", "behind", "too far", "behind a wall"],
)
def test_the_camera_has_an_angle_a_range_and_walls(person: tuple[float, float], sees: bool) -> None:
    plan = Map("m", walls=[((3.0, -1.0), (3.0, 1.0))])
    world = World(plan, PROFILE, (0.0, 0.0), 0.0)
    world.put("user", person)
    assert world.sees_person() is sees


def test_every_command_of_table_4_2_can_be_done(tmp_path: Path) -> None:
    commands = """
      <active-sensing-human/> <face-human/> <face-human-and-speak>Hi.</face-human-and-speak>
      <turn-and-speak angle="30">There.</turn-and-speak> <set-direction heading="90"/>
      <turn angle="-90"/> <set-speed-and-time speed="0.2" time="1s"/> <speak>Go.</speak>
      <move-head pan="20" tilt="5"/> <point-by-hand toward="hall"/> <gesture name="nod"/>
      <topological-move to="hall"/> <set-position x="3" y="0"/>
      <set-position-and-direction x="2" y="0" heading="180"/>"""
    body = f"""<form id="a"><block>{commands}</block>
      <field name="ok" type="boolean"><prompt>Shall I follow you?</prompt></field>
      <block><tracking-human/></block>
      <on event="touch"><stop-moving/><exit/></on></form>"""
    script = """<person x="1.5" y="0.3"/><answer to="Shall I follow you?">Yes.</answer>
      <when doing="tracking-human" after="3s"><touch sensor="head"/></when>"""
    transcript = rehearse(tmp_path, body, script)
    assert transcript.failures == []
    done = {r["command"] for r in transcript.records if r["phase"] == "end"}
    assert len(done | {"tracking-human"}) == 17
    assert transcript.outcome == "over"


def test_a_robot_faces_whom_its_camera_loses_while_it_turns(tmp_path: Path) -> None:
    """The head looks aside: the camera turns away from the user as the body turns to them."""
    body = '<form id="a"><block><move-head pan="-60"/><face-human/><exit/></block></form>'
    transcript = rehearse(tmp_path, body, '<person x="0.7" y="-0.7"/>')
    ended = [one for one in transcript.records if one["phase"] == "end"]
    assert ended[-1]["data"]["heading"] == pytest.approx(315, abs=5)


def test_the_search_turns_the_camera_when_patience_has_run_out(tmp_path: Path) -> None:
    body = """<form id="a"><block><active-sensing-human patience="5s">Where are you?</active-sensing-human>
      <speak>There you are.</speak><exit/></block></form>"""
    transcript = rehearse(tmp_path, body, '<person x="-1" y="0.3"/>')
    assert 10 < when(transcript, "There you are.") < 40
    assert (
        told(transcript).count('Active Sensing Human (patience 5s), saying "Where are you?"') == 1
    )


def test_a_device_that_fails_and_one_that_hangs_are_events(tmp_path: Path) -> None:
    body = """<form id="a"><block><speak>One.</speak></block>
      <block><speak>Two.</speak></block><block><exit/></block>
      <on event="error.device.speaker"><log expr="event.name"/></on></form>"""
    fails = (
        '<when at="0.5s"><fail device="speaker"/><wait for="1s"/><repair device="speaker"/></when>'
    )
    transcript = rehearse(tmp_path, body, fails)
    assert "Speak fails: the device fails" in told(transcript)
    assert transcript.failures == []
    hangs = '<when at="0.1s"><fail device="speaker" hangs="true"/></when>'
    hung = rehearse(tmp_path, body, hangs, until="600s")
    assert "Speak fails: The device did not end in time." in told(hung)


BREAKS = '<when at="0.7s"><fail device="{}" {}/></when>'
AT_ONCE = {
    "a sentence": ("speaker", "<speak>One, two, three, four.</speak>"),
    "a question": (
        "speech-recognition",
        '<field name="q" type="text"><prompt>Who?</prompt></field>',
    ),
    "a turn": ("locomotion", '<turn angle="180"/>'),
    "a loop": ("localization", '<topological-move to="hall"/>'),
    "a unit": (
        "speaker",
        """<iu><par><speak>One, two, three, four.</speak><move-head pan="80" tilt="0"/></par></iu>""",
    ),
}


@pytest.mark.parametrize("kind", AT_ONCE)
def test_a_device_that_fails_ends_what_runs_on_it_at_once(tmp_path: Path, kind: str) -> None:
    device, doing = AT_ONCE[kind]
    if not doing.startswith("<field"):
        doing = f"<block>{doing}<speak>Never.</speak></block>"
    body = f"""<form id="a">{doing}
      <on event="error.device"><log expr="event.name"/><exit/></on></form>"""
    transcript = rehearse(tmp_path, body, BREAKS.format(device, ""))
    logs = [(r["time"], r["message"]) for r in transcript.records if r["phase"] == "log"]
    assert logs == [(0.7, f"error.device.{device}")]
    assert f"the {device} fails" in told(transcript)
    assert '"Never."' not in told(transcript)


@pytest.mark.parametrize("how", ["", 'hangs="true"'], ids=["fails", "hangs"])
def test_a_device_that_breaks_stops_the_wheels_and_nobody_else(tmp_path: Path, how: str) -> None:
    body = """<form id="a"><block><set-speed-and-time speed="0.3" time="5s"/></block>
      <on event="error"/></form>"""
    other = '<form id="a"><block><speak>I talk for a second.</speak></block></form>'
    made = rehearse(tmp_path, body, BREAKS.format("locomotion", how), other=other)
    assert not [r for r in made.records if r["phase"] == "fail" and r["app"] == "other"]
    rehearsal = Rehearsal(api.load_scenario(tmp_path / "scenario.xml").cast, policy_named("prima"))
    moving = [(rehearsal.now, rehearsal.devices.world.moves()) for _ in rehearsal.run()]
    assert {time for time, moves in moving if moves} <= set(range(700))
    assert (0, True) in moving


def test_a_device_that_hangs_is_given_up_120_seconds_after_what_it_may_take(tmp_path: Path) -> None:
    body = """<form id="a"><field name="q" type="text">
      <prompt timeout="7s">Who?</prompt><noinput><log>silence</log></noinput></field>
      <on event="error.device"><log expr="event.name"/><exit/></on></form>"""
    script = BREAKS.format("speech-recognition", 'hangs="true"')
    script += '<when at="5s"><touch sensor="head"/><repair device="speech-recognition"/></when>'
    transcript = rehearse(tmp_path, body, script, until="600s")
    logs = [(r["time"], r["message"]) for r in transcript.records if r["phase"] == "log"]
    assert logs == [(120.0 + 7.0 + 0.5 * len("Who?"), "error.device.speaker")]
    assert "the speech-recognition hangs" in told(transcript)


UNHEARD = 'says "yes", which the robot does not hear'


@pytest.mark.parametrize("how", ["", 'hangs="true"'], ids=["fails", "hangs"])
def test_a_recogniser_that_is_broken_hears_nothing(tmp_path: Path, how: str) -> None:
    """Neither for a question nor for a link, whenever it was asked; a new question is answered."""
    body = """<form id="a"><link event="linked"><grammar>yes</grammar></link>
      <field name="q" type="boolean"><prompt/><noinput/><filled><log>yes</log><exit/></filled></field>
      <on event="error.device"><goto next="#b"/></on></form>
      <form id="b"><block><pause time="5s"/><goto next="#a"/></block></form>"""
    script = f"""<when at="0s"><fail device="speech-recognition" {how}/></when>
      <when at="0.1s"><say>yes</say><repair device="speech-recognition"/></when>
      <when at="200s"><say>yes</say></when>"""
    transcript = rehearse(tmp_path, body, script, until="600s")
    heard = [r["time"] for r in transcript.records if r.get("event") == "speech"]
    noted = [r["time"] for r in transcript.records if r["phase"] == "note" and r["text"] == UNHEARD]
    assert (noted, heard) == ([0.631], [200.531])


@pytest.mark.parametrize("how", ["", 'hangs="true"'], ids=["fails", "hangs"])
def test_a_camera_that_is_broken_sees_nobody(tmp_path: Path, how: str) -> None:
    """The user is lost after the usual second, and found once it works again, though nothing moves."""
    body = """<form id="a"><watch name="seen" when="sensor.human.visible"/>
      <watch name="unseen" when="!sensor.human.visible"/>
      <on event="human"><log expr="event.name"/></on>
      <on event="seen"><log>in view</log></on><on event="unseen"><log>out of view</log></on></form>"""
    script = f"""<person x="1" y="0"/><when at="2s"><fail device="human-detection" {how}/></when>
      <when at="5s"><repair device="human-detection"/></when>"""
    transcript = rehearse(tmp_path, body, script, until="9s")
    logs = [(r["time"], r["message"]) for r in transcript.records if r["phase"] == "log"]
    assert logs == [
        (0.0, "human.found"),
        (0.0, "in view"),
        (2.0, "out of view"),
        (3.001, "human.lost"),
        (5.0, "in view"),
        (5.001, "human.found"),
    ]


def test_a_question_that_listens_is_answered_though_the_speaker_hangs(tmp_path: Path) -> None:
    body = """<form id="a"><field name="q" type="boolean"><prompt>Well?</prompt>
      <filled><log expr="q"/><exit/></filled></field></form>"""
    script = """<when at="2s"><fail device="speaker" hangs="true"/><say>yes</say></when>"""
    assert "log: true" in told(rehearse(tmp_path, body, script))


@pytest.mark.parametrize("fails, hangs", [("neck", "arm"), ("arm", "neck")])
def test_a_device_that_fails_is_reported_beside_one_that_hangs(
    tmp_path: Path, fails: str, hangs: str
) -> None:
    body = """<form id="a"><block><gesture name="wave"/></block>
      <on event="error.device"><log expr="event.name"/><exit/></on></form>"""
    script = f'<when at="0s"><fail device="{hangs}" hangs="true"/><fail device="{fails}"/></when>'
    transcript = rehearse(tmp_path, body, script)
    logs = [r["message"] for r in transcript.records if r["phase"] == "log"]
    assert logs == [f"error.device.{fails}"]


def test_watches_see_the_sensors(tmp_path: Path) -> None:
    body = """<form id="a"><watch name="near" when="sensor.human.distance &lt; 1"/>
      <watch name="warm" when="sensor.temperature &gt; 30"/>
      <on event="near"><speak>You are near.</speak></on><on event="warm"><speak>Hot.</speak><exit/></on></form>"""
    script = """<person x="4" y="0"/><when at="1s"><walk x="0.8" y="0"/></when>
      <when at="9s"><sensor name="temperature" value="31"/></when>"""
    assert told(rehearse(tmp_path, body, script))[-3:-1] == ["warm", '"Hot."']


WATCHING = """<form id="a">
  <watch name="low" when="sensor.battery?.level &lt; 15"/>
  <on event="low"><log>Low.</log></on>
  <on event="touch"><turn angle="90"/><turn angle="-90"/></on></form>"""
TURNS = """<person x="4" y="0"/><when at="1s"><walk x="0.8" y="0"/><touch sensor="head"/></when>
  <when at="8s"><sensor name="battery.level" value="3"/></when>"""


def reports(transcript: api.Transcript) -> list[set[str]]:
    return [set(one["data"]) for one in transcript.records if one["phase"] == "sensed"]


def test_only_sensors_that_somebody_looks_at_are_told_after_the_first_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    few = rehearse(tmp_path, WATCHING, TURNS)
    first, *more = reports(few)
    assert first >= {"human.visible", "human.distance", "position.x", "moving"}
    assert more == [{"battery.level"}]
    other = '<form id="f"><watch name="m" when="sensor.moving"/></form>'
    _, *more = reports(rehearse(tmp_path, WATCHING, TURNS, other=other))
    assert more == [*[{"moving"}] * 4, {"battery.level"}], "it turns there and back"
    monkeypatch.setattr(devices, "sensors_read", lambda document: None)
    everything = rehearse(tmp_path, WATCHING, TURNS)
    assert len(reports(everything)) > 20
    assert [one for one in everything.records if one["phase"] != "sensed"] == [
        one for one in few.records if one["phase"] != "sensed"
    ]


def test_a_search_that_is_cut_short_leaves_it_to_the_camera_to_tell_whom_it_sees(
    tmp_path: Path,
) -> None:
    """While a Command searches, it reports whom it finds; the user is in view when it is stopped."""
    body = '<form id="a"><block><active-sensing-human/><speak>Found.</speak></block></form>'
    script = """<person x="-3" y="0.2"/><when at="1s"><walk x="3" y="0.4"/></when>
      <when at="4.7s"><emergency/></when>"""
    found = [
        one["time"]
        for one in rehearse(tmp_path, body, script).records
        if one.get("event") == "human.found"
    ]
    assert found == [4.701], "as soon as nobody searches"
