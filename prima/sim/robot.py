"""The simulated robot: a conductor on a simulated body, which confirms everything at once."""

from __future__ import annotations

from prima.devices.conductor import Conductor
from prima.devices.goals import Report
from prima.devices.profile import Profile
from prima.messages import Data, Inbound, Occurred, Order
from prima.messages.times import earliest
from prima.sim.body import Body
from prima.sim.routes import Routes
from prima.sim.world import World

SEES = "human-detection"
"""The device that recognises people in the camera's view."""


class Robot:
    """Takes the mediator's orders, and returns inbound values."""

    def __init__(
        self, profile: Profile, world: World, routes: Routes, exclusive: bool = True
    ) -> None:
        self.profile = profile
        self.world = world
        self.body = Body(profile, world, routes)
        self.conductor = Conductor(profile, world.pose, exclusive=exclusive)
        self.ear = self.conductor.ear
        self._reached: list[Occurred] = []
        """The events of corners that the body has come near at this instant."""

    def due(self) -> int | None:
        """When the next report is due (ms), if known."""
        return earliest(self.body.due(), self.conductor.due(self.world.sees_person()))

    def order(self, now: int, order: Order) -> None:
        """Carry out an order of the mediator."""
        self.conductor.order(now, order)
        if order.devices & self.body.broken.keys():
            self.ear.deafen(order.behavior)
        self._carry_out(now)

    def _carry_out(self, now: int) -> None:
        """Let the body carry out the conductor's calls until there are no more reports."""
        while calls := self.conductor.drain():
            for call in calls:
                self._report(now, self.body.take(now, call))

    def _report(self, now: int, reports: list[Report]) -> None:
        for report in reports:
            self.conductor.report(now, report)

    def get_on(self, now: int) -> bool:
        """Advance the body to ``now``; whether anything but motion resulted.

        This covers the effects of motion; :meth:`due` covers those of time.
        """
        reports = self.body.collect(now)
        if reports:
            self._report(now, reports)
            self._carry_out(now)
        self._reached = self.body.corners()
        if reports or self._reached or self.body.arrived:
            return True
        return self.conductor.sight.heeds(self.world.sees_person())

    def collect(self, now: int) -> list[Inbound]:
        """Everything that the devices report at ``now``, once the body has been advanced."""
        visible = self.world.sees_person()
        where = self.body.locomotion.whereabouts() if visible else {}
        reports = self.conductor.collect(now, visible, where)
        self._carry_out(now)
        return [*reports, *self._reached]

    def settle(self, now: int) -> None:
        """Note that all orders of an instant have been given."""
        self.conductor.end_loops()
        self._carry_out(now)

    def sense(self, values: Data) -> list[Inbound]:
        """The sensor values that have changed: the body's, and those of the surroundings."""
        return self.conductor.sensors.take({**self.body.sensors.measure(), **values})

    # What happens to it ---------------------------------------------------------------

    def broke(self, now: int, device: str, hangs: bool) -> list[Inbound]:
        """A device fails, with what runs on it (E1); or it hangs and no longer reports."""
        self._report(now, self.body.broke(device, hangs))
        self.world.blind = self.world.blind or device == SEES
        if hangs:
            for task in self.conductor.tasks.values():
                question = self.ear.questions.get(task.id)
                spoken = device == "speaker" and question is not None and question.listens
                if device in task.order.devices and not spoken:
                    self.ear.deafen(task.id)
        reports = self.conductor.failures()
        self._carry_out(now)
        return reports

    def repair(self, device: str) -> None:
        """A device works again."""
        self.body.broken.pop(device, None)
        if device == SEES:
            self.world.blind, self.conductor.sight.again = False, True

    @property
    def deaf(self) -> bool:
        """Whether the recogniser is broken, or was as the current question needed it."""
        return self.ear.deaf or "speech-recognition" in self.body.broken

    def speech_begins(self, now: int) -> None:
        """The user begins to speak."""
        self.conductor.speech_begins(now)
        self._carry_out(now)
