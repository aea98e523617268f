"""The simulated robot, user and services, seen through transcripts of small scenarios."""

from __future__ import annotations

import gc
import pickle
import sys
from collections import Counter
from collections.abc import Collection
from math import dist
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prima import api
from prima.devices.profile import Profile
from prima.errors import DocumentError
from prima.messages import Inbound, Order
from prima.scheduler.policy import policy_named
from prima.session import Session
from prima.sim import devices
from prima.sim.map import Map
from prima.sim.rehearsal import Rehearsal
from prima.sim.robot import Robot
from prima.sim.world import World
from prima.transcript import criteria
from tests import ROOT

HEAD = '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{}" id="{}" xml:lang="{}">'


def rehearse(
    folder: Path,
    body: str,
    script: str = "",
    policy: str | None = None,
    lang: str = "en",
    other: str = "",
    until: str = "120s",
) -> api.Transcript:
    """Run one application (and perhaps another) in the office."""
    (folder / "app.xml").write_text(HEAD.format("fa", "app", lang) + body + "</prima>", "utf-8")
    applications = '<application src="app.xml" kind="fa"/>'
    if other:
        (folder / "other.xml").write_text(HEAD.format("ea", "other", "en") + other + "</prima>")
        applications += '<application src="other.xml"/>'
    path = folder / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s"'
        f' world="{ROOT}/documents/worlds/office.xml" robot="{ROOT}/documents/robots/papero.xml"'
        f' until="{until}"><robot at="entrance"/>{applications}{script}</scenario>',
        "utf-8",
    )
    return api.rehearse(path, policy)


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


def test_an_alternative_is_not_likelier_than_what_is_heard(tmp_path: Path) -> None:
    script = """<answer to="a" confidence="0.4">b
      <alternative confidence="0.5">c</alternative><alternative>d</alternative></answer>
      <answer to="b">c<alternative confidence="1.5">c</alternative></answer>"""
    with pytest.raises(DocumentError) as caught:
        rehearse(tmp_path, "<form id='a'/>", script)
    told = [(one.code, one.place.line) for one in caught.value.problems if one.severity == "error"]
    assert ("out-of-range", 2) in told and ("missing-attribute", 2) in told
    assert ("out-of-range", 3) in told


def told(transcript: api.Transcript) -> list[str]:
    return [row.what for row in transcript.rows() if row.kind != "load"]


def when(transcript: api.Transcript, what: str) -> float:
    return next(row.time for row in transcript.rows() if what in row.what)


PROFILE = Profile("r", camera_angle=60, camera_range=4)


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
    world.person = person
    assert world.sees_person() is sees


def test_physics_steps_only_while_something_moves() -> None:
    world = World(Map("m"), PROFILE, (0.0, 0.0), 90.0)
    world.advance(10**9)
    assert (world.time, world.position) == (10**9, (0.0, 0.0))
    world.drive = (0.5, 0.0)
    world.advance(10**9 + 2000)
    assert world.position == pytest.approx((0.0, 1.0), abs=1e-6)


@pytest.mark.parametrize("x", [1.2, 50.0], ids=["by walls", "far from walls"])
@given(
    st.lists(
        st.tuples(st.floats(-1, 1), st.floats(-180, 180), st.integers(1, 300)),
        min_size=1,
        max_size=9,
    )
)
def test_the_body_goes_where_physics_would_take_it(
    x: float, drives: list[tuple[float, float, int]]
) -> None:
    walls = [((x, -1.0), (x, 1.0)), ((-x, 1.0), (x, 1.0))]
    ways = []
    for physics in (False, True):
        world = World(Map("m", walls=walls), PROFILE, (0.5, 0.25), 30.0)
        with pytest.MonkeyPatch.context() as patch:
            if physics:
                patch.setattr(world, "_wall_within", lambda reach: True)
            way = []
            for forward, turning, lasts in drives:
                world.drive = (forward, turning)
                world.advance(world.time + lasts)
                way.append((world.position, world.heading))
        ways.append(way)
    assert ways[0] == ways[1]


def test_a_wall_stops_the_robot() -> None:
    world = World(Map("m", walls=[((1.0, -1.0), (1.0, 1.0))]), PROFILE, (0.0, 0.0), 0.0)
    world.drive = (0.5, 0.0)
    world.advance(5000)
    assert world.position[0] < 0.85


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
    moving = [(rehearsal.now, rehearsal.devices.world.moving) for _ in rehearsal.run()]
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


def test_a_blocked_way_and_an_unknown_place_are_events(tmp_path: Path) -> None:
    body = """<form id="a"><block><set-position x="0" y="3"/><exit/></block>
      <on event="error.device.locomotion"><speak>Blocked.</speak><exit/></on></form>"""
    assert '"Blocked."' in told(rehearse(tmp_path, body))
    body = """<form id="a"><block><topological-move to="moon"/><exit/></block>
      <on event="error.device.localization"><speak>Where?</speak><exit/></on></form>"""
    assert '"Where?"' in told(rehearse(tmp_path, body))


def test_the_robot_goes_round_a_person_who_stands_in_its_way(tmp_path: Path) -> None:
    body = '<form id="a"><block><topological-move to="hall"/><exit/></block></form>'
    transcript = rehearse(tmp_path, body, '<person x="2" y="0.02"/>')
    assert "reaches hall" in told(transcript)
    passed = [r["data"]["y"] for r in transcript.records if "x" in (r.get("data") or {})]
    assert max(abs(y) for y in passed) > 0.25


def test_services_answer_late_fail_or_are_unknown(tmp_path: Path) -> None:
    body = """<form id="a"><block><send to="library"/><send to="library"/><send to="nobody"/></block>
      <on event="reply.library"><log expr="event.data.shelf"/></on>
      <on event="error.service"><log expr="event.data.message"/></on></form>"""
    script = """<service name="library"><reply after="2s"><data name="shelf" value="7"/></reply>
      <failure after="1s" reason="closed"/></service>"""
    transcript = rehearse(tmp_path, body, script)
    logs = [(r["time"], r["message"]) for r in transcript.records if r["phase"] == "log"]
    assert logs == [(0.001, 'there is no service "nobody"'), (1.0, "closed"), (2.0, "7")]


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


def test_an_emergency_stop_and_an_unload(tmp_path: Path) -> None:
    body = '<form id="a"><block><speak>A sentence of some length.</speak><exit/></block></form>'
    script = """<when at="0.5s"><emergency/><wait for="5s"/><release/></when>"""
    transcript = rehearse(tmp_path, body, script)
    assert transcript.records[-1]["time"] > 7
    starts = [r for r in transcript.records if r["phase"] == "start"]
    assert len(starts) == 2, "it is said again from its beginning"
    body = '<form id="a"><block><speak>One.</speak><speak>Two.</speak></block></form>'
    gone = rehearse(tmp_path, body, '<when at="0.2s"><unload application="app"/></when>')
    assert [r["text"] for r in gone.records if r["phase"] == "start"] == ["One."]


def test_without_mediation_behaviours_collide(tmp_path: Path) -> None:
    body = '<form id="a"><block><speak>My long sentence is here.</speak><exit/></block></form>'
    other = '<form id="a"><block><speak>Mine as well.</speak><exit/></block></form>'
    transcript = rehearse(tmp_path, body, policy="none", other=other)
    assert transcript.summary().collisions == 1
    mediated = rehearse(tmp_path, body, other=other)
    assert mediated.summary().collisions == 0


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


def test_a_thousand_times_real_time_needs_no_trick() -> None:
    """The demo's figure stands in docs/performance.md; here only that nothing is skipped."""
    path = ROOT / "documents" / "scenarios" / "follow-during-navigation.xml"
    loops = [
        r for r in api.rehearse(path).records if r["phase"] == "end" and r.get("outcome") == "again"
    ]
    assert len(loops) > 50


def test_nothing_is_computed_while_nothing_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A robot waits ten hours for a message, sees the user all the time, and watches sensors."""
    made: Counter[str] = Counter()

    def count(owner: type, name: str) -> None:
        kept = getattr(owner, name)

        def counted(*given: object) -> object:
            made[name] += 1
            return kept(*given)

        monkeypatch.setattr(owner, name, counted)

    for owner, name in (
        (Rehearsal, "step"), (Rehearsal, "due"), (World, "_step"), (World, "_look"),
        (World, "clear"), (Robot, "collect"), (Session, "step"), (Session, "deadline"),
    ):  # fmt: skip
        count(owner, name)
    body = """<form id="a"><watch name="warm" when="sensor.temperature &gt; 30"/>
      <block><speak>I am waiting.</speak></block>
      <on event="message"><speak>There it is.</speak><exit/></on></form>"""
    script = """<person x="1.5" y="0"/>
      <when at="36000s"><message from="Bob">Hello.</message></when>"""
    transcript = rehearse(tmp_path, body, script, until="80000s")
    assert when(transcript, "There it is.") == 36000
    assert transcript.outcome == "over"
    assert (made["_step"], made["_look"], made["clear"]) == (0, 1, 1)
    assert made["step"] <= 2 * 5, "both step: start, seen, said, the message, said"
    assert max(made.values()) <= 10


def test_while_a_body_only_moves_on_nothing_is_decided(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    instants, decided = 0, 0
    advance, step = World.advance, Session.step

    def counted(world: World, to: int) -> None:
        nonlocal instants
        instants += 1
        advance(world, to)

    def deciding(session: Session, now: int, inbound: Collection[Inbound]) -> list[Order]:
        nonlocal decided
        decided += 1
        return step(session, now, inbound)

    monkeypatch.setattr(World, "advance", counted)
    monkeypatch.setattr(Session, "step", deciding)
    body = '<form id="a"><block><turn angle="170"/><turn angle="-170"/><exit/></block></form>'
    transcript = rehearse(tmp_path, body)
    assert transcript.outcome == "over"
    assert instants > 20
    assert decided <= 3


def test_a_world_that_offers_something_to_a_robot_that_is_not_there_comes_to_an_end(
    tmp_path: Path,
) -> None:
    (tmp_path / "app.xml").write_text(
        HEAD.format("ea", "app", "en") + '<form id="a"><block><exit/></block></form></prima>'
    )
    (tmp_path / "world.xml").write_text(
        '<world xmlns="urn:prima:world:1" version="1.0" id="w"><place id="door" x="0" y="0"/>'
        '<area id="inside" title="a shop" application="app.xml" x1="4" y1="4" x2="6" y2="6"/>'
        "</world>"
    )
    path = tmp_path / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" entrances="open" until="60s"'
        f' world="world.xml" robot="{ROOT}/documents/robots/papero.xml"/>'
    )
    transcript = api.rehearse(path)
    assert [record["phase"] for record in transcript.records] == ["run", "over"]
    assert transcript.outcome == "quiet"


COMES_BACK = """<person x="4.5" y="4"/>
  <when at="1s"><event name="visit"/></when>
  <when on="visit" times="1000" after="60s"><event name="visit"/></when>
  <when on="visit" times="1000">
    <walk x="1.2" y="0"/><wait for="5s"/><touch sensor="head"/></when>
  <answer to="Shall I come">Yes.</answer>
  <when on="enough" times="1000"><walk x="4.5" y="4"/></when>"""
REACTS = """<watch name="near" when="sensor.human.distance &lt; 1.5"/>
  <form id="wait"><on event="near"><log>There.</log></on>
    <on event="touch"><goto next="#ask"/></on>
    <on event="human.lost"><goto next="#home"/></on></form>
  <form id="ask"><block><send to="office"/><send event="late" delay="30s"/></block>
    <field name="wish" type="boolean"><prompt>Shall I come with you?</prompt>
      <filled><goto next="#follow"/></filled></field></form>
  <form id="follow"><block><send event="enough" delay="3s"/><tracking-human/></block>
    <on event="enough"><goto next="#wait"/></on></form>
  <form id="home"><block><set-position-and-direction x="0" y="0" heading="0"/>
    <goto next="#wait"/></block></form>"""


def test_nothing_is_kept_of_what_is_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A user comes back once a minute; records are written, not kept."""
    monkeypatch.setattr(criteria, "MOST_EVENTS", 10)
    (tmp_path / "app.xml").write_text(HEAD.format("fa", "app", "en") + REACTS + "</prima>")
    path = tmp_path / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="3000s"'
        f' world="{ROOT}/documents/worlds/room.xml" robot="{ROOT}/documents/robots/papero.xml">'
        '<robot at="middle"/><application src="app.xml"/>'
        f'<service name="office"><reply after="1s"/></service>{COMES_BACK}</scenario>'
    )
    counts: list[tuple[int, int]] = []
    seen: Counter[str] = Counter()

    def look(line: str) -> None:
        for event in ("visit", "near", "touch.head", "reply.office", "human.lost"):
            seen[event] += f'"event":"{event}"' in line
        if '"event":"visit"' in line and seen["visit"] in (10, 50):
            gc.collect()
            objects = gc.get_objects()
            counts.append((len(objects), sum(map(sys.getsizeof, objects))))

    transcript = api.rehearse(path, sink=look, keep=False)
    assert (transcript.outcome, transcript.failures) == ("until", [])
    assert seen["visit"] == 50
    assert min(seen.values()) >= 49, "each visit was seen and answered"
    (objects, size), (later_objects, later_size) = counts
    assert later_objects - objects < 40, "less than one for each visit"
    assert later_size - size < 40 * 100


def test_a_way_is_chosen_that_the_body_fits_through() -> None:
    """A place may be seen past the end of a wall that the body would run into."""
    from prima.sim.routes import Routes

    plan = Map(
        "m",
        places={"bend": (5.0, 0.0), "jars": (5.0, 4.0)},
        ways=[("bend", "jars")],
        walls=[((-1.0, 1.2), (3.8, 1.2)), ((3.8, 1.2), (3.8, 6.0))],
    )
    world = World(plan, PROFILE, (3.4, 0.0), 180.0)
    assert world.clear(world.position, (5.0, 4.0))
    assert Routes(plan).route(world, "jars") == [(5.0, 0.0), (5.0, 4.0)]


WARD = """<world xmlns="urn:prima:world:1" version="1.0" id="ward">
  <place id="door" x="0" y="0" heading="0"/><place id="turn" x="4" y="0"/><place id="bed" x="4" y="4"/>
  <way from="door" to="turn"/><way from="turn" to="bed"/>
  <wall x1="0" y1="1" x2="2.5" y2="1"/>
  <corner id="beds" x="4" y="0" radius="0.4" event="corner.beds"/>
</world>"""
GOES = '<topological-move to="bed"/><speak>Here we are.</speak>'


@pytest.mark.parametrize("policy", ["fifo", "prima", "prima+all"])
@pytest.mark.parametrize("at", [1, 4, 6.5, 7, 7.5, 8, 9])
def test_a_pause_of_a_move_loses_no_corner(tmp_path: Path, policy: str, at: float) -> None:
    """From near the corner the goal is in view: a move that resumes may not cut it short."""
    (tmp_path / "ward.xml").write_text(WARD)
    (tmp_path / "guide.xml").write_text(
        HEAD.format("ea", "guide", "en") + f'<form id="go"><block>{GOES}</block>'
        '<on event="corner.beds"><speak>Mind the beds.</speak></on></form></prima>'
    )
    (tmp_path / "nice.xml").write_text(
        HEAD.format("fa", "nice", "en") + '<form id="sleep"><on event="touch">'
        "<speak>Hello, how nice of you to touch me.</speak></on></form></prima>"
    )
    path = tmp_path / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="ward.xml"'
        f' robot="{ROOT}/documents/robots/papero.xml" until="60s"><robot at="door"/>'
        '<application src="nice.xml" kind="fa"/><application src="guide.xml"/>'
        f'<when at="{at}s"><touch sensor="head"/></when></scenario>'
    )
    said = [row.what for row in api.rehearse(path, policy).rows() if row.what.startswith('"')]
    assert sorted(said) == [
        '"Hello, how nice of you to touch me."',
        '"Here we are."',
        '"Mind the beds."',
    ]


def test_a_move_that_is_asked_for_again_where_it_was_given_up_keeps_its_way(tmp_path: Path) -> None:
    (tmp_path / "ward.xml").write_text(WARD)
    (tmp_path / "guide.xml").write_text(
        HEAD.format("ea", "guide", "en") + f'<form id="go"><block>{GOES}</block>'
        '<on event="touch"><stop-moving/><goto next="#go"/></on>'
        '<on event="corner.beds"><speak>Mind the beds.</speak></on></form></prima>'
    )
    path = tmp_path / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="ward.xml"'
        f' robot="{ROOT}/documents/robots/papero.xml" until="60s"><robot at="door"/>'
        '<application src="guide.xml"/>'
        '<when at="7s"><touch sensor="head"/></when></scenario>'
    )
    assert '"Mind the beds."' in told(api.rehearse(path))


ROUND = Map(
    "m",
    places={"hall": (4.0, 0.0), "crossing": (8.0, 0.0), "room": (8.0, 6.0)},
    ways=[("hall", "crossing"), ("crossing", "room")],
    walls=[((-1.5, 1.5), (5.2, 1.5)), ((5.2, 1.5), (5.2, 7.5))],
)
BESIDE_THE_END = (5.171, 1.35)
"""Nearer to the walls' common end than the robot's radius."""


def test_a_way_leads_out_of_where_the_body_is_too_near_to_a_wall() -> None:
    from prima.sim.routes import Routes

    world = World(ROUND, PROFILE, BESIDE_THE_END, 57.5)
    assert world.clear(world.position, (8.0, 6.0))
    assert Routes(ROUND).route(world, "room") == [(8.0, 0.0), (8.0, 6.0)]


TRACKS = '<block><tracking-human distance="1"/></block>'


@pytest.mark.parametrize("x", [5.21, 5.22, 5.25, 5.3])
@pytest.mark.parametrize("y", [1.45, 1.5, 1.6, 2.5])
def test_a_way_leads_out_of_a_wall_itself(tmp_path: Path, x: float, y: float) -> None:
    """Where a scenario puts the body into the thickness of a wall, on the side of the room."""
    office = (ROOT / "documents" / "worlds" / "office.xml").read_text(encoding="utf-8")
    odd = f'<place id="odd" x="{x}" y="{y}" title="Odd"/><place id="hall"'
    (tmp_path / "w.xml").write_text(office.replace('<place id="hall"', odd, 1), encoding="utf-8")
    (tmp_path / "go.xml").write_text(
        HEAD.format("ea", "go", "en")
        + '<form id="f"><block><topological-move to="lab"/><exit/></block></form></prima>'
    )
    (tmp_path / "s.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="w.xml"'
        f' robot="{ROOT / "documents" / "robots" / "papero.xml"}"><robot at="odd"/>'
        '<person x="0.9" y="0"/><application src="go.xml"/></scenario>'
    )
    made = api.rehearse(tmp_path / "s.xml")
    assert made.failures == []
    assert made.records[-1]["time"] < 60


def test_tracking_keeps_the_body_from_the_end_of_a_wall(tmp_path: Path) -> None:
    """The user walks round it, so the straight line to him leads past it by less than a radius."""
    transcript = rehearse(
        tmp_path,
        f'<form id="f">{TRACKS}</form>',
        '<person x="1.5" y="0.5"/><when doing="tracking-human" after="1s">'
        '<walk x="5.2" y="0.5"/><walk x="7" y="0.5"/><walk x="6.6" y="3.6"/></when>',
        until="40s",
    )
    places = [
        (record["data"]["x"], record["data"]["y"])
        for record in transcript.records
        if record["phase"] == "end" and record.get("command") == "tracking-human"
    ]
    assert min(dist(place, (5.2, 1.5)) for place in places) > 0.2
    assert places[-1][1] > 2, "it has come round the corner"


@pytest.mark.parametrize("touch", [0.5, 1.6, 2.0, 7, 13])
@pytest.mark.parametrize("message", [0, 10.2, 11, 19])
def test_whenever_touch_and_message_come_the_room_is_reached(
    tmp_path: Path, touch: float, message: float
) -> None:
    folder = ROOT / "documents"
    text = (folder / "scenarios" / "follow-during-navigation.xml").read_text("utf-8")
    text = text.replace("../", f"{folder}/").replace('after="6s"', f'after="{touch}s"')
    later = 'doing="active-sensing-human" after="{}s"'
    text = text.replace(later.format(3), later.format(message))
    (tmp_path / "s.xml").write_text(text, "utf-8")
    transcript = api.rehearse(tmp_path / "s.xml")
    assert transcript.records[-1]["outcome"] == "quiet"
    assert '"I\'ve just reached the goal."' in told(transcript)


@pytest.mark.parametrize("name", ["follow-during-navigation.xml", "pizza-and-follow.xml"])
def test_what_a_run_needs_can_be_sent_to_another_process(name: str) -> None:
    loaded = api.load_scenario(ROOT / "documents" / "scenarios" / name)
    again = pickle.loads(pickle.dumps(loaded))
    assert api.rehearse(again).records == api.rehearse(loaded).records
