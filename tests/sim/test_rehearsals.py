"""Rehearsals: services, emergencies, no mediation, and time that costs nothing."""

from __future__ import annotations

import gc
import pickle
import sys
from collections import Counter
from collections.abc import Collection
from pathlib import Path

import pytest

from prima import api
from prima.messages import Inbound, Order
from prima.session import Session
from prima.sim.rehearsal import Rehearsal
from prima.sim.robot import Robot
from prima.sim.world import World
from prima.transcript import observer
from tests import ROOT
from tests.helpers.rehearsing import HEAD, rehearse, when


def test_services_answer_late_fail_or_are_unknown(tmp_path: Path) -> None:
    body = """<form id="a"><block><send to="library"/><send to="library"/><send to="nobody"/></block>
      <on event="reply.library"><log expr="event.data.shelf"/></on>
      <on event="error.service"><log expr="event.data.message"/></on></form>"""
    script = """<service name="library"><reply after="2s"><data name="shelf" value="7"/></reply>
      <failure after="1s" reason="closed"/></service>"""
    transcript = rehearse(tmp_path, body, script)
    logs = [(r["time"], r["message"]) for r in transcript.records if r["phase"] == "log"]
    assert logs == [(0.001, 'there is no service "nobody"'), (1.0, "closed"), (2.0, "7")]


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


def test_a_thousand_times_real_time_needs_no_trick() -> None:
    """Nothing is skipped; docs/performance.md has the demo's figure."""
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
        (Rehearsal, "_decide"), (Rehearsal, "due"), (World, "_move"), (World, "_look"),
        (World, "clear"), (World, "moves"), (Robot, "collect"),
        (Session, "step"), (Session, "deadline"),
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
    assert (made["_move"], made["_look"], made["clear"]) == (0, 1, 1)
    assert made["step"] == made["_decide"] <= 5, "start, seen, said, the message, said"
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


@pytest.mark.parametrize("robot", ["", '<robot at="first"/>'])
def test_a_robot_that_is_put_nowhere_is_at_the_first_place_as_that_is_turned(
    tmp_path: Path, robot: str
) -> None:
    (tmp_path / "world.xml").write_text(
        '<world xmlns="urn:prima:world:1" version="1.0" id="w">'
        '<place id="first" x="1" y="2" heading="90"/><place id="second" x="3" y="2"/></world>'
    )
    (tmp_path / "app.xml").write_text(
        HEAD.format("ea", "app", "en")
        + '<form id="a"><block><set-speed-and-time speed="0.5" time="1s"/><exit/></block></form></prima>'
    )
    path = tmp_path / "scenario.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="world.xml"'
        f' robot="{ROOT}/documents/robots/papero.xml">{robot}<application src="app.xml"/></scenario>'
    )
    [end] = [one for one in api.rehearse(path).records if one["phase"] == "end"]
    there = {name: end["data"][name] for name in ("x", "y", "heading")}
    assert there == pytest.approx({"x": 1.0, "y": 2.5, "heading": 90.0}, abs=0.02)


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
    monkeypatch.setattr(observer, "MOST_EVENTS", 10)
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


@pytest.mark.parametrize("name", ["follow-during-navigation.xml", "pizza-and-follow.xml"])
def test_what_a_run_needs_can_be_sent_to_another_process(name: str) -> None:
    loaded = api.load_scenario(ROOT / "documents" / "scenarios" / name)
    again = pickle.loads(pickle.dumps(loaded))
    assert api.rehearse(again).records == api.rehearse(loaded).records
