"""The interface between a session and whatever carries out its orders."""

from __future__ import annotations

from typing import Protocol

from prima.messages import Inbound, Order, Record


class Devices(Protocol):
    """A robot with its surroundings, simulated or real. Times are ms from the run's start.

    :class:`prima.devices.loop.Loop` drives it: when an instant is due, it collects the inbound
    values, passes them to the session, and passes back the session's orders, one at a time.
    """

    def due(self) -> int | None:
        """When there is next something to collect; None if unknown.

        It is called before each :meth:`collect`.
        """

    def collect(self, now: int) -> list[Inbound]:
        """Everything that has come in by ``now``, in order."""

    def order(self, now: int, order: Order) -> None:
        """Carry out an order of the mediator, or send what an application sends."""

    def observe(self, now: int, records: list[Record]) -> None:
        """Observe the records of an instant, after its last order."""

    @property
    def awaits(self) -> bool:
        """Whether an application is yet to be loaded: until then the run is not over."""
