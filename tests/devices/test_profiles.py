"""What a robot's document says of times."""

from __future__ import annotations

import pytest

from prima.devices.profile import Motion, read_robot
from prima.errors import DocumentError

HEAD = '<robot xmlns="urn:prima:robot:1" version="1.0" id="r"><device name="arm"/>'


@pytest.mark.parametrize(("duration", "gesture"), [('"0s"', 0), ('"1ms"', 1), ('"2s"', 2000)])
def test_a_duration_is_what_is_written(duration: str, gesture: int) -> None:
    text = (
        f'{HEAD}<gesture name="nod" duration={duration}/>'
        f'<adds command="wave" devices="arm" duration={duration}/></robot>'
    )
    profile = read_robot("r.xml", text.encode())
    assert profile.gestures["nod"] == gesture
    assert profile.lasts("wave") == max(gesture, 1), "an AB takes an instant"


@pytest.mark.parametrize(
    ("inside", "name"),
    [
        ('<option name="ear" value="a"/><option name="ear" value="b"/>', "ear"),
        ('<place name="p" x="1" y="1"/><place name="p" x="2" y="1"/>', "p"),
        ('<does command="say" by="a"/><does command="say" by="b"/>', "say"),
        ('<does gesture="bow" by="a"/><does gesture="bow" by="b"/>', "bow"),
        ('<does command="say"><set name="x" value="1"/><set name="x" value="2"/></does>', "x"),
    ],
)
def test_what_a_driver_would_drop_is_told(inside: str, name: str) -> None:
    more = f'<device name="neck"/><device name="speaker"/><gesture name="bow"/><driver kind="sim">{inside}</driver>'
    with pytest.raises(DocumentError) as error:
        read_robot("r.xml", f"{HEAD}{more}</robot>".encode())
    assert [one.message for one in error.value.problems] == [f'"{name}" is there twice.']


def test_a_gesture_and_other_gestures_are_carried_out_apart() -> None:
    does = (
        '<does command="gesture" by="a"/><does gesture="bow" by="b"/><does command="say" by="a"/>'
    )
    more = f'<device name="neck"/><device name="speaker"/><gesture name="bow"/><driver kind="sim">{does}</driver>'
    (driver,) = read_robot("r.xml", f"{HEAD}{more}</robot>".encode()).drivers
    assert [getattr(driver.how("gesture", one), "by", "") for one in ("bow", "nod")] == ["b", "a"]


@pytest.mark.parametrize(
    ("inside", "told"),
    [
        (
            '<driver kind="sim" devices="arm"/><driver kind="ros2" devices="arm"/>',
            'The device "arm" is carried twice. Name it once.',
        ),
        (
            '<driver kind="sim" devices="arm arm"/>',
            'The device "arm" is carried twice. Name it once.',
        ),
        (
            '<driver kind="sim" devices="arn"/>',
            'The robot has no device "arn". Did you mean "arm"?',
        ),
        (
            '<driver kind="sim"><does by="x"/></driver>',
            '<does> needs a command or a gesture. Write command="...".',
        ),
        (
            '<adds command="hum" devices="arm"/><substitute command="turn-and-speak" by="hum"/>',
            "hum cannot say anything. Name a Command that speaks, as turn-and-speak does.",
        ),
    ],
)
def test_what_a_robot_cannot_do_is_told(inside: str, told: str) -> None:
    with pytest.raises(DocumentError) as error:
        read_robot("r.xml", f"{HEAD}\n{inside}</robot>".encode())
    assert told in [f"{one.message} {one.remedy}" for one in error.value.problems]
    assert {one.place.line for one in error.value.problems} == {2}


def test_the_steps_of_a_motion_follow_each_other_and_repeat() -> None:
    motion = Motion([(1000, 0.1, 0.0), (500, 0.0, 90.0)], 0.0)
    first, second = (0.1, 0.0), (0.0, 90.0)
    times = (0, 999, 1000, 1499, 1500, 2600)
    assert [motion.at(time) for time in times] == [first, first, second, second, first, second]


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("{agnle}", [("agnle", "angle")]),
        ("[{angle_radians}, {Angle}]", [("angle_radians", "angle-radians"), ("Angle", "angle")]),
        ("{bwo}", [("bwo", "bow")]),
        ("{own-thing} {angle} {turn-radians} {bow} {language}", []),
        ('{"angle": 1}', []),
    ],
)
def test_a_misspelt_placeholder_is_told(value: str, told: list[tuple[str, str]]) -> None:
    does = f"<does command='turn' by='a'><set name='a' value='{value}'/></does>"
    more = f"<device name='locomotion'/><allows command='turn' argument='bow'/><driver kind='naoqi'>{does}</driver>"
    warnings = read_robot("r.xml", f"{HEAD}{more}</robot>".encode()).warnings
    assert [one.message for one in warnings] == [
        f'There is no value "{{{slot}}}", so this argument lacks it.' for slot, _ in told
    ]
    assert [one.fixes[0].edits[0].text for one in warnings] == [near for _, near in told]


@pytest.mark.parametrize(
    ("device", "adds", "remedies"),
    [
        ("light", "lights", ['Name it in an <adds devices="light">', 'Did you mean "light"?']),
        ("lights", "lights,", ['Name it in an <adds devices="lights">', 'Did you mean "lights"?']),
    ],
)
def test_a_device_and_the_command_that_needs_it_are_mended_alike(
    device: str, adds: str, remedies: list[str]
) -> None:
    text = f'{HEAD}<device name="{device}"/><adds command="glow" devices="{adds}"/></robot>'
    with pytest.raises(DocumentError) as error:
        read_robot("r.xml", text.encode())
    found = sorted(one.remedy for one in error.value.problems)
    assert all(one.startswith(start) for one, start in zip(found, sorted(remedies), strict=True))


def test_what_a_robot_gives_no_name_is_told_once() -> None:
    with pytest.raises(DocumentError) as error:
        read_robot("r.xml", f"{HEAD}<device/></robot>".encode())
    assert [one.code for one in error.value.problems] == ["missing-attribute"]
