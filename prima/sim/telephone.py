"""The telephone of a scenario: the outcome of calls to which applications transfer the user."""

from __future__ import annotations

from bisect import insort
from collections.abc import Iterable
from operator import itemgetter

from prima.messages import Inbound, Order, Transferred
from prima.sim.happenings import AT_ONCE, UNANSWERED, CallTransfer

ANSWERED = "answered"
NOBODY = CallTransfer("", "noanswer", AT_ONCE, AT_ONCE)
"""The default course of a bridged call."""
GIVEN_AWAY = CallTransfer("", "unknown", AT_ONCE, AT_ONCE)
"""The default course of other calls: somebody answers, and the user is gone."""


class Telephone:
    """Puts calls through as the scenario says, and reports what becomes of them."""

    def __init__(self, transfers: Iterable[CallTransfer] = (), seed: int = 1) -> None:
        self._seed = seed
        self._transfers = list(transfers)
        self._made: dict[str, int] = {}
        self._pending: list[tuple[int, Transferred]] = []
        """Reports to come, with their times, by time."""

    def order(self, now: int, order: Order) -> None:
        """Make a call, or end one."""
        if order.data["transfer"] == "over":
            self._hang_up(order.app, order.data["call"])
            return
        uri, kind = str(order.data["to"]), order.data["transfer"]
        call = self._of(uri) or (NOBODY if kind == "bridge" else GIVEN_AWAY)
        first, then = call.outcome, ""
        if call.outcome not in UNANSWERED and not call.outcome.startswith("error."):
            first, then = ANSWERED, call.outcome
        made = self._made.get(call.to, 1)
        begins = now + max(call.after.ms(self._seed, made), 1)
        self._later(begins, Transferred(order.app, order.serial, uri, first))
        if then and kind == "bridge":
            ends = begins + max(call.lasts.ms(self._seed, made), 1)
            self._later(ends, Transferred(order.app, order.serial, uri, then))

    def _of(self, uri: str) -> CallTransfer | None:
        """How the next call to a destination goes: the longest matching prefix wins, in order."""
        fitting = [one for one in self._transfers if uri.startswith(one.to)]
        if not fitting:
            return None
        longest = max(len(one.to) for one in fitting)
        ways = [one for one in fitting if len(one.to) == longest]
        made = self._made[ways[0].to] = self._made.get(ways[0].to, 0) + 1
        return ways[min(made, len(ways)) - 1]

    def _hang_up(self, app: str, serial: int) -> None:
        """Drop a call, with its pending reports."""
        self._pending = [
            one for one in self._pending if (one[1].app, one[1].serial) != (app, serial)
        ]

    def _later(self, time: int, value: Transferred) -> None:
        insort(self._pending, (time, value), key=itemgetter(0))

    def due(self) -> int | None:
        """When the next report on a call is due, if ever."""
        return self._pending[0][0] if self._pending else None

    def collect(self, now: int) -> list[Inbound]:
        """The reports on calls at ``now``."""
        arrived: list[Inbound] = []
        while self._pending and self._pending[0][0] <= now:
            arrived.append(self._pending.pop(0)[1])
        return arrived
