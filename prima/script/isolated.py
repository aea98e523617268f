"""Engines in processes of their own: what a run calls, which sends each call there.

:class:`IsolatedEngine` has the methods of :class:`~prima.script.engine.Engine`;
:class:`IsolatedSandbox` and :class:`IsolatedSyntax` those of theirs. Values of the engine are
:class:`~prima.script.worker.Handle` here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast

from prima.messages import Json
from prima.script import worker
from prima.script.budget import Budget
from prima.script.ecmascript import UNDEFINED
from prima.script.evaluation import (
    SCOPES,
    EngineLost,
    Item,
    Scope,
    ScriptError,
    bounded,
    plain_number,
)
from prima.script.worker import Handle, Meter, Nobody, Worker

if TYPE_CHECKING:
    from prima.script.engine import Engine

ISOLATIONS = ("ea", "all", "none")
"""Whose code gets a process of its own: each EA's, each application's, or nobody's.

Where it is ``ea``, FAs share one. Where it is ``none``, engines run in the process of the run, and
nothing can stop code that escapes their limits: for documents that can be trusted alone."""


Made = TypeVar("Made")


def _data(value: Any) -> list[Any]:
    return ["data", value]


def _value(value: Handle) -> list[Any]:
    return ["value", value.number]


def _values(values: tuple[Handle, ...]) -> list[Any]:
    return ["values", [one.number for one in values]]


class _Remote:
    """What is in another process, and how it is called."""

    def __init__(self, host: Worker, maker: str, arguments: list[Any], meter: Meter) -> None:
        self.host = host
        self._use = host.use
        self._meter = meter
        self._here: Handle = host.call(0, maker, arguments, meter)

    def _call(self, method: str, *arguments: list[Any]) -> Any:
        if self._use != self.host.use:
            raise EngineLost("its run has ended")
        return self.host.call(self._here.number, method, list(arguments), self._meter)


class IsolatedEngine(_Remote):
    """The ECMAScript of an application, in another process."""

    def __init__(self, host: Worker, scopes: tuple[str, ...] = SCOPES) -> None:
        self.now = 0
        """The time by the run's calendar (ms since 1970, UTC): what ``Date`` tells."""
        self.spent = 0.0
        """Seconds of the processor since the owner last set it to nought."""
        self.maker: Engines | None = None
        """Who lends the process, for as long as anybody uses it."""
        super().__init__(host, "engine", [_data(scopes)], self)
        self.nothing = self._call("empty")
        self._lenient: dict[str, str] = {}

    @property
    def lost(self) -> str:
        """Why nothing can be evaluated any more, if so."""
        return self.host.why

    def compile(self, code: str) -> None:
        """See :meth:`Engine.compile`; nothing comes back."""
        self._call("compile", _data(code))

    def lenient(self, code: str) -> str:
        """See :meth:`Engine.lenient`."""
        if code not in self._lenient:
            self._lenient[code] = self._call("lenient", _data(code))
        return self._lenient[code]

    def scope(self, **values: Json) -> Scope:
        """See :meth:`Engine.scope`."""
        scope = self._call("scope")
        for name, value in values.items():
            self.set(scope, name, value)
        return scope

    def named(self, name: str) -> Scope:
        """See :meth:`Engine.named`."""
        return self._call("named", _data(name))

    def view(self, scope: Scope) -> Scope:
        """See :meth:`Engine.view`."""
        return self._call("view", _value(scope))

    def event(self, name: str, message: str, data: Json) -> Scope:
        """See :meth:`Engine.event`."""
        return self._call("event", _data(name), _data(message), _data(data))

    def clock(self, scope: Scope, seconds: float) -> None:
        """See :meth:`Engine.clock`."""
        self._call("clock", _value(scope), _data(seconds))

    def set(self, scope: Scope, name: str, value: Json) -> None:
        """See :meth:`Engine.set`."""
        given = _value(value) if isinstance(value, Handle) else _data(value)
        self._call("set", _value(scope), _data(name), given)

    def unset(self, scope: Scope, name: str) -> None:
        """See :meth:`Engine.unset`."""
        self._call("unset", _value(scope), _data(name))

    def has(self, scope: Scope, name: str) -> bool:
        """See :meth:`Engine.has`."""
        return bool(self._call("has", _value(scope), _data(name)))

    def defined(self, scope: Scope, name: str) -> bool:
        """See :meth:`Engine.defined`."""
        return bool(self._call("defined", _value(scope), _data(name)))

    def raw(self, code: str, scopes: tuple[Scope, ...]) -> Any:
        """See :meth:`Engine.raw`."""
        return self._call("raw", _data(code), _values(scopes))

    def condition(self, code: str, scopes: tuple[Scope, ...]) -> bool:
        """See :meth:`Engine.condition`."""
        return bool(self._call("condition", _data(code), _values(scopes)))

    def text(self, code: str, scopes: tuple[Scope, ...]) -> str:
        """See :meth:`Engine.text`."""
        return bounded(str(self._call("text", _data(code), _values(scopes))))

    def value(self, code: str, scopes: tuple[Scope, ...]) -> Json:
        """See :meth:`Engine.value`."""
        return plain_number(self._call("value", _data(code), _values(scopes)))

    def get(self, scope: Scope, name: str) -> Json:
        """See :meth:`Engine.get`."""
        return plain_number(self._call("get", _value(scope), _data(name)))

    def elements(self, code: str, scopes: tuple[Scope, ...], most: int) -> list[Any]:
        """See :meth:`Engine.elements`."""
        array = self._call("listed", _data(code), _values(scopes), _data(most))
        length = min(int(self._call("length", _value(array))), most)
        return [Item(array, index) for index in range(length)]

    def assign(self, scope: Scope, name: str, code: str, scopes: tuple[Scope, ...]) -> None:
        """See :meth:`Engine.assign`."""
        self._call("assign", _value(scope), _data(name), _data(code), _values(scopes))

    def assign_declared(self, name: str, code: str, scopes: tuple[Scope, ...]) -> None:
        """See :meth:`Engine.assign_declared`."""
        self._call("assign_declared", _data(name), _data(code), _values(scopes))

    def detach(self, scope: Scope, name: str) -> None:
        """See :meth:`Engine.detach`."""
        self._call("detach", _value(scope), _data(name))

    def hand(self, scope: Scope, name: str, source: Scope) -> None:
        """See :meth:`Engine.hand`."""
        self._call("hand", _value(scope), _data(name), _value(source))

    def put(self, scope: Scope, name: str, value: Any) -> None:
        """See :meth:`Engine.put`."""
        if value is UNDEFINED:
            self.unset(scope, name)
        elif isinstance(value, Item):
            self._call("pick", _value(scope), _data(name), _value(value.array), _data(value.index))
        else:
            self.set(scope, name, value)

    def script(self, code: str, scope: Scope, scopes: tuple[Scope, ...]) -> None:
        """See :meth:`Engine.script`."""
        self._call("script", _data(code), _value(scope), _values(scopes))


class AbsentEngine:
    """What an application has whose engine cannot be had: nothing is evaluated, and it ends."""

    def __init__(self, lost: str) -> None:
        self.lost = lost
        self.now, self.spent = 0, 0.0
        self.nothing: Scope = None

    def named(self, _name: str) -> Scope:
        """A scope that nobody can look into."""

    def __getattr__(self, name: str) -> Any:
        raise EngineLost(self.lost)


class Engines:
    """The engines of one run's applications, each where its code may run.

    Args:
        isolate: one of :data:`ISOLATIONS`.
    """

    def __init__(self, isolate: str = "ea") -> None:
        self._isolate = isolate
        self.hosts: dict[str, Worker] = {}
        """The processes, by the application; that of all FAs by nothing."""
        self._absent = ""
        """Why the next application has no engine."""
        if isolate not in ISOLATIONS:
            raise ValueError(f'"{isolate}" is none of {", ".join(ISOLATIONS)}')

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
        """Make an application once more, for which no engine could be had; if need be without."""
        try:
            return make()
        except EngineLost:
            self._absent = str(error)
            try:
                return make()
            finally:
                self._absent = ""

    def close(self) -> None:
        """Give the processes back: nothing can be evaluated any more."""
        while self.hosts:
            worker.dismiss(self.hosts.popitem()[1])

    def __del__(self) -> None:
        self.close()


AnyEngine: TypeAlias = "Engine | IsolatedEngine"

_common: list[Worker] = []
_checkers: list[IsolatedSyntax] = []


def _shared() -> Worker:
    """The process for all code that leaves nothing behind; a new one if it was lost."""
    if not _common or _common[0].lost:
        _common[:] = [Worker()]
    return _common[0]


class IsolatedSandbox(_Remote):
    """The ECMAScript of one grammar document while one utterance is interpreted.

    All methods raise :class:`ScriptError`.
    """

    def __init__(self, budget: Budget, others: int = 0) -> None:
        """``others`` is how many sandboxes the same utterance has already."""
        host = budget.host if budget.host is not None else _shared()
        super().__init__(host, "sandbox", [_data(others)], budget)

    def run(self, code: str) -> None:
        """See :meth:`Sandbox.run`."""
        self._call("run", _data(code))

    def box(self, value: Json) -> Any:
        """See :meth:`Sandbox.box`."""
        return self._call("box", _data(value))

    def environment(self, text: str, merges: bool) -> Any:
        """See :meth:`Sandbox.environment`."""
        return self._call("environment", _data(text), _data(merges))

    def add(self, environment: Any, name: str, box: Any, text: str) -> None:
        """See :meth:`Sandbox.add`."""
        self._call("add", _value(environment), _data(name), _value(box), _data(text))

    def rule(self, code: str, environment: Any) -> Any:
        """See :meth:`Sandbox.rule`."""
        return self._call("rule", _data(code), _value(environment))

    def reached(self, environment: Any) -> int:
        """See :meth:`Sandbox.reached`."""
        return int(self._call("reached", _value(environment)))

    def fault(self, code: str) -> str:
        """See :meth:`Sandbox.fault`."""
        return str(self._call("fault", _data(code)))

    def carry(self, box: Any) -> str:
        """See :meth:`Sandbox.carry`."""
        return str(self._call("carry", _value(box)))

    def take(self, text: str) -> Any:
        """See :meth:`Sandbox.take`."""
        return self._call("take", _data(text))

    def json(self, box: Any) -> Json:
        """See :meth:`Sandbox.json`."""
        return self._call("json", _value(box))


def syntax() -> IsolatedSyntax:
    """What compiles code in the process that all share; a new one if that was lost."""
    host = _shared()
    if not _checkers or _checkers[0].host is not host:
        try:
            _checkers[:] = [IsolatedSyntax(host)]
        except EngineLost:  # it was ended from outside while nobody used it
            _checkers[:] = [IsolatedSyntax(_shared())]
    return _checkers[0]


AT_ONCE, LETTERS_AT_ONCE = 500, 100_000
"""Codes, and characters of them, that are compiled in one call: it has so much time."""


class IsolatedSyntax(_Remote):
    """Compiles code by itself, without running it."""

    def __init__(self, host: Worker) -> None:
        super().__init__(host, "syntax", [], Nobody())
        self._faults: dict[tuple[str, bool], tuple[str, int, int] | None] = {}
        """What has been found out ahead, by codes and whether they are scripts."""

    def look_ahead(self, codes: Iterable[tuple[str, bool]]) -> None:
        """Find out at once what is wrong with many codes: what has been found out before is let go.

        Args:
            codes: the codes that will be asked about, and whether they are scripts.
        """
        self._faults = {}
        asked: list[tuple[str, bool]] = []
        letters = 0
        for one in dict.fromkeys(codes):
            if asked and (len(asked) >= AT_ONCE or letters + len(one[0]) > LETTERS_AT_ONCE):
                self._ask(asked)
                asked, letters = [], 0
            asked.append(one)
            letters += len(one[0])
        self._ask(asked)

    def _ask(self, codes: list[tuple[str, bool]]) -> None:
        if self._use != self.host.use or self.host.lost:
            return  # who asks for one of them is told
        with suppress(ScriptError):
            faults = super()._call("faults", _data(codes))  # not twice, if it ends the process
            self._faults |= zip(codes, faults, strict=True)

    def _call(self, method: str, *arguments: list[Any]) -> Any:
        """Call it; once more in a new process, as somebody else's code may have ended this one."""
        try:
            return super()._call(method, *arguments)
        except EngineLost:
            return IsolatedSyntax(_shared())._once(method, *arguments)

    def _once(self, method: str, *arguments: list[Any]) -> Any:
        return super()._call(method, *arguments)

    def expression(self, code: str) -> None:
        """See :meth:`Syntax.expression`."""
        self._compile("expression", code, False)

    def script(self, code: str) -> None:
        """See :meth:`Syntax.script`."""
        self._compile("script", code, True)

    def _compile(self, method: str, code: str, is_script: bool) -> None:
        if (code, is_script) not in self._faults:
            self._call(method, _data(code))
        elif fault := self._faults[code, is_script]:
            error = ScriptError(fault[0])
            error.line, error.column = fault[1:]
            raise error

    def has_statements(self, code: str) -> bool:
        """See :meth:`Syntax.has_statements`."""
        return bool(self._call("has_statements", _data(code)))
