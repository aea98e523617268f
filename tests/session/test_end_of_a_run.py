"""E2: a run is over when all applications have ended, and what the robot still did as they went."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from prima.invariants import check
from prima.messages import Occurred
from tests.helpers.rehearsing import rehearse
from tests.helpers.robot import Bench

LEAVES = '<on event="touch"><exit/></on>'
TOUCHED = '<when at="1200ms"><touch sensor="head"/></when>'


def form(content: str) -> str:
    return f'<form id="f"><block>{content}</block>{LEAVES}</form>'


def test_a_session_is_over_when_what_runs_has_ended() -> None:
    bench = Bench(form("<speak>Welcome.</speak>"))
    bench.step(Occurred("touch.head", "user"))
    assert bench.phases("unload") and bench.saying() == ["Welcome."]
    assert not bench.session.over
    bench.finish("Welcome.")
    assert bench.session.over


def last(folder: Path, content: str) -> list[dict[str, Any]]:
    """The records behind the end of an application that is touched after 1.2 s."""
    made = rehearse(folder, form(content), TOUCHED)
    assert made.outcome == "over" and check(made.records) == []
    phases = [one["phase"] for one in made.records]
    return [dict(one) for one in made.records[phases.index("unload") + 1 :]]


def test_what_is_being_said_is_said_to_its_end(tmp_path: Path) -> None:
    text = "Welcome to our museum with all of its pictures."
    told = last(tmp_path, f"<speak>{text}</speak><speak>Come in.</speak>")
    (end,), over = [one for one in told if one["phase"] == "end"], told[-1]
    assert (end["phase"], end["text"], end["outcome"]) == ("end", text, "done")
    assert over["time"] == end["time"] > 2


@pytest.mark.parametrize(
    "content", ['<topological-move to="kidode-room"/>', "<tracking-human/>"], ids=["move", "track"]
)
def test_a_robot_that_drives_is_stopped(tmp_path: Path, content: str) -> None:
    told = [(one["phase"], one.get("rule")) for one in last(tmp_path, content)]
    assert told[-4:] == [("end", None), ("stream-end", "C1"), ("stop", "F5"), ("over", None)]


def test_a_question_that_listens_ends_at_once(tmp_path: Path) -> None:
    field = '<field name="q" type="boolean"><prompt>So?</prompt><filled><exit/></filled></field>'
    made = rehearse(tmp_path, f'<form id="f">{field}{LEAVES}</form>', TOUCHED)
    assert made.outcome == "over" and made.records[-1]["time"] == pytest.approx(1.2, abs=0.01)
