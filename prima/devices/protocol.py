"""The one interface between a session and whatever carries its orders out."""

from __future__ import annotations

from typing import Protocol

from prima.messages import Inbound, Order, Record


def earliest(*times: int | None) -> int | None:
    """The first of some times (ms), None left out; None if there is no other."""
    first: int | None = None
    for time in times:
        if time is not None and (first is None or time < first):
            first = time
    return first


class Devices(Protocol):
    """A robot with its surroundings, simulated or real. Times are ms from the run's start.

    :class:`prima.devices.loop.Loop` drives it: when an instant is due, it collects what has
    come in, hands it to the session, and gives the session's orders back, one at a time.
    """

    def due(self) -> int | None:
        """The next instant at which something is to be collected; None if none is known.

        It is asked before each :meth:`collect`.
        """

    def collect(self, now: int) -> list[Inbound]:
        """Everything that has come in by ``now``, in order."""

    def order(self, now: int, order: Order) -> None:
        """Carry out an order of the mediator, or send what an application sends."""

    def observe(self, now: int, records: list[Record]) -> None:
        """See what the session made of an instant, after its last order."""

    @property
    def awaits(self) -> bool:
        """Whether an application is still to be loaded: the run is not over without it."""
