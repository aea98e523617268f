"""Whole runs with a robot of ROS 2, and the check before them."""

from __future__ import annotations

import re
from pathlib import Path

from tests.parties.bench import LOST_AND_BACK, ROS_HOME, Process, Visit, in_order
from tests.parties.checked import checked
from tests.parties.ros2.nodes import ROBOT, made_again


def test_two_applications_run_to_their_end(robot: Process, tmp_path: Path) -> None:
    visit = Visit("ros2", ROBOT, tmp_path / "visit.jsonl", **ROS_HOME)
    try:
        robot.expect("goes")
        robot.write("touch on")
        robot.expect("go canceled")
        robot.expect("turns")
        robot.expect("stands")
        robot.expect("goes")
        robot.expect("go over")
        rows = visit.rows()
    finally:
        visit.kill()
    parts = ("Topological Move", "touch", "Turn", "ends dodge", "resumes", "ends walk: exit")
    assert in_order(rows, *parts), rows


def test_the_robot_goes_and_comes_back_in_the_midst_of_a_run(
    robot: Process, tmp_path: Path
) -> None:
    visit = Visit("ros2", ROBOT, tmp_path / "visit.jsonl", **ROS_HOME)
    rows = visit.rows_of_lost_robot(robot, made_again, "touch on")
    assert in_order(rows, *LOST_AND_BACK), rows


def test_the_check_before_a_run_tries_to_cancel(robot: Process) -> None:
    code, lines = checked("ros2", ROBOT, **ROS_HOME)
    for what in ("topological-move", "set-position", "turn", "say", "listen", "gesture nod"):
        assert re.match(r"ok .* \d+ ms +\d+ ms$", lines[what]), lines
    assert "by /emergency" in lines["emergency stop"]
    robot.expect("go canceled")
    lacking = {what for what, line in lines.items() if line.startswith("FAILS")}
    assert code == 3
    assert "refuses the goal" in lines["gesture hop"]
    lacking.remove("gesture hop")
    assert all("no driver carries it out" in lines[what] for what in lacking), lines
    robot.write("stubborn")
    _, lines = checked("ros2", ROBOT, **ROS_HOME)
    assert lines["topological-move"].endswith("stops late: does it heed a cancel?")
