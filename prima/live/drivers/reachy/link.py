"""The connection with Reachy Mini's daemon: REST for requests, a WebSocket for the ends of moves."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from prima.live.driver import Refused, Unreachable

if TYPE_CHECKING:
    import httpx
    from websockets.asyncio.client import ClientConnection

PORT = 8000
ADDRESS = f"http://127.0.0.1:{PORT}"
"""The daemon's address, unless the robot's document says otherwise."""
ENDS = {"move_completed", "move_failed", "move_cancelled"}
PAST = {"time value is out of range [0,1]", "Tried to evaluate recorded move beyond its duration."}
"""What the daemon reports of a move that it has made: it reads its clock once to see whether the
move's time is up and again to move on, and fails if the time is up in between."""
ANSWER_S = 2.0
"""How long the daemon may take to answer a request."""
CLOSE_S = 0.5
"""How long a daemon may take to close the connection."""
UPDATES = "/api/move/ws/updates"


class ReachyLink:
    """One connection with a daemon, which plays one move at a time.

    The daemon would play two moves at once, and each would undo the other's movements.

    Args:
        address: the daemon's URL.
        lost: called with the reason when the connection is gone.
    """

    def __init__(self, address: str, lost: Callable[[str], None]) -> None:
        self.address = address
        self._lost = lost
        self._client: httpx.AsyncClient | None = None
        self._socket: ClientConnection | None = None
        self._watching: asyncio.Task[None] | None = None
        self._ended: dict[str, tuple[str, str]] = {}
        """How moves have ended since the current one was requested."""
        self._news = asyncio.Event()
        self._gone = ""
        self.playing = asyncio.Lock()
        """Held while the robot moves."""

    async def connect(self) -> None:
        """Connect to the daemon.

        Raises:
            Unreachable: there is none, or it has no robot.
        """
        import httpx

        # A connection for each request: the daemon drops idle ones, and those after errors.
        once = httpx.Limits(max_keepalive_connections=0)
        self._client = httpx.AsyncClient(
            base_url=self.address, timeout=ANSWER_S, limits=once, trust_env=False
        )
        await self.check()
        await self._subscribe()

    async def _subscribe(self) -> None:
        from websockets.asyncio.client import connect
        from websockets.exceptions import WebSocketException

        url = "ws" + self.address.removeprefix("http") + UPDATES
        try:
            self._socket = await connect(
                url, proxy=None, open_timeout=ANSWER_S, close_timeout=CLOSE_S
            )
        except (OSError, WebSocketException) as error:
            raise Unreachable(f"The daemon does not report its moves: {error}.") from error
        self._watching = asyncio.create_task(self._watch(self._socket))

    async def check(self) -> None:
        """Ask whether the daemon has a robot.

        Raises:
            Unreachable: it has none, or is not there.
        """
        try:
            status = await self.ask("GET", "/api/daemon/status")
            state = status["state"]
        except (Refused, TypeError, KeyError) as error:
            raise Unreachable("What answers there is no Reachy Mini.") from error
        if state != "running":
            why = f" ({status['error']})" if status.get("error") else ""
            raise Unreachable(
                f"The daemon does not run its robot; its state is {state}{why}."
                " Start the robot in the daemon's dashboard."
            )

    async def ask(self, method: str, path: str, body: object = None) -> Any:
        """Send a request, and return the answer.

        Raises:
            Refused: the daemon does not do it.
            Unreachable: it does not answer.
        """
        import httpx

        if self._client is None:
            raise Unreachable("There is no connection with Reachy Mini.")
        try:
            async with asyncio.timeout(ANSWER_S):  # httpx's are for each part of a request
                answer = await self._client.request(method, path, json=body)
        except (httpx.HTTPError, TimeoutError) as error:
            reason = str(error) or "it takes too long"
            raise Unreachable(
                f"No Reachy Mini answers ({reason}). Start its daemon, or correct the address"
                " in the robot's document."
            ) from error
        if answer.status_code == 503:
            raise Unreachable("The daemon has lost its robot.")
        try:
            content = answer.json()
        except ValueError:
            content = answer.text[:200]
        if answer.is_error:
            detail = content.get("detail", content) if isinstance(content, dict) else content
            raise Refused(f"Reachy Mini refuses {path}: {detail} ({answer.status_code}).")
        return content

    async def play(self, path: str, body: object = None) -> None:
        """Let the robot make a move to its end; stop it if this is cancelled.

        The lock :attr:`playing` has to be held.

        Raises:
            Refused: the robot does not make it, or somebody else has stopped it.
            Unreachable: the daemon is gone.
        """
        self._ended.clear()
        asked = asyncio.ensure_future(self.ask("POST", f"/api/move/{path}", body))
        try:
            how, details = await self._end(_uuid(await asyncio.shield(asked)))
        except asyncio.CancelledError:
            await self._stop(_uuid(await asked))  # it may play although it was not reported
            raise
        if how == "move_failed" and details not in PAST:
            raise Refused(f"Reachy Mini has failed at {path}: {details}.")
        if how == "move_cancelled":
            raise Refused("Somebody else has stopped the move.")

    async def _end(self, uuid: str) -> tuple[str, str]:
        while uuid not in self._ended:
            if self._gone:
                raise Unreachable(self._gone)
            self._news.clear()
            await self._news.wait()
        return self._ended[uuid]

    async def _stop(self, uuid: str) -> None:
        try:
            await self.ask("POST", "/api/move/stop", {"uuid": uuid})
        except Refused:
            pass  # it has just ended

    async def stop_all(self) -> None:
        """Stop all moves that the daemon names, whoever requested them.

        Raises:
            Refused: the daemon does not tell which moves it makes.
            Unreachable: it is gone.
        """
        moves = await self.ask("GET", "/api/move/running")
        for move in moves if isinstance(moves, list) else ():
            with suppress(Refused):
                await self._stop(_uuid(move))

    async def _watch(self, socket: ClientConnection) -> None:
        from websockets.exceptions import WebSocketException

        try:
            async for message in socket:
                self._hear(message)
        except WebSocketException:
            pass
        self._gone = "The connection with Reachy Mini's daemon is gone."
        self._news.set()
        self._lost(self._gone)

    def _hear(self, message: str | bytes) -> None:
        """Note that a move has ended. It is dropped if nothing waits for it."""
        try:
            event = json.loads(message)
            how, uuid = event["type"], event["uuid"]
        except (ValueError, KeyError, TypeError, RecursionError):
            return
        named = isinstance(how, str) and isinstance(uuid, str)
        if named and how in ENDS and self.playing.locked():
            self._ended[uuid] = how, str(event.get("details", ""))
            self._news.set()

    async def close(self) -> None:
        """Close the connection without reporting it."""
        if self._watching is not None:
            self._watching.cancel()
            await asyncio.gather(self._watching, return_exceptions=True)
        if self._socket is not None:
            await self._socket.close()
        if self._client is not None:
            await self._client.aclose()
        self._client = self._socket = self._watching = None


def read_address(written: str) -> str:
    """The URL of a daemon; scheme and port may be omitted.

    Raises:
        ValueError: it is not a URL.
    """
    whole = written or ADDRESS
    try:
        parts = urlsplit(whole if "://" in whole else f"http://{whole}")
        host, port = parts.hostname, parts.port or PORT
    except ValueError:
        host, port = None, PORT
    if not host or " " in host or parts.scheme != "http" or parts.path.strip("/"):
        example = 'address="http://reachy-mini.local:8000"'
        raise ValueError(f'"{whole}" is not the address of a Reachy Mini; write {example}.')
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _uuid(move: Any) -> str:
    """The name of a move in the daemon's answer.

    Raises:
        Refused: there is none.
    """
    if not isinstance(move, dict) or not isinstance(move.get("uuid"), str):
        raise Refused("Reachy Mini does not tell which move it makes.")
    return str(move["uuid"])
