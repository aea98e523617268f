"""ECMAScript for untrusted documents: one engine for each application.

An expression is compiled once to a function of the scope objects it may see.
The engine's limits on time, memory and stack apply to every call. Built-ins that do not check the
time limit are stopped only if the engine has a process of its own (:mod:`prima.script.host`).
``Date`` has the run's clock and ``Math.random`` is seeded, so that a run can be repeated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from time import thread_time
from typing import TYPE_CHECKING, Any

from prima.script import sandbox
from prima.script.ecmascript import UNDEFINED
from prima.script.evaluation import (
    MAX_SCRIPT_SECONDS,
    SCOPES,
    EngineElement,
    Scope,
    ScriptError,
    bounded,
    marked,
    plain_number,
    read_json,
    whole,
)
from prima.script.hoisting import Hoisted, hoisted
from prima.script.names import script_names
from prima.script.surrogates import as_json, well_formed, well_formed_json
from prima.script.syntax import FAILURES, Syntax, column_in, confined, script_error
from prima.script.wrapping import (
    INTO,
    TARGET,
    Helpers,
    assignment,
    guarded,
    head,
    refusing,
    wrapped,
)

if TYPE_CHECKING:
    from prima.messages import Json


class Engine:
    """The ECMAScript of one application."""

    lost = ""
    """Why nothing can be evaluated any more: never, in the caller's own process."""

    def __init__(self, scopes: tuple[str, ...] = SCOPES) -> None:
        self._context = context = confined()
        self._syntax = Syntax(context)
        self._scopes = scopes
        self._names, self._withs = head(scopes)
        self.spent = 0.0
        """Seconds of evaluation since the owner last reset it."""
        # Functions by their code, for each way of using it.
        self._compiled: dict[str, Any] = {}
        self._conditions: dict[tuple[str, int], Any] = {}
        self._giving: dict[str, Any] = {}
        self._assigning: dict[tuple[str, str, int], Any] = {}
        self._scripts: dict[str, tuple[Any, Hoisted]] = {}
        context.eval(sandbox.GUARDS)
        self._help = Helpers(context, sandbox.source("engine.js"))
        self.now = self._told = 0
        """The time by the run's calendar (ms since 1970, UTC), as ``Date`` gives it."""
        self._clocked = False
        """Whether any code may read it."""
        self._tick = context.eval(sandbox.CLOCK)(sandbox.DATE)
        context.eval(sandbox.PRELUDE)
        self._tick()
        context.eval("Object.preventExtensions(globalThis)")
        self.nothing = self._call(self._help["nothing"], ())
        """A scope in which nothing is declared."""

    def _call(self, function: Any, args: tuple[Any, ...], most: float = math.inf) -> Any:
        """Call a function of the engine, unless the scripts of this instant took ``most`` seconds."""
        if self.spent > most:
            raise ScriptError("scripts take too long without ever waiting")
        now, began = self.now, thread_time()
        try:
            if self._clocked and self._told != now:
                self._told = now
                self._tick(float(now))
            return function(*args)
        except FAILURES as error:
            raise script_error(error) from None
        finally:
            self.spent += thread_time() - began

    def _evaluate(self, code: str, function: Any, args: tuple[Any, ...]) -> Any:
        """Call the function of an expression; errors have their place in its code."""
        try:
            return self._call(function, args, MAX_SCRIPT_SECONDS)
        except ScriptError as error:
            error.column = column_in(code, error.line, error.column)
            raise

    def _check(self, check: Callable[[str], None], code: str) -> None:
        """Refuse code that does not compile by itself."""
        check(code)
        self._clocked = self._clocked or sandbox.MAY_ASK_TIME.search(code) is not None

    def compile(self, code: str) -> Any:
        """Give the function of an expression, compiled on first use.

        Raises:
            ScriptError: with the line and column inside the expression.
        """
        function = self._compiled.get(code)
        if function is None:
            self._check(self._syntax.expression, code)
            function = self._compile(code, f"return {sandbox.GIVE}((\n{code}\n))")
            self._compiled[code] = function
        return function

    def lenient(self, code: str) -> str:
        """See :meth:`Syntax.lenient`."""
        return self._syntax.lenient(code)

    def _compile(self, code: str, body: str, scopes: tuple[str, ...] | None = None) -> Any:
        """A function of scopes, by default of all of them, with the code of an expression."""
        names, withs = (self._names, self._withs) if scopes is None else head(scopes)
        return self._function(names, f"{refusing(code)}{withs}{{{body}}}")

    def _function(self, parameters: str, body: str) -> Any:
        """A function of the engine; exceptions of code in it become our errors."""
        return self._call(self._context.eval, (guarded(parameters, body),))

    def empty(self) -> Scope:
        """The scope in which nothing is declared."""
        return self.nothing

    def scope(self, values: Mapping[str, Json] | None = None, *undefined: str) -> Scope:
        """A new scope object with these variables, and with others that are undefined."""
        scope = self._call(self._help["scope"], ())
        self.fill(scope, values or {})
        self.unset(scope, *undefined)
        return scope

    def named(self, name: str) -> Scope:
        """A new scope that contains itself as a variable, such as ``dialog`` (VoiceXML 5.1.2)."""
        return self._call(self._help["named"], (name,))

    def view(self, scope: Scope) -> Scope:
        """A read-only view of a scope and everything in it.

        An attempt to change it is an error; changes of the original are visible (VoiceXML 5.1.2).
        """
        return self._call(self._help["view"], (scope,))

    def event(self, name: str, message: str, data: Json) -> Scope:
        """The scope of an event's handler: ``event``, ``_event`` and ``_message``."""
        given = self.into(data) if data else None
        return self._call(self._help["event"], (name, self.into(message), given))

    def clock(self, scope: Scope, seconds: float) -> None:
        """Set a scope's ``session.time`` to the time of the run."""
        self._call(self._help["clock"], (scope, seconds))

    def into(self, value: Json) -> Any:
        """A Python value as a value of the engine.

        Raises:
            ScriptError: it has lists or objects too deep inside each other.
        """
        if isinstance(value, dict | list | tuple):
            try:
                return self._call(self._context.parse_json, (as_json(value),))
            except ValueError:  # numbers that JSON lacks
                return self._call(self._help["parse"], (as_json(marked(value)),))
            except RecursionError:
                raise ScriptError("it is nested too deep") from None
        if isinstance(value, str):
            return well_formed(value)
        # The binding truncates whole numbers to 32 bits.
        return whole(value) if isinstance(value, int) and abs(value) >= 2**31 else value

    def set(self, scope: Scope, name: str, value: Json) -> None:
        """Give a variable of a scope a value from outside."""
        self._call(self._help["set"], (scope, name, self.into(value)))

    def fill(self, scope: Scope, values: Mapping[str, Json]) -> None:
        """Give several variables of a scope values from outside."""
        for name, value in values.items():
            self.set(scope, name, value)

    def unset(self, scope: Scope, *names: str) -> None:
        """Make variables of a scope undefined."""
        for name in names:
            self._call(self._help["unset"], (scope, name))

    def has(self, scope: Scope, name: str) -> bool:
        """Whether a scope has a variable of that name."""
        return bool(self._call(self._help["has"], (scope, name)))

    def defined(self, scope: Scope, name: str) -> bool:
        """Whether a variable of a scope has a value other than undefined."""
        return bool(self._call(self._help["defined"], (scope, name)))

    def first_undefined(self, scope: Scope, *names: str) -> int:
        """The index of the first of some variables that is undefined; if none is, their number."""
        each = enumerate(names)
        return next((at for at, name in each if not self.defined(scope, name)), len(names))

    def raw(self, code: str, scopes: tuple[Scope, ...]) -> Any:
        """Evaluate an expression and return the engine's own value."""
        return self._evaluate(code, self.compile(code), scopes)

    def condition(self, code: str, scopes: tuple[Scope, ...]) -> bool:
        """Evaluate an expression as a condition; the inner scopes may be left out."""
        key = code, len(scopes)
        function = self._conditions.get(key)
        if function is None:
            self._check(self._syntax.expression, code)
            body = f"return !!(\n{code}\n)"
            function = self._conditions[key] = self._compile(
                code, body, self._scopes[: len(scopes)]
            )
        return bool(self._evaluate(code, function, scopes))

    def text(self, code: str, scopes: tuple[Scope, ...]) -> str:
        """Evaluate an expression and give its value as text for speech or a log."""
        found = self.out(self._call(self._help["text"], (self.raw(code, scopes),)))
        return "null" if found is None else str(found)

    def value(self, code: str, scopes: tuple[Scope, ...]) -> Json:
        """Evaluate an expression and give its value as plain data."""
        return self.out(self.raw(code, scopes))

    def out(self, value: Any) -> Json:
        """An engine's value as plain data; functions and undefined become None."""
        if value is None or isinstance(value, bool | int | float):
            return plain_number(value)
        if isinstance(value, str):
            return bounded(value)
        text = self._call(self._help["json"], (value,))
        return read_json(well_formed_json(text)) if isinstance(text, str) else None

    def elements(self, code: str, scopes: tuple[Scope, ...], most: int) -> list[Any]:
        """Evaluate an expression that gives an array; its elements, to be :meth:`put`.

        Raises:
            ScriptError: it is not an array.
        """
        array = self.listed(code, scopes, most)
        return [EngineElement(array, index) for index in range(self.length(array))]

    def listed(self, code: str, scopes: tuple[Scope, ...], most: int) -> Any:
        """Evaluate an expression that gives an array; give a private copy of it."""
        array = self.raw(code, scopes)
        length = self.length(array)
        if length < 0:
            raise ScriptError(f"{code} is not an array")
        if length > most:
            raise ScriptError(f"it has more than {most:,} elements")
        return self._call(self._help["listed"], (array,))

    def length(self, array: Any) -> int:
        """The number of an array's elements; -1 for anything else."""
        return int(self._call(self._help["items"], (array,)))

    def pick(self, scope: Scope, name: str, array: Any, index: int) -> None:
        """Give a variable an element of an array."""
        self._call(self._help["pick"], (scope, name, array, index))

    def assign(self, scope: Scope, name: str, code: str, scopes: tuple[Scope, ...]) -> None:
        """Evaluate an expression and give its value to a variable of a scope.

        The value stays in the engine: Python could not pass undefined back.
        """
        function = self._giving.get(code)
        if function is None:
            self._check(self._syntax.expression, code)
            around = f"{refusing(code)}{self._withs}"
            body = f"{around}{sandbox.DECLARE}({INTO}, {TARGET}, (\n{code}\n))"
            function = self._function(f"{self._names},{INTO},{TARGET}", body)
            self._giving[code] = function
        self._evaluate(code, function, (*scopes, scope, name))

    def assign_declared(self, name: str, code: str, scopes: tuple[Scope, ...]) -> None:
        """Give a declared variable, by its name as written, a value (VoiceXML 5.3.2).

        The inner scopes may be omitted if nothing in them can be meant.

        Raises:
            ScriptError: no scope declares it, or the expression fails.
        """
        key = name, code, len(scopes)
        function = self._assigning.get(key)
        if function is None:
            self._check(self._syntax.expression, code)
            names = self._scopes[: len(scopes)]
            body = assignment(name, code, names)
            function = self._assigning[key] = self._compile(code, body, names)
        self._evaluate(code, function, scopes)

    def detach(self, scope: Scope, name: str) -> None:
        """Let a variable hold a private copy of its data."""
        self._call(self._help["detach"], (scope, name))

    def hand(self, scope: Scope, name: str, source: Scope) -> None:
        """Set a variable to the value of its namesake in another scope."""
        self._call(self._help["hand"], (scope, name, source))

    def put(self, scope: Scope, name: str, value: Any) -> None:
        """Give a variable one of the engine's own values."""
        if value is UNDEFINED:
            self.unset(scope, name)
        elif isinstance(value, EngineElement):
            self.pick(scope, name, value.array, value.index)
        else:
            self._call(self._help["set"], (scope, name, value))

    def script(self, code: str, scope: Scope, scopes: tuple[Scope, ...]) -> None:
        """Run a script; its top-level declarations become variables of ``scope``."""
        kept = self._scripts.get(code)
        if kept is None:
            self._check(self._syntax.script, code)
            kept = self._scripts[code] = self._script(code)
        function, script = kept
        try:
            self._call(function, (*scopes, scope), MAX_SCRIPT_SECONDS)
        except ScriptError as error:
            if len(error.places) > 1:  # the outermost function is ours
                line, column = error.places[-2]
                column = column_in(script.code, line, column)
                error.line, error.column = line, script.column(line, column)
            raise

    def _script(self, code: str) -> tuple[Any, Hoisted]:
        """The function of a script; its parameters are all scopes, and the one for declarations."""
        script = hoisted(code)
        if script is not None:
            try:
                if script.code != code:
                    self._check(self._syntax.script, script.code)
                return self._function(*wrapped(script, self._scopes)), script
            except ScriptError:  # it contains something unexpected
                pass
        script = Hoisted(code, others=sorted(script_names(code).declared))
        return self._function(*wrapped(script, self._scopes)), script
