"""Live runs by a clock that goes on between two statements, with reports that come later."""

from __future__ import annotations

from collections import Counter
from functools import partial
from pathlib import Path

import pytest

from prima import api
from prima.devices.goals import (
    LISTEN,
    Accepted,
    Back,
    Begin,
    Done,
    Lost,
    News,
    Report,
    Speaks,
    Stopped,
)
from prima.devices.loop import Loop
from prima.devices.settings import FOREVER, DriverSettings
from prima.errors import Place
from prima.invariants import callers, check
from prima.live.devices import LiveDevices
from prima.live.driver import Driver
from prima.live.visit import FOREVER_MS
from prima.messages import Heard, Record
from prima.scheduler.policy import policy_named
from prima.sim.devices import Cast
from prima.sim.rehearsal import make_session
from prima.sim.services import Services
from tests.live.stage import Creeping, carried_out, in_ms, live_loop
from tests.live.test_differential import SCENARIOS, rehearsed


def told(records: list[Record], *phases: str) -> Counter[str]:
    """What happens how often, but for the number of loops."""
    found = (one for one in records if one["phase"] in phases)
    return Counter(
        f"{one['phase']} {one.get('behavior', '').partition('.')[0]} {one.get('outcome', '')}"
        for one in found
    )


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_what_a_rehearsal_gives_comes_a_little_later(path: Path) -> None:
    cast = api.load_scenario(path).cast
    policy, clock = cast.scenario.policy, Creeping(seed=len(path.stem))
    loop = live_loop(cast, policy, stopping="20ms")
    clock.delay(loop.devices.drivers[0])  # type: ignore[attr-defined]
    live, names = carried_out(loop, clock=clock), [doc.id for doc in cast.documents]
    assert check(in_ms(live), policy, names, calling=callers(cast.documents)) == []
    phases = ("listening", "fail", "device", "load", "unload")
    assert told(live, *phases) == told(rehearsed(path), *phases)


# A question, and what the user is heard to do -------------------------------------------------

ASKS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" id="asks" kind="ea">
  <form id="a">
    <block><speak>Welcome.</speak></block>
    <field name="sure" type="boolean">
      <prompt timeout="2s">Are you sure?</prompt>
      <noinput><log>silence</log><exit/></noinput>
      <filled><log>answer</log><exit/></filled>
    </field>
  </form>
</prima>"""
EAR = frozenset({"speech-recognition"})
SAYS_MS, STOPS_MS = 1000, 100


class Talker(Driver):
    """Says each text for a second, stops after a tenth, and reports what the test has planned."""

    def __init__(self, cast: Cast, clock: Creeping, plan: list[tuple[int, Report | News]]) -> None:
        devices, place = cast.robot.devices, Place("robot.xml")
        given = DriverSettings("talker", "", devices, 1000, 10**9, FOREVER, [], [], place)
        super().__init__(given, cast.robot, cast.world)
        self._clock = clock
        for time, news in plan:
            clock.at(time, partial(self.tell, news))

    def later(self, after: int, report: Report) -> None:
        self._clock.at(self._clock.time + after, partial(self.tell, report))

    def start(self, goal: Begin) -> None:
        self.later(1, Accepted(goal.key))
        if goal.kind != LISTEN:
            self.later(SAYS_MS, Done(goal.key))

    def cancel(self, key: str) -> None:
        self.later(STOPS_MS, Stopped(key))


@pytest.mark.parametrize(
    ("plan", "ends", "outcome"),
    [
        ([], 4000, "silence"),
        ([(2500, Speaks(True)), (2800, Speaks(False))], 4800, "silence"),
        ([(2500, Speaks(True)), (2800, Heard("yes"))], 2800, "answer"),
        ([(2500, Speaks(True)), (2600, Speaks(True)), (2800, Speaks(False))], 4800, "silence"),
        ([(1300, Speaks(True)), (1330, Speaks(False))], 3400, "silence"),
        ([(1300, Speaks(True)), (1600, Speaks(False))], 3600, "silence"),
        ([(1300, Speaks(True)), (1330, Heard("yes"))], 1330, "answer"),
        ([(300, Speaks(True)), (400, Lost(EAR, "gone")), (500, Back(EAR))], 4000, "silence"),
    ],
    ids=["silent", "coughs", "answers", "twice", "soon", "late", "interrupts", "lost"],
)
@pytest.mark.parametrize("longest", [0, 1, 5])
def test_a_question_waits_for_whatever_is_said_meanwhile(
    plan: list[tuple[int, Report | News]], ends: int, outcome: str, longest: int, tmp_path: Path
) -> None:
    (tmp_path / "asks.xml").write_text(ASKS)
    cast, clock = api.stage([], [str(tmp_path / "asks.xml")]).cast, Creeping(longest=longest)
    devices = LiveDevices(cast.robot, [Talker(cast, clock, plan)], Services([]), ["asks"])
    session = make_session(cast, policy_named("prima"), None, "none", None)
    devices.listening = session.listening
    records = carried_out(Loop(session, devices, FOREVER_MS, bounded=False), clock=clock)
    (log,) = [one for one in records if one["phase"] == "log"]
    assert log["message"] == outcome
    assert ends <= log["time"] * 1000 <= ends + 100
