"""The driver ``ros2`` without ROS: its document, its messages, and what it says where rclpy lacks."""

from __future__ import annotations

import asyncio
import sys
from typing import Any, ClassVar

import pytest

from prima.devices.profile import read_robot
from prima.errors import UsageError
from prima.live.driver import Refused, Unusable
from prima.live.drivers.ros2 import DRIVER
from prima.live.drivers.ros2.messages import fill, interface, paths, plain
from prima.live.ros import RosUse, uses
from prima.sim.map import Map
from tests.live.test_mapped import ROBOT


def driver(inside: str = "", address: str = "") -> Any:
    text = ROBOT.format(inside).replace('kind="mapped"', f'kind="ros2" address="{address}"')
    robot = read_robot("robot.xml", text.encode())
    return DRIVER(robot.drivers[0], robot, Map("m"))


def test_without_rclpy_it_is_told_how_to_have_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)
    with pytest.raises(Unusable, match="source /opt/ros/DISTRIBUTION/"):
        asyncio.run(driver().open())


@pytest.mark.parametrize("address", ["robot.local", "233", "-1"])
def test_an_address_is_the_number_of_a_domain(address: str) -> None:
    with pytest.raises(UsageError, match="Write a number from 0 to 232"):
        asyncio.run(driver(address=address).open())


@pytest.mark.parametrize(
    ("written", "kind"),
    [
        ('type="nav2_msgs/action/Spin"', "action"),
        ('type="std_srvs/srv/Trigger" as="service"', "service"),
        ('type="geometry_msgs/msg/Twist"', "topic"),
    ],
)
def test_the_type_tells_the_kind(written: str, kind: str) -> None:
    made = driver(f'<does command="turn" by="/x" {written} stop="/stop"/>')
    used = uses(made.settings)
    assert [one.kind for one in used] == [kind, "service"]
    assert used[1] == RosUse("service", "/stop", "")


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ('by="/x"', "needs by and type"),
        ('type="nav2_msgs/action/Spin"', "needs by and type"),
        ('by="/x" type="Spin"', '"Spin" is not a type of interfaces'),
        ('by="/x" type="nav2_msgs/action/Spin" as="topic"', "is not a type of topics"),
    ],
)
def test_a_does_that_does_not_fit_is_told_with_its_place(written: str, told: str) -> None:
    made = driver(f'<does command="turn" {written}/>')
    with pytest.raises(UsageError, match=rf"robot.xml:4:\d+: ros2: .*{told}"):
        asyncio.run(made.open())


def test_what_is_sensed_needs_the_type_of_its_topic() -> None:
    made = driver('<senses event="touch" by="/touch"/>')
    with pytest.raises(UsageError, match=r'<senses by="/touch"> needs the type of the topic'):
        asyncio.run(made.open())


def test_it_has_no_options() -> None:
    made = driver('<option name="domain" value="1"/>')
    with pytest.raises(UsageError, match=r'there is no option "domain"\. Remove it'):
        asyncio.run(made.open())


# Messages -----------------------------------------------------------------------------------


class Message:
    """As rclpy's messages are."""

    types: ClassVar[dict[str, str]]

    def get_fields_and_field_types(self) -> dict[str, str]:
        return self.types


class Inner(Message):
    types: ClassVar = {"x": "double", "on": "boolean"}

    def __init__(self) -> None:
        self.x = 0.0
        self.on = False


class Outer(Message):
    types: ClassVar = {
        "inner": "package/Inner",
        "count": "int32",
        "name": "string",
        "many": "sequence<double>",
        "few": "double[2]",
    }

    def __init__(self) -> None:
        self.inner = Inner()
        self.count = 0
        self.name = ""
        self.many: list[float] = []
        self.few = [0.0, 0.0]


def test_values_become_what_their_fields_are() -> None:
    values = {"inner": {"x": 2, "on": True}, "count": 3.0, "name": 7, "many": [1], "few": [1, 2]}
    message = fill(Outer(), values)
    assert plain(message) == {
        "inner": {"x": 2.0, "on": True},
        "count": 3,
        "name": "7",
        "many": [1.0],
        "few": [1.0, 2.0],
    }
    assert isinstance(message.inner.x, float)
    assert isinstance(message.count, int)


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({"inner": {"y": 1}}, 'Inner has no field "y"; it has x, on'),
        ({"inners": 1}, 'Outer has no field "inners"; it has inner, count'),
        ({"many": ["a"]}, "many of Outer is sequence<double>; .* does not fit"),
    ],
)
def test_what_does_not_fit_is_refused(values: dict[str, Any], told: str) -> None:
    with pytest.raises(Refused, match=told):
        fill(Outer(), values)


def test_the_fields_of_a_document_are_known_before_the_run() -> None:
    paths(Outer(), ["inner.x", "count"])
    with pytest.raises(Refused, match='Inner has no field "z"'):
        paths(Outer(), ["inner.z"])
    with pytest.raises(Refused, match="leads into a field without fields"):
        paths(Outer(), ["count.x"])


def test_a_type_that_is_not_installed_is_told() -> None:
    with pytest.raises(Unusable, match="the type nav2_msgs/action/Spin is not there"):
        interface("nav2_msgs/action/Spin")
