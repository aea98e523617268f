"""The evaluator of documents whose code Python can evaluate entirely.

An application with only such code (:func:`is_python`) is evaluated here: each expression is a
Python function of the scopes that it sees (:mod:`prima.script.compile`), and scripts only declare
data (:mod:`prima.script.data`). Any other application runs in an
:class:`~prima.script.engine.Engine`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

from prima.interpreter.elements import Document
from prima.script.compile import Compiled, Function, compiled
from prima.script.data import ScriptData, declared
from prima.script.ecmascript import (
    UNDEFINED,
    Named,
    Scope,
    Scopes,
    escaped,
    inward,
    outward,
    stringify,
    text,
    truth,
)
from prima.script.evaluation import MAX_SCRIPT_SECONDS, ScriptError, bounded
from prima.script.literals import fresh
from prima.script.operations import holder_of
from prima.script.surrogates import well_formed

if TYPE_CHECKING:
    from prima.messages import Json

LONG = 1_000
"""Length from which a text counts as long."""
MOST_HELD = 4_000_000
"""Maximum total length of the long texts in all variables of an application."""
SECONDS = 4e-9
"""The maximum time to compare, join or read a character."""
PIECE, FEW_PIECES = 125, 20
"""The work of a piece of an expression, in characters, if it has more pieces than the second."""
COUNTED = 10
"""The work of counting a variable, in characters."""
MOST_PIECES = 50_000
"""Maximum number of pieces of code of a document evaluated here."""


def is_python(document: Document) -> bool:
    """Whether all the code of a document can be evaluated here."""
    if document.python is None:
        codes: dict[str, Callable[[str], Compiled | ScriptData | None]] = {
            **dict.fromkeys((one.code for one in document.expressions), compiled),
            **dict.fromkeys(document.scripts, declared),
        }
        document.python = not document.assigns_parts and _are_python(codes)
    return document.python


def _are_python(codes: Mapping[str, Callable[[str], Compiled | ScriptData | None]]) -> bool:
    pieces = 0
    for code, read in codes.items():
        found = read(code)
        pieces += found.pieces if found else 0
        if found is None or pieces > MOST_PIECES:
            return False
    return True


def weighed(found: Compiled) -> Function:
    """The function of an expression; a long one counts as work."""
    call, pieces = found.call, found.pieces
    if pieces <= FEW_PIECES:
        return call

    def long(scopes: Scopes) -> Any:
        count = getattr(scopes[0], "count", None)
        if count is not None:
            count(PIECE * pieces)
        return call(scopes)

    return long


class PythonEngine:
    """Replaces an :class:`~prima.script.engine.Engine` for such applications."""

    nothing = Scope()
    """A scope in which nothing is declared."""
    lost = ""
    """Why nothing can be evaluated any more: never."""

    def __init__(self) -> None:
        self.now = 0
        """The time by the run's calendar: unused here."""
        self.spent = 0.0
        """Estimated seconds of work with long texts: nothing else here takes long."""
        self._long: WeakValueDictionary[int, Scope] | None = None
        """Scopes that were given a long text, by their id()."""
        self._added = 0
        self._functions: dict[str, Function] = {}
        """The functions of expressions evaluated so far, by their code."""

    def _call(self, code: str) -> Function:
        found = compiled(code)
        if found is None:
            raise ScriptError(f"SyntaxError: {code} needs an engine")
        call = self._functions[code] = weighed(found)
        return call

    def scope(self, values: Mapping[str, Json] | None = None) -> Scope:
        """A new scope with these variables."""
        return Scope({name: inward(value) for name, value in (values or {}).items()})

    def named(self, name: str) -> Scope:
        """A new scope that its expressions know as ``application``, ``document`` or ``dialog``."""
        made = Named()
        made.name = name
        if name == "application":
            made.count = self.work
        return made

    def work(self, characters: int) -> None:
        """Count work with so many characters.

        Raises:
            ScriptError: the limit of one instant is exceeded.
        """
        self.spent += characters * SECONDS
        if self.spent > MAX_SCRIPT_SECONDS:
            raise ScriptError("it works too long on long texts")

    def event(self, name: str, message: str, data: Json) -> Scope:
        """The scope of an event's handler: ``event``, ``_event`` and ``_message``."""
        given = inward(data) if data else {}
        said = well_formed(message)
        event = {"name": name, "message": said, "data": given}
        return Scope(event=event, _event=name, _message=said)

    def clock(self, scope: Scope, seconds: float) -> None:
        """Set a scope's ``session.time`` to the time of the run."""
        scope["session"] = {"time": float(seconds)}

    def set(self, scope: Scope, name: str, value: Json) -> None:
        """Give a variable of a scope a value from outside."""
        scope[name] = inward(value)

    def fill(self, scope: Scope, values: Mapping[str, Json]) -> None:
        """Give several variables of a scope values from outside."""
        for name, value in values.items():
            scope[name] = inward(value)

    def unset(self, scope: Scope, *names: str) -> None:
        """Make variables of a scope undefined."""
        for name in names:
            scope[name] = UNDEFINED

    def has(self, scope: Scope, name: str) -> bool:
        """Whether a scope has a variable of that name."""
        return name in scope

    def defined(self, scope: Scope, name: str) -> bool:
        """Whether a variable of a scope has a value other than undefined."""
        return scope.get(name, UNDEFINED) is not UNDEFINED

    def first_undefined(self, scope: Scope, *names: str) -> int:
        """The index of the first of some variables that is undefined; if none is, their number."""
        for at, name in enumerate(names):
            if scope.get(name, UNDEFINED) is UNDEFINED:
                return at
        return len(names)

    def condition(self, code: str, scopes: Scopes) -> bool:
        """Evaluate an expression as a condition."""
        return truth((self._functions.get(code) or self._call(code))(scopes))

    def text(self, code: str, scopes: Scopes) -> str:
        """Evaluate an expression and give its value as text for speech or a log."""
        value = (self._functions.get(code) or self._call(code))(scopes)
        if value is UNDEFINED:
            return "null"
        if isinstance(value, list | dict):
            return bounded(escaped(stringify(value)))
        return bounded(well_formed(text(value)))

    def value(self, code: str, scopes: Scopes) -> Json:
        """Evaluate an expression and give its value as plain data."""
        return outward((self._functions.get(code) or self._call(code))(scopes))

    def elements(self, code: str, scopes: Scopes, most: int) -> list[Any]:
        """Evaluate an expression that gives an array; give its elements.

        Raises:
            ScriptError: it is not an array.
        """
        array = (self._functions.get(code) or self._call(code))(scopes)
        if not isinstance(array, list):
            raise ScriptError(f"{code} is not an array")
        if len(array) > most:
            raise ScriptError(f"it has more than {most:,} elements")
        return array

    def assign(self, scope: Scope, name: str, code: str, scopes: Scopes) -> None:
        """Evaluate an expression and give its value to a variable of a scope."""
        self.put(scope, name, (self._functions.get(code) or self._call(code))(scopes))

    def assign_declared(self, name: str, code: str, scopes: Scopes) -> None:
        """Give a declared variable, by its name as written, a value (VoiceXML 5.3.2).

        Raises:
            ScriptError: no scope declares it, or the expression fails.
        """
        scope = holder_of(name, scopes)
        self.put(
            scope, name.rpartition(".")[2], (self._functions.get(code) or self._call(code))(scopes)
        )

    def script(self, code: str, scope: Scope, _scopes: Scopes) -> None:
        """Run a script; its declarations become variables of ``scope``."""
        data = declared(code)
        if data is None:
            raise ScriptError("SyntaxError: a script needs an engine")
        self.work(PIECE * data.pieces)
        for name, value in data.values.items():
            self.put(scope, name, fresh(value))

    def put(self, scope: Scope, name: str, value: Any) -> None:
        """Set a variable to a value of this engine.

        Raises:
            ScriptError: the total of all variables would exceed the limit.
        """
        if type(value) is str and len(value) > LONG:
            self.hold(scope, value)
        scope[name] = value

    def hold(self, scope: Scope, value: str) -> None:
        """Bound the total size of all variables, which is recounted only now and then."""
        if self._long is None:
            self._long = WeakValueDictionary()
        self._added += len(value)
        if self._added > MOST_HELD:
            held = {
                id(one): len(one)
                for kept in self._long.values()
                for one in kept.values()
                if isinstance(one, str)
            }
            self.work(COUNTED * len(held))
            held[id(value)] = len(value)
            self._added = sum(held.values())
            if self._added > MOST_HELD:
                raise ScriptError("it used too much memory")
        self._long[id(scope)] = scope
