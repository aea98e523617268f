"""The services of a scenario, which answer after a while or fail, and hosts that a run may ask."""

from __future__ import annotations

from bisect import insort
from collections.abc import Callable, Iterable
from html import escape
from operator import itemgetter
from typing import TYPE_CHECKING, Generic, TypeVar
from urllib.parse import urlsplit

from prima.language.values import shown
from prima.messages import SERVICE, Data, Fetched, Inbound, Occurred, Order
from prima.sim.happenings import Reply, Service

if TYPE_CHECKING:
    from prima.devices.endpoints import Endpoint

NO_ANSWER = "the host does not answer"
SILENCE = 10_000
"""Simulated milliseconds after which an application is notified that a host does not answer."""
Answering = Callable[[], Fetched | None]
"""Waits for the answer to a fetch, in real time; None if the host does not answer in time."""


Web = Callable[[str, str, str, Data], Answering]
"""Begins to fetch a URI for an application by a method with values; the answer's application
and serial are not yet set."""


Found = TypeVar("Found", Service, "Endpoint")


class Directory(Generic[Found]):
    """Services of a scenario or of a live run, each for one application or for all."""

    def __init__(self, services: Iterable[Found]) -> None:
        self._services: dict[tuple[str, str], Found] = {
            (one.name, one.application): one for one in services
        }
        self._names = {name for name, _ in self._services}

    def named(self, name: str, app: str) -> Found | None:
        """The service of a name that an application may use: its own, or that for all."""
        return self._services.get((name, app)) or self._services.get((name, ""))

    def of(self, uri: str, app: str) -> Found | None:
        """The service that a URI denotes: the one named, or the longest matching address."""
        if uri.startswith(SERVICE):
            return self.named(uri.removeprefix(SERVICE), app)
        below = [
            one
            for one in self._services.values()
            if one.uri and is_below(uri, one.uri) and one.application in ("", app)
        ]
        return max(below, key=lambda one: (len(one.uri), one.application), default=None)

    def for_order(self, order: Order) -> Found | None:
        """The service to which an order or a fetch is addressed."""
        find = self.of if "method" in order.data else self.named
        return find(str(order.data["to"]), order.app)

    def lacking(self, name: str) -> str:
        """Why an application gets no answer from a name."""
        name = name.removeprefix(SERVICE)
        if name in self._names:
            return f'the service "{name}" is another application\'s'
        return f'there is no service "{name}"'


class Services:
    """Answers what applications send or fetch; services that the scenario does not name fail."""

    def __init__(self, services: Iterable[Service], web: Web | None = None, seed: int = 1) -> None:
        self._seed = seed
        self._services = Directory(services)
        self._web = web
        self._asked: dict[tuple[str, str], int] = {}
        self._pending: list[tuple[int, Occurred | Fetched]] = []
        """Answers to come, with their times, by time."""
        self._begun: list[tuple[int, Order, Answering]] = []
        """Pending requests to hosts: since when, and what waits for the answer."""

    def order(self, now: int, order: Order) -> None:
        """Take a message to a service, or a fetch."""
        fetches = "method" in order.data
        service = self._services.for_order(order)
        if service is None and fetches:
            self._outside(now, order)
            return
        asked = 0
        if service is None:
            reply = Reply(error=self._services.lacking(order.data["to"]))
        elif not service.replies:
            return  # it accepts messages and does not reply
        else:
            which = service.name, service.application
            asked = self._asked.get(which, 0)
            reply = service.replies[min(asked, len(service.replies) - 1)]
            self._asked[which] = asked + 1
        after = max(reply.after.ms(self._seed, asked + 1), 1)
        self._later(now, after, fetched_of(order, reply) if fetches else event_of(order, reply))

    def _outside(self, now: int, order: Order) -> None:
        """A fetch that no service of the scenario answers: a host does, if it is allowed."""
        uri, data = order.data["to"], order.data
        if self._web is not None and not uri.startswith(SERVICE):
            asking = self._web(order.app, uri, data["method"], data["params"])
            self._begun.append((now, order, asking))
            return
        problem = not_allowed(uri)
        if uri.startswith(SERVICE):
            problem = self._services.lacking(uri)
        self._later(now, 1, Fetched(order.app, order.serial, uri, problem=problem))

    def _wait(self, now: int) -> None:
        """Wait, in real time, for what hosts were asked before this instant."""
        while self._begun and self._begun[0][0] < now:
            asked, order, asking = self._begun.pop(0)
            found, after = asking(), 1
            if found is None:
                found, after = Fetched("", 0, order.data["to"], problem=NO_ANSWER), SILENCE
            found.app, found.serial = order.app, order.serial
            self._later(asked, after, found)

    def _later(self, now: int, after: int, value: Occurred | Fetched) -> None:
        insort(self._pending, (now + after, value), key=itemgetter(0))

    @property
    def owed(self) -> set[str]:
        """The applications to which an answer is under way."""
        begun = {order.app for _, order, _ in self._begun}
        return begun | {value.app or "" for _, value in self._pending}

    def due(self) -> int | None:
        """When the next answer arrives, if any is under way."""
        pending = self._pending[0][0] if self._pending else None
        if not self._begun:
            return pending
        begun = self._begun[0][0] + 1
        return begun if pending is None else min(begun, pending)

    def collect(self, now: int) -> list[Inbound]:
        """The answers that arrive at ``now``."""
        self._wait(now)
        arrived: list[Inbound] = []
        while self._pending and self._pending[0][0] <= now:
            arrived.append(self._pending.pop(0)[1])
        return arrived


def is_below(uri: str, base: str) -> bool:
    """Whether a URI is an address or lies under it."""
    rest = uri.removeprefix(base)
    return uri.startswith(base) and (not rest or base.endswith("/") or rest[0] in "/?")


def event_of(order: Order, reply: Reply) -> Occurred:
    """A reply as an event for an application."""
    name = order.data["to"]
    if reply.error:
        data = {"service": name, "message": reply.error}
        return Occurred(f"error.service.{name}", "environment", data, order.app)
    return Occurred(f"reply.{name}", "environment", dict(reply.data), order.app)


def fetched_of(order: Order, reply: Reply) -> Fetched:
    """A reply as the answer to a fetch."""
    serial, uri = order.serial, order.data["to"]
    if reply.error:
        return Fetched(order.app, serial, uri, status=reply.status, problem=reply.error)
    return answer(order.app, serial, uri, reply.body or _xml(reply.data))


def answer(app: str, serial: int, uri: str, data: bytes) -> Fetched:
    """Bytes as an answer: text from which the same bytes can be restored."""
    try:
        return Fetched(app, serial, uri, data.decode("utf-8"))
    except UnicodeDecodeError:
        return Fetched(app, serial, uri, data.decode("latin-1"), "latin-1")


def _xml(data: Data) -> bytes:
    """A reply's data as XML: a ``reply`` with a ``data`` for each."""
    held = "".join(
        f'<data name="{escape(name)}">{escape(shown(value), quote=False)}</data>'
        for name, value in data.items()
    )
    return f"<reply>{held}</reply>".encode()


def not_allowed(uri: str) -> str:
    """Why a host is not asked, and the remedy."""
    host = host_of(uri)
    if not host:
        return "the URI names no host: write http://HOST or http://HOST:PORT before its path"
    return f'the run does not allow the host: add "--allow-host {host}"'


def host_of(uri: str) -> str:
    """The host that a URI names, with its port if it names one, in lower case."""
    parts = urlsplit(uri)
    name = parts.hostname or ""
    name = f"[{name}]" if ":" in name else name
    try:
        return f"{name}:{parts.port}" if parts.port else name
    except ValueError:
        return ""
