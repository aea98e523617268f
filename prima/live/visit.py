"""A live run from its documents to its end, as for ``prima live``."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import partial

from prima.devices.loop import Loop
from prima.devices.profile import Profile
from prima.devices.settings import DriverSettings
from prima.errors import UsageError
from prima.live.carried import uncarried
from prima.live.chosen import Chosen
from prima.live.clock import Clock
from prima.live.deadlines import run
from prima.live.devices import LiveDevices
from prima.live.driver import Driver, why
from prima.live.drivers import driver_class, drivers_in
from prima.live.journal import Journal
from prima.live.recordings import Recordings
from prima.live.redaction import Redactor
from prima.live.services import LiveServices
from prima.live.shell import LATE_MS, Shell
from prima.live.signals import handling_signals, heeding_signals
from prima.live.threads import call_in
from prima.loading import Loaded
from prima.loading.heads import chosen_policy, run_record
from prima.loading.reading import STAGE
from prima.messages import Record
from prima.scheduler.policy import Policy
from prima.sim.devices import sensors_watched, watches
from prima.sim.entrances import Entrances
from prima.sim.map import Map
from prima.sim.rehearsal import Rehearsal, make_session
from prima.sim.services import Web
from prima.transcript.record import LONGEST

FOREVER_MS = round(LONGEST * 1000)
"""How long a run may last on a robot: only its applications or people end it."""
Sink = Callable[[list[Record]], object]


@dataclass(slots=True)
class LiveSettings:
    """The options of a live run."""

    policy: str | None = None
    bound: int | None = None
    patience: int | None = None
    isolate: str = "ea"
    speed: float = 1.0
    until: int | None = None
    """Its latest end (ms)."""
    sync: bool = False
    """Whether each instant is flushed to the disk before it is carried out."""
    late: int | None = LATE_MS
    """How late (ms) an instant may be before that is reported."""
    redact: bool = False
    """Whether what users say is left out of journal and rows."""
    drivers: tuple[str, ...] = ()
    """Python files that define drivers."""
    web: Web | None = None


@dataclass(slots=True)
class Visit:
    """A live run that is ready to go."""

    loop: Loop
    clock: Clock
    settings: LiveSettings
    head: Record
    loaded: Loaded
    journal: Journal | None = None
    missed: list[Record] = field(default_factory=list)
    """Records missing from the last instant of a broken journal; empty for a new run."""
    stopped: bool = False
    """Whether it was ended from outside."""
    before: list[Record] = field(default_factory=list)
    """The records that the journal of a resumed run already has, times in s; empty for a new run."""
    _stop: Callable[[], object] = lambda: None

    def stop(self) -> None:
        """End it as soon as possible, from any thread: the robot is made safe."""
        self.stopped = True
        self._stop()

    def run(self, sink: Sink, warn: Callable[[str], None]) -> None:
        """Carry it out to its end.

        Args:
            sink: called with the records of each instant, times in ms, before it is carried out.
            warn: called with messages for the operator.

        Raises:
            Unreachable: a robot cannot be reached.
            RunError: the journal cannot be written.
        """

        redactor = Redactor(self.loop.session.listening) if self.settings.redact else None

        def keep(records: list[Record]) -> None:
            if redactor is not None:
                records = redactor(records)
            if self.journal is not None:
                self.journal.write(records)
            sink(records)

        self.loop.journal = keep
        try:
            run(self._run(warn))
        except KeyboardInterrupt as error:  # a driver blocked the run
            self.stopped = True
            warn(str(error) or "The run was broken off.")
        finally:
            self.loop.session.close()
            if redactor is not None:
                failures = self.loop.session.failures
                failures[:] = [str(redactor.without(one)) for one in failures]
            if self.journal is not None:
                self.journal.close()

    def run_anywhere(self, sink: Sink, warn: Callable[[str], None]) -> None:
        """The same in a thread, which also works inside a running event loop, such as a notebook's.

        Raises:
            KeyboardInterrupt: signals came again before the run had ended.
        """
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            self.run(sink, warn)
            return

        def hear(*_: object) -> None:
            if self.stopped:  # only further signals leave a thread that a driver blocks
                raise KeyboardInterrupt
            self.stop()

        # The first must not interrupt the start of the thread: nobody could stop it any more.
        with handling_signals(hear), ThreadPoolExecutor(1, "live") as pool:
            pool.submit(self.run, sink, warn).result()

    async def _run(self, warn: Callable[[str], None]) -> None:
        shell = Shell(self.loop, self.clock, warn, self.settings.late)
        self._stop = partial(call_in, asyncio.get_running_loop(), shell.stop)
        with heeding_signals(self.stop):
            if self.stopped:
                return
            try:
                # Not before: once there is a journal, a signal has to end the run as it should.
                self.loop.journal(self.missed if self.before else [self.head])
                await shell.run()
            finally:
                if not (shell.opened or self.before) and self.journal is not None:
                    self.journal.discard()  # nothing has happened: the command can be repeated


def begin(chosen: Chosen, settings: LiveSettings, output: str | None) -> Visit:
    """Prepare a new run.

    Raises:
        DocumentError: documents are wrong.
        UsageError: there is no such driver, policy or file; or there is a journal already.
    """
    loaded = chosen.loaded()
    cast = loaded.cast
    loaded.files.pop(STAGE, None)
    simulated = bool(chosen.scenario)
    if not simulated:
        now = datetime.now(UTC).replace(tzinfo=None)
        cast.scenario.date = now.isoformat(timespec="seconds")
    name = settings.policy or cast.scenario.policy
    policy = chosen_policy(name, loaded)
    if simulated:
        loop = in_simulation(loaded, policy, settings)
    else:
        loop = on_robot(loaded, policy, settings, chosen.answering(settings.web))
        assert isinstance(loop.devices, LiveDevices)
        loaded.problems += uncarried(cast.robot, loop.devices.drivers, cast.documents)
    if settings.until is not None:
        loop.until = settings.until
    recorded = chosen.recorded(os.path.dirname(output or ""))
    patience = cast.scenario.patience if settings.patience is None else settings.patience
    head = run_record(loaded, name, settings.bound, patience, {"live": recorded})
    journal = Journal(output, settings.sync) if output is not None else None
    record_beside(loop, journal, settings)
    return Visit(loop, Clock(settings.speed), settings, head, loaded, journal)


def in_simulation(loaded: Loaded, policy: Policy, settings: LiveSettings) -> Loop:
    """A scenario, run as in a rehearsal but by the clock."""
    given = settings.bound, settings.web, settings.isolate, settings.patience
    return Rehearsal(loaded.cast, policy, *given)


def on_robot(
    loaded: Loaded, policy: Policy, settings: LiveSettings, services: LiveServices, start: int = -1
) -> Loop:
    """A run on the robot's drivers."""
    cast = loaded.cast
    drivers = make_drivers(cast.robot, cast.world, settings.drivers)
    own = [doc.id for doc in cast.documents[: len(cast.scenario.applications)]]
    devices = LiveDevices(
        cast.robot,
        drivers,
        services,
        own,
        Entrances(cast.offers),
        watches(cast.documents),
        sensors_watched(cast.documents),
        policy.exclusive,
        start,
    )
    services.run = devices
    session = make_session(cast, policy, settings.bound, settings.isolate, settings.patience)
    devices.listening = session.listening
    return Loop(session, devices, FOREVER_MS, bounded=False)


def record_beside(loop: Loop, journal: Journal | None, settings: LiveSettings) -> None:
    """Let drivers store recordings beside the journal, if they are to be kept."""
    kept = journal is not None and not settings.redact and os.path.isfile(journal.path)
    recordings = Recordings(journal.path if journal is not None and kept else None)
    if isinstance(loop.devices, LiveDevices):
        for driver in loop.devices.drivers:
            driver.recordings = recordings


def make_drivers(robot: Profile, site: Map, files: Iterable[str]) -> list[Driver]:
    """The drivers of a robot's document.

    Raises:
        UsageError: the document has no driver, or an unknown one.
    """
    if not robot.drivers:
        hint = 'Write <driver kind="..."/> in it, as docs/live.md shows.'
        raise UsageError(f"{robot.place}: The robot {robot.id} has no driver. {hint}")
    defined = [found for file in files for found in drivers_in(file)]
    made = []
    for settings in robot.drivers:
        try:
            kind = driver_class(settings.kind, defined)
        except UsageError as error:
            raise UsageError(f"{settings.place}: {error}") from None
        try:
            made.append(_make(kind, settings, robot, site))
        except UsageError:
            raise
        except (Exception, SystemExit) as error:
            reason = f"the driver has failed: {why(error)}"
            raise UsageError(f"{settings.place}: {settings.kind}: {reason}") from error
    return made


def _make(kind: type[Driver], settings: DriverSettings, robot: Profile, site: Map) -> Driver:
    made = kind(settings, robot, site)
    if getattr(made, "settings", None) is not settings:
        raise UsageError(
            f"{settings.place}: {settings.kind}: Its __init__ leaves out that of its class. "
            "Write super().__init__(settings, profile, site) in it, or connect in open instead."
        )
    return made
