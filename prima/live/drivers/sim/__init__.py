"""The simulated robot as a driver: a body in the site's map, with the user in front of it."""

from __future__ import annotations

import math

from prima.devices.goals import (
    LISTEN,
    RECORD,
    Accepted,
    Again,
    At,
    Begin,
    Cancel,
    Report,
    Sees,
    Stand,
    Stopped,
)
from prima.devices.profile import Profile
from prima.devices.settings import DriverSettings
from prima.errors import UsageError
from prima.language.values import BadValue, read_value
from prima.live.driver import Driver
from prima.messages import Sensed
from prima.messages.times import earliest
from prima.sim.body import Body
from prima.sim.map import Map
from prima.sim.routes import Routes
from prima.sim.world import STEP_MS, World


class SimDriver(Driver):
    """A body in the site's map, which moves by the run's clock.

    It begins at the map's first place, or at ``option`` ``at``, with a user a metre in front of
    it unless ``user`` is ``false``. ``stopping`` is how long (as ``20ms``) a goal takes to stop.
    """

    kind = "sim"

    def __init__(self, settings: DriverSettings, profile: Profile, site: Map) -> None:
        super().__init__(settings, profile, site)
        self._later: list[tuple[int, Report]] = []
        self._at: At | None = None
        self._sees = Sees(False)
        self._stand_at("")

    async def open(self) -> None:
        """Put the robot on the map, where it was if it was there before.

        Raises:
            UsageError: an option is wrong.
        """
        options, site = self.settings.options, self.site
        self.settings.check_options("at", "stopping", "user")
        user = self.settings.choice("user", "true", "false")
        at = options.get("at", next(iter(site.places), ""))
        if at not in site.places and at:
            raise UsageError(f'{self.settings.place}: the map has no place "{at}".')
        try:
            self._stopping = int(read_value("duration", options.get("stopping", "0s")) or 0)
        except BadValue:
            message = f"{self.settings.place}: stopping is not a duration. Write it as 20ms."
            raise UsageError(message) from None
        self._stand_at(at)
        heading, (x, y) = self.world.heading, self.world.position
        if user == "true":
            angle = math.radians(heading)
            self.world.put("user", (x + math.cos(angle), y + math.sin(angle)))
        self._later, self._at, self._sees = [], None, Sees(False)

    def _stand_at(self, place: str) -> None:
        """Make an idle body."""
        site = self.site
        point = site.places.get(place, (0.0, 0.0))
        self.world = World(site, self.profile, point, site.headings.get(place, 0.0))
        self.world.time = self.now()
        self.body = Body(self.profile, self.world, Routes(site))

    def start(self, goal: Begin) -> None:
        """Begin a goal at the latest instant."""
        self.tell(Accepted(goal.key))
        if goal.kind not in (LISTEN, RECORD):
            self._report(self.body.take(self.world.time, goal))

    def cancel(self, key: str) -> None:
        """End a goal, at once or after the time that stopping takes."""
        reports = self.body.take(self.world.time, Cancel(key)) or [Stopped(key)]
        if self._stopping:
            self._later += [(self.now() + self._stopping, one) for one in reports]
        else:
            self._report(reports)

    def again(self, key: str) -> None:
        """The wheels stay with a goal that makes another loop."""
        if key in self.body.efforts:
            self.body.take(self.world.time, Again(key))

    def stand(self) -> None:
        """Stop the wheels."""
        self.body.take(self.world.time, Stand())

    async def safe(self) -> None:
        """Stop everything: wheels, arm, neck, and what is being said."""
        for key in list(self.body.efforts):
            self.cancel(key)
        self.body.locomotion.stand()

    def due(self) -> int | None:
        """When the body next has something to report."""
        moves = self.world.moves() or self.body.moves_on
        moved = self.world.time + STEP_MS if moves else None
        return earliest(self.body.due(), moved, *(when for when, _ in self._later))

    def sample(self, now: int) -> None:
        """Advance the body, and report the results.

        If the run is late, the body has kept steering: it has a controller of its own.
        """
        while self.world.time < (then := self.due() or now) < now:
            self._get_on(then)
        self._get_on(now)

    def _get_on(self, now: int) -> None:
        self.world.advance(now)
        ready = [report for when, report in self._later if when <= now]
        self._later = [one for one in self._later if one[0] > now]
        self._report(ready + self.body.collect(now))
        self._look()
        for event in self.body.corners():
            self.tell(event)
        if values := self.body.sensors.measure():
            self.tell(Sensed(values))

    def _look(self) -> None:
        """Report where the robot is and whether it sees the user, if that has changed."""
        at = At(*self.world.position, self.world.heading)
        visible = self.world.sees_person()
        sees = Sees(visible, **self.body.locomotion.whereabouts()) if visible else Sees(False)
        if at != self._at:
            self._at = at
            self.tell(at)
        if sees != self._sees:
            self._sees = sees
            self.tell(sees)

    def _report(self, reports: list[Report]) -> None:
        for report in reports:
            self.tell(report)


DRIVER = SimDriver
