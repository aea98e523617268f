"""The robot's surroundings: entrances that offer an EA, dances on the way, other robots."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from prima import api
from prima.errors import DocumentError

WORLD = """<world xmlns="urn:prima:world:1" version="1.0" id="street">
  <place id="door" x="0" y="0"/><place id="far" x="10" y="0"/><place id="street" x="-3" y="0"/>
  <way from="door" to="far"/><way from="door" to="street"/>
  {areas}
</world>"""
SHOP = '<area id="shop" title="the shop" application="shop.xml" x1="-1" y1="-2" x2="11" y2="2"/>'
ROBOT = """<robot xmlns="urn:prima:robot:1" version="1.0" id="r">
  <device name="human-detection"/><device name="locomotion"/><device name="localization"/>
  <device name="speaker"/><device name="speech-recognition"/>
  <camera angle="60" range="4"/><touch sensor="head"/>
  {more}
</robot>"""
ARM = '<device name="neck"/><device name="arm"/>'
DANCE = """<adds command="dance" title="Dance" devices="locomotion" duration="8s" stray="{stray}">
    <step for="500ms" turn-speed="80"/><step for="500ms" speed="0.3"/>
    <step for="1s" turn-speed="-80"/><step for="500ms" speed="-0.3"/>
    <step for="500ms" turn-speed="80"/></adds>"""
LASER = """<device name="laser"/>
  <adds command="point-by-laser" title="Point by Laser" devices="laser">
    <argument name="angle" kind="number"/><argument name="toward" kind="id"/></adds>
  <substitute command="point-by-hand" by="point-by-laser"/>"""


def document(kind: str, name: str, body: str) -> str:
    return f'<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="{kind}" id="{name}">{body}</prima>'


def form(content: str, name: str = "f") -> str:
    return f'<form id="{name}">{content}</form>'


def block(content: str) -> str:
    return form(f"<block>{content}</block>")


WANDERER = document(
    "fa",
    "fa",
    form('<on event="out"><topological-move to="street"/><topological-move to="door"/></on>'),
)
KEEPER = document(
    "ea",
    "shop",
    block("<speak>Welcome to the shop.</speak><speak>Look around.</speak>"),
)


def play(
    folder: Path,
    *apps: str,
    areas: str = "",
    more: str = ARM,
    happens: str = "",
    policy: str = "prima",
    scenario: str = "",
    **others: str,
) -> api.Transcript:
    (folder / "world.xml").write_text(WORLD.format(areas=areas))
    scenario = scenario or ('entrances="open"' if areas else "")
    (folder / "robot.xml").write_text(ROBOT.format(more=more))
    named = {f"app{index}": text for index, text in enumerate(apps)}
    for name, text in {**named, **others}.items():
        (folder / f"{name}.xml").write_text(text)
    sources = "".join(f'<application src="{name}.xml"/>' for name in named)
    (folder / "scenario.xml").write_text(
        '<scenario xmlns="urn:prima:scenario:1" version="1.0" id="s" world="world.xml"'
        f' robot="robot.xml" {scenario}><robot at="door"/><person x="1" y="1"/>{sources}{happens}'
        "</scenario>"
    )
    return api.rehearse(folder / "scenario.xml", policy)


def whats(transcript: api.Transcript) -> list[str]:
    return [row.what for row in transcript.rows()]


# Entrances --------------------------------------------------------------------------


def test_the_robot_loads_what_an_area_offers_and_unloads_it_on_leaving(tmp_path: Path) -> None:
    transcript = play(
        tmp_path,
        WANDERER,
        areas=SHOP,
        happens='<when at="8s"><event name="out"/></when>',
        shop=KEEPER,
    )
    assert whats(transcript) == [
        "starts fa",
        "enters the shop",
        "starts shop",
        '"Welcome to the shop."',
        '"Look around."',
        "out",
        "Topological Move (to street)",
        "leaves the shop",
        "ends shop: unloaded",
        "reaches street",
        "Topological Move (to door)",
        "enters the shop",
        "starts shop",
        '"Welcome to the shop."',
        '"Look around."',
        "reaches door",  # the FA's way went on beside the shop's words (F3)
    ]
    names = [r["behavior"] for r in transcript.records if r["phase"] == "request"]
    assert len(names) == len(set(names)), "no name is given out twice"


@pytest.mark.parametrize("middle", ["4", "9"], ids=["touching", "overlapping"])
def test_an_application_runs_on_from_one_of_its_areas_into_another(
    tmp_path: Path, middle: str
) -> None:
    here = f'<area id="here" title="the hall" application="shop.xml" x1="-1" y1="-2" x2="{middle}" y2="2"/>'
    on = '<area id="on" title="the wing" application="shop.xml" x1="4" y1="-2" x2="11" y2="2"/>'
    away = form('<on event="out"><topological-move to="far"/><topological-move to="street"/></on>')
    transcript = play(
        tmp_path,
        document("fa", "fa", away),
        areas=here + on,
        happens='<when at="8s"><event name="out"/></when>',
        shop=KEEPER,
    )
    crossings = [what for what in whats(transcript) if "shop" in what or "the " in what]
    assert crossings == [
        "enters the hall",
        "starts shop",
        '"Welcome to the shop."',
        "leaves the hall",
        "ends shop: unloaded",
    ]


def test_replay_of_entrances_gives_the_same_bytes(tmp_path: Path) -> None:
    happens = '<when at="8s"><event name="out"/></when>'
    transcript = play(tmp_path, WANDERER, areas=SHOP, happens=happens, shop=KEEPER)
    assert api.replay(transcript, tmp_path / "scenario.xml").dumps() == transcript.dumps()


def test_streams_of_what_is_left_end_in_order_and_the_fa_goes_on(tmp_path: Path) -> None:
    keeper = document("ea", "shop", block("<speak>One.</speak>" * 40))
    transcript = play(
        tmp_path,
        WANDERER,
        areas=SHOP,
        happens='<when at="1s"><event name="out"/></when>',
        shop=keeper,
        policy="fifo",
    )
    records = transcript.records
    left = next(i for i, r in enumerate(records) if r["phase"] == "unload")
    ended = next(
        i for i, r in enumerate(records) if r["phase"] == "stream-end" and r["app"] == "shop"
    )
    assert ended > left
    assert "reaches street" in whats(transcript)
    speaking = [r for r in records[left:ended] if r["phase"] == "end" and r["app"] == "shop"]
    assert len(speaking) <= 1, "what runs finishes, and nothing else starts"


@pytest.mark.parametrize(
    ("scenario", "beside"),
    [('entrances="closed"', ()), ('entrances="open"', ("shop",))],
    ids=["closed", "named"],
)
def test_a_scenario_may_say_itself_what_runs(
    tmp_path: Path, scenario: str, beside: tuple[str, ...]
) -> None:
    (tmp_path / "shop.xml").write_text(KEEPER)
    happens = "".join(f'<application src="{name}.xml" start="2s"/>' for name in beside)
    transcript = play(tmp_path, WANDERER, areas=SHOP, scenario=scenario, happens=happens)
    assert "enters the shop" not in whats(transcript)
    assert ("starts shop" in whats(transcript)) == bool(beside)


def test_an_area_whose_application_is_not_there_is_told_at_its_place(tmp_path: Path) -> None:
    with pytest.raises(DocumentError) as caught:
        play(tmp_path, WANDERER, areas=SHOP)
    [problem] = [one for one in caught.value.problems if one.severity == "error"]
    assert problem.code == "no-such-file"
    assert problem.place.file.endswith("world.xml")


# X2 and X5 in the simulated world --------------------------------------------------------


def test_x2_a_user_who_touches_is_answered_at_once_and_hears_the_rest_again(
    tmp_path: Path,
) -> None:
    story = "This is a rather long story about a robot."
    teller = document(
        "ea",
        "ea",
        block(
            f'<speak restartable="true">{story}<on event="interrupted">'
            '<log><value expr="event.data.heard"/>/<value expr="event.data.done"/></log></on></speak>'
        ),
    )
    listener = document("fa", "fa", form('<on event="touch"><speak>Yes.</speak></on>'))
    transcript = play(
        tmp_path,
        listener,
        teller,
        happens='<when at="1s"><touch sensor="head"/></when>',
        policy="prima+x2",
    )
    said = [row.what for row in transcript.rows() if row.time >= 1 and row.actor == "R"]
    assert said == [
        f'breaks off "{story}"',
        '"Yes."',
        "log: This is a/0.376",
        f'resumes "{story}"',
    ]
    yes = next(row for row in transcript.rows() if row.what == '"Yes."')
    assert yes.time == 1.0
    assert api.replay(transcript, tmp_path / "scenario.xml").dumps() == transcript.dumps()


MOVER = document("ea", "ea", block('<topological-move to="far"/><exit/>'))
DANCER = document("fa", "fa", form('<on event="tune"><command type="dance"/></on>'))


@pytest.mark.parametrize("stray", [0.2, 0.3, 1.0])
def test_x5_a_dance_on_the_way_strays_no_further_than_its_bound(
    tmp_path: Path, stray: float
) -> None:
    happens = '<when at="3s"><event name="tune"/></when>'
    more = ARM + DANCE.format(stray=stray)
    apart = play(tmp_path, DANCER, MOVER, more=more, happens=happens)
    together = play(tmp_path, DANCER, MOVER, more=more, happens=happens, policy="prima+x5")
    [dance] = [r for r in together.records if r["phase"] == "end" and r.get("command") == "dance"]
    assert 0 < dance["data"]["strayed"] <= stray
    assert "resumes Topological Move (to far)" in whats(apart)
    assert "resumes Topological Move (to far)" not in whats(together)
    arrives = [
        next(row.time for row in run.rows() if row.what == "reaches far")
        for run in (apart, together)
    ]
    assert arrives[1] < arrives[0]


@pytest.mark.parametrize("stray", [0.3, 0.6])
@pytest.mark.parametrize(
    "steps",
    [
        '<step for="1s" turn-speed="180"/><step for="1500ms" speed="2"/>',
        '<step for="3s" speed="-2"/>',
        '<step for="250ms" speed="-2" turn-speed="-180"/>'
        '<step for="200ms" speed="2" turn-speed="-90"/>',
    ],
)
def test_x5_a_fast_dance_strays_no_further_either(tmp_path: Path, steps: str, stray: float) -> None:
    """Turned aside, or driven backwards, the robot goes on for a while once the dance stops."""
    more = ARM + re.sub("<step.*/>", steps, DANCE.format(stray=stray), flags=re.DOTALL)
    happens = '<when at="3s"><event name="tune"/></when>'
    run = play(tmp_path, DANCER, MOVER, more=more, happens=happens, policy="prima+x5")
    [dance] = [r for r in run.records if r["phase"] == "end" and r.get("command") == "dance"]
    assert 0 < dance["data"]["strayed"] <= stray


def test_a_dance_alone_moves_the_body_as_its_steps_say(tmp_path: Path) -> None:
    steps = '<step for="1s" speed="0.3"/><step for="1s"/><step for="1s" turn-speed="30"/>'
    adds = f'<adds command="dance" devices="locomotion" duration="6s">{steps}</adds>'
    said = '<watch name="moves" when="sensor.moving"/>' + form(
        '<block><command type="dance"/><exit/></block><on event="moves"><log>moves</log></on>'
    )
    made = play(tmp_path, document("fa", "fa", said), more=ARM + adds)
    [dance] = [one for one in made.records if one["phase"] == "end"]
    there = {name: dance["data"][name] for name in ("x", "y", "heading")}
    assert there == pytest.approx({"x": 0.56, "y": 0.15, "heading": 60.0}, abs=0.01)
    logs = [one for one in made.records if one["phase"] == "log"]
    assert len(logs) == 3, "it stands still twice"


# X6 in the simulated world ----------------------------------------------------------------


POINTER = document(
    "ea",
    "ea",
    block('<point-by-hand toward="far"/><speak>Over there.</speak><exit/>')
    + '<on event="error.unsupported"><speak>I cannot point.</speak><exit/></on>',
)


def test_x6_the_same_ea_runs_on_robots_that_differ(tmp_path: Path) -> None:
    def said(more: str, policy: str) -> list[str]:
        return whats(play(tmp_path, POINTER, more=more, policy=policy))[1:-1]

    assert said(ARM, "prima") == ["Point by Hand (toward far)", '"Over there."']
    assert said(LASER, "prima+x6") == ["Point by Laser (toward far)", '"Over there."']
    assert '"I cannot point."' in said(LASER, "prima")


@pytest.mark.parametrize("more", [ARM, LASER])
def test_x6_events_name_the_command_that_the_document_asks_for(more: str, tmp_path: Path) -> None:
    inside = '<on event="end.point-by-hand"><speak>There it is.</speak></on>'
    content = f'<point-by-hand toward="far">{inside}</point-by-hand>'
    wave = '<on event="wave"><point-by-hand toward="street" order="now"/></on>'
    outside = '<on event="cancel.point-by-hand"><speak>Not there.</speak></on>'
    happens = '<when at="100ms"><event name="wave"/></when>'

    def said(*apps: str, happens: str = "") -> list[str]:
        made = play(tmp_path, *apps, more=more, happens=happens, policy="prima+x6")
        return [what for what in whats(made) if what.startswith('"')]

    assert said(document("ea", "ea", block(content))) == ['"There it is."']
    moved = document("fa", "fa", block(content) + wave + outside)
    assert said(moved, happens=happens) == ['"Not there."']


@pytest.mark.parametrize(
    ("more", "does"),
    [
        ('<adds command="sway" devices="arm" duration="300s"/>', '<command type="sway"/>'),
        ('<gesture name="bow" duration="300s"/>', '<gesture name="bow"/>'),
    ],
)
def test_what_takes_long_by_the_profile_is_not_given_up(
    tmp_path: Path, more: str, does: str
) -> None:
    made = play(tmp_path, document("ea", "ea", block(does + "<exit/>")), more=ARM + more)
    assert whats(made)[-1] == "ends ea: exit"
    assert made.records[-1]["time"] == 300


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (ARM + LASER, "The robot can do point-by-hand itself."),
        (
            '<device name="laser"/><adds command="ray" devices="laser"/>'
            '<substitute command="point-by-hand" by="ray"/>',
            'ray has no argument "angle"',
        ),
        (
            LASER.replace("<argument", '<argument name="for" required="true"/><argument', 1),
            'point-by-laser needs "for", which point-by-hand does not have.',
        ),
        ('<adds command="sway" devices="speaker" stray="9"/>', 'stray "9" is out of range'),
        ('<substitute command="point-by-hand" by="nothing"/>', 'no Command "nothing"'),
        ('<adds command="sway" devices="speaker"><step for="1s"/></adds>', "locomotion"),
    ],
)
def test_a_profile_that_makes_no_sense_is_told(tmp_path: Path, more: str, message: str) -> None:
    with pytest.raises(DocumentError, match=message):
        play(tmp_path, POINTER, more=more)
