"""Expressions of content: conditions, values, and texts that are said."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import TypeVar

from prima.interpreter.acts import Declare, Expression, Pause, Script, Text
from prima.interpreter.frame import Fiber
from prima.interpreter.owner import Owner
from prima.interpreter.places import where
from prima.interpreter.transfers import failure
from prima.markup.tree import Node
from prima.messages import Cue, Json
from prima.script.evaluation import RESULT_LIMIT, Scope, ScriptError

Made = TypeVar("Made")

MAX_TEXT = 4000
"""Characters that a Command may say."""


class Evaluator:
    """Evaluates the code of one application."""

    def __init__(self, owner: Owner) -> None:
        self.owner = owner
        self.engine = owner.engine

    def scopes(self, fiber: Fiber) -> tuple[Scope, ...]:
        """The scopes that content sees, outermost first."""
        frame, local = fiber.frame, fiber.local
        if self.owner.untold:
            self.owner.handling.tell_sensors()
        if local is None:  # nothing has been declared in it
            local = self.engine.nothing
        return (self.owner.application, frame.document, frame.dialog, local)

    def local(self, fiber: Fiber) -> Scope:
        """The innermost scope of a piece of content."""
        if fiber.local is None:
            fiber.local = self.engine.scope()
        return fiber.local

    def by_engine(
        self, method: Callable[..., Made], expr: Expression, fiber: Fiber, *given: object
    ) -> Made:
        """Let a method of the engine evaluate an expression; a failure is an event."""
        try:
            return method(*given, expr.code, self.scopes(fiber))
        except ScriptError as error:
            raise failure(error, expr.code, where(expr, error)) from None

    def evaluate(self, expr: Expression, fiber: Fiber) -> Json:
        """An expression's value as plain data."""
        return self.by_engine(self.engine.value, expr, fiber)

    def condition(self, expr: Expression, fiber: Fiber) -> bool:
        """An expression as a condition."""
        holds: bool = self.by_engine(self.engine.condition, expr, fiber)
        self.owner.note(expr.node, "true" if holds else "false")
        return holds

    def speech(self, parts: Text, fiber: Fiber, after: str = "") -> tuple[str, tuple[Cue, ...]]:
        """Speech following other text, with values filled in, and pauses as cues."""
        said = after
        cues: list[Cue] = []
        piece: list[str | Expression] = []
        for part in (*parts, None):
            if part is not None and not isinstance(part, Pause):
                piece.append(part)
                continue
            said = " ".join(filter(None, (said, self.text(piece, fiber))))
            if len(said) > MAX_TEXT:
                break
            if part is not None:
                cues.append(Cue(len(said), "pause", part.lasts))
            piece = []
        return said[:MAX_TEXT], tuple(cues)

    def text(
        self, parts: Iterable[str | Expression | Pause], fiber: Fiber, most: int = MAX_TEXT
    ) -> str:
        """Text with values filled in, limited to ``most`` characters; without pauses."""
        said, length = [], 0
        for part in parts:
            text = self.said(part, fiber) if isinstance(part, Expression) else part
            text = text if isinstance(text, str) else " "
            said.append(text)
            length += len(text)
            if length > RESULT_LIMIT:
                break  # far more than is ever spoken
        return " ".join("".join(said).split())[:most]

    def said(self, expr: Expression, fiber: Fiber) -> str:
        """An expression's value as text."""
        said: str = self.by_engine(self.engine.text, expr, fiber)
        return said

    def plain(self, value: Json | Expression, fiber: Fiber) -> Json:
        """A value, or the value of an expression."""
        return self.evaluate(value, fiber) if isinstance(value, Expression) else value

    def named(
        self, params: Sequence[tuple[str, str | Expression]], fiber: Fiber, node: Node
    ) -> dict[str, Json]:
        """Params as plain data by name; each is counted before the next is made."""
        found: dict[str, Json] = {}
        for name, value in params:
            found[name] = self.plain(value, fiber)
            self.owner.count_value(found[name], node)
        return found

    def passed(
        self, params: Sequence[tuple[str, str | Expression]], fiber: Fiber, node: Node
    ) -> dict[str, Json]:
        """Params of a call, copied, without those that are undefined."""
        own, defined = Fiber(fiber.frame), list[tuple[str, str | Expression]]()
        for name, value in params:
            given = value
            if isinstance(value, Expression):  # its plain data would not tell undefined from null
                self.declare(Declare(name, value, node), self.local(own), fiber)
                given = replace(value, code=name)
            if given is value or self.engine.defined(own.local, name):
                defined.append((name, given))
        return self.named(defined, own, node)

    def declare(self, act: Declare, scope: Scope, fiber: Fiber) -> None:
        """Declare a variable in a scope; declared again without a value, it keeps its own (5.3.1)."""
        if act.expr is not None:
            self.by_engine(self.engine.assign, act.expr, fiber, scope, act.name)
        elif not self.engine.defined(scope, act.name):
            self.engine.unset(scope, act.name)

    def script(self, act: Script, scope: Scope, fiber: Fiber) -> None:
        """Run a script; what it declares belongs to the scope."""

        def run(code: str, scopes: tuple[Scope, ...]) -> None:
            self.engine.script(code, scope, scopes)

        self.by_engine(run, act.code, fiber)
