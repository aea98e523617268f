"""Robots of ROS 2: nodes in a process of their own."""

from __future__ import annotations

import time
from pathlib import Path

from tests.parties.bench import ROS_HOME, Process

HERE = Path(__file__).parent
ROBOT = HERE / "robot.xml"
APART_S = 2
"""How long after another node one may begin."""


def made_robot() -> Process:
    robot = Process("ros2", str(HERE / "robot.py"), **ROS_HOME)
    robot.expect("ready")
    return robot


def made_again() -> Process:
    """A robot in the place of one that is gone, once the driver looks for it.

    Two nodes of one machine that begin at the same moment may be given the same port: then one of
    them never hears anything.
    """
    time.sleep(APART_S)
    return made_robot()
