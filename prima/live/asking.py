"""Requests to the services of a live run, each in a thread."""

from __future__ import annotations

import asyncio
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from http.client import HTTPException, HTTPResponse, IncompleteRead
from typing import TypeVar
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import Request

from prima.devices.endpoints import Endpoint, Unfit
from prima.live.answers import HIDDEN
from prima.live.threads import call_in, settle
from prima.loading.web import end_connections, follow, read_plain, silence
from prima.sim.services import host_of

T = TypeVar("T")
BUSY = frozenset([429, 502, 503, 504])
"""Statuses after which a request is repeated."""
FIRST_S = 0.1
"""The delay (s) before a request is repeated; it doubles each time."""


class _Busy(Unfit):
    """An error after which repeating the request may help."""


@dataclass(slots=True)
class ServiceRequests:
    """Requests to one service, one after the other, each in a thread."""

    endpoint: Endpoint
    secrets: dict[str, tuple[str, str]]
    hosts: frozenset[str]
    check: Callable[[HTTPResponse], None]
    held: list[socket.socket] = field(default_factory=list)
    closed: bool = False

    async def repeat(self, make: Callable[[], Request], retries: int) -> bytes:
        """Send a request, and repeat it where that may help, with growing delays.

        Raises:
            Unfit: there is no answer.
        """
        for count in range(retries):
            with suppress(_Busy):
                return await in_thread(lambda: self.run(make()))
            await asyncio.sleep(FIRST_S * 2**count)
        return await in_thread(lambda: self.run(make()))

    def run(self, request: Request) -> bytes:
        """Ask.

        Raises:
            Unfit: there is no answer.
        """
        try:
            body = follow(request, self._check, self._read, self.held, self._seconds)
        except HTTPError as error:
            error.close()
            why = f"the service answers {error.code}"
            raise (_Busy if error.code in BUSY else Unfit)(why) from None
        except URLError as error:
            raise _Busy(silence(error.reason)) from None
        except (OSError, IncompleteRead):
            raise _Busy("the answer breaks off") from None
        except HTTPException:
            raise _Busy("the answer is not HTTP") from None
        except ValueError as error:
            raise Unfit(str(error)) from None
        for _, secret in self.secrets.values():
            body = body.replace(secret.encode(), HIDDEN.encode())
        return body

    @property
    def _seconds(self) -> float:
        return self.endpoint.deadline / 1000

    def close(self) -> None:
        """End all connections."""
        self.closed = True
        end_connections(self.held)

    def _check(self, request: Request) -> None:
        """Refuses redirects to other hosts, and sends secrets only to the service's own."""
        url, own = request.full_url, self.endpoint.uri
        if self.closed:
            raise Unfit("nobody waits for it any more")
        if urlsplit(url).scheme not in ("http", "https"):
            raise Unfit("it is moved to a URI that is neither http nor https")
        if host_of(url) not in self.hosts:
            raise Unfit(f'it is moved to the host "{host_of(url)}", which no service names')
        if urlsplit(url)[:2] != urlsplit(own)[:2]:
            return
        for name, value in self.endpoint.headers.items():
            request.add_header(name, value)
        for name, (before, secret) in self.secrets.items():
            request.add_header(name, before + secret)

    def _read(self, response: HTTPResponse) -> bytes:
        """An answer's body, chunk by chunk, within the deadline of the whole."""
        self.check(response)
        most = self.endpoint.most
        ends = time.monotonic() + self._seconds
        data = read_plain(response, most + 1)
        if len(data) > most:
            raise Unfit(f"the answer is larger than {most:,} bytes")
        if time.monotonic() > ends or self.closed:
            raise Unfit("the answer is too slow")
        return data


async def in_thread(work: Callable[[], T]) -> T:
    """Run something blocking in a thread that the end of the run does not wait for."""
    loop = asyncio.get_running_loop()
    done: asyncio.Future[T] = loop.create_future()

    def run() -> None:
        outcome: object
        try:
            outcome = work()
        except Exception as error:
            outcome = error
        call_in(loop, settle, done, outcome)

    threading.Thread(target=run, daemon=True).start()
    return await done
