"""However a run ends, and whatever is lost meanwhile, the robot is made safe."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from threading import Thread

import pytest

from prima import api
from prima.devices.goals import Accepted, Begin, Lost, Stopped
from prima.devices.loop import Loop
from prima.devices.settings import USUAL, DriverLimits, DriverSettings
from prima.errors import Place, RunError
from prima.grammar.answers import Answers
from prima.grammar.phrases import phrases
from prima.live.clock import Clock
from prima.live.devices import LiveDevices
from prima.live.driver import TaskDriver, Unreachable
from prima.live.shell import Shell
from prima.live.visit import FOREVER_MS
from prima.messages import Command, Data, Emergency, Heard, Record
from prima.scheduler.policy import policy_named
from prima.sim.rehearsal import make_session
from prima.sim.services import Services

TALK = """<prima xmlns="urn:prima:dialogue:1" version="1.0" id="talk" kind="ea">
  <form id="a">
    <block><speak>One.</speak><speak>Two.</speak></block>
    <field name="more"><prompt>Shall I go on?</prompt><option>yes</option></field>
    <block><speak>Three.</speak><exit/></block>
  </form>
</prima>"""
TURNS = """<prima xmlns="urn:prima:dialogue:1" version="1.0" id="turns" kind="fa">
  <form id="a">
    <block><turn angle="10"/><turn angle="20"/><turn angle="30"/><exit/></block>
  </form>
</prima>"""


def test_a_goal_that_is_cancelled_before_its_first_turn_has_stopped() -> None:
    told: list[object] = []

    async def play() -> None:
        robot = Robot(frozenset({"speaker"}))
        robot.attach(told.append)
        robot.start(Begin("a", "say", Command("speak", {}, "Hello."), frozenset({"speaker"})))
        robot.cancel("a")
        await asyncio.sleep(0.05)

    asyncio.run(play())
    assert told == [Accepted("a"), Stopped("a")]


class Robot(TaskDriver):
    """Says and turns for as long as it is told to; notes when it is made safe."""

    kind = "robot"

    def __init__(self, devices: frozenset[str], lasts: float = 0.02) -> None:
        place = Place("robot.xml")
        given = DriverSettings("robot", "", devices, 200, 100, USUAL, [], [], place)
        profile = api.stage([], ["documents/ea/guide.xml"]).cast.robot
        super().__init__(given, profile, api.stage([], ["documents/ea/guide.xml"]).cast.world)
        self.lasts = lasts
        self.safe_calls = 0
        self.doing: list[str] = []
        self.heard: list[list[str]] = []
        self.there = True
        self.begun: Callable[[Begin], None] = lambda _: None

    async def open(self) -> None:
        if not self.there:
            raise Unreachable("it is switched off")

    async def ping(self) -> None:
        await self.open()

    async def perform(self, goal: Begin) -> Data:
        self.doing.append(goal.kind)
        self.begun(goal)
        await asyncio.sleep(1000 if goal.kind == "listen" else self.lasts)
        return {}

    async def safe(self) -> None:
        self.safe_calls += 1

    def hears(self, takes: Sequence[Answers]) -> None:
        self.heard.append([*phrases(takes[0])] if takes else [])


@pytest.fixture
def stage(tmp_path: object) -> Callable[..., tuple[Loop, list[Robot]]]:
    def made(lasts: float = 0.02) -> tuple[Loop, list[Robot]]:
        folder = str(tmp_path)
        for name, text in (("talk", TALK), ("turns", TURNS)):
            with open(f"{folder}/{name}.xml", "w") as file:
                file.write(text)
        cast = api.stage([f"{folder}/turns.xml"], [f"{folder}/talk.xml"]).cast
        voice = frozenset({"speaker", "speech-recognition", "human-detection"})
        robots = [Robot(voice, lasts), Robot(cast.robot.devices - voice, lasts)]
        names = [doc.id for doc in cast.documents]
        devices = LiveDevices(cast.robot, robots, Services([]), names)
        session = make_session(cast, policy_named("prima"), None, "none", None)
        devices.listening = session.listening
        return Loop(session, devices, FOREVER_MS, bounded=False), robots

    return made


Stage = Callable[..., tuple[Loop, list[Robot]]]


def carried_out(loop: Loop, until: float = 10, warned: list[str] | None = None) -> list[Record]:
    records: list[Record] = []
    loop.journal = records.extend
    told: list[str] = [] if warned is None else warned

    async def bounded() -> None:
        shell = Shell(loop, Clock(), told.append, None)
        asyncio.get_running_loop().call_later(until, shell.stop)
        await shell.run()

    try:
        asyncio.run(bounded())
    finally:
        loop.session.close()
    return records


def rows(records: list[Record], *phases: str) -> list[tuple[str, str]]:
    return [
        (record["phase"], str(record.get("behavior") or record.get("device") or record["outcome"]))
        for record in records
        if record["phase"] in phases
    ]


def answer_when_asked(robot: Robot) -> None:
    def begun(goal: Begin) -> None:
        if goal.kind == "listen":
            asyncio.get_running_loop().call_later(0.05, robot.tell, Heard("yes"))

    robot.begun = begun


def test_a_run_ends_with_a_safe_robot(stage: Stage) -> None:
    loop, (voice, body) = stage()
    answer_when_asked(voice)
    records = carried_out(loop)
    assert records[-1]["outcome"] == "over"
    assert voice.doing == ["say", "say", "say", "listen", "say"]
    assert body.doing == ["turn", "turn", "turn"]
    assert voice.safe_calls == body.safe_calls == 1


def test_a_recogniser_is_told_what_is_listened_for(stage: Stage) -> None:
    loop, (voice, _) = stage()
    answer_when_asked(voice)
    carried_out(loop)
    assert voice.heard == [["yes"], []]


def test_an_emergency_stop_makes_every_driver_safe_at_once(stage: Stage) -> None:
    loop, (voice, body) = stage(lasts=0.3)
    answer_when_asked(voice)

    def release_when_safe() -> None:
        if body.safe_calls:
            voice.tell(Emergency(False, True))
        else:
            asyncio.get_running_loop().call_later(0.01, release_when_safe)

    def begun(goal: Begin) -> None:
        body.begun = lambda _: None
        running = asyncio.get_running_loop()
        running.call_later(0.1, voice.tell, Emergency(True))
        running.call_later(0.1, release_when_safe)

    body.begun = begun
    records = carried_out(loop, 10)
    assert rows(records, "emergency") == [("emergency", "pressed"), ("emergency", "released")]
    assert records[-1]["outcome"] == "over", "what was stopped goes on"


def test_a_robot_that_an_emergency_stop_does_not_make_safe_is_lost(stage: Stage) -> None:
    loop, (voice, body) = stage(lasts=0.3)
    answer_when_asked(voice)

    async def fails() -> None:
        body.safe = Robot.safe.__get__(body)  # type: ignore[method-assign]
        asyncio.get_running_loop().call_later(0.1, voice.tell, Emergency(False, True))
        raise OSError("no motor answers")

    def begun(goal: Begin) -> None:
        body.begun = lambda _: None
        body.safe = fails  # type: ignore[method-assign]
        voice.tell(Emergency(True))

    body.begun = begun
    warned: list[str] = []
    records = carried_out(loop, 5, warned)
    lost = [record for record in records if record["phase"] == "device"]
    assert lost[0]["message"] == "safe has failed: OSError: no motor answers"
    assert body.safe_calls >= 2, "after the loss, and when it is back"
    assert warned[-1] == "robot: the robot is back."


def test_a_robot_that_does_not_become_safe_in_time_is_named(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("prima.live.shell.SAFE_S", 0.05)
    loop, (voice, body) = stage()
    answer_when_asked(voice)

    async def safe() -> None:
        await asyncio.sleep(1000)

    body.safe = safe  # type: ignore[method-assign]
    warned: list[str] = []
    carried_out(loop, 3, warned)
    assert warned == ["robot: safe has failed: no answer within 0.05 s."]


def test_a_lost_robot_fails_what_runs_on_it_and_is_taken_up_again(stage: Stage) -> None:
    loop, (voice, body) = stage(lasts=0.3)
    answer_when_asked(voice)

    def begun(goal: Begin) -> None:
        body.begun = lambda _: None
        asyncio.get_running_loop().call_later(0.1, body.lose, "the link is down")

    body.begun = begun
    warned: list[str] = []
    records = carried_out(loop, 5, warned)
    assert ("fail", "turns#1") in rows(records, "fail")
    assert ("device", "locomotion") in rows(records, "device")
    assert body.safe_calls >= 2, "after the loss, and at the end"
    ends = [name for _, name in rows(records, "end")]
    assert "talk#1" in ends, "the other application goes on"
    assert warned[0] == "robot: the robot is lost (the link is down); it is looked for."
    assert "robot: the robot is back." in warned
    outcomes = [record["outcome"] for record in records if record["phase"] == "device"]
    assert set(outcomes) == {"missing", "back"}


def test_what_was_going_on_when_a_robot_was_lost_is_over() -> None:
    ended: list[str] = []

    async def play() -> None:
        robot = Robot(frozenset({"wheels"}), lasts=30)
        robot.attach(lambda _: None)
        robot.start(Begin("a", "turn", Command("turn", {}), frozenset({"wheels"})))
        await asyncio.sleep(0.01)
        [goal] = robot._tasks.values()
        goal.add_done_callback(lambda one: ended.append("cancelled" if one.cancelled() else "over"))
        robot.lose("the link is down")
        await asyncio.sleep(0.05)
        assert not robot._tasks

    asyncio.run(play())
    assert ended, "it moves no robot that has come back"


def test_a_robot_lost_again_while_it_is_made_safe_is_not_back(stage: Stage) -> None:
    loop, (_, body) = stage(lasts=0.1)
    safe, calls = body.safe, 0

    async def lost_once_more() -> None:
        nonlocal calls
        calls += 1
        if calls == 2:  # after the first time that it was found
            body.lose("the link is down again")
        await safe()

    def begun(goal: Begin) -> None:
        body.begun = lambda _: None
        asyncio.get_running_loop().call_later(0.05, body.lose, "the link is down")

    body.begun, body.safe = begun, lost_once_more  # type: ignore[method-assign]
    warned: list[str] = []
    carried_out(loop, 5, warned)
    told = [one for one in warned if one.startswith("robot: the robot is")]
    assert [one.partition(";")[0] for one in told] == [
        "robot: the robot is lost (the link is down)",
        "robot: the robot is lost (the link is down again)",
        "robot: the robot is back.",
    ]


def test_a_robot_that_is_lost_at_the_end_is_not_looked_for(stage: Stage) -> None:
    loop, (voice, body) = stage()
    answer_when_asked(voice)

    async def lose() -> None:
        body.lose("it is switched off")

    body.safe = body.close = lose  # type: ignore[method-assign]
    warned: list[str] = []
    records = carried_out(loop, 3, warned)
    assert records[-1]["outcome"] == "over" and warned == []


def test_a_thread_of_a_library_may_say_that_the_robot_is_lost(stage: Stage) -> None:
    loop, (voice, body) = stage(lasts=0.3)
    answer_when_asked(voice)

    def begun(goal: Begin) -> None:
        body.begun = lambda _: None
        Thread(target=body.lose, args=["the link is down"]).start()

    body.begun = begun
    warned: list[str] = []
    records = carried_out(loop, 5, warned)
    assert ("fail", "turns#1") in rows(records, "fail")
    assert ("device", "locomotion") in rows(records, "device")
    assert body.safe_calls >= 2 and warned[-1] == "robot: the robot is back."


def test_what_a_thread_posts_after_the_run_is_dropped() -> None:
    robot = Robot(frozenset({"speaker"}))

    async def play() -> None:
        robot.attach(lambda _: None)

    asyncio.run(play())
    robot.post(Emergency(True))


def test_goals_that_are_over_take_no_memory(stage: Stage) -> None:
    loop, (voice, _) = stage()
    answer_when_asked(voice)
    carried_out(loop, 3)
    assert isinstance(loop.devices, LiveDevices)
    assert loop.devices._routes == {}


def test_a_robot_that_no_longer_answers_its_heartbeat_is_lost(stage: Stage) -> None:
    loop, (_, body) = stage(lasts=0.5)

    def begun(goal: Begin) -> None:
        body.there = False

    body.begun = begun
    warned: list[str] = []
    records = carried_out(loop, 1.0, warned)
    assert ("fail", "turns#1") in rows(records, "fail")
    assert warned[0] == "robot: the robot is lost (it is switched off); it is looked for."
    again = "robot: the robot is not back: robot.xml:1:1: robot: it is switched off"
    assert set(warned[1:]) <= {again} and len(warned) <= 2, "told once"


def test_an_error_inside_makes_the_robot_safe(stage: Stage) -> None:
    loop, robots = stage()

    def full(records: list[Record]) -> None:
        raise RunError("visit.jsonl: cannot be written: No space left on device.")

    loop.journal = full
    shell = Shell(loop, Clock(), lambda _: None, None)
    with pytest.raises(RunError):
        asyncio.run(shell.run())
    loop.session.close()
    assert [robot.safe_calls for robot in robots] == [1, 1]


def test_a_robot_that_cannot_be_made_safe_is_told_of_and_the_others_are(stage: Stage) -> None:
    loop, (voice, body) = stage()

    async def stuck() -> None:
        raise RuntimeError("no link")

    voice.safe = stuck  # type: ignore[method-assign]
    warned: list[str] = []
    carried_out(loop, 0.5, warned)
    assert body.safe_calls == 1
    assert any("has failed: RuntimeError: no link" in text for text in warned)


def test_no_robot_waits_for_another_to_be_made_safe(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither for one that takes long, nor for what still runs for a driver."""
    monkeypatch.setattr("prima.live.shell.SAFE_S", 2.0)
    loop, (voice, body) = stage()
    stopped = asyncio.Event()
    pings = iter(range(1000))

    async def safe() -> None:
        stopped.set()

    async def ping() -> None:
        if next(pings) == 0:
            return  # of the opening
        try:
            await asyncio.sleep(1000)
        except asyncio.CancelledError:
            await stopped.wait()

    body.safe, voice.ping = safe, ping  # type: ignore[method-assign]
    voice.safe = stopped.wait  # type: ignore[method-assign, assignment]
    answer_when_asked(voice)
    warned: list[str] = []
    carried_out(loop, 3, warned)
    assert not warned


def test_what_a_thread_tells_arrives_in_the_run(stage: Stage) -> None:
    loop, (voice, _) = stage()

    def begun(goal: Begin) -> None:
        if goal.kind == "listen":
            asyncio.get_running_loop().run_in_executor(None, voice.post, Heard("yes"))

    voice.begun = begun
    assert carried_out(loop)[-1]["outcome"] == "over"


def test_a_report_that_is_late_or_of_nobody_changes_nothing(stage: Stage) -> None:
    loop, (voice, body) = stage()
    answer_when_asked(voice)
    body.begun = lambda goal: body.tell(Lost(frozenset(), "nothing is lost"))
    assert carried_out(loop)[-1]["outcome"] == "over"
    assert DriverLimits(1).over(DriverLimits(2, 3)) == DriverLimits(1, 3)


@pytest.mark.skipif(not hasattr(time, "CLOCK_BOOTTIME"), reason="only Linux has such a clock")
def test_the_clock_goes_on_while_the_machine_is_suspended(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, real = Clock(), time.clock_gettime
    monkeypatch.setattr(time, "clock_gettime", lambda one: real(one) + 3600)
    assert clock.now() >= 3_600_000
