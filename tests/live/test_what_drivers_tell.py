"""What drivers tell: a journal stays readable, and a run its own, whatever a driver says."""

from __future__ import annotations

import json
from fractions import Fraction
from math import inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from prima.devices.conductor import Conductor
from prima.devices.goals import At, Back, Broke, Done, Lost, Sees, Speaks, Stopped
from prima.errors import brief
from prima.live.speaking import UserSpeech
from prima.live.wellformed import WRONG, well_formed
from prima.messages import Emergency, Heard, Narrated, Occurred, Sensed
from tests.helpers import command
from tests.helpers.here import prima
from tests.helpers.rehearsing import PROFILE

CYCLE: list[Any] = []
CYCLE.append(CYCLE)


@pytest.mark.parametrize(
    ("told", "held"),
    [
        (Sensed({"battery": nan, "near": [inf, 2]}), Sensed({"battery": None, "near": [None, 2]})),
        (Sensed({"a": (True, Fraction(1, 2), None)}), Sensed({"a": [True, 0.5, None]})),
        (Sensed({"a": {"b": (nan, {"c": 1})}}), Sensed({"a": {"b": [None, {"c": 1}]}})),
        (Sees(True, inf, nan), Sees(True, None, None)),
        (Sees(True, 1.5, -20), Sees(True, 1.5, -20.0)),
        (At(1.0, nan, 0.0), None),
        (At(1.0, 2.0, 3.0), At(1.0, 2.0, 3.0)),
        (At(Fraction(1, 2), np.float32(2), 3), At(0.5, 2.0, 3.0)),  # type: ignore[arg-type]
        (Sensed({"up": np.True_, "at": np.int8(3)}), Sensed({"up": True, "at": 3})),
        (Occurred("touch.head", "user", {"x": -inf}), Occurred("touch.head", "user", {"x": None})),
        (Done("a#1", {"x": nan}), Done("a#1", {"x": None})),
        (Heard("Yes.", {"confidence": 0.5}, 300), Heard("Yes.", {"confidence": 0.5}, 300)),
        (Broke("a#1", "neck", "hot"), Broke("a#1", "neck", "hot")),
        (Broke("a#1", "neck", "x" * 9_000_000), Broke("a#1", "neck", brief("x" * 5_000, 4_000))),
        (Stopped("a#1", 0.5), Stopped("a#1", 0.5)),
        (Stopped("a#1", nan, 3), Stopped("a#1", None, 3)),
        (Stopped("a#1", None, np.int64(3)), Stopped("a#1", None, 3)),  # type: ignore[arg-type]
        (Lost(frozenset({"neck"}), "gone"), Lost(frozenset({"neck"}), "gone")),
        (Emergency(True), Emergency(True)),
        (Emergency(1), Emergency(True)),  # type: ignore[arg-type]
        (Emergency(np.False_, 1), Emergency(False, True)),  # type: ignore[arg-type]
        (Speaks(np.True_), Speaks(True)),  # type: ignore[arg-type]
        (Sees(np.False_), Sees(False)),  # type: ignore[arg-type]
    ],
)
def test_what_a_driver_tells_is_taken_in_a_form_that_records_can_hold(told: Any, held: Any) -> None:
    taken = well_formed(told)
    assert taken == held and repr(taken) == repr(held)


@pytest.mark.parametrize(
    "told",
    [
        Sensed({"battery": object()}),
        Sensed({"list": CYCLE}),
        Sensed({3: 4}),  # type: ignore[dict-item]
        Sensed([1]),  # type: ignore[arg-type]
        Heard(5),  # type: ignore[arg-type]
        Heard("half a letter: \ud800"),
        Heard("Yes.", None),  # type: ignore[arg-type]
        Occurred("touch.head", "robo"),  # type: ignore[arg-type]
        Occurred("touch.head", "mediator"),
        Heard("Yes.", {}, inf),  # type: ignore[arg-type]
        Sensed({"huge": 10**400}),
        Sensed({"image": np.zeros(2)}),
        Lost(frozenset({"speaker"}), ValueError("gone")),  # type: ignore[arg-type]
        Lost(["speaker"], "gone"),  # type: ignore[arg-type]
        Back(frozenset({5})),  # type: ignore[arg-type]
        Done(["a#1"]),  # type: ignore[arg-type]
        Stopped("a#1", None, "half"),  # type: ignore[arg-type]
        Stopped("a#1", None, nan),  # type: ignore[arg-type]
        Occurred("touch.head", "user", {}, 5),  # type: ignore[arg-type]
        Narrated("user", None),  # type: ignore[arg-type]
        Narrated("robot", "It waits."),  # type: ignore[arg-type]
        Done("a#1", 5),  # type: ignore[arg-type]
        Broke("a#1", "neck", None),  # type: ignore[arg-type]
        Heard("Yes.", {"lasted": 1.5}),
        Heard("x" * 2_000_000),
        Occurred("speech", "user"),
        Occurred("emergency.stop", "environment"),
        Occurred("emergency.release", "user"),
        Occurred("touch.head", "user", {"image": [255] * 500_000}),
        Emergency("no"),  # type: ignore[arg-type]
        Emergency(None),  # type: ignore[arg-type]
        Speaks("begins"),  # type: ignore[arg-type]
        Sees("no"),  # type: ignore[arg-type]
        "touch.head",
        None,
    ],
)
def test_what_no_record_can_hold_is_refused(told: Any) -> None:
    with pytest.raises(WRONG):
        well_formed(told)


DRIVER = """
import sys
from prima.live.driver import TaskDriver
from prima.messages import Heard, Occurred, Sensed

class Odd(TaskDriver):
    kind = "odd"
    async def perform(self, goal):
        {}
        return {{}}
"""
ROBOT = """<robot xmlns="urn:prima:robot:1" version="1.0" id="odd">
  <driver kind="odd"/>
  <device name="speaker"/>
</robot>"""


def live(folder: Path, what: str, *more: str) -> tuple[int, str, list[dict[str, Any]]]:
    """A run whose driver does something odd for its one Command, and then a replay of it."""
    (folder / "odd.py").write_text(DRIVER.format(what))
    (folder / "robot.xml").write_text(ROBOT)
    (folder / "hi.xml").write_text(
        '<prima xmlns="urn:prima:dialogue:1" version="1.0" kind="ea" id="hi"><form id="a">'
        "<block><speak>Hi.</speak><exit/></block></form></prima>"
    )
    words = ["--driver", "odd.py", "--robot", "robot.xml", "--ea", "hi.xml", "--until", "8s"]
    ran = command.prima("live", *words, "-o", "m.jsonl", *more, cwd=folder)
    records = [json.loads(line) for line in (folder / "m.jsonl").read_text().splitlines()]
    if more:
        return ran.returncode, ran.stderr, records
    again = prima("replay", "m.jsonl", cwd=folder)
    assert (again.returncode, again.stderr) == (0, "the same, byte for byte\n")
    return ran.returncode, ran.stderr, records


@pytest.mark.parametrize(
    "what", ['self.tell(Sensed({"battery": float("nan")}))', 'return {"x": float("inf")}']
)
def test_the_journal_of_a_driver_that_measures_nothing_replays(what: str, tmp_path: Path) -> None:
    code, _, records = live(tmp_path, what)
    assert code == 0 and records[-1]["outcome"] == "over"


@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("return 5", "a report of the driver is wrong (Done): its data must be a dict, not int"),
        ('self.tell(Heard("\\ud800"))', "a report of the driver is wrong (Heard): 'utf-8' codec"),
        ('self.tell(Sensed({"a": object()}))', "wrong (Sensed): a record cannot hold object"),
        ('self.tell(Occurred("speech", "user"))', "report the user's words by Heard(text)"),
        (
            'self.tell(Occurred("emergency.stop"))',
            'report the emergency stop by Emergency(True), in <senses> by as="emergency"',
        ),
        ('return {"map": "x" * 2_000_000}', "wrong (Done): it has more than 1,000,000 characters"),
        ("sys.exit(4)", "SystemExit: 4"),
    ],
)
def test_a_driver_that_goes_wrong_ends_in_a_clear_sentence(
    what: str, told: str, tmp_path: Path
) -> None:
    code, said, records = live(tmp_path, what)
    assert code == 3
    assert records[-1]["outcome"] in ("over", "until")
    assert told in said + json.dumps(records), (said, records)


@pytest.mark.parametrize("more", [(), ("--redact",)])
@pytest.mark.parametrize("others", [5, None, "Bye.", ["Bye."], [{}], [{"text": 5}]])
def test_alternatives_in_another_form_end_no_run(
    others: object, more: tuple[str, ...], tmp_path: Path
) -> None:
    data = {"confidence": 0.5, "alternatives": others}
    code, said, _ = live(tmp_path, f'self.tell(Heard("Hello.", {data!r}))', *more)
    assert (code, said) == (0, "")


@pytest.mark.parametrize(("lasted", "known"), [(300, 300), (-5, 0), (10**9, 1000)])
def test_how_long_an_utterance_took_counts_where_its_beginning_was_not_told(
    lasted: int, known: int
) -> None:
    speech = UserSpeech(Conductor(PROFILE, dict))
    assert speech.heard(1000, Heard("Yes.", {}, lasted)) == [Heard("Yes.", {}, known)]
    speech.begins(2000)
    assert speech.heard(2400, Heard("Yes.", {}, lasted)) == [Heard("Yes.", {}, 400)]
