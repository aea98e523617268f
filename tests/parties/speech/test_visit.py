"""A mediated run whose user is heard by sound: Figure 5.3, with another voice for the user.

The robot's voice, the detector of speech and both recognisers are the real ones; two pipes in
memory are the sound card. What the user says is a scenario's answers.
"""

from __future__ import annotations

import signal
from pathlib import Path
from threading import Timer

from tests.parties.speech.sounding import HERE, LONGEST_S, prima

LAST = "O.K. I'll stop following you."
ROWS = [
    "Where are you going?",
    "Come on, let's go.",
    "Topological Move (to kidode-room)",
    "touches the robot's head",
    "What's the matter with you?",
    "Come on, follow me.",
    "Active Sensing Human",
    "a message from Prof. Kidode arrives",
    "I've just got a message.",
    "Do you have a reply?",
    "O.K. I'll send your message.",
    "I found you, I'll start following",
    "Tracking Human",
    "touches the robot's head",
    "May I stop following you?",
    LAST,
]
"""What is done and said, in this order."""


def test_a_user_who_is_heard_takes_the_robot_along(python: str, tmp_path: Path) -> None:
    journal = tmp_path / "visit.jsonl"
    running = prima(
        python,
        *("live", "--robot", f"{HERE}/heard.xml", "--driver", f"{HERE}/user.py"),
        *("--world", "documents/worlds/office.xml", "--fa", "documents/fa/follow.xml"),
        *("-o", str(journal)),
    )
    limit = Timer(LONGEST_S, running.kill)
    limit.start()
    shown, waited = [], list(ROWS)
    assert running.stdout is not None
    for line in running.stdout:
        shown.append(line)
        if waited and waited[0] in line:
            waited.pop(0)
        if not waited:
            break
    running.send_signal(signal.SIGINT)
    running.communicate()
    limit.cancel()
    assert not waited, "".join(shown)
    assert running.returncode == 130
    assert "the recogniser" not in "".join(shown)
    again = prima(python, "replay", str(journal))
    told, _ = again.communicate(timeout=60)
    assert again.returncode == 0
    assert told.splitlines()[1:] == [
        f"Go on with: prima live --resume {journal}",
        "the same, byte for byte",
    ]
