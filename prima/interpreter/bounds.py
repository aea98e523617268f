"""Bounds on what an application may do in one instant: beyond them, it ends."""

from __future__ import annotations

from collections.abc import Sized
from typing import TYPE_CHECKING, Generic, Literal, NamedTuple, NoReturn, TypeVar

from prima.interpreter.places import source
from prima.interpreter.transfers import GoOut
from prima.language.values import moment
from prima.markup.tree import Node
from prima.messages import Action, Json, Quit, Say
from prima.script.budget import Budget
from prima.script.evaluation import MAX_RUN_SECONDS, MAX_SCRIPT_SECONDS, MAX_SHARE, EngineLost
from prima.script.sandbox import START

if TYPE_CHECKING:
    from prima.interpreter.pyengine import PythonEngine
    from prima.script.isolated import AnyEngine

Evaluator = TypeVar("Evaluator", bound="AnyEngine | PythonEngine")
"""The evaluator of an application's code."""
MAX_STEPS = 20_000
"""Pieces of content that an application may execute in one instant."""
LOOKED_AT_A_STEP = 50
"""How many handlers or form items are looked at, to find the next one, for a piece of content."""
MAX_OUTPUT, MAX_WRITTEN = 1_000_000, 10_000_000
"""Characters that an application may say, log, send and pass on in one instant, and in a run."""
MAX_RUN_STEPS, STEPS_A_SECOND = 1_500_000, 5_000
"""Pieces of content that it may execute in a run, plus those for each second of the run."""
MAX_ACTIONS, ACTIONS_A_SECOND = 20_000, 20
"""Commands, messages and other actions that an application may request in a run, plus those for
each second of the run."""

BRIEF_MS, MOST_BRIEF = 50, 1_000
"""How long waits must last on average (ms), and how many more there may be."""


Visited = Literal["document", "enter", "leave", "in", "true", "false", "heard"]
"""How an application came to an element.

``document``: it is the root of a document that is there now; ``enter``: its state is active now;
``leave``: a state was left; ``in``: it is executed; ``true`` and ``false``: its condition was;
``heard``: the user said what it listens for."""


class ElementVisit(NamedTuple):
    """An application came to an element of a document."""

    app: str
    time: int
    """The instant (ms)."""
    what: Visited
    node: Node | None
    """The element; None if a state was left."""
    name: str = ""
    """The state that is active now; the path of a document."""


class Bounds(Generic[Evaluator]):
    """Counts what an application does; the base of the interpreters of both languages.

    There may be very many applications: most fields have their first values in the class.
    """

    name: str
    """The application's name."""
    over = False
    deadline: int | None = None
    """When the application wants to be called next, if ever (ms)."""
    began = moment(START)
    """When the run began by its own calendar (ms since 1970, UTC)."""
    now = -1
    """The instant, in ms since the run began."""
    written = 0
    """Characters said, logged and sent since the start."""
    steps = 0
    """Pieces of content executed in this instant."""
    hurried = -1
    """An instant that continues the previous step count, after an event sent without delay."""
    asked = 0
    """The number of actions that the session has carried out."""
    exhausted = ""
    """Why the application may not continue."""
    _short = 0
    """By how much (ms) the waits so far were too short."""
    _waits = 0
    """The number of waits since they were last long enough."""
    _waited = 0
    """When the latest wait ended."""
    _latest: Node | None = None
    """The element executed last."""
    _output = 0
    _spent = 0.0
    """Seconds spent on scripts in earlier instants, and on tags."""
    _gone = 0
    """Pieces of content executed in earlier instants."""

    def __init__(self, engine: Evaluator) -> None:
        self.engine = engine
        self.actions: list[Action] = []
        """The application's requests, for the session to carry out."""
        self.visits: list[ElementVisit] = []
        """The elements that it came to, until the session drains them."""
        self._heard = Budget()
        """The budget used to match the latest utterance."""

    def note(self, node: Node | None, what: Visited = "in", name: str = "") -> None:
        """Note what happened to an element."""
        self.visits.append(ElementVisit(self.name, self.now, what, node, name))

    def renew(self, now: int) -> None:
        """Begin a new instant, so many ms after the run began."""
        self.now = now
        if now != self.hurried:
            self._gone += self.steps
            self.steps = 0
            if self._gone > MAX_RUN_STEPS + now * STEPS_A_SECOND // 1000:
                self.exhausted = f"it went through {self._gone:,} pieces of content in this run"
        self._output = 0
        engine = self.engine
        engine.now = self.began + now
        self._spent += engine.spent + self._heard.spent
        engine.spent = self._heard.spent = 0.0
        if self._spent > MAX_RUN_SECONDS + now * MAX_SHARE / 1000:
            self.exhausted = f"its scripts took {self._spent:.1f} s of this run"

    def utterance(self) -> Budget:
        """The budget for matching one more utterance; the time of tags counts for the run."""
        self._spent += self._heard.spent
        engine = self.engine
        self._heard = Budget(engine.now, host=getattr(engine, "host", None))
        return self._heard

    def count_step(self, node: Node, steps: int = 1) -> None:
        """Bound the steps of one instant: a document may loop for ever."""
        self.steps += steps
        self._latest = node
        if self.steps > MAX_STEPS:
            self.give_up(node, "it loops without ever waiting")
        if self.exhausted:
            self.give_up(node, self.exhausted)
        if self.engine.spent > MAX_SCRIPT_SECONDS:
            self.give_up(node, "its scripts take too long without ever waiting")
        if self.engine.lost:
            self.give_up(node, self.engine.lost)

    def count_looked_at(self, node: Node, some: Sized) -> None:
        """Bound the handlers and form items looked at: a document may have very many."""
        if len(some) >= LOOKED_AT_A_STEP:
            self.count_step(node, len(some) // LOOKED_AT_A_STEP)

    def count_output(self, characters: int, node: Node) -> None:
        """Bound the text that an application says, logs, sends and passes on."""
        self._output += characters
        self.written += characters
        if self._output > MAX_OUTPUT:
            self.give_up(node, f"more than {MAX_OUTPUT:,} characters come out at once")
        if self.written > MAX_WRITTEN:
            self.give_up(node, f"more than {MAX_WRITTEN:,} characters come out in this run")

    def count_value(self, value: Json, node: Node) -> None:
        """Count a value that leaves its variables, before another is made."""
        self.count_step(node)
        self.count_output(len(value if isinstance(value, str) else str(value)), node)

    def count_action(self) -> None:
        """Bound the actions of an application in a run: each makes records.

        Raises:
            GoOut: the bound is exceeded.
        """
        self.asked += 1
        if self.asked > MAX_ACTIONS + self.now * ACTIONS_A_SECOND // 1000 and not self.over:
            place = source(self._latest) if self._latest is not None else ""
            reason = f"it asked for {self.asked:,} Commands and messages in this run"
            raise GoOut(f"error.semantic: {place}: {reason}", True, place)

    def count_wait(self, began: int, node: Node) -> None:
        """Bound waits of almost no duration (ms, when the wait began), however they are mixed.

        Commands that fail or are refused at once, and questions or calls that time out at once,
        make records for ever, whose number is limited. Longer waits make up for short ones, and so
        does time without a wait.
        """
        lasted = self.now - began + max(0, began - self._waited)
        self._short = max(0, self._short + BRIEF_MS - lasted)
        self._waits = self._waits + 1 if self._short else 0
        self._waited = self.now
        if self._short > MOST_BRIEF * BRIEF_MS:
            often = f"{BRIEF_MS - self._short / self._waits:.0f} ms"
            reason = f"it waited {self._waits:,} times, for {often} on an average"
            self.give_up(node, f"{reason}: let what comes again and again wait longer")

    def fail(self, error: Exception) -> None:
        """E2: end the application after a failure of the interpreter itself or of an engine."""
        place = source(self._latest) if self._latest is not None else ""
        if isinstance(error, GoOut):
            reason, place = error.reason, error.source
        elif isinstance(error, EngineLost):
            reason = f"error.semantic: {error}"
        else:
            reason = f"{place}: this is a defect of prima: {type(error).__name__}: {error}"
        self.over, self.deadline = True, None
        self.actions[:] = [Say("error", reason, place), Quit(reason, True)]

    def give_up(self, node: Node, reason: str) -> NoReturn:
        """End the application: it exceeded a limit, which no handler can remedy."""
        place = source(node)
        raise GoOut(f"error.semantic: {place}: {reason}", True, place)
