"""Engines in a shared process: those of grammars' tags, and the compiler of code."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import Any

from prima.messages import Json
from prima.script.budget import Budget
from prima.script.evaluation import EngineLost, ScriptError
from prima.script.remote import Remote, as_data, as_value
from prima.script.worker import Nobody, Worker

_common: list[Worker] = []
_checkers: list[IsolatedSyntax] = []


def _shared() -> Worker:
    """The process for all code without lasting effects; a new one if it was lost."""
    if not _common or _common[0].lost:
        _common[:] = [Worker()]
    return _common[0]


class IsolatedTagEngine(Remote):
    """The ECMAScript of one grammar document while one utterance is interpreted.

    All methods raise :class:`ScriptError`.
    """

    def __init__(self, budget: Budget, others: int = 0) -> None:
        """``others`` is how many of them the same utterance has already."""
        host = budget.host if budget.host is not None else _shared()
        super().__init__(host, "tag_engine", [as_data(others)], budget)

    def run(self, code: str) -> None:
        """See :meth:`TagEngine.run`."""
        self._call("run", as_data(code))

    def box(self, value: Json) -> Any:
        """See :meth:`TagEngine.box`."""
        return self._call("box", as_data(value))

    def environment(self, text: str, merges: bool) -> Any:
        """See :meth:`TagEngine.environment`."""
        return self._call("environment", as_data(text), as_data(merges))

    def add(self, environment: Any, name: str, box: Any, text: str) -> None:
        """See :meth:`TagEngine.add`."""
        self._call("add", as_value(environment), as_data(name), as_value(box), as_data(text))

    def rule(self, code: str, environment: Any) -> Any:
        """See :meth:`TagEngine.rule`."""
        return self._call("rule", as_data(code), as_value(environment))

    def reached(self, environment: Any) -> int:
        """See :meth:`TagEngine.reached`."""
        return int(self._call("reached", as_value(environment)))

    def fault(self, code: str) -> str:
        """See :meth:`TagEngine.fault`."""
        return str(self._call("fault", as_data(code)))

    def carry(self, box: Any) -> str:
        """See :meth:`TagEngine.carry`."""
        return str(self._call("carry", as_value(box)))

    def take(self, text: str) -> Any:
        """See :meth:`TagEngine.take`."""
        return self._call("take", as_data(text))

    def json(self, box: Any) -> Json:
        """See :meth:`TagEngine.json`."""
        return self._call("json", as_value(box))


def syntax() -> IsolatedSyntax:
    """The compiler in the shared process; a new one if that was lost."""
    host = _shared()
    if not _checkers or _checkers[0].host is not host:
        try:
            _checkers[:] = [IsolatedSyntax(host)]
        except EngineLost:  # ended from outside while idle
            _checkers[:] = [IsolatedSyntax(_shared())]
    return _checkers[0]


AT_ONCE, LETTERS_AT_ONCE = 500, 100_000
"""Maximum number of codes compiled in one call, whose time is limited, and of their characters."""


class IsolatedSyntax(Remote):
    """Compiles code by itself, without running it."""

    def __init__(self, host: Worker) -> None:
        super().__init__(host, "syntax", [], Nobody())
        self._faults: dict[tuple[str, bool], tuple[str, int, int] | None] = {}
        """Results of the look-ahead, by code and whether it is a script."""

    def look_ahead(self, codes: Iterable[tuple[str, bool]]) -> None:
        """Check many codes in one call, replacing the results of earlier calls.

        Args:
            codes: the codes to check, and whether they are scripts.
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
            return  # the check of each one raises the error
        with suppress(ScriptError):
            faults = super()._call("faults", as_data(codes))  # not twice, if it ends the process
            self._faults |= zip(codes, faults, strict=True)

    def _call(self, method: str, *arguments: list[Any]) -> Any:
        """Call it; retry in a new process, as code of others may have ended this one."""
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
            self._call(method, as_data(code))
        elif fault := self._faults[code, is_script]:
            error = ScriptError(fault[0])
            error.line, error.column = fault[1:]
            raise error

    def has_statements(self, code: str) -> bool:
        """See :meth:`Syntax.has_statements`."""
        return bool(self._call("has_statements", as_data(code)))
