"""The loop between a session and its devices: for virtual time, real time and ``prima talk``.

It has no clock. Its caller jumps to the next due time, or waits until then.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Protocol

from prima.interpreter.bounds import ElementVisit
from prima.messages import Inbound, Order, Record
from prima.messages.times import earliest
from prima.session import Session

MAX_RECORDS = 500_000
"""Maximum number of records of a run."""
MAX_WRITTEN = 50_000_000
"""Maximum number of characters that the applications of a run say, log and send."""


class Devices(Protocol):
    """A robot with its surroundings, simulated or real. Times are ms from the run's start.

    :class:`Loop` drives it: when an instant is due, it collects the inbound values, passes them
    to the session, and passes back the session's orders, one at a time.
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


class Loop:
    """One run: a session on its devices, instant by instant. Times are ms from its start."""

    def __init__(
        self, session: Session, devices: Devices, until: int, bounded: bool = True
    ) -> None:
        self.session = session
        self.devices = devices
        self.until = until
        """When the run ends at the latest."""
        self.bounded = bounded
        """Whether the number of records is limited; those of a live run need not be kept."""
        self.journal: Callable[[list[Record]], object] = lambda _: None
        """Called with the records of an instant before its orders are carried out."""
        self.now = 0
        """The latest instant carried out."""
        self.outcome = ""
        """Why the run ended: ``over``, ``quiet``, ``until`` or ``limit``."""
        self.visits: list[ElementVisit] = []
        """The elements reached in the latest instant with a decision."""
        self._made = 0
        self._deadline = session.deadline()
        """When the session has to be stepped even if nothing happens; only a step changes this."""
        self._ended = session.over
        """Whether the session is over; only a step changes this, too."""
        self._full = False
        """Whether the run has reached a limit."""

    def go_on(self, now: int) -> None:
        """Continue with a session that has already been brought to this time."""
        self.now, self._deadline, self._ended = now, self.session.deadline(), self.session.over

    def run(self) -> Iterator[list[Record]]:
        """Run to the end, yielding the records of each instant as they are made."""
        while (records := self.advance(self.until)) is not None:
            yield records
        yield self.finish(self.until)

    def advance(self, until: int) -> list[Record] | None:
        """Carry out the instants up to a time, to the first at which more than bodies moves.

        Returns:
            Its records, or None if there is no such instant: nothing else is due by then, or
            ``outcome`` says why the run has ended.
        """
        if self.over and not self.outcome:
            self.outcome = "over"
        while not self.outcome and (due := self.due()) is not None and due <= until:
            if self._full:
                self.outcome = "limit"
                break
            if due > self.now:
                self.now = due
            inbound = self.devices.collect(self.now)
            if inbound or (self._deadline is not None and self.now >= self._deadline):
                return self._decide(self.now, inbound)
        return None

    def finish(self, until: int) -> list[Record]:
        """End the run at a time by which nothing else is due; returns its last records."""
        due = None if self.outcome else self.due()
        if not self.outcome:
            self.outcome = "quiet" if due is None else "until"
        if self.outcome == "until":
            self.now = until
        self.session.recorder.now = self.now
        self.session.recorder.add("over", "mediator", outcome=self.outcome)
        self.visits = self.session.drain_visits()
        self.session.close()
        records = self.session.drain()
        self.journal(records)
        return records

    @property
    def over(self) -> bool:
        """Whether the session is over and no application is yet to be loaded."""
        return self._ended and not self.devices.awaits

    def due(self) -> int | None:
        """When the next instant is due, if ever."""
        return earliest(self.devices.due(), self._deadline)

    def _decide(self, now: int, inbound: list[Inbound]) -> list[Record]:
        """Let the session process what has come in, and the devices carry out its orders."""
        session = self.session
        orders = session.step(now, inbound)
        records, self.visits = session.drain(), session.drain_visits()
        self.journal(records)
        for order in orders:
            self.devices.order(now, order)
        self._deadline, self._ended = session.deadline(), session.over
        if self.bounded:
            self._made += len(records)
            self._full = self._made > MAX_RECORDS or session.written > MAX_WRITTEN
        self.devices.observe(now, records)
        return records
