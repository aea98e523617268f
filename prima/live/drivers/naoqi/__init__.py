"""The driver of NAO and Pepper, by the ``qi`` framework."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable
from contextlib import nullcontext, suppress
from functools import partial
from typing import Any, Final

from prima.devices.goals import LISTEN, Begin
from prima.devices.settings import Does
from prima.errors import UsageError
from prima.live.driver import OpenRequests, Refused, Unreachable, Unusable
from prima.live.mapped import SAFE_S, SHARE, MappedDriver
from prima.live.threads import call_in, settle
from prima.messages import Data, Json

INSTALL: Final = "the library qi is not there ({}). Write: pip install 'prima[naoqi]'."
PORT: Final = 9559
ADDRESS: Final = re.compile(r"tcps?://(?:[\w.-]+|\[[0-9a-fA-F:.]+\])(?::(?P<port>[0-9]{1,5}))?")
MEMORY: Final = "ALMemory"
LANGUAGES: Final = {
    "de": "German",
    "en": "English",
    "es": "Spanish",
    "fr": "French",
    "it": "Italian",
    "ja": "Japanese",
    "ko": "Korean",
    "nl": "Dutch",
    "pt": "Portuguese",
    "zh": "Chinese",
}
"""The robot's names of languages: ``{language}``."""


class NaoqiDriver(MappedDriver):
    """A robot with NAOqi. Its address is that of its service directory: ``tcp://nao.local:9559``.

    ``by`` names a service and its method, such as ``ALTextToSpeech.say``; the values of ``set`` are
    its arguments in order. ``senses`` name events of ALMemory.
    """

    kind = "naoqi"

    _session: Any = None
    _services: dict[str, Any]
    _links: list[tuple[Any, int]]
    """Signals, and what is connected to them."""
    _pending: OpenRequests

    # The connection -------------------------------------------------------------------------

    async def open(self) -> None:
        """Connect with the robot's service directory, and check that all services exist."""
        try:
            import qi
        except ImportError as error:
            raise Unusable(INSTALL.format(error)) from None
        methods = self._methods()
        await self.leave()
        self._services, self._links, self._pending = {}, [], OpenRequests()
        self._session = session = qi.Session()
        url = _url(self.settings.address)
        try:
            async with asyncio.timeout(self.settings.open / 1000 * SHARE):
                await self._future(session.connect(url, _async=True))
                for service, method in methods:
                    await self._find(service, method)
                await self._subscribe()
        except TimeoutError:
            await self.leave()
            raise Unreachable(f"{url} does not answer.") from None
        except Refused as error:
            await self.leave()
            raise Unreachable(f"{url} cannot be reached: {error}.") from None
        except BaseException:
            await self.leave()
            raise
        self.gone = False
        session.disconnected.connect(partial(self._gone, session))

    def _methods(self) -> list[tuple[str, str]]:
        """The services and methods that the robot's document names."""
        self.settings.check_options()
        named = {name: does for does in self.settings.does for name in (does.by, does.stop) if name}
        for does in self.settings.does:
            if not does.by:
                named[""] = does
        for name, does in named.items():
            if name.count(".") != 1:
                remedy = 'Write for example by="ALTextToSpeech.say".'
                message = f'"{name}" is not a service and its method.'
                raise UsageError(f"{does.place}: naoqi: {message} {remedy}")
        return [tuple(name.split(".")) for name in named]  # type: ignore[misc]

    async def _find(self, name: str, method: str) -> None:
        if name not in self._services:
            asked = self._session.service(name, _async=True)
            try:
                self._services[name] = await self._future(asked)
            except Refused:
                raise Unreachable(f"the robot has no service {name}.") from None
        if method and not hasattr(self._services[name], method):
            raise Unreachable(f"the service {name} has no method {method}.")

    async def _subscribe(self) -> None:
        """Listen to the robot's memory."""
        if not self.settings.senses:
            return
        await self._find(MEMORY, "subscriber")
        memory = self._services[MEMORY]
        for senses in self.settings.senses:
            subscriber = await self._future(memory.subscriber(senses.by, _async=True))
            take = partial(self.sense_from_thread, senses)
            link = await asyncio.to_thread(subscriber.signal.connect, take)
            self._links.append((subscriber, link))

    def _gone(self, session: Any, *_: object) -> None:
        """The connection has been lost; called in a thread of qi."""
        if session is self._session:
            call_in(self._loop, self.lose, "the connection with the robot is lost")

    def lose(self, reason: str) -> None:
        """Give up calls that have not been answered."""
        super().lose(reason)
        self._pending.fail(reason)

    async def ping(self) -> None:
        """Ask the service directory for its services."""
        if self.gone:
            raise Unreachable("there is no connection")
        await self._future(self._session.services(_async=True))

    async def leave(self) -> None:
        """End the connection, if there is one."""
        session, self._session, self.gone = self._session, None, True
        if session is not None:
            self._links.clear()
            self._services.clear()
            closing = asyncio.to_thread(session.close)
            await asyncio.wait([asyncio.ensure_future(closing)], timeout=SAFE_S)

    # Goals ----------------------------------------------------------------------------------

    def values(self, goal: Begin) -> dict[str, Json]:
        """Add the robot's name of the language."""
        primary = (goal.command.lang or "en").lower().partition("-")[0]
        return super().values(goal) | {"language": LANGUAGES.get(primary, "English")}

    async def perform(self, goal: Begin) -> Data:
        """Call a method; the goal is done when it returns, or after the Command's time."""
        does = await self.way(goal)
        arguments = list(does.filled(self.values(goal)).values())
        stopped = False
        calling, cancel = self._call(does.by, arguments)
        try:
            if await asyncio.shield(calling) is False:
                raise Refused(f"{does.by} answers that it has failed")
            if self._goes_on(goal, does):
                await asyncio.sleep(self.lasts(goal) or 86_400)
                stopped = True
                await self._stop(does)
        except asyncio.CancelledError:
            if not stopped:
                await self._end(does, calling, cancel)
            raise
        return {}

    def _goes_on(self, goal: Begin, does: Does) -> bool:
        """Whether what its method began continues until it is stopped."""
        return bool(does.stop) and ("time" in goal.command.args or goal.kind == LISTEN)

    async def _end(
        self, does: Does, calling: asyncio.Future[Any], cancel: Callable[[], object]
    ) -> None:
        """Stop what a method does, and wait until it has returned."""
        if does.stop:
            await self._stop(does)
        else:
            await asyncio.to_thread(cancel)
        await asyncio.wait([calling])
        if not calling.cancelled():
            calling.exception()

    async def _stop(self, does: Does) -> None:
        try:
            await self._call(does.stop, [])[0]
        except (Refused, Unreachable):
            pass  # what it should stop continues, and is waited for

    def stand(self) -> None:
        """Do what ``stop-moving`` does."""
        if not self.gone and (does := self.settings.how("stop-moving")) is not None:
            calling, _ = self._call(does.by, [])
            calling.add_done_callback(lambda one: one.cancelled() or one.exception())

    async def safe(self) -> None:
        """Call all stopping methods, even over a link that seems to be lost."""
        if self._session is None:
            return
        named = {does.stop for does in self.settings.does if does.stop}
        if (does := self.settings.how("stop-moving")) is not None:
            named.add(does.by)
        with suppress(Exception) if self.gone else nullcontext():
            await self.end_all([self._ask_method(name, [])[0] for name in sorted(named)])

    # Calls ----------------------------------------------------------------------------------

    def _call(
        self, name: str, arguments: list[Json]
    ) -> tuple[asyncio.Future[Any], Callable[[], object]]:
        """Call a method; returns its answer, and a function that cancels it."""
        if self.gone:
            raise Unreachable("there is no connection")
        return self._ask_method(name, arguments)

    def _ask_method(
        self, name: str, arguments: list[Json]
    ) -> tuple[asyncio.Future[Any], Callable[[], object]]:
        service, _, method = name.partition(".")
        asked = getattr(self._services[service], method)(*arguments, _async=True)
        return self._future(asked), asked.cancel

    def _future(self, asked: Any) -> asyncio.Future[Any]:
        """The future of a call, for this loop."""
        future = self._pending.add_one()

        def take(asked: Any) -> None:
            if asked.isCanceled():
                settle(future, Refused("the robot has cancelled it"))
            elif asked.hasError():
                settle(future, Refused(_said(asked.error())))
            else:
                settle(future, asked.value())

        asked.addCallback(partial(call_in, asyncio.get_running_loop(), take))
        return future


def _said(error: object) -> str:
    """The robot's error message: its first line."""
    lines = (line.strip().removeprefix("RuntimeError: ") for line in str(error).splitlines())
    return next((line for line in lines if line), "the robot has refused it")


def _url(address: str) -> str:
    """The URL of a service directory.

    Raises:
        Unusable: it is not a URL.
    """
    url = address or "127.0.0.1"
    url = url if "://" in url else f"tcp://{url}"
    found = ADDRESS.fullmatch(url)
    if found is None or not 0 < int(found["port"] or PORT) < 65_536:
        remedy = 'Write for example address="tcp://nao.local:9559".'
        raise Unusable(f'"{address}" is not the address of a service directory. {remedy}')
    return url if found["port"] else f"{url}:{PORT}"


DRIVER = NaoqiDriver
