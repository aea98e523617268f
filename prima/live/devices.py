"""A real robot as the devices of a run: the conductor, drivers, services and places.

It has no clock of its own and starts no tasks: the shell provides both.
"""

from __future__ import annotations

from collections.abc import Callable, Coroutine, Sequence
from functools import partial
from typing import Any, Protocol, TypeVar

from prima.devices.conductor import Conductor
from prima.devices.goals import (
    RECORD,
    Accepted,
    Again,
    At,
    Back,
    Begin,
    Broke,
    Call,
    Cancel,
    Done,
    Lost,
    News,
    Progress,
    Report,
    Safe,
    Sees,
    Speaks,
    Stand,
    Stopped,
)
from prima.devices.profile import Profile
from prima.grammar.answers import Answers
from prima.live.carried import lacking, limits_of, own_copy, route
from prima.live.deadlines import unescaped, within
from prima.live.driver import Driver, due_of, why
from prima.live.journal import KnownAtCut
from prima.live.speaking import UserSpeech
from prima.messages import ApplicationLoaded, Emergency, Heard, Inbound, Order, Record, Sensed
from prima.messages.times import earliest
from prima.sim.entrances import Entrances

T = TypeVar("T")
MOST_NEWS = 10_000
"""How many reports drivers may make in one turn; a driver that exceeds this is given up."""
EAR = "speech-recognition"
SAFE_S = 5.0
"""How long a driver may take to stop everything."""


class Answering(Protocol):
    """Answers the messages that applications send."""

    def due(self) -> int | None:
        """When an answer is to be collected (ms)."""

    def collect(self, now: int) -> list[Inbound]:
        """The answers that have arrived."""

    def order(self, now: int, order: Order) -> None:
        """Take a message."""


class LiveDevices:
    """The :class:`~prima.devices.loop.Devices` of a real robot. Times are ms of the run.

    Args:
        profile: the robot.
        drivers: its drivers, in the document's order.
        services: answers applications' messages.
        loads: the applications to be loaded at once, by their ids.
        entrances: the areas of the site that offer applications.
        watches: whether any application watches sensors.
        read: the sensors that they use; None if that cannot be determined.
        exclusive: whether a device does one thing at a time (every policy with a mediator).
        start: the instant after which the run begins or resumes.
    """

    def __init__(
        self,
        profile: Profile,
        drivers: Sequence[Driver],
        services: Answering,
        loads: Sequence[str],
        entrances: Entrances | None = None,
        watches: bool = True,
        read: frozenset[str] | None = None,
        exclusive: bool = True,
        start: int = -1,
    ) -> None:
        self.drivers = drivers
        self.services = services
        self.conductor = Conductor(
            profile,
            lambda: self._at.where if self._at else {},
            lambda goal: limits_of(drivers, goal, profile.voices),
            exclusive,
            max(start, 0),
        )
        self.now: Callable[[], int] = lambda: 0
        """The run's clock."""
        self.wake: Callable[[], None] = lambda: None
        """Makes the shell check at once what is due."""
        self.spawn: Callable[[Coroutine[Any, Any, None]], object] = lambda one: one.close()
        """Runs something in the background."""
        self.lost: Callable[[Driver, str], None] = lambda *_: None
        """Called with a driver that has lost its robot, and why."""
        self._watches = watches
        self.listening: Callable[[], Sequence[Answers]] = tuple
        """Returns what questions and links are listening for."""
        self._taken: Sequence[Answers] = ()
        """The answers for which the drivers last had to listen."""
        self._read = read
        self._loads = list(loads)
        self._entrances = entrances or Entrances([])
        self._routes: dict[str, Driver] = {}
        self._news: list[News | Inbound] = []
        self._told: int | None = None
        """Since when a report has been waiting."""
        self._last = start
        """The latest instant."""
        self._at: At | None = None
        self._sees = Sees(False)
        self._stopping = 0
        """How many drivers are being made safe."""
        self._failing: set[Driver] = set()
        """Drivers that have failed and are not called until they are back."""
        self._flooding: set[Driver] = set()
        """Drivers that have made too many reports in this turn."""
        self._speech = UserSpeech(self.conductor)
        self._carrying = False

    # The session's side ------------------------------------------------------------------

    @property
    def awaits(self) -> bool:
        """Whether an application is yet to be loaded."""
        return bool(self._loads) or bool(self._entrances.offers)

    def due(self) -> int | None:
        """When there is next something to collect, if known."""
        return earliest(
            self._last + 1 if self._loads or self._entrances.unseen else None,
            self._after(self._told),
            self.conductor.due(self._sees.visible),
            self._speech.too_long,
            self.services.due(),
            *(self._after(self._let(driver, partial(due_of, driver))) for driver in self.drivers),
        )

    def _after(self, time: int | None) -> int | None:
        """A time, at the earliest that after the latest instant: no instant comes twice."""
        return None if time is None else max(time, self._last + 1)

    def collect(self, now: int) -> list[Inbound]:
        """Everything that has come in by ``now``, in order."""
        self._last = now
        for driver in self.drivers:
            self._let(driver, partial(driver.sample, now))
        self._told = None
        inbound: list[Inbound] = [ApplicationLoaded(name) for name in self._loads]
        self._loads.clear()
        if self._at is not None:
            inbound += self._entrances.cross((self._at.x, self._at.y))
        inbound += self.conductor.collect(now, self._sees.visible, self._sees.where)
        self._carry_out()
        self._flooding.clear()
        news, self._news = self._news, []
        while news and not (self._stopping and _releases(news[0])):
            inbound += self._take(now, news.pop(0))
        self._news = news  # a release counts once everything has stopped
        inbound += [*self._speech.cut_off(now), *self.services.collect(now)]
        if not inbound:  # or else the session decides first whether the ear keeps listening
            self._speech.listen_on(now)
        return inbound

    def order(self, now: int, order: Order) -> None:
        """Pass an order to its recipient."""
        if order.verb == "send":
            self.services.order(now, order)
            return
        self.conductor.order(now, order)
        self._carry_out()

    def observe(self, now: int, records: list[Record]) -> None:
        """Note that all orders of an instant have been given: the ear keeps listening."""
        self.conductor.end_loops()
        self._carry_out()
        self._speech.listen_on(now)
        takes = self.listening()
        if [id(one) for one in takes] != [id(one) for one in self._taken]:
            self._taken = takes
            for driver in self.drivers:
                self._let(driver, partial(driver.hears, takes))
        for driver in self.drivers:
            self._let(driver, partial(driver.observe, now, records))

    def go_on(self, state: KnownAtCut, first: list[Inbound]) -> None:
        """Continue a run that was cut off.

        Args:
            state: its state at that time.
            first: values to report before anything else.
        """
        self._loads = [name for name in self._loads if name not in state.loaded]
        self._entrances.enter(state.inside)
        self.conductor.sight.restore(state.found)
        self.conductor.sensors.values.update(state.sensors)
        self._news += first
        self._told = self._last

    # The drivers' side -------------------------------------------------------------------

    def tell(self, driver: Driver, report: Report | News) -> None:
        """Take a driver's news; reports on goals reach the conductor at once."""
        now = self._now()
        if not isinstance(report, Accepted | Progress | Stopped) and self._told is None:
            self._told = now
        match report:
            case At():
                self._at = report
            case Sees():
                self._sees = report
            case _ if isinstance(report, Report):
                if isinstance(report, Lost):
                    self.lost(driver, report.reason)
                    if EAR in report.devices:  # it will not report the end of an utterance
                        self._news.append(Speaks(False))
                if isinstance(report, Back):
                    self._failing.discard(driver)
                if isinstance(report, Done | Stopped | Broke):
                    self._routes.pop(report.key, None)
                self.conductor.report(now, report)
                self._carry_out()
            case _ if len(self._news) < MOST_NEWS:
                self._news.append(report)
            case _:
                if driver not in self._flooding:
                    self._flooding.add(driver)
                    driver.lose(f"it reports more than {MOST_NEWS:,} things at once")
        self.wake()

    def _take(self, now: int, news: News | Inbound) -> list[Inbound]:
        """The inbound values that a driver's news amounts to."""
        match news:
            case Speaks(begins=True):
                self._speech.begins(now)
                self._carry_out()
                return []
            case Speaks():
                self._speech.ends()
                return []
            case Heard():
                return self._speech.heard(now, news)
            case Sensed():
                values = {name: value for name, value in news.values.items() if self._matters(name)}
                return self.conductor.sensors.take(values)
            case Emergency(pressed=True):
                self.make_safe()
                return [news]
            case At() | Sees():
                return []
            case _:
                return [news]

    def _matters(self, sensor: str) -> bool:
        """Whether a sensor's value matters; if no application uses it, only its first does."""
        read, known = self._read, self.conductor.sensors.values
        looks = read is None or sensor.partition(".")[0] in read
        return self._watches and (looks or sensor not in known)

    def _now(self) -> int:
        return max(self.now(), self._last)

    def make_safe(self) -> None:
        """Let every driver stop everything at once."""
        for driver in self.drivers:
            self._stopping += 1
            self.spawn(self._make_safe(driver))

    async def _make_safe(self, driver: Driver) -> None:
        try:
            await within(SAFE_S, driver.safe())
        except Exception as error:
            driver.lose(f"safe has failed: {why(error)}")
        finally:
            self._stopping -= 1
            if self._news and self._told is None:
                self._told = self._now()
            self.wake()

    def _let(self, driver: Driver, what: Callable[[], T]) -> T | None:
        """Call a driver; one that raises an error has lost its robot."""
        if driver in self._failing:
            return None
        try:
            return unescaped(what)
        except Exception as error:
            self._failing.add(driver)
            driver.lose(f"the driver has failed: {why(error)}")
            return None

    def _carry_out(self) -> None:
        """Let the drivers carry out the conductor's calls until there are no more."""
        if self._carrying:
            return
        self._carrying = True
        try:
            while calls := self.conductor.drain():
                for call in calls:
                    self._call(call)
        finally:
            self._carrying = False

    def _call(self, call: Call) -> None:
        match call:
            case Begin():
                self._begin(call)
            case Again() if driver := self._routes.get(call.key):
                self._let(driver, partial(driver.again, call.key))
            case Cancel() if driver := self._routes.get(call.key):
                self._let(driver, partial(driver.cancel, call.key))
            case Stand():
                for driver in self.drivers:
                    self._let(driver, driver.stand)
            case Safe():
                self.make_safe()

    def _begin(self, goal: Begin) -> None:
        driver = route(self.drivers, goal)
        now = self._now()
        if driver is None:
            reason, records = lacking(self.drivers, goal), goal.kind == RECORD
            self.conductor.report(now, Broke(goal.key, goal.device, reason, records))
            return
        self._routes[goal.key] = driver
        try:
            unescaped(partial(driver.start, own_copy(goal)))
        except Exception as error:
            reason = f"the driver {driver.kind} has failed: {why(error)}"
            self.conductor.report(now, Broke(goal.key, goal.device, reason))
            self._let(driver, partial(driver.cancel, goal.key))  # it may have begun


def _releases(news: News | Inbound) -> bool:
    """Whether the emergency stop is released."""
    return isinstance(news, Emergency) and not news.pressed
