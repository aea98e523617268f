"""The services of a scenario: they answer after a while, or fail."""

from __future__ import annotations

from prima.messages import Inbound, Occurred, Order
from prima.sim.scenario import Reply


class Services:
    """Answers what applications send; one that the scenario does not name does not answer."""

    def __init__(self, replies: dict[str, list[Reply]]) -> None:
        self._replies = replies
        self._asked: dict[str, int] = {}
        self._pending: list[tuple[int, int, Occurred]] = []
        self._serial = 0

    def order(self, now: int, order: Order) -> None:
        """Take a message to a service."""
        name = order.data["to"]
        replies = self._replies.get(name)
        if replies is None:
            reply = Reply(1, error=f'there is no service "{name}"')
        elif not replies:
            return  # it takes what it is sent and says nothing
        else:
            reply = replies[min(self._asked.get(name, 0), len(replies) - 1)]
        self._asked[name] = self._asked.get(name, 0) + 1
        if reply.error:
            data = {"service": name, "message": reply.error}
            event = Occurred(f"error.service.{name}", "environment", data, order.app)
        else:
            event = Occurred(f"reply.{name}", "environment", dict(reply.data), order.app)
        self._serial += 1
        self._pending.append((now + reply.after, self._serial, event))

    def due(self) -> int | None:
        """When the next answer arrives, if any is under way."""
        return min((pending[0] for pending in self._pending), default=None)

    def collect(self, now: int) -> list[Inbound]:
        """The answers that arrive at ``now``."""
        arrived = sorted(
            (pending for pending in self._pending if pending[0] <= now), key=lambda p: p[:2]
        )
        self._pending = [pending for pending in self._pending if pending[0] > now]
        return [event for _, _, event in arrived]
