"""Motion through the world: physics, walls, people, and ways that are found."""

from __future__ import annotations

from itertools import pairwise
from math import dist
from pathlib import Path
from unittest.mock import Mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from prima import api
from prima.sim.locomotion import ALIGNED
from prima.sim.map import Map
from prima.sim.routes import Routes
from prima.sim.world import World
from tests import ROOT
from tests.helpers.rehearsing import HEAD, PROFILE, rehearse, told


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


def test_there_is_no_way_through_a_wall() -> None:
    from prima.sim.routes import Routes

    plan = Map("m", places={"a": (0.0, 0.0), "b": (4.0, 0.0)}, walls=[((2.0, -9.0), (2.0, 9.0))])
    for x, there in ((0.0, "b"), (4.0, "a")):
        world = World(plan, PROFILE, (x, 0.0), 0.0)
        assert Routes(plan).route(world, there) is None


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


MOVE = '<topological-move to="d"/>'


def moved(folder: Path, world: str, robot: str, does: str = MOVE) -> api.Transcript:
    """A move from ``a`` to ``d``, or another motion, in a world and by a robot of their own."""
    texts = {
        "world": f'<world xmlns="urn:prima:world:1" version="1.0" id="w">{world}</world>',
        "robot": f'<robot xmlns="urn:prima:robot:1" version="1.0" id="r"{robot}>'
        '<device name="locomotion"/><device name="localization"/></robot>',
        "app": HEAD.format("ea", "mv", "en")
        + f'<form id="f"><block>{does}<exit/></block></form></prima>',
        "scenario": '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" until="900s"'
        ' world="world.xml" robot="robot.xml"><robot at="a"/><application src="app.xml"/></scenario>',
    }
    for name, text in texts.items():
        (folder / f"{name}.xml").write_text(text)
    return api.rehearse(folder / "scenario.xml")


def test_places_on_one_spot_do_not_lead_round_and_round(tmp_path: Path) -> None:
    world = """<place id="a" x="0" y="0"/><place id="b" x="4" y="0"/><place id="c" x="4" y="0"/>
      <place id="d" x="8" y="0"/><way from="a" to="b"/><way from="b" to="c"/><way from="b" to="d"/>"""
    assert told(moved(tmp_path, world, ""))[-1] == "ends mv: exit"


@pytest.mark.parametrize("robot", [' speed="0.01"', ' loop="10ms"', ' speed="0.02" loop="20ms"'])
def test_who_is_slow_is_not_blocked(tmp_path: Path, robot: str) -> None:
    world = '<place id="a" x="0" y="0"/><place id="d" x="3" y="0"/><way from="a" to="d"/>'
    assert told(moved(tmp_path, world, robot))[-1] == "ends mv: exit"


def test_who_is_fast_and_turns_slowly_does_not_drift_into_a_wall(tmp_path: Path) -> None:
    world = """<place id="a" x="4.3" y="-1.5" heading="180"/><place id="d" x="-1.4" y="2.4"/>
      <wall x1="2.2" y1="-2.4" x2="3" y2="-1"/>"""
    assert told(moved(tmp_path, world, ' speed="1" turn-speed="30"'))[-1] == "ends mv: exit"


def test_who_slides_along_a_wall_is_blocked(tmp_path: Path) -> None:
    """The wall pushes the body back, the wheels drive it on: no progress."""
    world = """<place id="a" x="-5" y="6"/><place id="b" x="0.3" y="-0.8"/><place id="d" x="3" y="-1"/>
      <way from="a" to="b"/><way from="b" to="d"/>
      <wall x1="0.1" y1="-3.5" x2="0" y2="0.9"/><wall x1="-2" y1="3" x2="-1" y2="2"/>"""
    assert told(moved(tmp_path, world, ' radius="0.4" speed="1"'))[-2:] == [
        "Topological Move fails: the way is blocked",
        "ends mv: error.device.locomotion: app.xml:1:103: the way is blocked",
    ]


@pytest.mark.parametrize(("given", "heading"), [("", 90), (' heading="0"', 0)])
def test_a_robot_begins_in_the_direction_of_its_place(
    tmp_path: Path, given: str, heading: int
) -> None:
    """The table has no default, which an editor or a schema would fill in."""
    from prima.sim.vocabulary.scenario import SCENARIO

    (tmp_path / "hall.xml").write_text(
        '<world xmlns="urn:prima:world:1" version="1.0" id="hall">'
        '<place id="door" x="0" y="0" heading="90"/></world>'
    )
    (tmp_path / "where.xml").write_text(
        HEAD.format("ea", "where", "en") + '<watch name="never" when="sensor.position.x &gt; 9"/>'
        '<form id="f"><block><pause time="1s"/><log expr="sensor.position.heading"/><exit/></block>'
        "</form></prima>"
    )
    path = tmp_path / "s.xml"
    path.write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="hall.xml"'
        f' robot="{ROOT}/documents/robots/papero.xml"><robot at="door"{given}/>'
        '<application src="where.xml"/></scenario>'
    )
    assert f"log: {heading}" in [row.what for row in api.rehearse(path).rows()]
    attributes = SCENARIO.elements["robot"].attributes
    assert [one.default for one in attributes if one.name == "heading"] == [""]


def test_a_robot_that_turns_slowly_keeps_its_turn_speed(tmp_path: Path) -> None:
    world = '<place id="a" x="0" y="0" heading="90"/><place id="d" x="1" y="0"/>'
    [end] = [
        record["time"]
        for record in moved(tmp_path, world, ' turn-speed="1"', '<turn angle="-20"/>').records
        if record["phase"] == "end" and record["command"] == "turn"
    ]
    assert end == pytest.approx(20 - ALIGNED, abs=0.1), "a degree a second"


@given(st.permutations([0.4, 1.5, 4.3]), st.permutations([0.4, 1.5, 4.3]))
def test_of_equal_ways_the_first_in_the_alphabet_is_taken_however_they_are_divided(
    one: list[float], other: list[float]
) -> None:
    plan = Map("m", places={"here": (0.0, 0.0), "there": (0.0, 6.2)})
    for name, lengths in (("a", one), ("b", other)):
        along = [(0.0, round(sum(lengths[:count]), 1)) for count in (1, 2)]
        names = [f"{name}{number}" for number in (1, 2)]
        plan.places |= dict(zip(names, along, strict=True))
        plan.ways += pairwise(["here", *names, "there"])
    plan.walls = [((-1.0, -1.0), (-0.5, -1.0))]
    world = World(plan, PROFILE, (0.0, 0.0), 0.0)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(world, "passable", lambda here, place: here == place)
        assert Routes(plan).route(world, "there") == [
            plan.places[name] for name in ("here", "a1", "a2", "there")
        ]


def test_few_of_many_places_are_looked_at_to_begin_a_way() -> None:
    places = {f"p{number}": (number * 0.2, 0.0) for number in range(500)}
    plan = Map("m", places=places, ways=list(pairwise(places)))
    world = World(plan, PROFILE, (0.0, 0.5), 0.0)
    free = Mock(return_value=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(world, "passable", free)
        assert Routes(plan).route(world, "p499") == [places["p499"]]
    free.assert_called_once()
