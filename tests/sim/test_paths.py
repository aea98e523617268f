"""Values of a scenario by their paths."""

from __future__ import annotations

import pytest

from prima.devices.vocabulary.robot import ROBOT
from prima.errors import UsageError
from prima.markup.edits import edited
from prima.markup.reader import read_tree
from prima.markup.tree import Node
from prima.sim.paths import find
from prima.sim.scenario import look_at_scenario

TEXT = """<scenario xmlns="urn:prima:scenario:1" version="1.0" id="visit" until="30s"
  world="room.xml" robot="papero.xml">
  <robot at="middle"/>
  <person x="1" y="0"/>
  <application src="pet.xml" kind="fa"/>
  <application src="guide.xml"/>
  <answer id="reply" to="on?" after="1s">Yes.</answer>
  <answer to="off?">No.</answer>
  <when id="touch" at="1s"><touch sensor="head"/></when>
  <when said="Hello" after="2s"><wait for="1s"/><wait for="3s"/></when>
  <service name="mail"><reply/></service>
  <service name="post"/>
</scenario>
"""

ROBOT_TEXT = """<robot xmlns="urn:prima:robot:1" version="1.0" id="papero">
  <device name="speaker"/>
  <voice lang="en" rate="14"/>
  <voice lang="ja" rate="8"/>
  <gesture name="nod" duration="800ms"/>
  <gesture name="wave"/>
  <adds command="dance" devices="locomotion" duration="4s"/>
</robot>
"""


def root() -> Node:
    return look_at_scenario("visit.xml", TEXT.encode())[0].node


def robot() -> Node:
    return read_tree("papero.xml", ROBOT_TEXT.encode(), ROBOT)[0]


@pytest.mark.parametrize(
    ("path", "written", "kind", "loads"),
    [
        ("until", "30s", "duration", False),
        ("world", "room.xml", "path", True),
        ("person.x", "1", "number", False),
        ("person.speed", "1", "number", False),
        ("robot", "papero.xml", "path", True),
        ("robot.at", "middle", "id", False),
        ("reply", "Yes.", "text", False),
        ("reply.after", "1s", "duration", False),
        ("answer[2]", "No.", "text", False),
        ("answer[2].to", "off?", "text", False),
        ("touch", "1s", "duration", False),
        ("touch.at", "1s", "duration", False),
        ("touch.touch.sensor", "head", "id", False),
        ("when[2]", "2s", "duration", False),
        ("when[2].wait[2].for", "3s", "duration", False),
        ("application[2].src", "guide.xml", "path", True),
        ("application[1]", "pet.xml", "path", True),
        ("service[mail].reply", "0s", "duration", False),
    ],
)
def test_what_a_path_means(path: str, written: str, kind: str, loads: bool) -> None:
    target = find(root(), path, robot)
    assert (target.written, target.kind, target.loads) == (written, kind, loads)
    value = "9" if kind == "number" else "9s" if kind == "duration" else "nine"
    again = edited(TEXT, [target.edit(value)])
    assert find(look_at_scenario("visit.xml", again)[0].node, path, robot).written == value


@pytest.mark.parametrize(
    ("path", "written", "kind"),
    [
        ("robot.speed", "0.5", "number"),
        ("robot.loop", "500ms", "duration"),
        ("robot.gesture[nod]", "800ms", "duration"),
        ("robot.gesture[2].duration", "1s", "duration"),
        ("robot.voice[ja].rate", "8", "number"),
        ("robot.voice[en]", "14", "number"),
        ("robot.adds", "4s", "duration"),
    ],
)
def test_a_path_that_leads_on_in_the_robots_document(path: str, written: str, kind: str) -> None:
    target = find(root(), path, robot)
    assert (target.written, target.kind, target.of_robot, target.loads) == (
        *(written, kind),
        *(True, False),
    )
    again = edited(ROBOT_TEXT, [target.edit("9")])
    changed = read_tree("papero.xml", again, ROBOT)[0]
    assert find(root(), path, lambda: changed).written == "9"


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("robot.sped", r'"robot.sped" is not a value of papero.xml. Did you mean "speed"\?'),
        ("robot.gesture", r"There are 2 <gesture>: write gesture\[1\] to gesture\[2\]"),
        ("robot.gesture[bow]", r'No <gesture> has the name "bow"\. Write \w+ or \w+\.$'),
        ("robot.device", "<device> has no value of its own: write robot.device.name."),
        ("robot.device.name", "neither a number nor a time. Vary the robot's document: --vary"),
        ("robot.id", "neither a number nor a time"),
    ],
)
def test_a_path_that_leads_nowhere_in_the_robots_document(path: str, why: str) -> None:
    with pytest.raises(UsageError, match=why):
        find(root(), path, robot)


def test_an_element_called_robot_comes_before_the_robots_document() -> None:
    text = TEXT.replace('id="touch"', 'id="robot"').encode()
    assert not find(look_at_scenario("visit.xml", text)[0].node, "robot.after", robot).of_robot


@pytest.mark.parametrize(
    ("path", "why"),
    [
        ("toch", 'Did you mean "touch"?'),
        ("nix", r"There are answer, application, .*, service and \d more\.$"),
        ("person.sped", 'Did you mean "speed"?'),
        ("when.after", r"There are 2 <when>: write when\[1\] to when\[2\], or an id."),
        ("when[3].after", "There are 2 <when>."),
        ("when[0]", "There are 2 <when>."),
        ("when[99999999999999999999]", "There are 2 <when>."),
        ("service[nail].reply", 'No <service> has the name "nail". Did you mean "mail"?'),
        ("service[bank].reply", 'No <service> has the name "bank". Write mail or post.'),
        ("service[post]", "<service> has no value of its own: write .*name or"),
        ("a..b", r"Write it as when\[2\].after or person.speed."),
        ("", "Write it as"),
        ("when[2", "Write it as"),
        ("touch.touch.sensor.x", 'Did you mean "sensor"?'),
    ],
)
def test_a_path_that_leads_nowhere(path: str, why: str) -> None:
    with pytest.raises(UsageError, match=why):
        find(root(), path, robot)


def test_a_text_beside_alternatives_is_no_value() -> None:
    text = TEXT.replace("Yes.", 'Yes.<alternative confidence="0.3">Yet.</alternative>').encode()
    scenario = look_at_scenario("visit.xml", text)[0].node
    with pytest.raises(UsageError, match=r"vary reply.alternative\.$"):
        find(scenario, "reply", robot)
    assert find(scenario, "reply.alternative", robot).written == "Yet."


def test_an_id_comes_before_an_attribute_or_element_of_that_name() -> None:
    text = TEXT.replace('id="touch"', 'id="until"').encode()
    assert find(look_at_scenario("visit.xml", text)[0].node, "until", robot).written == "1s"


def test_two_elements_of_one_id() -> None:
    problems = look_at_scenario("visit.xml", TEXT.replace('"touch" at', '"reply" at').encode())[1]
    assert [(one.place.line, one.code) for one in problems if one.severity == "error"] == [
        (9, "duplicate-id")
    ]
