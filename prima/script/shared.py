"""Engines in a shared process: those of grammars' tags, and the compiler of code."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import Any

from prima.script.budget import Budget
from prima.script.evaluation import EngineLost, ScriptError
from prima.script.remote import Remote
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

    there = "TagEngine"

    def __init__(self, budget: Budget, others: int = 0) -> None:
        """``others`` is how many of them the same utterance has already."""
        host = budget.host if budget.host is not None else _shared()
        super().__init__(host, budget, "tag_engine", others)


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

    there = "Syntax"

    def __init__(self, host: Worker) -> None:
        super().__init__(host, Nobody(), "syntax")
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
            faults = super()._call("faults", codes)  # not twice, if it ends the process
            self._faults |= zip(codes, faults, strict=True)

    def _call(self, method: str, *arguments: Any) -> Any:
        """Call it; retry in a new process, as code of others may have ended this one."""
        try:
            return super()._call(method, *arguments)
        except EngineLost:
            return IsolatedSyntax(_shared())._once(method, *arguments)

    def _once(self, method: str, *arguments: Any) -> Any:
        return super()._call(method, *arguments)

    def expression(self, code: str) -> None:
        """See :meth:`Syntax.expression`."""
        self._compile("expression", code, False)

    def script(self, code: str) -> None:
        """See :meth:`Syntax.script`."""
        self._compile("script", code, True)

    def _compile(self, method: str, code: str, is_script: bool) -> None:
        if (code, is_script) not in self._faults:
            self._call(method, code)
        elif fault := self._faults[code, is_script]:
            raise ScriptError(fault[0], place=fault[1:])
