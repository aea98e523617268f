"""The driver of Reachy Mini: what it asks of the daemon, and what it makes of the answers."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Coroutine
from math import radians
from pathlib import Path
from typing import Any

import pytest

from prima.devices.goals import At, Begin, Broke, Done, Lost, News, Report, Stopped
from prima.devices.profile import Profile, read_robot
from prima.errors import UsageError
from prima.live.driver import Refused, Unreachable, Unusable
from prima.live.drivers import driver_class
from prima.live.drivers.reachy import DRIVER, driver
from prima.live.drivers.reachy.link import PAST, read_address
from prima.live.drivers.reachy.pose import HeadPose, read_pose, read_step
from prima.live.reports import SenseReports
from prima.messages import Command, Occurred, Sensed
from prima.sim.map import Map
from tests.live.fake_reachy import UPRIGHT, FakeReachy, fake_reachy

ROBOT = Path(__file__).parents[2] / "documents" / "robots" / "reachy-mini.xml"
SITE = Map("site", places={"desk": (1.0, 1.0), "hall": (1.0, 4.0)}, headings={"desk": 90.0})
WITHIN_S = 20


NOD = re.compile('<does gesture="nod".*?</does>', re.DOTALL)


def robot(more: str = "", address: str = "http://127.0.0.1:8000") -> Profile:
    """The shipped robot, with more at the beginning of its driver; of two gestures nod it counts."""
    written = ROBOT.read_text(encoding="utf-8").replace("http://127.0.0.1:8000", address)
    if 'gesture="nod"' in more:
        written = NOD.sub("", written)
    return read_robot("r.xml", written.replace("    <does ", f"    {more}<does ", 1).encode())


class Run:
    """A driver that is connected with a fake daemon, and what it has told."""

    def __init__(self, fake: FakeReachy, more: str = "") -> None:
        profile = robot(more, f"http://127.0.0.1:{fake.port}")
        self.driver = DRIVER(profile.drivers[0], profile, SITE)
        self.told: list[Report | News] = []
        self.driver.attach(self.told.append)
        self._keys = 0
        self.reports = SenseReports()

    def begin(self, kind: str, **args: Any) -> str:
        self._keys += 1
        key = f"goal/{self._keys}"
        given = {name.replace("_", "-"): value for name, value in args.items()}
        devices = frozenset({"neck"} if kind == "move-head" else {"locomotion"})
        self.driver.start(Begin(key, kind, Command(kind, given), devices))
        return key

    async def end(self, key: str) -> Report:
        while True:
            for one in self.told:
                if isinstance(one, Done | Stopped | Broke) and one.key == key:
                    return one
            await asyncio.sleep(0.001)

    async def do(self, kind: str, **args: Any) -> Report:
        return await self.end(self.begin(kind, **args))


def play(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(test, WITHIN_S))


def test_it_is_found_by_its_kind() -> None:
    assert driver_class("reachy") is DRIVER


@pytest.mark.parametrize(
    ("kind", "args", "sent"),
    [
        ("turn", {"angle": 60.0}, {"body": 60, "yaw": 60, "duration": 1.0}),
        ("turn", {"angle": 300.0}, {"body": -60, "yaw": -60, "duration": 1.0}),
        ("move-head", {"pan": 30.0, "tilt": 10.0}, {"yaw": 30, "pitch": -10, "duration": 0.333}),
        ("move-head", {"pan": 0.0, "tilt": 0.0}, {"duration": 0.2}),
        (
            "set-speed-and-time",
            {"turn_speed": 20.0, "time": 2000},
            {"body": 40, "yaw": 40, "duration": 2.0},
        ),
        ("turn-to", {"heading": -30.0}, {"body": -30, "yaw": -30, "duration": 0.5}),
        ("turn-to", {"angle": 12.0}, {"body": 12, "yaw": 12, "duration": 0.2}),
        ("turn-to", {"toward": "door"}, {"body": 26.565, "yaw": 26.565, "duration": 0.443}),
    ],
)
def test_commands_become_gotos(kind: str, args: dict[str, Any], sent: dict[str, float]) -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            run = Run(fake)
            await run.driver.open()
            key = run.begin(kind, **args)
            assert await run.end(key) == Done(key)
            (goto,) = fake.gotos
            assert goto["duration"] == sent["duration"]
            assert goto["body_yaw"] == pytest.approx(radians(sent.get("body", 0)), abs=1e-4)
            for name in ("yaw", "pitch", "roll"):
                wanted = radians(sent.get(name, 0))
                assert goto["head_pose"][name] == pytest.approx(wanted, abs=1e-4)
            assert goto["antennas"] == pytest.approx([-0.1745, 0.1745], abs=1e-4)
            await run.driver.close()

    play(test())


def test_a_gesture_is_its_steps_from_where_the_head_is() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            run = Run(fake)
            await run.driver.open()
            await run.do("move-head", pan=30.0, tilt=0.0)
            fake.state["head_pose"]["yaw"] -= radians(3)  # it sags
            await run.do("gesture", name="nod")
            nod = fake.gotos[1:]
            tilts, pans = ([one["head_pose"][name] for one in nod] for name in ("pitch", "yaw"))
            assert tilts == pytest.approx([radians(one) for one in (15, -8, 10, 0)])
            assert pans == pytest.approx([radians(30)] * 4)
            assert [one["duration"] for one in nod] == [0.3] * 4
            await run.driver.close()

    play(test())


def test_a_recorded_move_is_played() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            run = Run(fake, '<does gesture="nod" by="lab/our-moves/yes"/>')
            await run.driver.open()
            assert isinstance(await run.do("gesture", name="nod"), Done)
            assert fake.asked[-1][0] == "/api/move/play/recorded-move-dataset/lab/our-moves/yes"
            await run.driver.close()

    play(test())


def test_where_it_stands_is_told_and_heeded() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            run = Run(fake, '<option name="at" value="desk"/>')
            await run.driver.open()
            assert run.told == [At(1.0, 1.0, 90.0)]
            assert isinstance(await run.do("turn-to", heading=60.0), Done)
            (at,) = [one for one in run.told[1:] if isinstance(one, At)]
            assert at.heading == pytest.approx(60)
            assert isinstance(await run.do("turn-to", toward="hall"), Done)
            assert fake.gotos[-1]["body_yaw"] == pytest.approx(0)
            end = await run.do("turn-to", toward="desk")
            assert isinstance(end, Broke) and end.reason == 'The robot stands at "desk" itself.'
            await run.driver.close()

    play(test())


def test_a_robot_that_sleeps_is_woken_up() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            fake.mode = "disabled"
            run = Run(fake)
            await run.driver.open()
            paths = [path for path, _ in fake.asked]
            assert paths[2:4] == ["/api/motors/set_mode/enabled", "/api/move/play/wake_up"]
            await run.driver.close()

    play(test())


@pytest.mark.parametrize(
    ("path", "status", "answer", "reason"),
    [
        ("/api/daemon/status", 200, "<html>", "What answers there is no Reachy Mini."),
        (
            "/api/daemon/status",
            404,
            {"detail": "Not Found"},
            "What answers there is no Reachy Mini.",
        ),
        (
            "/api/daemon/status",
            200,
            {"state": "error", "error": "no USB"},
            r"its state is error \(no USB\)",
        ),
        ("/api/motors/status", 503, {}, "The daemon has lost its robot."),
        ("/api/motors/status", 200, {}, "Reachy Mini does not wake up"),
        ("/api/state/full", 200, {"body_yaw": 0}, "does not tell where its parts are"),
    ],
)
def test_what_is_no_ready_daemon_is_told(path: str, status: int, answer: Any, reason: str) -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            fake.answers[path] = status, answer
            run = Run(fake)
            with pytest.raises(Unreachable, match=reason):
                await run.driver.open()
            assert run.told == []
            with pytest.raises(Unreachable, match="not connected"):
                await run.driver.ping()

    play(test())


@pytest.mark.parametrize(
    ("ends", "answer", "reason"),
    [
        ("move_failed", None, "Reachy Mini has failed at goto: the motor is hot."),
        ("move_cancelled", None, "Somebody else has stopped the move."),
        ("", (422, {"detail": "too far"}), "Reachy Mini refuses /api/move/goto: too far (422)."),
        ("", (200, {"id": 1}), "Reachy Mini does not tell which move it makes."),
    ],
)
def test_moves_that_fail_break_their_goals(ends: str, answer: Any, reason: str) -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            fake.ends = ends
            if answer:
                fake.answers["/api/move/goto"] = answer
            run = Run(fake)
            await run.driver.open()
            key = run.begin("move-head", pan=10.0, tilt=0.0)
            assert await run.end(key) == Broke(key, "neck", reason)
            await run.driver.close()

    play(test())


@pytest.mark.parametrize("details", sorted(PAST))
def test_a_move_that_the_daemon_fails_at_its_very_end_is_made(details: str) -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            fake.ends, fake.details = "move_failed", details
            run = Run(fake)
            await run.driver.open()
            key = run.begin("move-head", pan=10.0, tilt=0.0)
            assert await run.end(key) == Done(key, {})
            fake.moves = False  # where the parts are is looked at all the same
            assert isinstance(await run.do("turn", angle=40.0), Broke)
            await run.driver.close()

    play(test())


def test_parts_that_do_not_get_there_break_their_goals(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "SETTLE_S", 0.1)

    async def test() -> None:
        async with fake_reachy() as fake:
            fake.moves = False
            run = Run(fake)
            await run.driver.open()
            end = await run.do("turn", angle=40.0)
            assert isinstance(end, Broke) and end.device == "locomotion"
            assert end.reason.startswith("Reachy Mini's body is at 0 instead of 40: ")
            await run.driver.close()

    play(test())


def test_a_goal_that_is_cancelled_stops_its_move_and_none_that_waits_begins() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            fake.ends = ""
            run = Run(fake)
            await run.driver.open()
            first, second = run.begin("turn", angle=40.0), run.begin("move-head", pan=9.0, tilt=0.0)
            while not fake.running:
                await asyncio.sleep(0.001)
            run.driver.cancel(second)
            run.driver.cancel(first)
            assert await run.end(first) == Stopped(first)
            assert await run.end(second) == Stopped(second)
            assert fake.running == [] and len(fake.gotos) == 1
            third = run.begin("turn", angle=40.0)
            while not fake.running:
                await asyncio.sleep(0.001)
            fake.running.append("of-another-program")
            await run.driver.safe()
            assert fake.running == [] and await run.end(third) == Stopped(third)
            await run.driver.close()

    play(test())


@pytest.mark.parametrize("told", [[{"uuid": 5}, {"uuid": "other"}, "x"], {"uuid": "x"}, 7, None])
def test_safe_stops_the_moves_that_a_strange_daemon_names(told: object) -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            run = Run(fake)
            await run.driver.open()
            fake.running.append("other")
            fake.answers["/api/move/running"] = 200, told
            await run.driver.safe()
            assert fake.running == ([] if isinstance(told, list) else ["other"])
            await run.driver.close()

    play(test())


def test_a_daemon_that_hangs_up_is_lost_though_nothing_moves() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            run = Run(fake)
            await run.driver.open()
            fake.hang_up()
            while not run.told:
                await asyncio.sleep(0.001)
            reason = "The connection with Reachy Mini's daemon is gone."
            assert run.told == [Lost(frozenset({"locomotion", "neck", "arm"}), reason)]
            await run.driver.close()

    play(test())


def test_nonsense_ends_no_move_and_a_daemon_that_hangs_up_meanwhile_is_lost() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            fake.ends = ""
            run = Run(fake)
            await run.driver.open()
            run.begin("turn", angle=40.0)
            while not fake.running:
                await asyncio.sleep(0.001)
            fake.send("x" * 200)
            fake.send('{"type": "move_completed", "uuid": 7, "details": ""}' + " " * 99)
            fake.send('{"type": "move_completed", "uuid": ["a"], "details": ""}' + " " * 99)
            fake.send('{"type": {"a": 1}, "uuid": "a", "details": ""}' + " " * 99)
            await asyncio.sleep(0.01)
            assert not any(isinstance(one, Lost) for one in run.told)
            fake.hang_up()
            while not any(isinstance(one, Lost) for one in run.told):
                await asyncio.sleep(0.001)
            assert not any(isinstance(one, Broke | Stopped) for one in run.told)
            await run.driver.close()

    play(test())


def test_a_missing_library_is_named_with_its_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "find_spec", lambda _: None)
    profile = robot()
    with pytest.raises(Unusable, match=r"httpx is missing: pip install 'prima\[reachy\]'"):
        asyncio.run(DRIVER(profile.drivers[0], profile, SITE).open())


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ('<option name="speed" value="1"/>', 'there is no option "speed". Write at.'),
        ('<option name="at" value="moon"/>', 'There is no place "moon", where the robot stands.'),
        ('<does gesture="nod" by="nod"/>', 'by="nod" is neither "goto" nor a recorded'),
        ('<senses event="touch" by="/x"/>', 'by="/x" is not an address of the daemon'),
        ('<does gesture="nod"/>', 'by="" is neither "goto" nor a recorded move, DATASET/MOVE.'),
        (
            '<does gesture="nod" by="goto"><set name="a" value="15"/></does>',
            'The step "a" of the robot\'s document moves nothing.',
        ),
        (
            '<does gesture="nod" by="goto"><set name="a.tail" value="15"/></does>',
            'no "tail" to move; write one of body, left, lift, pan, right, roll, tilt, time or turn.',
        ),
        (
            '<does gesture="nod" by="goto"><set name="a.tilt" value="up"/></does>',
            "The tilt of the step \"a\" is not a number: 'up'.",
        ),
        (
            '<does gesture="nod" by="goto"><set name="a.time" value="0"/></does>',
            'The time of the step "a" is not between 0 and 60 s.',
        ),
        (
            '<does gesture="nod" by="goto"><set name="a.tilt" value="50"/></does>',
            "Reachy Mini's tilt goes to 40 degrees either way, not to 50.",
        ),
    ],
)
def test_slips_in_the_robots_document_are_told_before_the_run(more: str, message: str) -> None:
    profile = robot(more)
    with pytest.raises(UsageError) as told:
        DRIVER(profile.drivers[0], profile, SITE)
    assert message in str(told.value) and str(told.value).startswith("r.xml:")


@pytest.mark.parametrize(
    ("written", "address"),
    [
        ("", "http://127.0.0.1:8000"),
        ("reachy-mini.local", "http://reachy-mini.local:8000"),
        ("192.168.1.7:8001", "http://192.168.1.7:8001"),
        ("http://[::1]/", "http://[::1]:8000"),
    ],
)
def test_addresses_may_be_short(written: str, address: str) -> None:
    assert read_address(written) == address


@pytest.mark.parametrize(
    "written", ["ws://robot", "http://", "http://robot:x", "http://robot/api", "not an address"]
)
def test_what_is_no_address_is_told_before_the_run(written: str) -> None:
    profile = robot(address=written)
    with pytest.raises(UsageError, match="is not the address of a Reachy Mini; write address="):
        DRIVER(profile.drivers[0], profile, SITE)


def test_poses_are_read_as_they_are_sent() -> None:
    pose = HeadPose(body=150.0, pan=20.0, tilt=-10.0, roll=5.0, lift=8.0, left=30.0, right=-20.0)
    sent = pose.goto(1.0)
    back = read_pose({**sent, "antennas_position": sent["antennas"]})
    assert max(pose.off(back).values()) < 1e-9
    assert read_pose(UPRIGHT).near(HeadPose())


@pytest.mark.parametrize(
    ("step", "reason"),
    [
        ({"body": 170.0}, "Reachy Mini's body goes to 160 degrees either way, not to 170."),
        ({"turn": 175.0}, "Reachy Mini's body goes to 160 degrees either way, not to -175."),
        ({"lift": -30.0}, "Reachy Mini's lift goes to 25 mm either way, not to -30."),
        ({"body": 150.0}, "Body and neck would turn the head to 180 degrees; it turns to 175."),
    ],
)
def test_parts_go_no_further_than_they_can(step: dict[str, float], reason: str) -> None:
    at = HeadPose(body=10.0, pan=30.0)
    with pytest.raises(Refused) as told:
        at.moved(step)
    assert str(told.value) == reason


def test_a_step_has_numbers_alone() -> None:
    assert read_step("a", {"tilt": 3, "time": 0.5}) == {"tilt": 3.0, "time": 0.5}
    for wrong in (True, None, float("nan"), "3"):
        with pytest.raises(Refused, match="is not a number"):
            read_step("a", {"tilt": wrong})


DOA = """<senses sensor="sound" by="/api/state/doa" field="angle"/>
    <senses event="speech.begins" by="/api/state/doa" field="speech_detected" when="true"/>
"""


def test_what_the_daemon_senses_is_told_when_it_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "SENSE_S", 60.0)  # it is asked here

    async def test() -> None:
        async with fake_reachy() as fake:
            run = Run(fake, DOA)
            await run.driver.open()
            assert not [one for one in run.told if isinstance(one, Sensed | Occurred)]
            for angle, speaks in ((1.5, False), (1.5, True), (1.5, True), (2.0, True)):
                fake.doa = {"angle": angle, "speech_detected": speaks}
                await run.driver._sense(run.driver._link, run.reports)  # type: ignore[arg-type]
            await run.driver.close()
            told = [one for one in run.told if isinstance(one, Sensed | Occurred)]
            assert told == [
                Sensed({"sound": 1.5}),
                Occurred("speech.begins", "user"),
                Sensed({"sound": 2.0}),
            ]

    play(test())


def test_what_the_daemon_does_not_have_is_a_wrong_setting() -> None:
    async def test() -> None:
        async with fake_reachy() as fake:
            fake.answers["/api/state/smell"] = (404, {"detail": "Not Found"})
            run = Run(fake, '<senses sensor="smell" by="/api/state/smell"/>')
            with pytest.raises(Unusable, match=r"/api/state/smell.*Not Found"):
                await run.driver.open()

    play(test())
