"""Real HTTP for a run that allows it, by host: nothing else in the package uses the network."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from http.client import HTTPException, HTTPMessage
from typing import IO, NoReturn
from urllib.error import HTTPError, URLError
from urllib.parse import urlencode, urlsplit
from urllib.request import HTTPRedirectHandler, OpenerDirector, Request, build_opener

from prima.markup.limits import LIMITS
from prima.messages import Data, Fetched, Json
from prima.script.ecmascript import inward, stringify
from prima.sim.services import Web, answer, host_of, not_allowed

REAL_SECONDS = 10
"""How long a host may take, in real seconds."""


def web(hosts: Iterable[str]) -> Web:
    """A fetcher that asks the named hosts, as ``HOST`` or ``HOST:PORT``, and no others."""
    allowed = frozenset(host.lower() for host in hosts)

    class Redirects(HTTPRedirectHandler):
        """Follows a redirection only to a host that may be asked."""

        def redirect_request(
            self,
            req: Request,
            fp: IO[bytes],
            code: int,
            msg: str,
            headers: HTTPMessage,
            newurl: str,
        ) -> Request | None:
            _check(newurl, allowed)
            return super().redirect_request(req, fp, code, msg, headers, newurl)

    opener = build_opener(Redirects)

    def ask(uri: str, method: str, values: Data) -> Fetched:
        try:
            _check(uri, allowed)
            return answer("", 0, uri, _body(opener, _request(uri, method, values)))
        except HTTPError as error:
            return Fetched("", 0, uri, status=error.code, problem=f"the host answers {error.code}")
        except URLError as error:
            return Fetched("", 0, uri, problem=f"the host does not answer: {error.reason}")
        except (OSError, HTTPException, ValueError) as error:
            return Fetched("", 0, uri, problem=f"it cannot be fetched: {error}")

    def get(uri: str, method: str, values: Data) -> Fetched:
        """Ask in a thread of its own: a host may send so slowly that no timeout of its own ends it."""
        found: list[Fetched] = []
        asking = threading.Thread(
            target=lambda: found.append(ask(uri, method, values)), daemon=True
        )
        asking.start()
        asking.join(REAL_SECONDS)
        return found[0] if found else Fetched("", 0, uri, problem=f"no answer in {REAL_SECONDS} s")

    return get


def _check(uri: str, allowed: frozenset[str]) -> None:
    """Refuse what is not of an allowed host.

    Raises:
        ValueError: with what to do.
    """
    host = host_of(uri)
    if urlsplit(uri).scheme not in ("http", "https"):
        _refuse(f"{uri} is no address of the web")
    if not {host, host.partition(":")[0]} & allowed:
        _refuse(not_allowed(uri))


def _refuse(message: str) -> NoReturn:
    raise ValueError(message)


def _request(uri: str, method: str, values: Data) -> Request:
    encoded = urlencode({name: _text(value) for name, value in values.items()})
    if method == "post":
        return Request(uri, encoded.encode(), {"User-Agent": "PRIMA"}, method="POST")
    mark = "&" if "?" in uri else "?"
    whole = f"{uri}{mark}{encoded}" if encoded else uri
    return Request(whole, headers={"User-Agent": "PRIMA"})


def _text(value: Json) -> str:
    """A value as ECMAScript's text of it; data as JSON."""
    if isinstance(value, str):
        return value
    return "undefined" if value is None else stringify(inward(value))


def _body(opener: OpenerDirector, request: Request) -> bytes:
    with opener.open(request, timeout=REAL_SECONDS) as response:
        data: bytes = response.read(LIMITS.bytes + 1)
    if len(data) > LIMITS.bytes:
        _refuse(f"it is larger than {LIMITS.bytes // 1024 // 1024} MB")
    return data
