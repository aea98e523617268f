"""Real HTTP for runs that allow it, by host: nothing else in the package uses the network.

An answer takes no simulated time, so the run waits for it in real time: each application waits
only once for a silent host, and others in the same instant wait at the same time, not one after
the other. Simulated time never waits.
"""

from __future__ import annotations

import re
import socket
import string
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from http.client import (
    BadStatusLine,
    HTTPConnection,
    HTTPException,
    HTTPMessage,
    HTTPResponse,
    HTTPSConnection,
    IncompleteRead,
)
from typing import IO, NoReturn
from urllib.error import HTTPError, URLError
from urllib.parse import quote, urlencode, urljoin, urlsplit
from urllib.request import (
    HTTPDefaultErrorHandler,
    HTTPErrorProcessor,
    HTTPHandler,
    HTTPRedirectHandler,
    HTTPSHandler,
    OpenerDirector,
    ProxyHandler,
    Request,
    UnknownHandler,
)

from prima.markup.encodings import recoded
from prima.markup.limits import LIMITS
from prima.messages import Data, Fetched, Json
from prima.script.ecmascript import inward, stringify
from prima.sim.services import Answering, answer, host_of, not_allowed

REAL_SECONDS = 10.0
"""How long (s) a host may take for a complete answer, redirections included, in real time."""
MOST_REDIRECTIONS = 5
"""Maximum number of redirections followed in one fetch."""
MOST_FETCHES = 1000
"""Maximum number of fetches in a run, including redirections; applications share them equally."""
MOST_BYTES = 50_000_000
"""Maximum size of a run's answers in bytes; each application has an equal share."""
MOST_SECONDS = 120.0
"""How long (s) a run waits for answers, in real time; each application has an equal share."""
HEADERS = {"User-Agent": "PRIMA"}
MOVED = frozenset([301, 302, 303, 307, 308])
"""Statuses of redirections."""
BROKEN = {IncompleteRead: "the answer breaks off", BadStatusLine: "the answer is not HTTP"}


class Hosts:
    """Sends requests only to the hosts that a run allows, as ``HOST`` or ``HOST:PORT``.

    ``sharing`` is how many applications share the run's limits.
    """

    def __init__(self, allowed: Iterable[str], sharing: int) -> None:
        self._allowed = frozenset(host.lower() for host in allowed)
        self.sharing = max(sharing, 1)
        self._made: Counter[str] = Counter()
        self._bytes: Counter[str] = Counter()
        self._waited: defaultdict[str, float] = defaultdict(float)
        self._silent: set[tuple[str, str]] = set()
        """Applications, each with a host that did not answer it."""

    def __call__(self, app: str, uri: str, method: str, values: Data) -> Answering:
        """Begin to fetch a URI by a method with values; returns what waits for its answer."""
        if problem := self._refusal(app, uri):
            return partial(Fetched, app, 0, uri, problem=problem)
        asking = _Fetching(self, app, uri)
        threading.Thread(target=asking.run, args=(method, values), daemon=True).start()
        return asking.wait

    def count(self, app: str) -> None:
        """Count a request of an application.

        Raises:
            ValueError: it has reached its limit.
        """
        self._made[app] += 1
        if self._made[app] > MOST_FETCHES // self.sharing:
            _refuse(_used_up(f"{MOST_FETCHES // self.sharing} fetches"))

    def check(self, uri: str) -> None:
        """Refuse a request to a host that is not allowed.

        Raises:
            ValueError: with a remedy.
        """
        host = host_of(uri)
        if urlsplit(uri).scheme not in ("http", "https"):
            _refuse(f"{uri} is not an http or https URI")
        if "@" in urlsplit(uri).netloc:
            _refuse("the URI names a user: leave out what is before the @")
        if not {host, re.sub(r":[0-9]+$", "", host)} & self._allowed:
            _refuse(not_allowed(uri))

    def left(self, app: str) -> int:
        """How many bytes an application may still be sent."""
        return max(MOST_BYTES // self.sharing - self._bytes[app], 0)

    def took(self, app: str, uri: str, seconds: float, size: int | None) -> None:
        """Note how long the wait for an answer took, and its size; None without an answer."""
        self._waited[app] += seconds
        self._bytes[app] += size or 0
        if size is None:
            self._silent.add((app, host_of(uri)))

    def _refusal(self, app: str, uri: str) -> str:
        """Why an application may not request a URI any more; empty if it may."""
        if (app, host_of(uri)) in self._silent:
            return f"the host has kept the application waiting for {REAL_SECONDS:g} s before"
        if not self.left(app):
            return _used_up(f"{MOST_BYTES // self.sharing:,} bytes")
        if self._waited[app] > MOST_SECONDS / self.sharing:
            return _used_up(f"{MOST_SECONDS / self.sharing:g} s of waiting")
        return ""


def _used_up(share: str) -> str:
    return f"the application has used up its share of what a run fetches, {share}"


@dataclass(slots=True)
class _Fetching:
    """One fetch, in a thread of its own: a host may send so slowly that no timeout ends it."""

    hosts: Hosts
    app: str
    uri: str
    ends: float = field(default_factory=lambda: time.monotonic() + REAL_SECONDS)
    done: threading.Event = field(default_factory=threading.Event)
    found: Fetched | None = None
    size: int = 0
    asked: str = ""
    """The URI requested last: the first one's, or that of a redirection."""
    held: list[socket.socket] = field(default_factory=list)

    def wait(self) -> Fetched | None:
        """The answer; None if there is none by the deadline."""
        began = time.monotonic()
        answered = self.done.wait(max(self.ends - began, 0)) and self.found is not None
        self.hosts.took(
            self.app, self.uri, time.monotonic() - began, self.size if answered else None
        )
        if not answered:
            end_connections(self.held)
        return self.found if answered else None

    def run(self, method: str, values: Data) -> None:
        """Send the request, and keep the answer or the error."""
        try:
            request = form_request(self.uri, method, values)
            data = follow(request, self._check, self._read, self.held, REAL_SECONDS)
            self.size = len(data)
            self.found = answer("", 0, self.uri, data)
            self.found.host = True
            self.found.moved = self.asked if self.asked != request.full_url else ""
        except HTTPError as error:
            problem = f"the host answers {error.code}"
            self.found = Fetched("", 0, self.uri, status=error.code, problem=problem)
            error.close()
        except URLError as error:
            # A connection may time out a moment before the deadline: the host is silent all the same.
            if not isinstance(error.reason, TimeoutError):
                self.found = Fetched("", 0, self.uri, problem=silence(error.reason))
        except TimeoutError:
            pass
        except (OSError, HTTPException, ValueError) as error:
            why = BROKEN.get(type(error), error)
            self.found = Fetched("", 0, self.uri, problem=f"it cannot be fetched: {why}")
        finally:
            end_connections(self.held)
            self.done.set()

    def _check(self, request: Request) -> None:
        self.hosts.check(request.full_url)
        self.hosts.count(self.app)
        self.asked = request.full_url

    def _read(self, response: HTTPResponse) -> bytes:
        """An answer's body, unmodified, up to the maximum length of a document."""
        most = min(LIMITS.bytes, self.hosts.left(self.app))
        data = read_plain(response, most + 1)
        if len(data) > LIMITS.bytes:
            _refuse(f"it is larger than {LIMITS.bytes / 1_000_000:g} MB")
        if len(data) > most:
            _refuse(_used_up(f"{MOST_BYTES // self.hosts.sharing:,} bytes"))
        return recoded(data, response.headers)


def follow(
    request: Request,
    check: Callable[[Request], None],
    read: Callable[[HTTPResponse], bytes],
    held: list[socket.socket],
    seconds: float,
) -> bytes:
    """The bytes of the answer to a request, wherever it is moved to.

    Args:
        request: the request.
        check: refuses a request (ValueError), or adds headers to it.
        read: reads the body of an answer.
        held: receives the connections, so that they can be ended.
        seconds: how long (s) a host may be silent.

    Raises:
        HTTPError, OSError, HTTPException, ValueError: there is no such answer.
    """
    for _ in range(MOST_REDIRECTIONS + 1):
        check(request)
        try:
            with _opener(held).open(request, timeout=seconds) as response:
                return read(response)
        except HTTPError as error:
            where = error.headers.get("Location", "") if error.code in MOVED else ""
            if not where:
                raise
            error.close()
            request = _moved(request, error.code, where)
    _refuse(f"it is moved more than {MOST_REDIRECTIONS} times")


def read_plain(response: HTTPResponse, most: int) -> bytes:
    """At most so many bytes of an uncompressed answer.

    Raises:
        IncompleteRead: it breaks off.
        ValueError: it is compressed.
    """
    if (coding := response.headers.get("Content-Encoding", "identity")) != "identity":
        _refuse(f"the host sends it compressed, as {coding[:20]}")
    try:
        data: bytes = response.read(most)
    except ValueError:  # the length of a chunk is negative
        raise IncompleteRead(b"") from None
    if response.length and len(data) < most:  # the length announced, less what has come
        raise IncompleteRead(data, response.length)
    return data


def end_connections(held: Iterable[socket.socket]) -> None:
    """End connections, so that nothing more is sent or read."""
    for one in held:
        with suppress(OSError):
            one.shutdown(socket.SHUT_RDWR)


def silence(reason: object) -> str:
    """Why a host does not answer, from an error of urllib."""
    sentence = str(reason)
    return sentence if isinstance(reason, ValueError) else f"the host does not answer: {sentence}"


class _Stays(HTTPRedirectHandler):
    """Neither follows a redirection nor reads its body."""

    def _stays(
        self, req: Request, fp: IO[bytes], code: int, msg: str, headers: HTTPMessage
    ) -> None:
        """Treat it as an error, like other statuses."""

    http_error_301 = http_error_302 = http_error_303 = _stays
    http_error_307 = http_error_308 = _stays


def _opener(held: list[socket.socket]) -> OpenerDirector:
    """An opener for http and https only; ``held`` receives its connections."""

    class Plain(HTTPConnection):
        def connect(self) -> None:
            super().connect()
            held.append(self.sock)

    class Secure(Plain, HTTPSConnection):
        pass

    class OpensPlain(HTTPHandler):
        def http_open(self, req: Request) -> HTTPResponse:
            return self.do_open(Plain, req)

    class OpensSecure(HTTPSHandler):
        def https_open(self, req: Request) -> HTTPResponse:
            return self.do_open(Secure, req)

    opener = OpenerDirector()
    for handler in (OpensPlain(), OpensSecure(), ProxyHandler(), _Stays(), UnknownHandler()):
        opener.add_handler(handler)
    opener.add_handler(HTTPDefaultErrorHandler())
    opener.add_handler(HTTPErrorProcessor())
    return opener


def _moved(request: Request, status: int, where: str) -> Request:
    """The request for a redirection's target (RFC 9110, 15.4).

    Raises:
        ValueError: the target is not an address.
    """
    try:
        uri = urljoin(request.full_url, quote(where, string.punctuation, "latin-1"))
        parts = urlsplit(uri)
        wrong = parts.port == 0 or "@" in parts.netloc
    except ValueError:
        wrong = True
    if wrong:
        _refuse(f"it is moved to {where[:200]}, which is not an address")
    if status in (307, 308):
        return Request(uri, request.data, HEADERS, method=request.get_method())
    return Request(uri, headers=HEADERS)


def _refuse(message: str) -> NoReturn:
    raise ValueError(message)


def form_request(uri: str, method: str, values: Data) -> Request:
    """A request that sends values as a form does."""
    parts = urlsplit(uri)  # a fragment would take the values along, and is never sent
    path, query = (quote(one, string.punctuation) for one in (parts.path, parts.query))
    uri = parts._replace(path=path, query=query, fragment="").geturl()
    encoded = urlencode({name: _text(value) for name, value in values.items()})
    if method == "post":
        return Request(uri, encoded.encode(), HEADERS, method="POST")
    mark = "&" if "?" in uri else "?"
    whole = f"{uri}{mark}{encoded}" if encoded else uri
    return Request(whole, headers=HEADERS)


def _text(value: Json) -> str:
    """A value as text, as in ECMAScript; data as JSON."""
    if isinstance(value, str):
        return value
    return "undefined" if value is None else stringify(inward(value))
