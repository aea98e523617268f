"""What an event does in a state, as one Python function, where it happens often.

:func:`reaction_of` writes what :meth:`~prima.interpreter.handling.Handling.dispatch` does for the
handlers in scope whose names take an event: their conditions, their content, and where it leads.
It does so only for handlers in which no Command stands; all else stays with ``dispatch``. Code that
is evaluated in Python (:mod:`prima.interpreter.plain`) is written out, other code is the engine's.
What differs from one handler to the next is given to its function, so that handlers alike have
their Python compiled once.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from prima.interpreter.bounds import MAX_STEPS
from prima.interpreter.content import SIMPLE
from prima.interpreter.elements import (
    Act,
    Assign,
    Declare,
    Document,
    Expression,
    Foreach,
    Form,
    Goto,
    Handler,
    If,
    Script,
    Subdialog,
    all_acts,
    all_items,
)
from prima.interpreter.frame import Fiber, Frame, GoForm, Thrown, Transfer
from prima.interpreter.plain import FEW_PIECES, LONG, PlainEngine, is_plain
from prima.interpreter.selection import Taking
from prima.messages import Event
from prima.script.compiling import INHERITED, VARIABLES, Compiled, quickly
from prima.script.ecmascript import HELPERS, Scope, holder_of
from prima.script.evaluation import MAX_SCRIPT_SECONDS, ScriptError

if TYPE_CHECKING:
    from prima.interpreter.application import Interpreter

Given = tuple[Any, ...]
"""What differs from one handler to others alike: the seldom needed in one tuple, then the rest."""
React = Callable[["Interpreter", Frame, Event, Given], Transfer | Form | None]
"""What an event does: gives the transfer of control in which it ends, or :data:`DONE`; or the form
to which it leads, where neither form has anything to do but to wait for events."""
Reaction = tuple[React, Given]
"""A function, and what it is to be called with. Handlers alike have one function, so that what each
has of its own is little: of many states what is needed next is then at hand."""
Place = tuple[Handler | None, Expression | None]
"""Where something may fail: in a handler or a condition before it, and in which expression."""

DONE = Transfer()
"""There is nothing left to do: no handler takes the event, or its error has been handled."""
DEEPEST = 30
"""Columns at which content may stand: how deep ``if`` may be inside each other."""
WORD = re.compile(r"[\w$]+")
MOST_ACTS = 300
"""Pieces of content that are written out for one event."""
MOST_LETTERS, MOST_WRITTEN = 40_000, 1_000_000
"""Characters of the function for one event, and of all different ones of a document: compiled, each
takes ten bytes and more."""


class _Beyond(Exception):
    """There is something in it that only ``dispatch`` does."""


def reaction_of(document: Document, form: Form, candidates: Taking) -> Reaction | None:
    """What an event does in a form where these handlers take it; None if ``dispatch`` does it."""
    handlers = [handler for handler, _ in candidates]
    acts = [act for handler in handlers for act in all_acts(handler.content)]
    if document.counting or document.written > MOST_WRITTEN or len(acts) > MOST_ACTS:
        return None
    if any(one.waits for one in handlers):
        return None
    if any(handler.count != 1 for handler in handlers):
        return None
    own = any(isinstance(act, Declare | Foreach | Script) for act in acts)
    kind = _Writer if is_plain(document) else _EngineWriter
    writer = kind(document, form, document.curious or own)
    try:
        writer.reaction(handlers)
    except _Beyond:
        return None
    known = _function.cache_info().misses
    function = _function("\n".join(writer.lines))
    document.written += writer.letters * (_function.cache_info().misses - known)
    return function, ((*writer.rare, tuple(writer.places)), *writer.given)


@lru_cache(maxsize=500)
def _function(code: str) -> React:
    """A function by its text."""
    held: dict[str, Any] = {}
    exec(code, NAMES, held)
    return held["react"]  # type: ignore[no-any-return]


class _Writer:
    """Writes a function line by line, and all code in it as Python."""

    new_local, no_local = "Scope()", "nothing"
    """A new scope, and one in which nothing is declared."""

    def __init__(self, document: Document, form: Form, has_local: bool) -> None:
        self.document = document
        self.form = form
        self.has_local = has_local
        """Whether anything can stand in the handlers' own scope."""
        self.has_dialog = bool(dialog_names(document))
        """Whether anything can stand in a form's scope."""
        dialog = "dialog" if self.has_dialog else "frame.dialog"
        local = "local" if has_local else self.no_local
        self.all_scopes = f"(owner.application, document, {dialog}, {local})"
        """The scopes in a reaction, for those who need all of them: few do."""
        self.lines: list[str] = []
        self.letters = 0
        """How long they are together."""
        self.given: list[Any] = []
        """What the function is called with, behind what is seldom needed."""
        self.rare: list[Any] = []
        """What it seldom needs, for the tuple that is ``given[0]``; the last of it are the places."""
        self.places: list[Place] = [(None, None)]
        self.with_fiber = False
        """Whether the handler that is being written calls anything that needs its fiber."""
        self.with_sensors = False
        """Whether any code may look at sensors."""

    def reaction(self, handlers: Sequence[Handler]) -> None:
        """The whole function."""
        self.write(0, "def react(owner, frame, event, given):")
        before = len(self.lines)
        self.write(2, "document = frame.document")
        if self.has_dialog:
            self.write(2, "dialog = frame.dialog")
        if self.has_local:
            curious = self.document.curious
            local = "owner.handling.event_scope(event)" if curious else self.new_local
            self.write(2, f"local = {local}")
        self.write(2, "try:")
        self.handlers(handlers)
        self.write(2, "except failures as error:")
        self.write(3, "return failed(owner, frame, event, error, given[0][-1][at])")
        self.write(2, "return untaken(event)")
        if self.with_sensors:
            line = "  if owner.untold: owner.handling.tell_sensors()"
            self.lines.insert(before, line)

    def write(self, depth: int, line: str) -> None:
        """A line of the function."""
        self.letters += len(line)
        if self.letters > MOST_LETTERS:
            raise _Beyond
        self.lines.append(" " * depth + line)

    def give(self, value: Any) -> str:
        """Something that the function is called with."""
        self.given.append(value)
        return f"given[{len(self.given)}]"

    def at(self, handler: Handler | None, expr: Expression | None) -> str:
        """The place, by its number, where something may fail from here on."""
        self.places.append((handler, expr))
        return str(len(self.places) - 1)

    def where(self, name: str) -> tuple[str, ...]:
        """The scopes that may have a variable, outermost first."""
        dialog = ("dialog",) if name in dialog_names(self.document) else ()
        return ("document", *dialog, *(("local",) if self.has_local else ()))

    def expression(self, expr: Expression) -> Compiled:
        """An expression in Python."""
        found = quickly(expr.code, self.all_scopes, self.where)
        if found is None or found.pieces > FEW_PIECES:  # the engine counts the work of long ones
            raise _Beyond
        if "sensor" in expr.code or "application" in expr.code:
            self.with_sensors = True
        return found

    def condition(self, expr: Expression) -> str:
        """An expression in Python, as a condition."""
        found = self.expression(expr)
        return found.source if found.kind == "boolean" else f"truth({found.source})"

    def handlers(self, handlers: Sequence[Handler]) -> None:
        """The first handler whose condition holds; all of them are evaluated (VoiceXML 5.2.4)."""
        names: list[str] = []
        for index, handler in enumerate(handlers):
            names.append("True")
            if handler.cond is not None:
                names[-1] = f"h{index}"
                self.write(3, f"at = {self.at(None, handler.cond)}")
                self.write(3, f"h{index} = {self.condition(handler.cond)}")
        for name, handler in zip(names, handlers, strict=True):
            self.write(3, f"if {name}:")
            self.handler(handler)
        self.write(3, "pass")

    def handler(self, handler: Handler) -> None:
        """A handler whose turn it is."""
        if not self.form.bare or any(not self.stays(act) for act in all_acts(handler.content)):
            causes = {
                None: "event.serial if event.reactive else None",
                True: "event.serial or event.name",
            }
            self.write(4, f"owner.cause = {causes.get(handler.reactive)}")
        self.write(4, f"at = {self.at(handler, None)}")
        before, self.with_fiber = len(self.lines), False
        self.block(4, handler, handler.content)
        if self.with_fiber:
            local = "local" if self.has_local else "None"
            self.lines.insert(before, f"    fiber = Fiber(frame, False, {local})")
        self.write(4, "return None")

    def block(self, depth: int, handler: Handler, content: Sequence[Act]) -> None:
        """Content, piece by piece; too much of it in one instant ends the application."""
        if depth > DEEPEST:
            raise _Beyond
        self.write(depth, f"owner.steps += {len(content)}")
        if content:
            spent = f"owner.engine.spent > {MAX_SCRIPT_SECONDS}"
            over = f"owner.steps > {MAX_STEPS} or {spent} or owner.exhausted"
            self.write(depth, f"if {over}: owner.count_step(given[0][{len(self.rare)}], 0)")
            self.rare.append(content[0].node)
        for act in content:
            match act:
                case Assign() if "." not in act.name:
                    self.assign(depth, handler, act)
                case Declare():
                    self.declare(depth, handler, act)
                case If():
                    self.branches(depth, handler, act)
                case Goto(form=str(form), item=None) if form in self.document.forms:
                    self.write(depth, f"return {self.give(self.way(form))}")
                case Foreach():
                    self.repeat(depth, act)
                case _:
                    self.call(depth, handler, act)

    def assign(self, depth: int, handler: Handler, act: Assign) -> None:
        """A declared variable has a new value; innermost scope first, mostly the document's."""
        name, inner = repr(act.name), self.where(act.name)[1:]
        several = inner or act.name in VARIABLES
        scope, holder = "scope" if several else "document", f"holder_of({name}, {self.all_scopes})"
        self.write(depth, f"at = {self.at(handler, act.expr)}")
        if several:
            hidden = "".join(f" and {name} not in {one}" for one in inner)
            self.write(depth, f"scope = document if {name} in document{hidden} else {holder}")
        else:
            self.write(depth, f"if {name} not in document: {holder}")
        self.value(depth, act.expr, scope)
        self.write(depth, f"{scope}[{name}] = value")

    def declare(self, depth: int, handler: Handler, act: Declare) -> None:
        """A variable of the handler's own."""
        if act.expr is None:
            self.write(depth, f"local[{act.name!r}] = undefined")
            return
        self.write(depth, f"at = {self.at(handler, act.expr)}")
        self.value(depth, act.expr, "local")
        self.write(depth, f"local[{act.name!r}] = value")

    def value(self, depth: int, expr: Expression, scope: str) -> None:
        """The value that a variable of a scope gets; what long texts there are is bounded."""
        found = self.expression(expr)
        self.write(depth, f"value = {found.source}")
        if found.kind not in ("number", "boolean"):
            hold = f"owner.engine.hold({scope}, value)"
            self.write(depth, f"if type(value) is str and len(value) > {LONG}: {hold}")

    def branches(self, depth: int, handler: Handler, act: If) -> None:
        """The first branch whose condition holds."""
        word = "if"
        for cond, content in act.branches:
            test = "True"
            if cond is not None:
                test = f"(at := {self.at(handler, cond)}) and {self.condition(cond)}"
            self.write(depth, f"{word} {test}:")
            self.block(depth + 1, handler, content)
            word = "elif"

    def stays(self, act: Act) -> bool:
        """Whether nothing can be asked for because of content: no reaction comes of it (C5)."""
        match act:
            case Assign() | Declare() | If():
                return True
            case Goto(form=str(form), item=None) if form in self.document.forms:
                return isinstance(self.way(form), Form)
        return False

    def way(self, form: str) -> Transfer | Form:
        """The way to a form: the form itself where there is nothing to leave and to begin."""
        target = self.document.forms[form]
        return target if self.form.bare and target.bare else GoForm(form)

    def repeat(self, depth: int, act: Foreach) -> None:
        """Content for each element of an array."""
        self.with_fiber = True
        self.write(depth, f"for part in owner.execute.foreach({self.give(act)}, fiber):")
        self.write(depth + 1, "transfer = owner.execute.run_at_once(part, fiber)")
        self.write(depth + 1, "if transfer is not None: return transfer")

    def call(self, depth: int, handler: Handler, act: Act) -> None:
        """What has a method of its own, which tells where it fails."""
        method = SIMPLE.get(type(act))
        if method is None:
            raise _Beyond
        self.with_fiber = True
        self.write(depth, f"at = {self.at(handler, None)}")
        call = f"{self.give(method)}(owner.execute, {self.give(act)}, fiber)"
        self.write(depth, f"transfer = {call}")
        self.write(depth, "if transfer is not None: return transfer")


class _EngineWriter(_Writer):
    """Writes a function in which the engine evaluates all code."""

    new_local, no_local = "owner.engine.scope()", "owner.engine.nothing"

    def scopes(self, *codes: str) -> str:
        """The scopes that code and names have to see: where nothing is meant in the inner ones, not
        those, as each makes all names take longer.
        """
        self.with_sensors = True  # what the code looks at is not known
        document = self.document
        alone = self.form.bare and not (self.has_local or document.tampering)
        words = {word for code in codes for word in WORD.findall(code)}
        if alone and words.isdisjoint(INHERITED) and words.isdisjoint(dialog_names(document)):
            return "(owner.application, document)"
        return self.all_scopes

    def way(self, form: str) -> Transfer | Form:
        """The way to a form; a scope that scripts may have put something into does not stay."""
        return GoForm(form) if self.document.tampering else super().way(form)

    def condition(self, expr: Expression) -> str:
        """An expression as a condition."""
        return f"owner.engine.condition({self.give(expr.code)}, {self.scopes(expr.code)})"

    def assign(self, depth: int, handler: Handler, act: Assign) -> None:
        """A declared variable has a new value."""
        self.write(depth, f"at = {self.at(handler, act.expr)}")
        name, code = act.name, act.expr.code
        given = f"{self.give(name)}, {self.give(code)}, {self.scopes(name, code)}"
        self.write(depth, f"owner.engine.assign_declared({given})")

    def declare(self, depth: int, handler: Handler, act: Declare) -> None:
        """A variable of the handler's own."""
        name = self.give(act.name)
        if act.expr is None:
            self.write(depth, f"owner.engine.unset(local, {name})")
            return
        self.write(depth, f"at = {self.at(handler, act.expr)}")
        self.with_sensors = True
        given = f"local, {name}, {self.give(act.expr.code)}, {self.all_scopes}"
        self.write(depth, f"owner.engine.assign({given})")


def dialog_names(document: Document) -> frozenset[str]:
    """The names of all variables that any form's scope may ever have."""
    if document.dialog_names is None:
        names: set[str] = set()
        for form in document.forms.values():
            names.update(act.name for act in form.setup if isinstance(act, Declare))
            for item in all_items(form.items):
                names |= {item.name, f"{item.name}$"}
                if isinstance(item, Subdialog):
                    names.update(name for name, _ in item.params)
        document.dialog_names = frozenset(names)
    return document.dialog_names


def failed(
    owner: Interpreter, frame: Frame, event: Event, error: Thrown | ScriptError, place: Place
) -> Transfer:
    """Something has failed: an event that the handler's own state may handle.

    Raises:
        Thrown: it failed in a condition, before any handler had its turn.
    """
    handler, expr = place
    if handler is not None:
        owner.handling.allow_reaction(handler, event)
    if expr is not None and isinstance(error, ScriptError):
        error = owner.execute.failure(error, expr)
    if handler is None:
        raise error from None
    owner.handling.recover(frame, handler, error)
    return DONE


def untaken(event: Event) -> Transfer:
    """No handler takes an event.

    Raises:
        Thrown: it is an error.
    """
    if event.name.startswith("error."):
        unhandled = Thrown(event)
        unhandled.sought = True
        raise unhandled
    return DONE


NAMES: dict[str, Any] = {
    **HELPERS, "nothing": PlainEngine.nothing, "Scope": Scope,
    "Fiber": Fiber, "failures": (Thrown, ScriptError), "failed": failed, "untaken": untaken,
    "holder_of": holder_of,
}  # fmt: skip
"""What reactions know."""
