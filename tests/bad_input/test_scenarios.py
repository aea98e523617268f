"""Scenarios, worlds and robots that are wrong, or odd."""

from __future__ import annotations

from pathlib import Path

import pytest

from prima.devices import loop
from tests.helpers.bad_input import (
    CATCH,
    GOOD,
    PLAY,
    Prima,
    app,
    block,
    form,
    process,
    robot,
    scenario,
    stage,
    world,
    write,
)

FOREIGN = ' xmlns:x="urn:x"'
SCENARIOS = [
    ("no-world", scenario(PLAY, world="no.xml"), "s.xml:1:68", '"no.xml" cannot be read: No such'),
    ("directory", scenario(PLAY, world="."), "s.xml:1:68", "cannot be read"),
    ("itself-as-world", scenario(PLAY, world="s.xml"), "s.xml:1:", "This is a scenario; a world is needed here"),
    ("itself-as-app", scenario('<application src="s.xml"/>'), "s.xml:2:", "This is a scenario; an application"),
    ("url", scenario('<application src="http://127.0.0.1:9/x"/>'), "s.xml:2:19", "cannot be read"),
    ("device", scenario('<application src="/dev/zero"/>'), "", "/dev/zero"),
    ("long-path", scenario(f'<application src="{"x" * 999}"/>'), "s.xml:2:19", "cannot be read"),
    ("no-application", scenario(""), "s.xml:1:1", "runs no <application>"),
    ("two-ids", scenario(PLAY + PLAY), "s.xml:2:29", "have the id"),
    ("place", scenario(f'<robot at="entrnce"/>{PLAY}'), "s.xml:2:12", 'Did you mean "entrance"?'),
    ("sensor", scenario(PLAY + '<when at="1s"><touch sensor="hed"/></when>'), "s.xml:2:58", '"head"?'),
    ("thing", scenario(PLAY + '<when at="1s"><look at="postr"/></when>'), "s.xml:2:53", '"poster"?'),
    ("broken", scenario(PLAY + '<when at="1s"><fail device="am"/></when>'), "s.xml:2:57", '"arm"?'),
    ("unload", scenario(PLAY + '<when at="1s"><unload application="b"/></when>'), "s.xml:2:64", "no application"),
    ("command", scenario(PLAY + '<when doing="speek"><stay/></when>'), "s.xml:2:42", '"speak"?'),
    ("no-trigger", scenario(PLAY + "<when><stay/></when>"), "s.xml:2:29", "exactly one of"),
    ("two-triggers", scenario(PLAY + '<when at="1s" said="x"/>'), "s.xml:2:49", "exactly one of"),
    ("negative", scenario(PLAY + '<when at="-1s"/>'), "s.xml:2:39", "with its unit"),
    ("walk", scenario(PLAY + '<when at="1s"><walk/></when>'), "s.xml:2:43", "a place to go to"),
    ("policy", scenario(PLAY, 'policy="fixd"'), "s.xml:1:", 'Did you mean "fixed"?'),
    ("walk-half", scenario(PLAY + '<when at="1s"><walk x="1"/></when>'), "s.xml:2:43", "or x and y"),
    ("walk-twice", scenario(PLAY + '<when at="1s"><walk to="lab" x="1" y="1"/></when>'), "s.xml:2:61", "Keep one"),
    ("person-half", scenario(PLAY + '<person x="1"/>'), "s.xml:2:29", "or x and y"),
    ("person-twice", scenario(PLAY + '<person at="lab" x="1" y="1"/>'), "s.xml:2:49", "Keep one"),
    ("two-robots", scenario('<robot at="lab"/>' * 2 + PLAY), "s.xml:2:18", "a second <robot>"),
    ("infinite", scenario(PLAY + '<person x="1e999" y="0"/>'), "s.xml:2:40", "is not a number"),
    ("service", scenario(PLAY + '<service name="a"><replay/></service>'), "s.xml:2:47", "reply"),
    ("status", scenario(PLAY + '<service name="a"><failure status="-1"/></service>'), "s.xml:2:64", "from 100 to 599"),
    ("foreign", scenario(f"{PLAY}<x:person{FOREIGN} x='1'/>"), "s.xml:2:29", "another namespace"),
    ("foreign-answer", scenario(f"{PLAY}<x:answer{FOREIGN} to='x'>Yes.</x:answer>"), "s.xml:2:29", "another namespace"),
    ("no-such-favourite", scenario(PLAY, 'policy="fixed:zz"'), "s.xml:1:", "Write a."),
    ("policy-with-favourite", scenario(PLAY, 'policy="fixd"'), "s.xml:1:", "fixed:APP"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "place", "message"), SCENARIOS)
def test_scenarios(
    prima: Prima, tmp_path: Path, name: str, text: str, place: str, message: str
) -> None:
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "s.xml", text)
    prima("run", "s.xml").check(1, place, message)


WORLDS = [
    ("range", world('<place id="a" x="5000" y="0"/>'), "w.xml:2:18", "out of range"),
    ("infinite", world('<place id="a" x="1e999" y="0"/>'), "w.xml:2:18", "is not a number"),
    ("twice", world('<place id="a" x="0" y="0"/><thing id="a" x="0" y="0"/>'), "w.xml:2:39", "twice"),
    ("way", world('<place id="lab" x="0" y="0"/><way from="lab" to="lob"/>'), "w.xml:2:50", 'mean "lab"?'),
    ("foreign", world(f'<x:place{FOREIGN} id="a"/>'), "w.xml:2:1", "another namespace"),
    ("wall", world('<wall x1="1e308" y1="0" x2="0" y2="1"/>'), "w.xml:2:11", "out of range"),
]  # fmt: skip
ROBOTS = [
    ("radius", robot("", 'radius="-1"'), "w.xml:1:63", "out of range"),
    ("speed", robot("", 'speed="0"'), "w.xml:1:62", "out of range"),
    ("twice", robot('<adds command="speak" devices="arm"/>'), "w.xml:2:16", "already"),
    ("device-twice", robot('<device name="arm"/>'), "w.xml:2:15", '"arm" is there twice. Keep one.'),
    ("gesture-twice", robot('<gesture name="g"/>' * 2), "w.xml:2:35", '"g" is there twice'),
    ("voice-twice", robot('<voice lang="en" rate="9"/><voice lang="EN" rate="8"/>'), "w.xml:2:41", '"en" is there twice'),
    ("argument-twice", robot('<adds command="a" devices="arm"><argument name="n"/><argument name="n"/></adds>'), "w.xml:2:69", '"n" is there twice'),
    ("cameras", robot("<camera/><camera/>"), "w.xml:2:10", "a second <camera>"),
    ("allows", robot('<allows command="speek" argument="v"/>'), "w.xml:2:18", 'mean "speak"?'),
    ("foreign", robot(f"<x:camera{FOREIGN} angle='1'/>"), "w.xml:2:1", "another namespace"),
    ("adds-device", robot('<adds command="dance" devices="leg"/>'), "w.xml:2:32", "leg"),
    ("bounds", robot('<adds command="a" devices="arm"><argument name="n" kind="number" low="5" high="1"/></adds>'), "w.xml:2:", "low"),
    ("bounds-of-text", robot('<adds command="a" devices="arm"><argument name="n" high="1"/></adds>'), "w.xml:2:58", "high limits numbers"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "place", "message"), WORLDS + ROBOTS)
def test_worlds_and_robots(
    prima: Prima, tmp_path: Path, name: str, text: str, place: str, message: str
) -> None:
    write(tmp_path, "w.xml", text)
    prima("validate", "w.xml").check(1, place, message)


def test_a_run_of_no_time(prima: Prima, tmp_path: Path) -> None:
    path = stage(tmp_path, GOOD, attributes='until="0s"')
    assert "alive" not in prima("run", path).check(0).out


@pytest.mark.parametrize("levels", ["." * 300_000 + "/", "a.." * 100_000 + "/"])
def test_a_range_without_an_end(tmp_path: Path, levels: str) -> None:
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "s.xml", scenario(PLAY + '<when at="1s"><say>x</say></when>'))
    write(tmp_path, "study.toml", f'scenarios = ["s.xml"]\n[vary]\n"when.at" = "{levels}"\n')
    process(tmp_path, "sweep", "study.toml", seconds=10).check(2, "when.at", "with its unit")


def test_a_world_of_nothing(prima: Prima, tmp_path: Path) -> None:
    write(tmp_path, "app.xml", GOOD)
    write(tmp_path, "w.xml", world('<wall x1="0" y1="0" x2="0" y2="0"/>'))
    write(tmp_path, "s.xml", scenario(PLAY, world="w.xml"))
    prima("run", "s.xml").check(0, "log: alive")
    prima("validate", "w.xml").check(0, "w.xml:2:25: warning: The wall has no length")


LACKING = block("<speak>x</speak>")


@pytest.mark.parametrize(
    ("body", "code", "message"),
    [
        (LACKING, 3, "a: error.unsupported.speak: app.xml:2"),
        (LACKING + CATCH.join(['<form id="g">', "</form>"]), 3, "error.unsupported.speak"),
        (form(f"<block><speak>x</speak></block>{CATCH}"), 0, "caught"),
    ],
)
def test_a_robot_without_devices(
    prima: Prima, tmp_path: Path, body: str, code: int, message: str
) -> None:
    write(tmp_path, "app.xml", app(body))
    write(tmp_path, "r.xml", '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"/>')
    write(tmp_path, "s.xml", scenario(PLAY, robot="r.xml"))
    said = prima("run", "s.xml").check(code, message)
    assert "app.xml:2:21: warning: This robot cannot do speak" in said.err


DANCE = '<adds command="dance" devices="arm">{}</adds><allows command="speak" argument="voice"/>'
NUMBER = '<argument name="n" kind="number" low="5"/>'


@pytest.mark.parametrize(
    ("body", "arguments", "code", "message"),
    [
        ('<command type="danse"/>', "", 1, 'app.xml:2:21: error: This robot has no Command "danse". Did you mean "dance"?'),
        ('<speak>x<param name="voic" value="1"/></speak>', "", 1, 'Did you mean "voice"?'),
        ('<topological-move to="moon"/>', "", 3, 'a: error.device.localization: app.xml:2:21: there is no way to "moon"'),
        ('<gesture name="jump"/>', "", 3, 'the robot knows no gesture "jump"'),
        ('<point-by-hand toward="moon"/>', "", 3, 'error.device.arm: app.xml:2:21: there is no place "moon"'),
        ('<turn angle="4"><param name="angle" value="9"/></turn>', "", 1, 'turn has no additional argument "angle". Write it as the attribute angle of <turn>.'),
        ('<turn angle-expr="0/0"/>', "", 3, "error.semantic: app.xml:2:21: angle"),
        ('<turn angle-expr="1/0"/>', "", 3, "error.semantic: app.xml:2:21: angle"),
        ('<turn angle-expr="[]"/>', "", 3, "is not a number"),
        ('<send event="x" delay-expr="0/0"/>', "", 3, "is not a time"),
        ('<send event="x" delay-expr="-1"/>', "", 3, "is not a time"),
        ('<goto next-expr="1/0"/>', "", 3, "error.badfetch: app.xml:2:21: there is no form"),
        ('<set-speed-and-time time-expr="1e300"/>', "", 3, "error.semantic: app.xml:2:21: time"),
        ('<set-direction toward-expr="1/0"/>', "", 3, "error.semantic: app.xml:2:21: toward"),
        ('<set-direction toward-expr="0/0"/>', "", 3, "error.semantic: app.xml:2:21: toward"),
        ('<command type="dance"><param name="n" expr="1"/></command>', NUMBER, 3, "out of range"),
    ],
)  # fmt: skip
def test_commands_and_arguments(
    prima: Prima, tmp_path: Path, body: str, arguments: str, code: int, message: str
) -> None:
    write(tmp_path, "app.xml", app(block(body)))
    write(tmp_path, "r.xml", robot(DANCE.format(arguments)))
    write(tmp_path, "s.xml", scenario(PLAY, robot="r.xml"))
    prima("run", "s.xml").check(code, message)


def test_an_application_with_a_dot_in_its_name(prima: Prima, tmp_path: Path) -> None:
    document = app(block("<speak>x</speak><log>alive</log><exit/>"), name="my.app")
    prima("run", stage(tmp_path, document)).check(1, "app.xml:1:65: error", "has a dot")


def test_nobody_answers_all_day(
    prima: Prima, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loop, "MAX_RECORDS", 5_000)
    body = form('<field name="q" type="text"><prompt timeout="0s"/></field>')
    path = stage(tmp_path, app(body), attributes='until="86400s"')
    prima("run", path, "-o", "t").check(
        3, "more records, or more text, than a run may. Let what", "wait longer each time"
    )
    prima("show", "t").check(0)
