"""What any application may do in one instant: beyond it, the application ends."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Generic, NoReturn, TypeVar

from prima.interpreter.content import source
from prima.interpreter.frame import GoOut
from prima.markup.tree import Node
from prima.messages import Action, Quit, Say
from prima.prelude import START
from prima.script.evaluation import MAX_RUN_SECONDS, MAX_SCRIPT_SECONDS, EngineLost
from prima.values import moment

if TYPE_CHECKING:
    from prima.interpreter.plain import PlainEngine
    from prima.script.isolated import AnyEngine

Evaluator = TypeVar("Evaluator", bound="AnyEngine | PlainEngine")
"""What evaluates an application's code."""
MAX_STEPS = 20_000
"""Pieces of content that an application may go through in one instant."""
MAX_OUTPUT = 1_000_000
"""Characters that an application may say, log and send in one instant."""

BRIEF_MS, MOST_BRIEF = 50, 1_000
"""How long a wait must last (ms), or how many may be shorter in a row."""


class Bounds(Generic[Evaluator]):
    """Counts what an application does; interpreters of both languages are such."""

    def __init__(self, engine: Evaluator) -> None:
        self.engine = engine
        self.actions: list[Action] = []
        """What the application wants, for the session to carry out."""
        self.over = False
        self.deadline: int | None = None
        """When the application wants to be called, if ever (ms)."""
        self.began = moment(START)
        """When the run began by its own calendar (ms since 1970, UTC)."""
        self.now = -1
        """The instant: so many ms after the run began."""
        self.written = 0
        """Characters said, logged and sent since the start."""
        self.steps = 0
        """Pieces of content gone through in this instant."""
        self.hurried = -1
        """An instant that is none of its own: of an event sent without delay just before."""
        self._brief = 0
        """How many waits in a row lasted almost no time."""
        self._waited = 0
        """When the latest wait ended."""
        self._latest: Node | None = None
        """What was gone through last."""
        self._output = 0
        self._spent = 0.0
        """Seconds of scripts in the instants before."""

    def renew(self, now: int) -> None:
        """A new instant begins, so many ms after the run began."""
        self.now = now
        if now != self.hurried:
            self.steps = 0
        self._output = 0
        engine = self.engine
        engine.now = self.began + now
        if engine.spent:
            self._spent += engine.spent
            engine.spent = 0.0 if self._spent <= MAX_RUN_SECONDS else math.inf

    def count_step(self, node: Node, steps: int = 1) -> None:
        """Bound what an application does in one instant; a document may loop for ever."""
        self.steps += steps
        self._latest = node
        if self.steps > MAX_STEPS:
            self.give_up(node, "it loops without ever waiting")
        if self._spent > MAX_RUN_SECONDS:
            self.give_up(node, f"its scripts took more than {MAX_RUN_SECONDS:g} s in this run")
        if self.engine.spent > MAX_SCRIPT_SECONDS:
            self.give_up(node, "its scripts take too long without ever waiting")
        if self.engine.lost:
            self.give_up(node, self.engine.lost)

    def count_output(self, characters: int, node: Node) -> None:
        """Bound what an application says, logs and sends in one instant."""
        self._output += characters
        self.written += characters
        if self._output > MAX_OUTPUT:
            self.give_up(node, f"more than {MAX_OUTPUT:,} characters come out at once")

    def count_wait(self, began: int, node: Node) -> None:
        """Bound waits that last almost no time, one after the other (ms, when the wait began).

        Commands that fail or are refused at once, and questions that time out at once, make
        records for ever, of which a run may have so many.
        """
        brief = self.now - began < BRIEF_MS and began - self._waited < BRIEF_MS
        self._brief = self._brief + 1 if brief else 0
        self._waited = self.now
        if self._brief > MOST_BRIEF:
            reason = f"it waited for less than {BRIEF_MS} ms {MOST_BRIEF:,} times in a row"
            self.give_up(node, f"{reason}: let what comes again and again wait longer")

    def fail(self, error: Exception) -> None:
        """E2: the interpreter itself or an engine has failed, and ends the application."""
        place = source(self._latest) if self._latest is not None else ""
        if isinstance(error, EngineLost):
            reason = f"error.semantic: {error}"
        else:
            reason = f"{place}: this is a defect of prima: {type(error).__name__}: {error}"
        self.over, self.deadline = True, None
        self.actions[:] = [Say("error", reason, place), Quit(reason, True, place)]

    def give_up(self, node: Node, reason: str) -> NoReturn:
        """End the application: it has gone past a limit that no handler can mend."""
        place = source(node)
        raise GoOut(f"error.semantic: {place}: {reason}", True, place)
