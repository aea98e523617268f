"""What the driver and the daemon do together."""

from __future__ import annotations

import asyncio
import json
import signal
import socket
import time
from collections.abc import AsyncIterator, Coroutine, Iterator
from contextlib import asynccontextmanager
from math import degrees, radians
from pathlib import Path
from typing import Any

import pytest

from prima.devices.goals import Accepted, Broke, Done, Lost, Stopped
from prima.live.driver import Unreachable, Unusable
from prima.messages import Sensed
from tests.parties.reachy.daemon import Daemon, Run, daemon, until

LONGEST_S = 60


@pytest.fixture(scope="module")
def party(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Daemon]:
    """The daemon that most tests share."""
    home = tmp_path_factory.mktemp("reachy")
    record(home)
    with daemon(home) as one:
        yield one


def record(home: Path) -> None:
    """Put a recorded move where the daemon keeps data sets: the head goes up and down once."""
    level = [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1.0]]
    raised = [*level[:2], [0, 0, 1.0, 0.015], level[3]]
    points = [{"head": one, "antennas": [-0.17, 0.17]} for one in (level, raised, raised, level)]
    move = {"description": "up", "time": [0.0, 0.5, 1.0, 1.5], "set_target_data": points}
    folder = home / "hub" / "datasets--prima--moves"
    (folder / "refs").mkdir(parents=True)
    (folder / "refs" / "main").write_text("a" * 40)
    (folder / "snapshots" / ("a" * 40)).mkdir(parents=True)
    (folder / "snapshots" / ("a" * 40) / "up.json").write_text(json.dumps(move))


@asynccontextmanager
async def connected(address: str, more: str = "") -> AsyncIterator[Run]:
    run = Run(address, more)
    await run.driver.open()
    try:
        yield run
    finally:
        await run.driver.close()


def play(test: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(test, LONGEST_S))


def test_commands_bring_the_parts_where_they_have_to_be(party: Daemon) -> None:
    async def test() -> None:
        async with connected(party.address) as run:
            key = run.begin("turn", angle=40.0)
            assert run.told[0] == Accepted(key)
            assert await run.end(key) == Done(key)
            assert degrees(party.body()) == pytest.approx(40, abs=3)
            assert isinstance(await run.do("move-head", pan=30.0, tilt=10.0), Done)
            head = party.get("/api/state/full")["head_pose"]
            assert degrees(head["yaw"]) == pytest.approx(70, abs=10)
            assert degrees(head["pitch"]) == pytest.approx(-10, abs=10)
            assert isinstance(await run.do("turn-to", toward="door"), Done)
            assert degrees(party.body()) == pytest.approx(26.6, abs=3)
            assert isinstance(await run.do("turn-to", heading=0.0), Done)
            head = party.get("/api/state/full")["head_pose"]
            assert degrees(head["yaw"]) == pytest.approx(30, abs=10), "the head goes with the body"
            assert isinstance(await run.do("move-head", pan=0.0, tilt=0.0), Done)

    play(test())


@pytest.mark.parametrize("name", ["nod", "shake", "bow", "wave", "perk-up"])
def test_gestures_end_where_they_began(party: Daemon, name: str) -> None:
    async def test() -> None:
        async with connected(party.address) as run:
            began = time.monotonic()
            assert isinstance(await run.do("gesture", name=name), Done)
            assert time.monotonic() - began < run.profile.gestures[name] / 1000 + 1.5
            state = party.get("/api/state/full")
            assert max(abs(value) for value in state["head_pose"].values()) < 0.15
            assert state["antennas_position"] == pytest.approx([-0.17, 0.17], abs=0.1)

    play(test())


@pytest.mark.parametrize(
    ("args", "sides"), [({"angle": -40.0}, (-1.57, 0.17)), ({"toward": "door"}, (-0.17, 1.57))]
)
def test_it_points_with_the_antenna_of_the_side(
    party: Daemon, args: dict[str, float | str], sides: tuple[float, float]
) -> None:
    there = pytest.approx(sides, abs=0.15)

    async def test() -> None:
        async with connected(party.address) as run:
            key = run.begin("point-by-hand", **args)
            await until(lambda: party.get("/api/state/full")["antennas_position"] == there)
            assert isinstance(await run.end(key), Done)

    play(test())


def test_a_recorded_move_is_played_by_the_daemon(party: Daemon) -> None:
    recorded = '<does gesture="wave" by="prima/moves/up"/>'

    async def test() -> None:
        async with connected(party.address) as run:
            run.driver.settings.does.clear()
            end = await run.do("gesture", name="wave")
            assert isinstance(end, Broke) and "does not say how" in end.reason
        async with connected(party.address, recorded) as run:
            run.driver.settings.does = [
                one for one in run.driver.settings.does if one.by.startswith("prima/")
            ]
            key, highest = run.begin("gesture", name="wave"), 0.0
            while run.end_of(key) is None:
                await asyncio.sleep(0.05)
                highest = max(highest, party.get("/api/state/full")["head_pose"]["z"])
            assert isinstance(run.end_of(key), Done) and highest == pytest.approx(0.015, abs=0.004)

    play(test())


def test_a_move_that_is_cancelled_half_way_stops_there(party: Daemon) -> None:
    async def test() -> None:
        async with connected(party.address) as run:
            assert isinstance(await run.do("turn-to", heading=0.0), Done)
            key = run.begin("set-speed-and-time", speed=0.0, turn_speed=30.0, time=4000)
            await until(lambda: party.body() > radians(30))
            asked = time.monotonic()
            run.driver.cancel(key)
            assert await run.end(key) == Stopped(key)
            assert time.monotonic() - asked < 0.5
            assert party.get("/api/move/running") == []
            await asyncio.sleep(0.3)
            stopped = party.body()
            await asyncio.sleep(0.7)
            assert party.body() == pytest.approx(stopped, abs=0.02)
            assert degrees(stopped) < 90
            assert isinstance(await run.do("turn-to", heading=0.0), Done)

    play(test())


def test_a_move_that_is_cancelled_before_the_daemon_has_answered_stops(party: Daemon) -> None:
    async def test() -> None:
        async with connected(party.address) as run:
            for waits in (0.0, 0.001, 0.003, 0.006, 0.01, 0.02, 0.03):
                key = run.begin("turn", angle=20.0)
                await asyncio.sleep(waits)
                run.driver.cancel(key)
                assert await run.end(key) == Stopped(key)
                assert party.get("/api/move/running") == []
            assert isinstance(await run.do("turn-to", heading=0.0), Done)

    play(test())


def test_what_begins_while_another_move_plays_begins_after_it(party: Daemon) -> None:
    """The daemon would play both at once, and end neither where it was sent."""

    async def test() -> None:
        async with connected(party.address) as run:
            first, second = run.begin("turn", angle=60.0), run.begin("gesture", name="nod")
            third = run.begin("move-head", pan=20.0, tilt=0.0)
            await until(lambda: len(party.get("/api/move/running")) == 1)
            run.driver.cancel(third)
            assert await run.end(third) == Stopped(third), "it has not begun"
            assert run.end_of(first) is None
            assert isinstance(await run.end(first), Done)
            assert run.end_of(second) is None
            assert isinstance(await run.end(second), Done)
            assert degrees(party.body()) == pytest.approx(60, abs=3)
            assert isinstance(await run.do("turn-to", heading=0.0), Done)

    play(test())


def test_moves_that_somebody_else_stops_fail(party: Daemon) -> None:
    async def test() -> None:
        async with connected(party.address) as run, connected(party.address) as other:
            key = run.begin("turn", angle=60.0)
            await until(lambda: party.get("/api/move/running"))
            await other.driver.safe()
            end = await run.end(key)
            assert isinstance(end, Broke) and end.reason == "Somebody else has stopped the move."
            assert isinstance(await run.do("turn-to", heading=0.0), Done)

    play(test())


@pytest.mark.parametrize(
    ("kind", "args", "device", "reason"),
    [
        ("turn-to", {"heading": 170.0}, "locomotion", "Reachy Mini's body goes to 160 degrees"),
        ("move-head", {"pan": 90.0, "tilt": 0.0}, "neck", "Reachy Mini's pan goes to 65 degrees"),
        ("set-speed-and-time", {"speed": 0.5, "time": 1000}, "locomotion", "has no wheels"),
        ("turn-to", {"toward": "moon"}, "locomotion", 'Where is "moon"?'),
    ],
)
def test_what_it_cannot_do_fails_at_once(
    party: Daemon, kind: str, args: dict[str, Any], device: str, reason: str
) -> None:
    async def test() -> None:
        async with connected(party.address) as run:
            end = await run.do(kind, **args)
            assert isinstance(end, Broke) and end.device == device and reason in end.reason

    play(test())


def test_a_pose_that_the_neck_does_not_reach_is_not_done(party: Daemon) -> None:
    """The daemon calls each move completed, wherever the parts are."""

    async def test() -> None:
        async with connected(party.address) as run:
            end = await run.do("move-head", pan=65.0, tilt=-40.0)
            assert isinstance(end, Broke) and end.device == "neck"
            assert "instead of 65" in end.reason
            assert isinstance(await run.do("move-head", pan=0.0, tilt=0.0), Done)

    play(test())


def test_the_daemon_tells_of_its_sensors(party: Daemon) -> None:
    senses = """<senses sensor="body" by="/api/state/present_body_yaw"/>
    <senses sensor="sound" by="/api/state/doa" field="angle"/>
    <senses sensor="upright" by="/api/state/imu" field="quaternion"/>
    """

    async def test() -> None:
        async with connected(party.address, senses) as run:
            assert isinstance(await run.do("turn", angle=30.0), Done)
            await asyncio.sleep(0.5)
            told = [one.values for one in run.told if isinstance(one, Sensed)]
            assert {name for values in told for name in values} == {"body"}, "MuJoCo has no others"
            assert degrees(told[-1]["body"]) == pytest.approx(30, abs=5)
            assert isinstance(await run.do("turn-to", heading=0.0), Done)
        with pytest.raises(Unusable, match="Not Found"):
            async with connected(party.address, '<senses sensor="x" by="/api/state/smell"/>'):
                pass

    play(test())


def test_safe_stops_all_at_once(party: Daemon) -> None:
    async def test() -> None:
        async with connected(party.address) as run:
            keys = [run.begin("turn", angle=90.0), run.begin("gesture", name="bow")]
            await until(lambda: party.body() > radians(15))
            asked = time.monotonic()
            await run.driver.safe()
            assert time.monotonic() - asked < 0.5
            assert party.get("/api/move/running") == []
            assert [run.end_of(key) for key in keys] == [Stopped(key) for key in keys]
            await run.driver.safe()
            await asyncio.sleep(0.3)
            stopped = party.body()
            await asyncio.sleep(0.5)
            assert party.body() == pytest.approx(stopped, abs=0.02)
            assert isinstance(await run.do("turn-to", heading=0.0), Done)

    play(test())


def test_a_daemon_that_is_killed_in_mid_move_is_lost_and_comes_back(tmp_path: Path) -> None:
    async def test(party: Daemon) -> None:
        async with connected(party.address) as run:
            await run.driver.ping()
            key = run.begin("turn", angle=90.0)
            await until(lambda: party.body() > radians(15))
            killed = time.monotonic()
            party.send(signal.SIGKILL)
            lost = await until(lambda: next((x for x in run.told if isinstance(x, Lost)), None))
            assert time.monotonic() - killed < 1
            assert lost.devices == {"locomotion", "neck", "arm"} and "is gone" in lost.reason
            assert run.end_of(key) is None, "what runs fails by the loss"
            await run.driver.safe()
            with pytest.raises(Unreachable, match="No Reachy Mini answers"):
                await run.driver.ping()
            with pytest.raises(Unreachable, match="No Reachy Mini answers"):
                await run.driver.open()
            party.kill()
            party.start()
            await run.driver.open()
            assert isinstance(await run.do("turn", angle=20.0), Done)

    with daemon(tmp_path) as party:
        play(test(party))


def test_a_daemon_that_hangs_is_lost_in_time(tmp_path: Path) -> None:
    async def test(party: Daemon) -> None:
        async with connected(party.address) as run:
            party.send(signal.SIGSTOP)
            asked = time.monotonic()
            with pytest.raises(Unreachable, match="it takes too long"):
                await run.driver.ping()
            run.begin("turn", angle=90.0)
            await until(lambda: any(isinstance(one, Lost) for one in run.told))
            await run.driver.safe()
            assert time.monotonic() - asked < 8

    with daemon(tmp_path) as party:
        play(test(party))


def test_a_daemon_whose_robot_was_switched_off_says_so(tmp_path: Path) -> None:
    async def test(party: Daemon) -> None:
        async with connected(party.address) as run:
            import httpx

            httpx.post(f"{party.address}/api/daemon/stop?goto_sleep=false", trust_env=False)
            await until(lambda: party.get("/api/daemon/status")["state"] == "stopped")
            with pytest.raises(Unreachable, match="its state is stopped"):
                await run.driver.ping()
            key = run.begin("turn", angle=10.0)
            lost = await until(lambda: next((x for x in run.told if isinstance(x, Lost)), None))
            assert lost.reason.endswith("has lost its robot.") and run.end_of(key) is None

    with daemon(tmp_path) as party:
        play(test(party))


def test_an_address_where_nobody_is_is_told_in_time() -> None:
    async def test() -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        run = Run(f"http://127.0.0.1:{port}")
        with pytest.raises(Unreachable, match="No Reachy Mini answers"):
            await run.driver.open()

    play(test())
