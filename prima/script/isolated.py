"""Proxies of engines in processes of their own.

:class:`IsolatedEngine` has the methods of :class:`~prima.script.engine.Engine`. Values of the
engine are :class:`~prima.script.worker.Handle` here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast

from prima.errors import UsageError, one_of
from prima.messages import Json
from prima.script import worker
from prima.script.ecmascript import UNDEFINED
from prima.script.evaluation import SCOPES, EngineElement, EngineLost, Scope, bounded, plain_number
from prima.script.remote import Remote, as_data, as_value, as_values
from prima.script.worker import Handle, Worker

if TYPE_CHECKING:
    from prima.script.engine import Engine

ISOLATIONS = ("ea", "all", "none")
"""Whose code gets a process of its own: each EA's, each application's, or none.

With ``ea``, FAs share one. With ``none``, engines run in the process of the run, and nothing can
stop code that escapes their limits: only for trusted documents."""


Made = TypeVar("Made")


class IsolatedEngine(Remote):
    """The ECMAScript of an application, in another process."""

    def __init__(self, host: Worker, scopes: tuple[str, ...] = SCOPES) -> None:
        self.now = 0
        """The time by the run's calendar (ms since 1970, UTC), as ``Date`` gives it."""
        self.spent = 0.0
        """Seconds of processor time since the owner last reset it."""
        self.maker: Engines | None = None
        """The owner of the process, which must live as long as the process is used."""
        super().__init__(host, "engine", [as_data(scopes)], self)
        self.nothing = self._call("empty")
        self._lenient: dict[str, str] = {}

    @property
    def lost(self) -> str:
        """Why nothing can be evaluated any more, if so."""
        return self.host.why

    def compile(self, code: str) -> None:
        """See :meth:`Engine.compile`; returns nothing."""
        self._call("compile", as_data(code))

    def lenient(self, code: str) -> str:
        """See :meth:`Engine.lenient`."""
        if code not in self._lenient:
            self._lenient[code] = self._call("lenient", as_data(code))
        return self._lenient[code]

    def scope(self, **values: Json) -> Scope:
        """See :meth:`Engine.scope`."""
        scope = self._call("scope")
        if values:
            self.fill(scope, values)
        return scope

    def named(self, name: str) -> Scope:
        """See :meth:`Engine.named`."""
        return self._call("named", as_data(name))

    def view(self, scope: Scope) -> Scope:
        """See :meth:`Engine.view`."""
        return self._call("view", as_value(scope))

    def event(self, name: str, message: str, data: Json) -> Scope:
        """See :meth:`Engine.event`."""
        return self._call("event", as_data(name), as_data(message), as_data(data))

    def clock(self, scope: Scope, seconds: float) -> None:
        """See :meth:`Engine.clock`."""
        self._call("clock", as_value(scope), as_data(seconds))

    def set(self, scope: Scope, name: str, value: Json) -> None:
        """See :meth:`Engine.set`."""
        given = as_value(value) if isinstance(value, Handle) else as_data(value)
        self._call("set", as_value(scope), as_data(name), given)

    def fill(self, scope: Scope, values: Mapping[str, Json]) -> None:
        """See :meth:`Engine.fill`."""
        self._call("fill", as_value(scope), as_data(values))

    def unset(self, scope: Scope, *names: str) -> None:
        """See :meth:`Engine.unset`."""
        self._call("unset", as_value(scope), *map(as_data, names))

    def has(self, scope: Scope, name: str) -> bool:
        """See :meth:`Engine.has`."""
        return bool(self._call("has", as_value(scope), as_data(name)))

    def defined(self, scope: Scope, name: str) -> bool:
        """See :meth:`Engine.defined`."""
        return bool(self._call("defined", as_value(scope), as_data(name)))

    def first_undefined(self, scope: Scope, *names: str) -> int:
        """See :meth:`Engine.first_undefined`."""
        return int(self._call("first_undefined", as_value(scope), *map(as_data, names)))

    def raw(self, code: str, scopes: tuple[Scope, ...]) -> Any:
        """See :meth:`Engine.raw`."""
        return self._call("raw", as_data(code), as_values(scopes))

    def condition(self, code: str, scopes: tuple[Scope, ...]) -> bool:
        """See :meth:`Engine.condition`."""
        return bool(self._call("condition", as_data(code), as_values(scopes)))

    def text(self, code: str, scopes: tuple[Scope, ...]) -> str:
        """See :meth:`Engine.text`."""
        return bounded(str(self._call("text", as_data(code), as_values(scopes))))

    def value(self, code: str, scopes: tuple[Scope, ...]) -> Json:
        """See :meth:`Engine.value`."""
        return plain_number(self._call("value", as_data(code), as_values(scopes)))

    def get(self, scope: Scope, name: str) -> Json:
        """See :meth:`Engine.get`."""
        return plain_number(self._call("get", as_value(scope), as_data(name)))

    def elements(self, code: str, scopes: tuple[Scope, ...], most: int) -> list[Any]:
        """See :meth:`Engine.elements`."""
        array = self._call("listed", as_data(code), as_values(scopes), as_data(most))
        length = min(int(self._call("length", as_value(array))), most)
        return [EngineElement(array, index) for index in range(length)]

    def assign(self, scope: Scope, name: str, code: str, scopes: tuple[Scope, ...]) -> None:
        """See :meth:`Engine.assign`."""
        self._call("assign", as_value(scope), as_data(name), as_data(code), as_values(scopes))

    def assign_declared(self, name: str, code: str, scopes: tuple[Scope, ...]) -> None:
        """See :meth:`Engine.assign_declared`."""
        self._call("assign_declared", as_data(name), as_data(code), as_values(scopes))

    def detach(self, scope: Scope, name: str) -> None:
        """See :meth:`Engine.detach`."""
        self._call("detach", as_value(scope), as_data(name))

    def hand(self, scope: Scope, name: str, source: Scope) -> None:
        """See :meth:`Engine.hand`."""
        self._call("hand", as_value(scope), as_data(name), as_value(source))

    def put(self, scope: Scope, name: str, value: Any) -> None:
        """See :meth:`Engine.put`."""
        if value is UNDEFINED:
            self.unset(scope, name)
        elif isinstance(value, EngineElement):
            self._call(
                "pick", as_value(scope), as_data(name), as_value(value.array), as_data(value.index)
            )
        else:
            self.set(scope, name, value)

    def script(self, code: str, scope: Scope, scopes: tuple[Scope, ...]) -> None:
        """See :meth:`Engine.script`."""
        self._call("script", as_data(code), as_value(scope), as_values(scopes))


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
