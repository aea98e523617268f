"""A run that is ended by a signal, or killed and resumed, leaves no robot moving: each against its party."""

from __future__ import annotations

import signal
import socket
from pathlib import Path

import pytest

from tests.parties.bench import ROS_HOME, Process, Visit

HERE = Path(__file__).parent
PARTIES = {"naoqi": "go over", "ros2": "go canceled", "rosbridge": "go over"}
"""What robots tell when they have been stopped on their way."""


def free_port() -> str:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return str(free.getsockname()[1])


BY_SIGNAL = [(party, end) for party in PARTIES for end in (signal.SIGTERM, signal.SIGINT)]


# A bridge cancels no goals of a connection that is gone; ROS 2 takes seconds to forget a process.
@pytest.mark.parametrize(("party", "end"), [*BY_SIGNAL, ("naoqi", signal.SIGKILL)])
def test_the_robot_stops_when_the_run_ends(party: str, end: signal.Signals, tmp_path: Path) -> None:
    port, environment = free_port(), ROS_HOME if party == "ros2" else {}
    words = {"naoqi": [port], "ros2": [], "rosbridge": [port, "threads"]}[party]
    document = tmp_path / "robot.xml"
    document.write_text((HERE / party / "robot.xml").read_text().replace("PORT", port))
    robot = Process(party, str(HERE / party / "robot.py"), *words, **environment)
    robot.expect("ready")
    visit = Visit(party, document, tmp_path / "visit.jsonl", **environment)
    try:
        robot.expect("goes")
        visit.process.send_signal(end)
        code = visit.process.wait(30)
        assert code == (-9 if end is signal.SIGKILL else 130), "".join(visit.errors)
        if end is not signal.SIGKILL:
            robot.expect(PARTIES[party])
            return
        # Nobody has stopped it; to go on begins with a safe robot.
        words = ["live", "--resume", str(tmp_path / "visit.jsonl"), "--until", "60s"]
        on = Process(party, "-m", "prima", *words, **environment)
        try:
            robot.expect("goes", longest=30)
            if PARTIES[party] not in [line["what"] for line in robot.lines]:
                robot.expect(PARTIES[party])  # its thread may tell so after the other has begun
        finally:
            on.kill()
    finally:
        visit.kill()
        robot.kill()
