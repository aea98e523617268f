"""However a run is disturbed, and however it ends, each driver is made safe: nothing goes on."""

from __future__ import annotations

import asyncio
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from prima.devices.goals import SAY, Begin
from prima.devices.profile import read_robot
from prima.live.chosen import Chosen
from prima.live.driver import Driver, TaskDriver, Unreachable
from prima.live.drivers.console import ConsoleDriver
from prima.live.drivers.ros2 import Ros2Driver
from prima.live.drivers.rosbridge import RosbridgeDriver
from prima.live.drivers.sim import SimDriver
from prima.live.drivers.speech import SpeechDriver
from prima.live.drivers.speech.segments import Segments
from prima.live.drivers.speech.sound import RATE
from prima.live.ros import CANCELED, Outcome, RosUse, Sent
from prima.live.visit import LiveSettings, begin
from prima.messages import Command, Emergency, Record
from prima.sim.map import Map
from tests.live.fake_reachy import FakeReachy, fake_reachy
from tests.parties.speech.user import Pipes

LONG_S = 20
LONG = "This takes much longer than anybody wants to wait for it. " * 5
APPLICATION = """<prima xmlns="urn:prima:dialogue:1" version="1.0" id="works" kind="fa">
  <form id="a"><block>{}<exit/></block><on event="error"><pause time="60s"/></on></form>
</prima>"""
ROBOT = """<robot xmlns="urn:prima:robot:1" version="1.0" id="r" turn-speed="20">
  <device name="locomotion"/><device name="localization"/><device name="neck"/>
  <device name="speaker"/><device name="arm"/>
  <gesture name="bow" duration="9s"/>
  {}
</robot>"""
SPIN = '<does command="turn" by="/spin" type="nav2_msgs/action/Spin"/>'
DRIVERS = {
    "sim": "",
    "console": '<option name="stdin" value="false"/>',
    "speech": "",
    "reachy": "",
    "ros2": SPIN,
    "rosbridge": SPIN,
    "naoqi": '<does command="turn" by="ALMotion.moveTo" stop="ALMotion.stopMove"/>',
}
SPEAK = frozenset({"console", "speech"})
CAUSES = (
    "emergency stop",
    "watchdog",
    "lost link",
    "internal error",
    "SIGINT",
    "SIGTERM",
    "SIGHUP",
)


def load(driver: Any) -> None:
    """A voice that says everything in ten seconds, and ears that hear nothing."""
    driver._ears = SimpleNamespace(listen_for=lambda _: None, close=lambda: None)
    driver._voices = SimpleNamespace(say=lambda *_: bytes(10 * RATE * 2))
    driver._segments = Segments(lambda _: 0.0, 0.1)


class FakeLink:
    """A robot with ROS on which a goal goes on until it is cancelled."""

    def __init__(self) -> None:
        self.going: list[asyncio.Future[Outcome]] = []

    async def connect(self, uses: list[RosUse], driver: Driver) -> None:
        """It is there."""

    async def send_goal(self, use: RosUse, values: dict[str, Any], on: Callable[[], None]) -> Sent:
        end: asyncio.Future[Outcome] = asyncio.get_running_loop().create_future()
        self.going.append(end)
        return Sent(end, self.cancel_all)

    def cancel_all(self) -> None:
        going, self.going = self.going, []
        for end in going:
            if not end.done():
                end.set_result(Outcome(CANCELED, {}))

    def fail(self, reason: str) -> None:
        """Nobody knows any more how goals end, which go on all the same."""
        for end in self.going:
            if not end.done():
                end.set_exception(Unreachable(reason))

    async def call(self, use: RosUse, values: dict[str, Any]) -> dict[str, Any]:
        return {}

    def publish(self, use: RosUse, values: dict[str, Any]) -> None:
        """Nobody listens."""

    async def ping(self) -> None:
        """It answers."""

    async def close(self) -> None:
        """It is gone."""


class Asked:
    """A call of qi, as its futures are."""

    def __init__(self) -> None:
        self._over: list[Callable[[Asked], None]] = []
        self._ended = False
        self._cancelled = False

    def addCallback(self, over: Callable[[Asked], None]) -> None:
        self._over.append(over)
        if self._ended:
            over(self)

    def end(self, cancelled: bool = False) -> Asked:
        self._ended, self._cancelled = True, cancelled
        for over in self._over:
            over(self)
        return self

    def cancel(self) -> None:
        """Few methods heed it."""

    def isCanceled(self) -> bool:
        return self._cancelled

    def hasError(self) -> bool:
        return False

    def value(self) -> None:
        return None


def fake_qi() -> tuple[Any, list[Asked]]:
    """A module like qi, with a robot that moves until it is stopped; and its moves."""
    going: list[Asked] = []

    def move(*_: object, **__: object) -> Asked:
        going.append(Asked())
        return going[-1]

    def stop(*_: object, **__: object) -> Asked:
        for one in going:
            one.end()
        going.clear()
        return Asked().end()

    def answered(value: object) -> Callable[..., Asked]:
        def ask(*_: object, **__: object) -> Asked:
            asked = Asked()
            asked.value = lambda: value  # type: ignore[method-assign, assignment]
            return asked.end()

        return ask

    motion = SimpleNamespace(moveTo=move, stopMove=stop)
    signal_ = SimpleNamespace(connect=lambda _: 1)

    def session() -> SimpleNamespace:
        return SimpleNamespace(
            connect=answered(None),
            service=answered(motion),
            services=answered([]),
            disconnected=signal_,
            close=lambda: None,
        )

    module = ModuleType("qi")
    module.Session = session  # type: ignore[attr-defined]
    return module, going


@pytest.fixture
def reachy() -> Iterator[FakeReachy]:
    """A daemon, in a thread, whose moves go on until they are stopped."""
    made: list[FakeReachy] = []
    ready, over = threading.Event(), threading.Event()

    async def serve() -> None:
        async with fake_reachy() as fake:
            fake.ends = ""
            made.append(fake)
            ready.set()
            while not over.is_set():
                await asyncio.sleep(0.02)

    thread = threading.Thread(target=asyncio.run, args=(serve(),), daemon=True)
    thread.start()
    assert ready.wait(10)
    yield made[0]
    over.set()
    thread.join(10)


@pytest.fixture
def going(
    kind: str, reachy: FakeReachy, monkeypatch: pytest.MonkeyPatch
) -> Callable[[Driver], int]:
    """Put second parties in the place of robots; gives what counts what goes on there."""
    links: list[FakeLink] = []

    def make_link(_: object) -> FakeLink:
        links.append(FakeLink())
        return links[-1]

    for one in (Ros2Driver, RosbridgeDriver):
        monkeypatch.setattr(one, "make_link", make_link)
    monkeypatch.setattr(SpeechDriver, "sound", lambda _: Pipes())
    monkeypatch.setattr(SpeechDriver, "_load", load)
    module, moves = fake_qi()
    monkeypatch.setitem(sys.modules, "qi", module)

    def count(driver: Driver) -> int:
        if isinstance(driver, SimDriver):
            return len(driver.body.efforts) + (driver.world.drive != (0.0, 0.0))
        if isinstance(driver, ConsoleDriver):
            return len(driver._saying)
        assert isinstance(driver, TaskDriver)
        there: list[Any] = []
        if kind in ("reachy", "naoqi"):
            there = [*reachy.running, *moves]
        return len(driver._tasks) + len(there) + sum(len(link.going) for link in links)

    return count


def disturb(cause: str, driver: Driver) -> None:
    """Let something go wrong while the driver does something."""
    if cause == "emergency stop":
        driver.tell(Emergency(True))
    elif cause == "lost link":
        driver.lose("the link is gone")
    elif cause.startswith("SIG"):
        signal.raise_signal(getattr(signal, cause))
    elif cause == "internal error":
        driver.tell(Emergency(True))  # something of which an instant is made
    else:
        assert cause == "watchdog", "its limit is up by itself"


@pytest.mark.parametrize("cause", CAUSES)
@pytest.mark.parametrize("kind", DRIVERS)
def test_whatever_happens_the_robot_is_made_safe(
    kind: str, cause: str, going: Callable[[Driver], int], reachy: FakeReachy, tmp_path: Path
) -> None:
    limits = 'progress="300ms" cancel="300ms"' if cause == "watchdog" else 'progress="60s"'
    address = f'address="127.0.0.1:{reachy.port}"' if kind == "reachy" else ""
    inside = f'<driver kind="{kind}" {address} {limits} heartbeat="60s">{DRIVERS[kind]}</driver>'
    does = f"<speak>{LONG}</speak>" if kind in SPEAK else '<turn angle="150"/>'
    (tmp_path / "robot.xml").write_text(ROBOT.format(inside))
    (tmp_path / "works.xml").write_text(APPLICATION.format(does))
    chosen = Chosen(str(tmp_path / "robot.xml"), fas=(str(tmp_path / "works.xml"),))
    visit = begin(chosen, LiveSettings(), None)
    (driver,) = visit.loop.devices.drivers  # type: ignore[attr-defined]
    seen: dict[str, Any] = {"safe": 0, "went on": False, "left": None}
    safe, cancel = driver.safe, driver.cancel

    async def made_safe() -> None:
        seen["safe"] += 1
        driver.cancel = cancel
        await safe()

    driver.safe = made_safe
    if cause == "watchdog":
        driver.cancel = lambda _: None  # the device does not stop

    async def play() -> None:
        try:
            async with asyncio.timeout(LONG_S):
                while not going(driver):
                    await asyncio.sleep(0.02)
                seen["went on"] = True
                disturb(cause, driver)
                while not seen["safe"] or going(driver):
                    await asyncio.sleep(0.02)
                seen["left"] = going(driver)
        finally:
            visit.stop()

    def sink(records: list[Record]) -> None:
        if records[0]["phase"] == "run":
            tasks.append(asyncio.ensure_future(play()))
        if cause == "internal error" and seen["went on"]:
            raise ZeroDivisionError("inside")

    tasks: list[asyncio.Future[None]] = []
    if cause == "internal error":
        with pytest.raises(ZeroDivisionError):
            visit.run(sink, lambda _: None)
    else:
        visit.run(sink, lambda _: None)
    assert seen["went on"], "the driver has done something"
    assert seen["safe"], "and was made safe"
    assert not going(driver), "so that nothing goes on"
    if not (cause.startswith("SIG") or cause == "internal error"):
        assert seen["left"] == 0, "during the run already"


def test_the_simulated_robot_stops_everything(tmp_path: Path) -> None:
    profile = read_robot("r.xml", ROBOT.format('<driver kind="sim"/>').encode())
    told: list[Any] = []

    async def play() -> None:
        driver = SimDriver(profile.drivers[0], profile, Map("nowhere"))
        await driver.safe()  # before it is opened, too
        driver.attach(told.append)
        await driver.open()
        said = Command("speak", {}, LONG, lang="en")
        driver.start(Begin("say", SAY, said, frozenset({"speaker"}), spoken=9000))
        bow = Command("gesture", {"name": "bow"})
        driver.start(Begin("bow", "gesture", bow, frozenset({"arm"})))
        turn = Command("turn", {"angle": 150.0})
        driver.start(Begin("turn", "turn", turn, frozenset({"locomotion"})))
        driver.sample(100)
        assert len(driver.body.efforts) == 3
        await driver.safe()
        driver.sample(20_000)
        assert not driver.body.efforts
        assert driver.world.drive == (0.0, 0.0)

    asyncio.run(play())
    names = [type(one).__name__ for one in told]
    assert (names.count("Stopped"), names.count("Done")) == (3, 0)


@pytest.mark.parametrize("late", [300, 700, 5000])
def test_a_late_run_leaves_the_simulated_robot_its_aim(late: int) -> None:
    """Instants that come late, as on a busy machine, once let it turn to and fro for ever."""
    profile = read_robot("r.xml", ROBOT.format('<driver kind="sim"/>').encode())
    told: list[Any] = []

    async def play() -> None:
        driver = SimDriver(profile.drivers[0], profile, Map("nowhere"))
        driver.attach(told.append)
        await driver.open()
        turn = Command("turn", {"angle": 90.0})
        driver.start(Begin("turn", "turn", turn, frozenset({"locomotion"})))
        for now in range(late, 10_001, late):
            driver.sample(now)
        assert driver.world.heading == pytest.approx(90.0, abs=2.0)

    asyncio.run(play())
    assert [type(one).__name__ for one in told].count("Done") == 1
