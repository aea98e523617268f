"""Proxies of engines in processes of their own.

:class:`IsolatedEngine` has the methods of :class:`~prima.script.engine.Engine`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast

from prima.errors import UsageError, one_of
from prima.script import worker
from prima.script.ecmascript import UNDEFINED
from prima.script.evaluation import SCOPES, EngineElement, EngineLost, Scope
from prima.script.remote import Remote
from prima.script.worker import Worker

if TYPE_CHECKING:
    from prima.script.engine import Engine

ISOLATIONS = ("ea", "all", "none")
"""Whose code gets a process of its own: each EA's, each application's, or none.

With ``ea``, FAs share one. With ``none``, engines run in the process of the run, and nothing can
stop code that escapes their limits: only for trusted documents."""


Made = TypeVar("Made")


class IsolatedEngine(Remote):
    """The ECMAScript of an application, in another process."""

    there = "Engine"

    def __init__(self, host: Worker, scopes: tuple[str, ...] = SCOPES) -> None:
        self.now = 0
        """The time by the run's calendar (ms since 1970, UTC), as ``Date`` gives it."""
        self.spent = 0.0
        """Seconds of processor time since the owner last reset it."""
        self.maker: Engines | None = None
        """The owner of the process, which must live as long as the process is used."""
        super().__init__(host, self, "engine", scopes)
        self.nothing = self.empty()
        self._lenient: dict[str, str] = {}

    @property
    def lost(self) -> str:
        """Why nothing can be evaluated any more, if so."""
        return self.host.why

    def lenient(self, code: str) -> str:
        """See :meth:`Engine.lenient`."""
        if code not in self._lenient:
            self._lenient[code] = self._call("lenient", code)
        return self._lenient[code]

    def elements(self, code: str, scopes: tuple[Scope, ...], most: int) -> list[Any]:
        """See :meth:`Engine.elements`."""
        array = self.listed(code, scopes, most)
        length = min(int(self.length(array)), most)
        return [EngineElement(array, index) for index in range(length)]

    def put(self, scope: Scope, name: str, value: Any) -> None:
        """See :meth:`Engine.put`."""
        if value is UNDEFINED:
            self.unset(scope, name)
        elif isinstance(value, EngineElement):
            self.pick(scope, name, value.array, value.index)
        else:
            self.set(scope, name, value)


class AbsentEngine:
    """Replaces an engine that is unavailable: nothing is evaluated, and the application ends."""

    def __init__(self, lost: str) -> None:
        self.lost = lost
        self.now, self.spent = 0, 0.0
        self.nothing: Scope = None

    def named(self, _name: str) -> Scope:
        """A scope that cannot be read."""

    def __getattr__(self, name: str) -> Any:
        raise EngineLost(self.lost)


def check_isolation(isolate: str) -> None:
    """Refuse an unknown isolation.

    Raises:
        UsageError: it is not one of :data:`ISOLATIONS`.
    """
    if isolate not in ISOLATIONS:
        raise UsageError(f'isolate="{isolate}": write {one_of(ISOLATIONS)}.')


class Engines:
    """The engines of one run's applications, each in the process where its code may run.

    Args:
        isolate: one of :data:`ISOLATIONS`.
    """

    def __init__(self, isolate: str = "ea") -> None:
        self._isolate = isolate
        self.hosts: dict[str, Worker] = {}
        """The processes, by application; the one shared by FAs under the empty name."""
        self._absent = ""
        """Why the next application has no engine."""
        check_isolation(isolate)

    def engine(self, name: str, kind: str, scopes: tuple[str, ...] = SCOPES) -> AnyEngine:
        """A new engine for an application, by its name and kind (``fa`` or ``ea``).

        Raises:
            EngineLost: no process can be started.
        """
        if self._absent:
            return cast("IsolatedEngine", AbsentEngine(self._absent))
        if self._isolate == "none":
            from prima.script.engine import Engine

            return Engine(scopes)
        key = name if self._isolate == "all" or kind != "fa" else ""
        host = self.hosts.get(key)
        if host is None or not host.alive:
            host = self.hosts[key] = worker.hire()
        made = IsolatedEngine(host, scopes)
        made.maker = self
        return made

    def without(self, error: EngineLost, make: Callable[[], Made]) -> Made:
        """Create an application again whose engine was unavailable, if need be without one."""
        try:
            return make()
        except EngineLost:
            self._absent = str(error)
            try:
                return make()
            finally:
                self._absent = ""

    def close(self) -> None:
        """Return the processes: nothing can be evaluated any more."""
        while self.hosts:
            worker.dismiss(self.hosts.popitem()[1])

    def __del__(self) -> None:
        self.close()


AnyEngine: TypeAlias = "Engine | IsolatedEngine"
