"""The services of a live run: real HTTP, by name, without making the run wait.

A request runs in a thread, as a host may send so slowly that no timeout ends it. Its answer is
an inbound record, so a replay sends no requests. Deadlines are in real time at any speed.
"""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Callable, Container, Iterable, Mapping
from http.client import HTTPResponse
from typing import TYPE_CHECKING
from urllib.request import Request

from prima.devices.endpoints import Endpoint, Unfit, filled_by_grammar
from prima.errors import UsageError
from prima.live.answers import check_type, hidden, read_json, said_by_model
from prima.live.asking import ServiceRequests, in_thread
from prima.loading.web import form_request
from prima.messages import SERVICE, Data, Fetched, Inbound, Json, Occurred, Order
from prima.sim.happenings import Reply
from prima.sim.services import (
    NO_ANSWER,
    Directory,
    Web,
    answer,
    event_of,
    fetched_of,
    host_of,
    not_allowed,
)
from prima.sim.telephone import Telephone

if TYPE_CHECKING:
    from prima.live.devices import LiveDevices

MOST_ASKED = 32
"""Maximum number of a run's simultaneous requests."""
CUT_OFF = "the run was cut off before the answer came; it is asked once only"


class LiveServices:
    """Sends requests to the services of a run's document, and to the hosts that the run allows.

    Args:
        endpoints: the services.
        web: fetches from other hosts if the run allows it.
        environment: holds the secrets.

    Raises:
        UsageError: a secret is missing.
    """

    def __init__(
        self,
        endpoints: Iterable[Endpoint],
        web: Web | None = None,
        environment: Mapping[str, str] = os.environ,
    ) -> None:
        known = tuple(endpoints)
        self._endpoints = Directory(known)
        self._secrets = {(one.name, one.application): _secrets(one, environment) for one in known}
        made = (secret for held in self._secrets.values() for _, secret in held.values())
        self._hide = frozenset(made)
        self._hosts = frozenset(host_of(one.uri) for one in known)
        self._web = web
        self._telephone = Telephone()
        self._arrived: list[tuple[int, Inbound]] = []
        self._last = -1
        self._under_way = 0
        self._open: list[tuple[Order, bool]] = []
        """Requests of a run that was cut off, and whether each may have been sent before."""
        self.run: LiveDevices
        """Provides the clock, and runs things in the background."""

    def due(self) -> int | None:
        """When an answer is to be collected."""
        times = [time for time, _ in self._arrived[:1]]
        calls = self._telephone.due()
        times += [] if calls is None else [calls]
        return max(min(times), self._last + 1) if times else None

    def collect(self, now: int) -> list[Inbound]:
        """The answers that have arrived."""
        self._last = now
        waiting, self._open = self._open, []
        for order, perhaps in waiting:
            if perhaps and not self._may_ask_again(order):
                self._arrive(now, _failed(order, CUT_OFF))
            else:
                self.order(now, order)
        inbound = [value for _, value in self._arrived]
        self._arrived.clear()
        return inbound + self._telephone.collect(now)

    def go_on(self, asked: Iterable[Order], never: Container[str]) -> None:
        """Handle the open requests of a run that was cut off, so that none waits for ever.

        Args:
            asked: the requests without an answer, the oldest first.
            never: the names of those that were certainly not sent before the cut.
        """
        self._open = [(order, order.behavior not in never) for order in asked]

    def _may_ask_again(self, order: Order) -> bool:
        """Whether a request may safely be sent twice."""
        fetches, name = "method" in order.data, str(order.data["to"])
        if "transfer" in order.data or order.data.get("method") == "get":
            return True
        endpoint = self._endpoints.for_order(order)
        if endpoint is None:  # unknown services are not asked; other hosts by a post
            return not fetches or name.startswith(SERVICE)
        return endpoint.repeats

    def order(self, now: int, order: Order) -> None:
        """Take a message, a fetch or a call."""
        if "transfer" in order.data:
            self._telephone.order(now, order)
        elif self._under_way >= MOST_ASKED:
            problem = f"{MOST_ASKED} requests are under way already"
            self._arrive(now + 1, _failed(order, problem))
        else:
            self._under_way += 1
            self.run.spawn(self._answer(order))

    def _arrive(self, now: int, value: Inbound) -> None:
        self._arrived.append((now, value))
        self.run.wake()

    async def _answer(self, order: Order) -> None:
        """Carry out an order; whatever happens, the application is notified."""
        try:
            value = await self._asked(order)
        except Unfit as error:
            value = _failed(order, str(error))
        except Exception as error:
            value = _failed(order, f"it cannot be asked: {type(error).__name__}")
        finally:
            self._under_way -= 1
        self._arrive(self.run.now(), hidden(value, self._hide))

    async def _asked(self, order: Order) -> Occurred | Fetched:
        fetches, name = "method" in order.data, str(order.data["to"])
        endpoint = self._endpoints.for_order(order)
        if endpoint is None and fetches and not name.startswith(SERVICE):
            return await self._outside(order)
        if endpoint is None:
            hint = "name it in the document of --services"
            raise Unfit(f"{self._endpoints.lacking(name)}; {hint}")
        params = order.data.get("params", order.data) if fetches else order.data["params"]
        if fetches and not endpoint.model:
            return await self._fetch(endpoint, order, params)
        data = await self._data(endpoint, params)
        return fetched_of(order, Reply(data)) if fetches else event_of(order, Reply(data))

    async def _outside(self, order: Order) -> Occurred | Fetched:
        """Send a request to a host of ``--allow-host``."""
        uri, data = str(order.data["to"]), order.data
        if self._web is None:
            raise Unfit(not_allowed(uri))
        asking = self._web(order.app, uri, data["method"], data["params"])
        found = await in_thread(asking) or Fetched("", 0, uri, problem=NO_ANSWER)
        found.app, found.serial = order.app, order.serial
        return found

    async def _fetch(self, endpoint: Endpoint, order: Order, params: Data) -> Occurred | Fetched:
        """The bytes of a service's answer, for VoiceXML."""
        uri, method = str(order.data["to"]), str(order.data["method"])
        where = endpoint.uri if uri.startswith(SERVICE) else uri
        repeats = method == "get" or endpoint.repeats
        body = await self._ask(endpoint, lambda: form_request(where, method, params), repeats)
        found = answer(order.app, order.serial, uri, body)
        found.host = True
        return found

    async def _data(self, endpoint: Endpoint, params: Data) -> dict[str, Json]:
        """The data of a service's reply; for a language model possibly the fallback's."""
        try:
            what = endpoint.chat(params) if endpoint.model else params
            body = await self._ask(
                endpoint, lambda: _request(endpoint, what), endpoint.repeats, check_type
            )
            given = read_json(body, "the answer")
            if endpoint.model:
                given = said_by_model(given)
            return endpoint.reply(given)
        except Unfit:
            if (found := filled_by_grammar(endpoint, params)) is not None:
                return found
            raise

    async def _ask(
        self,
        endpoint: Endpoint,
        make: Callable[[], Request],
        again: bool,
        check: Callable[[HTTPResponse], None] = lambda _: None,
    ) -> bytes:
        """The bytes of an answer; the request is repeated if that is allowed and may help.

        ``check`` rejects answers by their headers.

        Raises:
            Unfit: there is no answer.
        """
        asking = ServiceRequests(
            endpoint, self._secrets[endpoint.name, endpoint.application], self._hosts, check
        )
        try:
            async with asyncio.timeout(endpoint.deadline / 1000):
                return await asking.repeat(make, endpoint.retries if again else 0)
        except TimeoutError:
            raise Unfit(f"no answer within {endpoint.deadline / 1000:g} s") from None
        finally:
            asking.close()


def _secrets(endpoint: Endpoint, environment: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    """The values of a service's headers from the environment, with their prefixes.

    Raises:
        UsageError: a variable is not set, or not valid as a header's value.
    """
    found = {}
    for name, (before, variable) in endpoint.variables.items():
        secret = environment.get(variable, "").strip()
        where = f"{endpoint.place}: the environment variable {variable}"
        if not secret:
            hint = f"Set it before the run: export {variable}=..."
            raise UsageError(f'{where} is not set; the service "{endpoint.name}" needs it. {hint}')
        if not secret.isascii() or not secret.isprintable():
            raise UsageError(f"{where} has characters that no header may have.")
        found[name] = (before, secret)
    return found


def _request(endpoint: Endpoint, what: Data) -> Request:
    """A request that sends values: in the URL, or as JSON."""
    if endpoint.method == "get":
        return form_request(endpoint.uri, "get", what)
    headers = {"User-Agent": "PRIMA", "Content-Type": "application/json"}
    body = json.dumps(dict(what), ensure_ascii=False).encode()
    return Request(endpoint.uri, body, headers, method=endpoint.method.upper())


def _failed(order: Order, why: str) -> Occurred | Fetched:
    """The answer to an order that failed."""
    if "method" in order.data:
        return fetched_of(order, Reply(error=why))
    return event_of(order, Reply(error=why))
